//! Options of all commands that trace a scene: how to read it, what of it to replace, and on how many threads.

use clap::Args;
use lichtweg::scene::description::{Description, FilterDescription};
use lichtweg_io::scene_file::SceneLocation;
use lichtweg_montecarlo::SamplerKind;

use crate::console::Console;
use crate::failure::Failure;
use crate::load::{Loader, ReadArgs};
use crate::options::{self, IntegratorChoice};
use crate::overrides::Overrides;

/// What they have in common.
#[derive(Debug, Args)]
pub struct SettingsArgs {
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = options::parse_spp)]
    pub spp: Option<u32>,

    /// Size of the image in pixels
    #[arg(long, value_name = "WxH", value_parser = options::parse_size)]
    size: Option<[u32; 2]>,

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

/// `--max-depth`: `None` is no limit. (An own type, as clap takes an option in an option for an optional value.)
#[derive(Clone, Copy, Debug)]
struct MaxDepth(Option<u32>);

impl std::str::FromStr for MaxDepth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        options::parse_max_depth(text).map(Self)
    }
}

/// Stack of a thread: readers recurse over what is nested in files.
const STACK_BYTES: usize = 16 << 20;

impl SettingsArgs {
    /// Where to talk.
    pub fn console(&self) -> Console {
        Console::new(self.quiet)
    }

    /// The threads asked for.
    pub fn threads(&self) -> Result<rayon::ThreadPool, Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.unwrap_or(0))
            .stack_size(STACK_BYTES)
            .build()
            .map_err(|error| Failure::Failed(format!("the threads cannot be started: {error}")))
    }

    /// Reads a scene.
    pub fn load(&self, scene: &SceneLocation, console: Console) -> Result<(Loader, Description), Failure> {
        let mut loader = Loader::new(scene, self.lenient, console);
        match loader.read(&self.read.options()) {
            Some(description) => Ok((loader, description)),
            None => Err(loader.fail()),
        }
    }

    /// What wins over the scene's own settings.
    pub fn overrides(&self, integrator: Option<&IntegratorChoice>) -> Overrides {
        Overrides {
            size: self.size,
            crop: None,
            filter: self.filter,
            samples_per_pixel: self.spp,
            sampler: self.sampler,
            seed: self.seed,
            integrator: integrator.cloned(),
            max_depth: self.max_depth.map(|d| d.0),
        }
    }
}
