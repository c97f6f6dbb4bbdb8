//! `lichtweg render`: from a scene to pictures.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use lichtweg::render::{Job, LayerSelection, Progress, RenderError, RenderedImage, Rendering};
use lichtweg::scene::Scene;
use lichtweg::scene::description::Description;
use lichtweg_io::image::{Layer, OutputImage, ToneMap};
use lichtweg_io::scene_file::SceneLocation;

use crate::console::{Console, tell};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::load::location_parser;
use crate::options::{self, IntegratorChoice};
use crate::output::Outputs;
use crate::overrides::Overrides;
use crate::progress::{Goal, watch};
use crate::record::Record;
use crate::settings::SettingsArgs;
use crate::{memory, text};

const EXAMPLES: &str = "\
Examples:
  lichtweg render                       the built-in Cornell box
  lichtweg render scene.xml -D spp=16   with a parameter of the scene's own
  lichtweg render scene.xml --time 60 -o a.exr -o a.png --exposure 1
  lichtweg render scene.pbrt --size 640x360 --spp 256 --max-depth 9 --filter box
  lichtweg render scene.xml --integrator path:light=nee,rr_depth=off --layers all
  lichtweg render scene.xml --integrator bdpt --max-depth 6
  lichtweg render scene.xml --crop 100,50,64,64 --stats stats.json

Ctrl-C ends a render after the pass it is in, with an image of the samples so far (exit code 0); a second Ctrl-C \
leaves at once, without an image (exit code 130).";

/// Render a scene
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct RenderArgs {
    /// Scene file (.xml, .pbrt, .pbrt.gz) or builtin:NAME
    #[arg(default_value = "builtin:cornell-box", value_parser = location_parser())]
    scene: SceneLocation,

    /// Image file, by extension .exr, .png, .jpg, .hdr or .pfm (repeatable) [default: NAME.exr and NAME.png]
    #[arg(short, long, value_name = "FILE", value_parser = options::output_parser())]
    output: Vec<PathBuf>,

    /// Render for this long; without --spp as many samples as fit
    #[arg(long, value_name = "SECONDS", value_parser = options::parse_seconds)]
    time: Option<Duration>,

    /// Render only this part: pixels from the top left corner
    #[arg(long, value_name = "X,Y,W,H", value_parser = options::parse_crop)]
    crop: Option<[u32; 4]>,

    /// Estimator, with settings that differ from the scene's: path:light=naive|nee|mis, heuristic=balance|power,
    /// lights=auto|uniform|power|tree, rr_depth=N|off, hide_emitters=true|false; bdpt with the last four; light with the last
    #[arg(long, value_name = "NAME[:KEY=VALUE,...]", value_parser = options::parse_integrator)]
    integrator: Option<IntegratorChoice>,

    #[command(flatten)]
    settings: SettingsArgs,

    /// Exposure of PNG files in stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = options::parse_exposure)]
    exposure: f32,

    /// Layers of EXR files besides the image: variance, albedo, normal, depth, all or none
    #[arg(long, value_name = "NAMES", default_value = "variance", value_parser = options::parse_layers)]
    layers: LayerSelection,

    /// Write everything that was measured to this file, as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
}

/// Renders.
pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    args.settings.threads()?.install(|| render(args, args.settings.console()))
}

fn render(args: &RenderArgs, console: Console) -> Result<(), Failure> {
    let mut outputs = Outputs::new(&args.output, args.stats.as_deref())?;
    let (mut loader, mut description) = args.settings.load(&args.scene, console)?;
    args.overrides().apply(&mut description)?;
    outputs.complete(&description.name)?;
    let goal = args.goal(&description);
    check_memory(goal.pixels, args.layers)?;

    let diagnostics = &mut loader.diagnostics;
    let job = Job::compile(&description, args.layers, args.time, diagnostics);
    let scene = console.stage("building", || Scene::compile(&description, diagnostics));
    let (Some(job), Some(scene)) = (job, scene) else { return Err(loader.fail()) };
    loader.show();

    let (rendering, interrupted) = run_job(&job, &scene, goal, console)?;
    let record = Record {
        loader: &loader,
        description: &description,
        scene: &scene,
        rendering: &rendering,
        goal,
        interrupted,
    };
    let image = output_image(&rendering.image, args.layers, record.metadata());
    let tone_map = ToneMap { exposure_stops: args.exposure };
    let (written, images_saved) = outputs.save(&image, &tone_map, console);
    drop(image);
    let statistics_saved = outputs.save_statistics(&record.json(&written));
    record.dropped_warning().iter().for_each(tell);
    if interrupted {
        console.say(&format!("stopped early: the image has {} per pixel", record.samples()));
    }
    console.say(&record.summary());
    if let Some(panic) = &rendering.panic {
        tell(format_args!(
            "error: a thread panicked ({panic}), which is a mistake in the program\n = help: what was rendered before is \
             saved; {} per pixel",
            record.samples()
        ));
        return Err(Failure::Quiet(1));
    }
    if images_saved && statistics_saved { Ok(()) } else { Err(Failure::Quiet(1)) }
}

