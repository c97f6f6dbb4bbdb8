//! `lichtweg bake`: irradiance maps of all shapes, by walks from the lights.

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use lichtweg::render::{BakeSettings, Deposit, Progress, bake};
use lichtweg_io::image::{Layer, OutputImage, ToneMap, write_image};

use crate::console::tell;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress::{Goal, watch};
use crate::setup::{Setup, SetupArgs, make_directory};
use crate::text;

const EXAMPLES: &str = "\
Examples:
  lichtweg bake scene.xml -o maps --walks 10000000
  lichtweg bake scene.xml -o maps --resolution 128 --deposit absorption

Writes shape-N.exr for each shape on which light falls: irradiance over its (u, v), v = 0 in the bottom row. Divided by pi and \
multiplied by the albedo it is the radiance of a diffuse surface, and can be its emission texture.";

/// Make irradiance maps of all shapes
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct BakeArgs {
    #[command(flatten)]
    setup: SetupArgs,

    /// Directory for the maps; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Walks from the lights
    #[arg(long, value_name = "N", default_value = "1000000")]
    walks: u64,

    /// Texels in a row, and rows, of each map
    #[arg(long, value_name = "N", default_value = "64", value_parser = clap::value_parser!(u32).range(1..=4096))]
    resolution: u32,

    /// When a walk leaves its power: at every hit, or where it is absorbed
    #[arg(long, value_enum, default_value = "hit")]
    deposit: DepositName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DepositName {
    Hit,
    Absorption,
}

/// Texels of all maps at most: 100 bytes each.
const MOST_TEXELS: u64 = 1 << 26;

/// Makes them.
pub fn run(args: &BakeArgs) -> Result<(), Failure> {
    args.setup.with(|description| description.keep_coordinates = true, |setup| make(args, &setup))
}

fn make(args: &BakeArgs, setup: &Setup) -> Result<(), Failure> {
    let texels = u64::from(args.resolution).pow(2) * setup.scene.shape_count() as u64;
    if texels > MOST_TEXELS {
        return Err(Failure::Usage(format!(
            "--resolution {}: {} have too many texels together; make it smaller",
            args.resolution,
            text::plural(setup.scene.shape_count() as u64, "map")
        )));
    }
    make_directory(&args.output)?;
    let settings = BakeSettings {
        walks: args.walks,
        resolution: args.resolution,
        deposit: match args.deposit {
            DepositName::Hit => Deposit::EveryHit,
            DepositName::Absorption => Deposit::Absorption,
        },
        seed: setup.description.sampler.seed,
        max_depth: setup.description.integrator.max_depth.unwrap_or(u32::MAX),
    };
    let interrupt = Interrupt::install()
        .map_err(|error| Failure::Failed(format!("Ctrl-C cannot be watched for: {error}")))?;
    let progress = Arc::new(Progress::default());
    let per_pixel = args.walks.min(u64::from(u32::MAX)) as u32;
    let goal = Goal { pixels: 1, samples_per_pixel: Some(per_pixel), time: None };
    let watcher = watch(setup.console, Arc::clone(&progress), interrupt, goal);
    let maps = bake(&setup.scene, &settings, &progress);
    drop(watcher);
    let mut written = 0;
    for map in maps.iter().filter(|map| map.irradiance.iter().flatten().any(|&v| v > 0.0)) {
        let path = args.output.join(format!("shape-{}.exr", map.shape));
        let name = setup.description.shapes.get(map.shape as usize).and_then(|s| s.name.clone());
        let image = OutputImage {
            layers: vec![Layer {
                name: String::new(),
                channels: ["R", "G", "B"].map(str::to_owned).to_vec(),
                data: map.irradiance.iter().flatten().copied().collect(),
            }],
            metadata: vec![
                ("quantity".to_owned(), "irradiance".to_owned()),
                ("shape".to_owned(), name.unwrap_or_default()),
                ("walks".to_owned(), progress.samples().to_string()),
            ],
            ..OutputImage::new(args.resolution, args.resolution)
        };
        if let Err(error) = write_image(&path, &image, &ToneMap::default()) {
            tell(format_args!("error: {error}\n = help: {}", error.help));
            return Err(Failure::Quiet(1));
        }
        written += 1;
    }
    setup.console.say(&format!(
        "{} from the lights, {}, wrote {} to {}",
        text::plural(progress.samples(), "walk"),
        text::plural(progress.rays(), "ray"),
        text::plural(written, "map"),
        args.output.display()
    ));
    Ok(())
}
