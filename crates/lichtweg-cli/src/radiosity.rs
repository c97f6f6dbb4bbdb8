//! `lichtweg radiosity`: the rendering equation of a diffuse scene as a linear system, solved by walks or without, and
//! looked at. The bridge between the renderer and `lichtweg solve`.

mod patches;
mod quadric;
mod solving;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;
use lichtweg::camera::Camera;
use lichtweg::scene::Scene;
use lichtweg::scene::description::Description;
use lichtweg_io::image::{Layer, OutputImage, ToneMap, write_image};
use lichtweg_io::scene_file::SceneLocation;
use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_walk::{Method, System};
use rayon::prelude::*;

use crate::console::Console;
use crate::failure::Failure;
use crate::load::{Loader, ReadArgs, location_parser};
use crate::solve::write_text;
use crate::text::{count, seconds};
use patches::Patches;

const EXAMPLES: &str = "\
Examples:
  lichtweg radiosity builtin:cornell-box -o box.png
  lichtweg radiosity scene.xml -o out.exr --patch 0.05 --rays 4096
  lichtweg radiosity builtin:cornell-box -o walks.png --method adjoint
  lichtweg radiosity builtin:cornell-box --system box    write box-M.mtx and box-b.mtx (green), for `lichtweg solve`";

/// Solve a diffuse scene as a linear system, by walks or without
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RadiosityArgs {
    /// Scene file (.xml, .pbrt, .pbrt.gz) or builtin:NAME, lit by its own surfaces
    #[arg(value_parser = location_parser())]
    scene: SceneLocation,

    #[command(flatten)]
    read: ReadArgs,

    /// Image to write: .exr, .png, .hdr or .pfm
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write the system of the green channel as NAME-M.mtx and NAME-b.mtx
    #[arg(long, value_name = "NAME")]
    system: Option<String>,

    /// Length of a patch's edges, as a fraction of the scene's diagonal
    #[arg(long, value_name = "FRACTION", default_value_t = 0.04)]
    patch: f32,

    /// Rays from each patch for its form factors
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,

    /// How: deterministic, sequential, or any other method of `lichtweg solve`, for each patch in sight
    #[arg(long, value_name = "METHOD", default_value = "deterministic", value_parser = crate::solve::method)]
    method: Method,

    /// Relative half width of the 95 % interval of each patch
    #[arg(long, value_name = "REL", default_value_t = 0.02, value_parser = crate::solve::positive)]
    tolerance: f64,

    /// Rays for each pixel
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    spp: u32,

    /// Seed of form factors and walks
    #[arg(long, default_value_t = 0)]
    seed: u64,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Solves, and writes what was asked for.
pub fn run(args: &RadiosityArgs) -> Result<(), Failure> {
    if args.output.is_none() && args.system.is_none() {
        return Err(Failure::Usage(
            "nothing to write: -o FILE for an image, --system NAME for the system".into(),
        ));
    }
    if !(args.patch > 0.0 && args.patch.is_finite()) {
        return Err(Failure::Usage("--patch has to be above 0".to_owned()));
    }
    let console = Console::new(args.quiet);
    let mut loader = Loader::new(&args.scene, false, console);
    let Some(description) = loader.read(&args.read.options()) else { return Err(loader.fail()) };
    let Some(scene) = Scene::compile(&description, &mut loader.diagnostics) else {
        return Err(loader.fail());
    };
    if !description.instances.is_empty() {
        return Err(Failure::Failed("radiosity knows no instances: place the shapes themselves".to_owned()));
    }
    let (width, height) = (description.film.width, description.film.height);
    let camera = Camera::compile(&description.camera, width, height, &mut loader.diagnostics);
    let Some(camera) = camera else { return Err(loader.fail()) };
    loader.show();

    let bounds = scene.bounds();
    let diagonal = (bounds.max - bounds.min).length_squared().sqrt();
    let patches = Patches::new(&scene, args.patch * diagonal).map_err(Failure::Failed)?;
    let form_factors = console.stage("form factors", || patches.form_factors(args.rays, args.seed));
    console.say(&format!(
        "{} patches, {} form factors",
        count(patches.len() as u64),
        count(form_factors.entries() as u64)
    ));
    let systems = [0, 1, 2].map(|channel| patches.system(&form_factors, channel));
    let systems: Vec<System> = systems.into_iter().collect::<Result<_, _>>().map_err(Failure::Failed)?;
    if let Some(name) = &args.system {
        write_system(name, &systems[1])?;
        console.say(&format!("wrote {name}-M.mtx and {name}-b.mtx: lichtweg solve {name}-M.mtx -b {name}-b.mtx --problem fixed-point -u 1"));
    }
    if let Some(path) = &args.output {
        let view = View { patches: &patches, camera: &camera, description: &description, args };
        let wanted = wanted(&view, console);
        let began = Instant::now();
        let radiosity = solving::solve(&systems, wanted.as_deref(), args, console)?;
        console.say(&format!(
            "solved by {} in {}",
            args.method.name(),
            seconds(began.elapsed().as_secs_f64())
        ));
        write(path, view.image(&radiosity))?;
        console.say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

/// The patches to ask for, where each has to be paid for: those that the camera sees. `None` stands for all.
fn wanted(view: &View<'_>, console: Console) -> Option<Vec<usize>> {
    if matches!(view.args.method, Method::Auto | Method::Deterministic | Method::Direct | Method::Sequential)
    {
        return None;
    }
    let seen = view.seen();
    console.say(&format!(
        "note: for the {} patches in sight a deterministic solver is the right tool, or --method sequential, which walks for all of \
         them at once",
        count(seen.len() as u64)
    ));
    Some(seen)
}

/// What the camera sees.
struct View<'a> {
    patches: &'a Patches,
    camera: &'a Camera,
    description: &'a Description,
    args: &'a RadiosityArgs,
}

impl View<'_> {
    /// Patches along the rays of a pixel.
    fn met(&self, index: u32) -> impl Iterator<Item = usize> + '_ {
        let (width, height) = (self.description.film.width, self.description.film.height);
        (0..self.args.spp).filter_map(move |sample| {
            let mut sampler = Sampler::new(SamplerKind::Sobol, self.args.seed, u64::from(index), sample);
            let [x, y] = sampler.next_2d();
            let film =
                [((index % width) as f32 + x) / width as f32, ((index / width) as f32 + y) / height as f32];
            self.patches.seen(&self.camera.ray(film, sampler.next_2d(), 0.0)).map(|patch| patch as usize)
        })
    }

    fn pixels(&self) -> u32 {
        self.description.film.width * self.description.film.height
    }

    /// All patches in sight.
    fn seen(&self) -> Vec<usize> {
        let seen: Vec<AtomicBool> = (0..self.patches.len()).map(|_| AtomicBool::new(false)).collect();
        (0..self.pixels()).into_par_iter().for_each(|pixel| {
            self.met(pixel).for_each(|patch| seen[patch].store(true, Ordering::Relaxed));
        });
        (0..seen.len()).filter(|&patch| seen[patch].load(Ordering::Relaxed)).collect()
    }

    /// Radiance, three numbers a pixel.
    fn image(&self, radiosity: &[Vec<f64>]) -> OutputImage {
        let film = &self.description.film;
        let scale = f64::from(film.scale) / (std::f64::consts::PI * f64::from(self.args.spp));
        let pixel = |index: u32| {
            let mut sum = [0.0_f64; 3];
            for patch in self.met(index) {
                sum.iter_mut().zip(radiosity).for_each(|(sum, b)| *sum += b[patch]);
            }
            sum.map(|sum| (sum * scale) as f32)
        };
        let data: Vec<[f32; 3]> = (0..self.pixels()).into_par_iter().map(pixel).collect();
        let channels = ["R", "G", "B"].map(str::to_owned).to_vec();
        let layer = Layer { name: String::new(), channels, data: data.into_iter().flatten().collect() };
        OutputImage { layers: vec![layer], ..OutputImage::new(film.width, film.height) }
    }
}

fn write(path: &Path, image: OutputImage) -> Result<(), Failure> {
    write_image(path, &image, &ToneMap::default())
        .map_err(|error| Failure::Failed(format!("{error}\n = help: {}", error.help)))
}

fn write_system(name: &str, system: &System) -> Result<(), Failure> {
    let matrix = system.matrix();
    let n = matrix.rows();
    let mut text = format!("%%MatrixMarket matrix coordinate real general\n{n} {n} {}\n", matrix.entries());
    for (i, j, value) in matrix.triplets() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{} {} {value:e}", i + 1, j + 1);
    }
    write_text(Path::new(&format!("{name}-M.mtx")), &text)?;
    crate::solve::write_vector(Path::new(&format!("{name}-b.mtx")), system.source())
}
