//! Rays against time, build time and memory: ours, and Embree's where `EMBREE_LIBRARY` names a libembree4
//! (`bench/fetch_embree.py` fetches one).
//!
//! `cargo bench -p lichtweg-ray -- [--quick] [--builds] [--avx2] [scene substring]`. Both sides answer the same
//! single-ray queries on the same triangles in the same process, by turns, with denormals flushed to zero; the
//! fastest of several turns counts. `--builds` measures no queries, but more builds; `--avx2` holds both sides to
//! AVX2, which they leave for AVX-512 otherwise. `STREET_PLY` names the street as a PLY file (`--example street_ply` of
//! `lichtweg-io` writes it), `HOUSE_PLY` the folder of the house's PLY files; without the first a stand-in
//! street is generated, without the second the house is left out. With `--features count` nodes and triangles touched are counted instead.

mod support;

use libloading::Library;
use lichtweg_ray::math::Vec3;
use lichtweg_ray::{Accel, BuildOptions, BuildQuality, CurveBasis};
use support::embree::{Embree, Mode};
use support::rays::{self, Rays};
use support::scenes::{self, Scene};
use support::timing::{self, Threads, by_turns};

type Maker = fn() -> Option<Scene>;

/// How much to measure.
#[derive(Clone, Copy)]
struct Settings {
    /// Rays across and down the picture.
    side: u32,
    turns: usize,
    builds: usize,
    queries: bool,
}

impl Settings {
    fn new(flag: impl Fn(&str) -> bool) -> Self {
        let queries = !flag("--builds");
        match (flag("--quick"), queries) {
            (true, true) => Self { side: 300, turns: 7, builds: 1, queries },
            (true, false) => Self { side: 300, turns: 0, builds: 3, queries },
            (false, true) => Self { side: 400, turns: 25, builds: 3, queries },
            (false, false) => Self { side: 400, turns: 0, builds: 9, queries },
        }
    }
}

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let flag = |name: &str| arguments.iter().any(|a| a == name);
    if flag("--avx2") {
        // SAFETY: no other thread runs yet.
        unsafe {
            std::env::set_var("LICHTWEG_ISA", "avx2");
            std::env::set_var("EMBREE_CONFIG", "isa=avx2");
        }
    }
    timing::flush_denormals();
    rayon::ThreadPoolBuilder::new()
        .start_handler(|_| timing::flush_denormals())
        .build_global()
        .expect("threads");
    let wanted = arguments.iter().find(|a| !a.starts_with('-')).cloned().unwrap_or_default();
    let settings = Settings::new(flag);
    let library = std::env::var("EMBREE_LIBRARY").ok().and_then(|path| Embree::open(&path));
    let makers: [(&str, Maker); 5] = [
        ("displaced sphere", || Some(scenes::displaced_sphere(707))),
        ("street", street),
        ("hair ball", || Some(scenes::hair_ball(20_000, 25))),
        ("house", house),
        ("teapot in a stadium", || Some(scenes::stadium::teapot_in_a_stadium(160))),
    ];
    let mut found = Found::default();
    for (name, make) in makers {
        if !name.contains(&wanted) {
            continue;
        }
        match make() {
            Some(scene) => compare(&scene, library, settings, &mut found),
            None => println!("\n{name}: skipped, see the head of this program"),
        }
    }
    for (name, basis) in [("hairs of lines", CurveBasis::Linear), ("hairs of splines", CurveBasis::BSpline)] {
        if name.contains(&wanted) {
            compare_curves(name, basis, library, settings);
        }
    }
    summarise_builds(&found.builds);
    summarise(&found.queries);
}

fn street() -> Option<Scene> {
    let Ok(path) = std::env::var("STREET_PLY") else {
        println!("\nSTREET_PLY is not set: a stand-in for the street");
        return Some(scenes::street(22));
    };
    let (eye, target, light) =
        (Vec3::new(1.5, 5.8, 15.0), Vec3::new(-0.8, 5.8, -30.0), Vec3::new(120.0, 112.0, 68.0));
    scenes::files::read("street", &path, eye, target, light)
}

fn house() -> Option<Scene> {
    let path = std::env::var("HOUSE_PLY").ok()?;
    let (eye, light) = (Vec3::new(-37.47, -0.61, 32.12), Vec3::new(-40.0, 60.0, 40.0));
    let scene = scenes::files::read("house", &path, eye, eye + Vec3::new(0.6665, 0.152, -0.7298), light)?;
    Some(Scene { field: 0.3, ..scene })
}