impl RenderArgs {
    fn overrides(&self) -> Overrides {
        // Where only time is given, it alone counts.
        let unlimited = self.time.map(|_| u32::MAX);
        Overrides {
            crop: self.crop,
            samples_per_pixel: self.settings.spp.or(unlimited),
            ..self.settings.overrides(self.integrator.as_ref())
        }
    }

    /// How far the render of a scene, overrides applied, will go.
    fn goal(&self, description: &Description) -> Goal {
        let film = &description.film;
        let [_, _, width, height] = film.crop.unwrap_or([0, 0, film.width, film.height]);
        Goal {
            pixels: u64::from(width) * u64::from(height),
            samples_per_pixel: (self.time.is_none() || self.settings.spp.is_some())
                .then_some(description.sampler.samples_per_pixel),
            time: self.time,
        }
    }
}

/// Runs the job under the eyes of the user; the image, and whether a signal cut it short.
fn run_job(job: &Job, scene: &Scene, goal: Goal, console: Console) -> Result<(Rendering, bool), Failure> {
    let interrupt = Interrupt::install()
        .map_err(|error| Failure::Failed(format!("Ctrl-C cannot be watched for: {error}")))?;
    if console == Console::Plain {
        console.say(&announcement(job, &goal));
    }
    let progress = Arc::new(Progress::default());
    let watcher = watch(console, Arc::clone(&progress), interrupt.clone(), goal);
    let result = job.render(scene, &progress);
    drop(watcher);
    match result {
        Ok(rendering) => {
            let complete = Some(rendering.statistics.samples_per_pixel) == goal.samples_per_pixel;
            Ok((rendering, interrupt.asked() && !complete))
        }
        Err(error @ RenderError::Stopped) => {
            tell(format_args!("{error}: there is no image"));
            Err(Failure::Quiet(130))
        }
    }
}

fn announcement(job: &Job, goal: &Goal) -> String {
    let [width, height] = job.size();
    let samples = goal.samples_per_pixel.map(|n| format!(", {} per pixel", text::plural(n.into(), "sample")));
    let time = goal.time.map(|t| format!(", for {}", text::seconds(t.as_secs_f64())));
    format!(
        "rendering {width}x{height} pixels{}{} on {}",
        samples.unwrap_or_default(),
        time.unwrap_or_default(),
        text::plural(rayon::current_num_threads() as u64, "thread")
    )
}

/// Refuses an image that would not fit into memory, rather than be killed while rendering it.
fn check_memory(pixels: u64, layers: LayerSelection) -> Result<(), Failure> {
    use lichtweg::film::{AuxiliarySums, Pixel};
    let auxiliary = layers.albedo || layers.normal || layers.depth;
    let sums = size_of::<Pixel>() + if auxiliary { size_of::<AuxiliarySums>() } else { 0 };
    let channels = if auxiliary { 13 } else { 6 };
    // The sums in tiles and as an image; the channels interleaved and apart.
    let needed = pixels * (2 * sums + 2 * channels * size_of::<f32>()) as u64;
    match memory::available() {
        Some(available) if needed > available => Err(Failure::Failed(format!(
            "an image of {} pixels takes {} of memory, and {} are free; make it smaller with --size, or render it in \
             parts with --crop",
            text::count(pixels),
            text::bytes(needed),
            text::bytes(available),
        ))),
        _ => Ok(()),
    }
}

fn output_image(
    rendered: &RenderedImage,
    layers: LayerSelection,
    metadata: Vec<(String, String)>,
) -> OutputImage {
    let [x, y, width, height] = rendered.window;
    let layers = rendered.layers(layers).into_iter().map(|layer| Layer {
        name: layer.name.to_owned(),
        channels: layer.channels.iter().map(|&c| c.to_owned()).collect(),
        data: layer.data,
    });
    OutputImage {
        width,
        height,
        layers: layers.collect(),
        metadata,
        data_offset: [x as i32, y as i32],
        display_size: rendered.size,
    }
}
