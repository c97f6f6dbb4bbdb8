//! What the commands about paths have in common: a scene, settings that replace its own, and threads.

use clap::Args;
use lichtweg::render::{Job, LayerSelection};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{Description, EstimatorKind, FilterDescription};
use lichtweg_io::scene_file::SceneLocation;
use lichtweg_montecarlo::SamplerKind;

use crate::console::Console;
use crate::failure::Failure;
use crate::load::{Loader, ReadArgs, location_parser};
use crate::options::{self, IntegratorChoice};
use crate::overrides::Overrides;
use crate::render::{MaxDepth, STACK_BYTES};

/// A scene and settings.
#[derive(Debug, Args)]
pub struct SetupArgs {
    /// Scene file (.xml, .pbrt, .pbrt.gz) or builtin:NAME
    #[arg(value_parser = location_parser())]
    scene: SceneLocation,

    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = options::parse_spp)]
    spp: Option<u32>,

    /// Size of the image in pixels
    #[arg(long, value_name = "WxH", value_parser = options::parse_size)]
    size: Option<[u32; 2]>,

    /// Settings of bidirectional path tracing: bdpt:heuristic=balance|power, rr_depth=N|off, hide_emitters=true|false
    #[arg(long, value_name = "bdpt[:KEY=VALUE,...]", value_parser = options::parse_integrator)]
    integrator: Option<IntegratorChoice>,

    /// Largest number of path edges: 1 emitters alone, 2 direct light, -1 no limit
    #[arg(long, value_name = "D")]
    max_depth: Option<MaxDepth>,

    /// Reconstruction filter: box, tent, gaussian, mitchell, catmullrom or lanczos
    #[arg(long, value_name = "NAME[:RADIUS]", value_parser = options::parse_filter)]
    filter: Option<FilterDescription>,

    /// Random numbers: independent or sobol
    #[arg(long, value_name = "NAME", value_parser = options::parse_sampler)]
    sampler: Option<SamplerKind>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", value_parser = options::parse_seed)]
    seed: Option<u64>,

    /// Threads; the result does not depend on it [default: all processors]
    #[arg(long, value_name = "N", value_parser = options::parse_threads)]
    threads: Option<usize>,

    #[command(flatten)]
    read: ReadArgs,

    /// Replace what is not supported, with a warning, instead of failing
    #[arg(long)]
    lenient: bool,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
}

/// A scene that is ready to be rendered.
#[derive(Debug)]
pub struct Setup {
    /// As it was described, settings replaced.
    pub description: Description,
    /// Compiled.
    pub scene: Scene,
    /// Its job.
    pub job: Job,
    /// Where to talk.
    pub console: Console,
}

impl SetupArgs {
    /// Does something with the scene, in a pool of the threads asked for.
    pub fn with(
        &self,
        prepare: impl FnOnce(&mut Description) + Send,
        action: impl FnOnce(Setup) -> Result<(), Failure> + Send,
    ) -> Result<(), Failure> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.unwrap_or(0))
            .stack_size(STACK_BYTES)
            .build()
            .map_err(|error| Failure::Failed(format!("the threads cannot be started: {error}")))?;
        pool.install(|| action(self.compile(prepare)?))
    }

    fn compile(&self, prepare: impl FnOnce(&mut Description)) -> Result<Setup, Failure> {
        let console = Console::new(self.quiet);
        let mut loader = Loader::new(&self.scene, self.lenient, console);
        let Some(mut description) = loader.read(&self.read.options()) else { return Err(loader.fail()) };
        let overrides = Overrides {
            size: self.size,
            filter: self.filter,
            samples_per_pixel: self.spp,
            sampler: self.sampler,
            seed: self.seed,
            integrator: self.integrator.clone(),
            max_depth: self.max_depth.map(|d| d.0),
            ..Default::default()
        };
        overrides.apply(&mut description)?;
        description.integrator.estimator = EstimatorKind::Bidirectional;
        prepare(&mut description);
        let diagnostics = &mut loader.diagnostics;
        let job = Job::compile(&description, LayerSelection::default(), None, diagnostics);
        let scene = console.stage("building", || Scene::compile(&description, diagnostics));
        let (Some(job), Some(scene)) = (job, scene) else { return Err(loader.fail()) };
        loader.show();
        Ok(Setup { description, scene, job, console })
    }
}

/// Makes a directory, if it is not there.
pub fn make_directory(path: &std::path::Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path)
        .map_err(|error| Failure::Failed(format!("{} cannot be made: {error}", path.display())))
}

/// Writes a file.
pub fn write_file(path: &std::path::Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text)
        .map_err(|error| Failure::Failed(format!("{} cannot be written: {error}", path.display())))
}
