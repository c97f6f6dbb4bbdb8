//! Scenes and reference images beside the checkout.

use std::path::{Path, PathBuf};

use lichtweg::render::{Job, LayerSelection, Progress, RenderedImage};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{
    Description, Diagnostics, FilterDescription, RouletteDescription, SourceMap,
};
use lichtweg_io::image::read_exr_layers;
use lichtweg_io::options::{LoadReport, ReadOptions};

/// `../shared`, or a notice and `None`.
pub fn shared_folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    if folder.join("refs").is_dir() && folder.join("scenes").is_dir() {
        return Some(folder);
    }
    println!("skipped: there is no {} with scenes and references", folder.display());
    None
}

/// Means and the variances of those means, pixel by pixel.
pub struct Estimate {
    pub size: [usize; 2],
    pub mean: Vec<[f64; 3]>,
    pub variance: Vec<[f64; 3]>,
}

impl From<&RenderedImage> for Estimate {
    fn from(image: &RenderedImage) -> Self {
        Self {
            size: image.size.map(|n| n as usize),
            mean: image.pixels.iter().map(|p| p.mean()).collect(),
            variance: image.pixels.iter().map(|p| p.variance_of_mean()).collect(),
        }
    }
}

/// A reference image and how it was made.
pub struct Reference {
    pub estimate: Estimate,
    pub max_depth: u32,
}

impl Reference {
    /// Reads `refs/NAME.exr` and `refs/NAME.json`.
    pub fn read(folder: &Path, name: &str) -> Self {
        let path = folder.join("refs").join(name);
        let file = read_exr_layers(&path.with_extension("exr")).unwrap();
        let text = std::fs::read_to_string(path.with_extension("json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["filter"], "box");
        let channels = |names: [&str; 3]| -> Vec<[f64; 3]> {
            let planes = names.map(|name| file.channel(name).unwrap());
            (0..planes[0].len()).map(|i| planes.map(|p| f64::from(p[i]))).collect()
        };
        Self {
            estimate: Estimate {
                size: [file.width as usize, file.height as usize],
                mean: channels(["R", "G", "B"]),
                variance: channels(["variance.R", "variance.G", "variance.B"]),
            },
            max_depth: json["max_depth"].as_u64().unwrap() as u32,
        }
    }
}

/// Renders a description with the box filter and without roulette, as the references were made.
pub fn render_description(
    mut description: Description,
    size: [usize; 2],
    samples: u32,
    max_depth: u32,
) -> Estimate {
    let mut diagnostics = Diagnostics::default();
    description.film.width = size[0] as u32;
    description.film.height = size[1] as u32;
    description.film.filter = FilterDescription::BOX;
    description.sampler.samples_per_pixel = samples;
    description.sampler.seed = 1;
    description.integrator.max_depth = Some(max_depth);
    description.integrator.roulette = RouletteDescription { start_depth: None };
    let scene = Scene::compile(&description, &mut diagnostics);
    let job = Job::compile(&description, LayerSelection::default(), None, &mut diagnostics);
    let (Some(scene), Some(job)) = (scene, job) else { panic!("{:#?}", diagnostics.list) };
    let rendering = job.render(&scene, &Progress::default()).unwrap();
    assert_eq!(rendering.statistics.dropped, 0);
    Estimate::from(&rendering.image)
}

/// Reads and renders a Mitsuba scene.
pub fn render(file: &Path, reference: &Reference, samples: u32, max_depth: u32) -> Estimate {
    let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::default());
    let options = ReadOptions::default();
    let description = lichtweg_io::mitsuba::read(
        file,
        &options,
        &mut sources,
        &mut diagnostics,
        &mut LoadReport::default(),
    );
    let Some(description) = description else { panic!("{:#?}", diagnostics.list) };
    render_description(description, reference.estimate.size, samples, max_depth)
}

/// Reads a pbrt scene from a text that stands for `file`.
pub fn read_pbrt_text(text: &str, file: &Path) -> Description {
    let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::default());
    let folder = file.parent().unwrap();
    let options = ReadOptions::default();
    let name = file.to_string_lossy();
    let description = lichtweg_io::pbrt::read_str(
        text,
        &name,
        folder,
        &options,
        &mut sources,
        &mut diagnostics,
        &mut LoadReport::default(),
    );
    description.unwrap_or_else(|| panic!("{:#?}", diagnostics.list))
}