/// One ratio of times: theirs over ours.
struct Ratio {
    scene: &'static str,
    occlusion: bool,
    threads: Threads,
    robust: bool,
    ratio: f64,
}

/// What all scenes add up to.
#[derive(Default)]
struct Found {
    /// Times of fast and high builds, ours over theirs.
    builds: Vec<[f64; 2]>,
    queries: Vec<Ratio>,
}

fn compare(scene: &Scene, library: Option<&'static Library>, settings: Settings, found: &mut Found) {
    println!("\n{}: {} triangles", scene.name, scene.indices.len());
    let accel = builds(scene, library, settings, &mut found.builds);
    if !settings.queries {
        return;
    }
    let sets = rays::sets(scene, &accel, settings.side);
    if cfg!(feature = "count") {
        return sets.iter().for_each(|set| count(set, &accel));
    }
    let embree = |mode| library.map(|l| Embree::build(l, scene, mode));
    let (high, robust) = (embree(Mode::High), embree(Mode::Robust));
    println!("  Mrays/s               ours      Embree high       Embree robust");
    for threads in [Threads::One, Threads::All] {
        for set in &sets {
            measure(
                set,
                threads,
                &accel,
                [high.as_ref(), robust.as_ref()],
                scene.name,
                settings,
                &mut found.queries,
            );
        }
    }
}

/// Round curves, of which Embree 4 has the same kinds; no part of the summary.
fn compare_curves(
    name: &'static str,
    basis: CurveBasis,
    library: Option<&'static Library>,
    settings: Settings,
) {
    let curves = scenes::curves::curves(basis, scenes::curves::hair_ball(20_000));
    println!("\n{name}: {} segments", curves.segment_count());
    let accel = Accel::build(vec![curves.clone().into()], BuildOptions::default()).expect("sound curves");
    let embree = library.map(|l| Embree::build_curves(l, &curves));
    let line = |whose: &str, seconds: f64, bytes: f64| {
        let a_segment = bytes / curves.segment_count() as f64;
        println!("  build {whose:14} {seconds:7.3} s  {a_segment:6.1} bytes a segment");
    };
    line("high", accel.report().seconds, accel.report().bytes as f64);
    if let Some(embree) = &embree {
        line("Embree high", embree.build_seconds, embree.bytes as f64);
    }
    if !settings.queries {
        return;
    }
    let sets = rays::of_hairs(&accel, settings.side);
    println!("  Mrays/s               ours      Embree high");
    for threads in [Threads::One, Threads::All] {
        for set in &sets {
            let embrees = [embree.as_ref(), None];
            measure(set, threads, &accel, embrees, name, settings, &mut Vec::new());
        }
    }
}

/// Times and memory of builds; returns ours of high quality.
fn builds(
    scene: &Scene,
    library: Option<&'static Library>,
    settings: Settings,
    ratios: &mut Vec<[f64; 2]>,
) -> Accel {
    let ours = |quality| {
        let accel = rays::accel_of(scene, quality);
        (accel.report().seconds, accel.report().bytes as f64)
    };
    let theirs = |mode| {
        library.map_or((f64::NAN, f64::NAN), |l| {
            let embree = Embree::build(l, scene, mode);
            (embree.build_seconds, embree.bytes as f64)
        })
    };
    let (mut b0, mut b1, mut b2, mut b3) = (0.0, 0.0, 0.0, 0.0);
    let keep = |(seconds, bytes): (f64, f64), to: &mut f64| {
        *to = bytes;
        seconds
    };
    let seconds = by_turns(
        settings.builds,
        [
            &mut || keep(ours(BuildQuality::Fast), &mut b0),
            &mut || keep(theirs(Mode::Medium), &mut b1),
            &mut || keep(ours(BuildQuality::High), &mut b2),
            &mut || keep(theirs(Mode::High), &mut b3),
        ],
    );
    ratios.push([seconds[0] / seconds[1], seconds[2] / seconds[3]]);
    let names = ["fast", "Embree medium", "high", "Embree high"];
    for ((name, bytes), seconds) in names.iter().zip([b0, b1, b2, b3]).zip(seconds) {
        if seconds.is_finite() {
            let per_triangle = bytes / scene.indices.len() as f64;
            println!("  build {name:14} {seconds:7.3} s  {per_triangle:6.1} bytes a triangle");
        }
    }
    let mut fast = rays::accel_of(scene, BuildQuality::Fast);
    let positions: std::sync::Arc<[Vec3]> = scene.positions.clone().into();
    let mut refit = || {
        let start = std::time::Instant::now();
        fast.refit(&[(0, positions.clone())]).expect("the same mesh");
        start.elapsed().as_secs_f64()
    };
    println!("  refit of fast        {:7.3} s", by_turns(settings.builds, [&mut refit])[0]);
    rays::accel_of(scene, BuildQuality::High)
}

