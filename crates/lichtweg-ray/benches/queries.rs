//! Millions of rays per second and thread: ours, and Embree's where `EMBREE_LIBRARY` names a libembree4.
//!
//! `cargo bench -p lichtweg-ray -- [scene substring]`. Both answer the same single-ray queries in the
//! same process, by turns; the fastest of several turns counts. `EMBREE_QUALITY` (1 medium, 2 high) and
//! `EMBREE_FLAGS` (4 robust) are handed on.

mod support;

use std::hint::black_box;

use lichtweg_ray::{Accel, Ray};
use support::embree::Embree;
use support::rays::{self, Rays};
use support::scenes::{self, Scene};

type Maker = fn() -> Scene;

const TURNS: usize = 25;

fn main() {
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    let number =
        |name: &str, default: i32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let (quality, flags) = (number("EMBREE_QUALITY", 1), number("EMBREE_FLAGS", 0));
    let library = std::env::var("EMBREE_LIBRARY").ok().and_then(|path| Embree::open(&path));
    let makers: [(&str, Maker); 6] = [
        ("box room", scenes::box_room),
        ("box room with balls", scenes::box_room_with_balls),
        ("small sphere", || scenes::displaced_sphere(40)),
        ("displaced sphere", || scenes::displaced_sphere(707)),
        ("hair ball", || scenes::hair_ball(20_000, 25)),
        ("street", || scenes::street(22)),
    ];
    for (name, make) in makers {
        if !name.contains(&wanted) {
            continue;
        }
        let scene = make();
        let accel = rays::accel(&scene);
        let comparable = library.filter(|_| scene.balls.is_empty());
        let embree = comparable.map(|l| Embree::build(l, &scene, quality, flags));
        let again = rays::accel(&scene).report().seconds.min(accel.report().seconds);
        let report = accel.report();
        println!(
            "{name}: {} triangles, {} nodes, {:.1} MB, built in {again:.3} s{}",
            report.triangles,
            report.nodes,
            report.bytes as f64 / 1e6,
            embree.as_ref().map_or(String::new(), |e| format!(" (Embree {:.3} s)", e.build_seconds)),
        );
        for set in rays::sets(&scene, &accel, 400) {
            measure(&set, &accel, embree.as_ref());
        }
    }
}

fn measure(set: &Rays, accel: &Accel, embree: Option<&Embree>) {
    let (mut ours, mut theirs) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..TURNS {
        ours = ours.min(seconds(&set.rays, |r| {
            if set.occlusion { accel.occluded(r) } else { accel.closest(r).is_some() }
        }));
        if let Some(embree) = embree {
            theirs = theirs.min(seconds(&set.rays, |r| {
                if set.occlusion { embree.occluded(r) } else { embree.closest(r).geometry != u32::MAX }
            }));
        }
    }
    let speed = |seconds: f64| set.rays.len() as f64 / seconds / 1e6;
    print!("  {:18} {:8.2} Mrays/s", set.name, speed(ours));
    if embree.is_some() {
        print!("   Embree {:8.2}   ratio {:.2}", speed(theirs), theirs / ours);
    }
    println!();
}

fn seconds(rays: &[Ray], query: impl Fn(&Ray) -> bool) -> f64 {
    let start = thread_seconds();
    let hits = rays.iter().filter(|r| query(r)).count();
    let seconds = thread_seconds() - start;
    black_box(hits);
    seconds
}

/// Processor time of this thread.
fn thread_seconds() -> f64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the record is writable.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}
