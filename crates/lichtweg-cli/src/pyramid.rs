//! `lichtweg pyramid`: the image of every strategy of bidirectional path tracing.

mod font;
mod page;
mod sheet;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use lichtweg::render::{Progress, Pyramid, StrategyImage};
use lichtweg_io::image::{Layer, OutputImage, ToneMap, write_image};

use self::sheet::{Tile, sheet};
use crate::console::tell;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options;
use crate::progress::{Goal, watch};
use crate::setup::{Setup, SetupArgs, make_directory, write_file};
use crate::text;

const EXAMPLES: &str = "\
Examples:
  lichtweg pyramid scene.xml -o pyramid --size 256x256 --spp 64 --length 5

Writes sSStTT.exr (layers: weighted, unweighted, variance), weighted.png and unweighted.png (contact sheets: a row for each \
path length, brighter from row to row as written), and index.html.";

/// Render the image of every strategy of bidirectional path tracing
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct PyramidArgs {
    #[command(flatten)]
    setup: SetupArgs,

    /// Directory for the files; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Longest paths, in edges
    #[arg(long, value_name = "K", default_value = "5", value_parser = clap::value_parser!(u32).range(1..=12))]
    length: u32,

    /// Exposure of PNG files in stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = options::parse_exposure)]
    exposure: f32,
}

/// Bytes of sums for one pixel of one strategy, and of its means.
const BYTES_PER_PIXEL: u64 = 200;

/// Renders it.
pub fn run(args: &PyramidArgs) -> Result<(), Failure> {
    args.setup.with(|_| (), |setup| render(args, &setup))
}

fn render(args: &PyramidArgs, setup: &Setup) -> Result<(), Failure> {
    let film = &setup.description.film;
    let [_, _, width, height] = film.crop.unwrap_or([0, 0, film.width, film.height]);
    let pixels = u64::from(width) * u64::from(height);
    let strategies = u64::from(args.length * (args.length + 5) / 2);
    let needed = pixels * strategies * BYTES_PER_PIXEL;
    if crate::memory::available().is_some_and(|available| needed > available) {
        return Err(Failure::Failed(format!(
            "{strategies} images of {} pixels take {} of memory; make them smaller with --size",
            text::count(pixels),
            text::bytes(needed)
        )));
    }
    make_directory(&args.output)?;
    let interrupt = Interrupt::install()
        .map_err(|error| Failure::Failed(format!("Ctrl-C cannot be watched for: {error}")))?;
    let progress = Arc::new(Progress::default());
    let samples = setup.description.sampler.samples_per_pixel;
    let goal = Goal { pixels, samples_per_pixel: Some(samples), time: None };
    let watcher = watch(setup.console, Arc::clone(&progress), interrupt, goal);
    let pyramid = setup.job.render_pyramid(&setup.description, args.length, &setup.scene, &progress);
    drop(watcher);
    if pyramid.samples_per_pixel == 0 {
        tell("stopped before the first sample: there is no image");
        return Err(Failure::Quiet(130));
    }
    write(args, &pyramid)?;
    setup.console.say(&format!(
        "{} per pixel in {}; wrote {} strategies, weighted.png, unweighted.png and index.html to {}",
        text::plural(pyramid.samples_per_pixel.into(), "sample"),
        text::seconds(pyramid.seconds),
        pyramid.strategies.len(),
        args.output.display()
    ));
    Ok(())
}

fn write(args: &PyramidArgs, pyramid: &Pyramid) -> Result<(), Failure> {
    let [_, _, width, height] = pyramid.window;
    let tone_map = ToneMap { exposure_stops: args.exposure };
    for image in &pyramid.strategies {
        let name = file_name(image);
        save(&args.output.join(format!("{name}.exr")), &layers(pyramid, image), &tone_map)?;
    }
    let total: f64 = pyramid.strategies.iter().map(|image| mean(&image.weighted)).sum();
    for weighted in [true, false] {
        let name = if weighted { "weighted" } else { "unweighted" };
        let mut tiles = Vec::with_capacity(pyramid.strategies.len());
        for image in &pyramid.strategies {
            let pixels = if weighted { &image.weighted } else { &image.unweighted };
            let tile = tile(image, pixels, weighted.then(|| share(image, total)));
            let data = pixels.iter().flat_map(|p| p.map(|v| (v * tile.gain) as f32)).collect();
            let single = picture_of(pyramid, vec![layer("", data)]);
            save(&args.output.join(format!("{}-{name}.png", file_name(image))), &single, &tone_map)?;
            tiles.push(tile);
        }
        let picture = sheet(&tiles, [width as usize, height as usize]);
        save(&args.output.join(format!("{name}.png")), &picture, &tone_map)?;
    }
    write_file(&args.output.join("index.html"), &page::page(pyramid, total))
}

/// Its place on the contact sheet, with its share in percent if that is to be told.
fn tile<'a>(image: &StrategyImage, pixels: &'a [[f64; 3]], share: Option<f64>) -> Tile<'a> {
    let gain = gain(image);
    let share = share.map_or(String::new(), |share| format!(" {share:.2}%"));
    let label = format!("s={} t={} x{gain}{share}", image.s, image.t);
    Tile { place: [(image.s + image.t - 2) as usize, image.s as usize], label, pixels, gain }
}

/// How much brighter the pictures of a row are shown: paths of more edges carry less.
fn gain(image: &StrategyImage) -> f64 {
    f64::from(1_u32 << (image.s + image.t - 2).min(20))
}

fn file_name(image: &StrategyImage) -> String {
    format!("s{:02}t{:02}", image.s, image.t)
}

/// Part of the whole image in percent.
fn share(image: &StrategyImage, total: f64) -> f64 {
    if total > 0.0 { 100.0 * mean(&image.weighted) / total } else { 0.0 }
}

fn mean(pixels: &[[f64; 3]]) -> f64 {
    pixels.iter().flatten().sum::<f64>() / (3.0 * pixels.len() as f64)
}

fn layer(name: &str, data: Vec<f32>) -> Layer {
    Layer { name: name.to_owned(), channels: ["R", "G", "B"].map(str::to_owned).to_vec(), data }
}

fn picture_of(pyramid: &Pyramid, layers: Vec<Layer>) -> OutputImage {
    let [x, y, width, height] = pyramid.window;
    let (data_offset, display_size) = ([x as i32, y as i32], pyramid.size);
    OutputImage { width, height, layers, metadata: Vec::new(), data_offset, display_size }
}

fn layers(pyramid: &Pyramid, image: &StrategyImage) -> OutputImage {
    let data = |pixels: &[[f64; 3]]| pixels.iter().flatten().map(|&v| v as f32).collect::<Vec<f32>>();
    let mut picture = picture_of(
        pyramid,
        vec![
            layer("", data(&image.weighted)),
            layer("variance", data(&image.variance)),
            layer("unweighted", data(&image.unweighted)),
            layer("unweightedVariance", data(&image.variance_unweighted)),
        ],
    );
    picture.metadata = vec![
        ("s".to_owned(), image.s.to_string()),
        ("t".to_owned(), image.t.to_string()),
        ("samplesPerPixel".to_owned(), pyramid.samples_per_pixel.to_string()),
    ];
    picture
}

fn save(path: &Path, image: &OutputImage, tone_map: &ToneMap) -> Result<(), Failure> {
    write_image(path, image, tone_map).map_err(|error| {
        tell(format_args!("error: {error}\n = help: {}", error.help));
        Failure::Quiet(1)
    })
}