fn measure(
    set: &Rays,
    threads: Threads,
    accel: &Accel,
    embrees: [Option<&Embree>; 2],
    scene: &'static str,
    settings: Settings,
    all: &mut Vec<Ratio>,
) {
    let occlusion = set.occlusion;
    let mut ours = || {
        timing::seconds(threads, &set.rays, |r| {
            if occlusion { accel.occluded(r) } else { accel.closest(r).is_some() }
        })
    };
    let theirs = |embree: Option<&Embree>| {
        embree.map_or(f64::NAN, |e| {
            timing::seconds(threads, &set.rays, |r| {
                if occlusion { e.occluded(r) } else { e.closest(r).geometry != u32::MAX }
            })
        })
    };
    let [ours, high, robust] =
        by_turns(settings.turns, [&mut ours, &mut || theirs(embrees[0]), &mut || theirs(embrees[1])]);
    let speed = |seconds: f64| set.rays.len() as f64 / seconds / 1e6;
    let label = if threads == Threads::One { "1 thread" } else { "all threads" };
    print!("  {:8} {label:11} {:7.2}", set.name, speed(ours));
    for (seconds, robust) in [(high, false), (robust, true)] {
        if seconds.is_finite() {
            let ratio = seconds / ours;
            print!("   {:7.2} ({ratio:.2}x)", speed(seconds));
            all.push(Ratio { scene, occlusion, threads, robust, ratio });
        }
    }
    println!();
}

/// Nodes and triangles touched per ray.
#[cfg(feature = "count")]
fn count(set: &Rays, accel: &Accel) {
    use lichtweg_ray::counts;
    counts::take();
    for ray in &set.rays {
        std::hint::black_box(if set.occlusion { accel.occluded(ray) } else { accel.closest(ray).is_some() });
    }
    let n = set.rays.len() as f64;
    let [nodes, blocks] = counts::take().map(|c| c as f64 / n);
    println!("  {:8} {nodes:6.2} nodes, {blocks:6.2} blocks of up to 8 triangles a ray", set.name);
}

#[cfg(not(feature = "count"))]
fn count(_: &Rays, _: &Accel) {}

fn summarise_builds(ratios: &[[f64; 2]]) {
    for (i, kind) in ["fast against Embree medium", "high against Embree high"].into_iter().enumerate() {
        let mean = ratios.iter().map(|r| r[i].ln()).sum::<f64>() / ratios.len() as f64;
        if mean.is_finite() {
            println!("\ntime of builds, {kind}: {:.3} in the geometric mean", mean.exp());
        }
    }
}

/// Geometric means and the smallest ratios.
fn summarise(all: &[Ratio]) {
    if all.is_empty() {
        return;
    }
    println!("\nspeed, as multiples of Embree's: geometric mean (least)");
    for robust in [false, true] {
        for threads in [Threads::One, Threads::All] {
            for occlusion in [false, true] {
                let of_kind = |r: &&Ratio| (r.robust, r.threads, r.occlusion) == (robust, threads, occlusion);
                let some: Vec<&Ratio> = all.iter().filter(of_kind).collect();
                let Some(least) = some.iter().min_by(|a, b| a.ratio.total_cmp(&b.ratio)) else { continue };
                let mean = (some.iter().map(|r| r.ratio.ln()).sum::<f64>() / some.len() as f64).exp();
                println!(
                    "  {:9} against {:6}, {:11}: {mean:.3} ({:.3}, {})",
                    if occlusion { "occlusion" } else { "closest" },
                    if robust { "robust" } else { "high" },
                    if threads == Threads::One { "1 thread" } else { "all threads" },
                    least.ratio,
                    least.scene,
                );
            }
        }
    }
}
