//! What a render was asked for, and what it measured: for the image's metadata and for `--stats`.

use std::path::PathBuf;

use lichtweg::render::Rendering;
use lichtweg::scene::Scene;
use lichtweg::scene::description::Description;
use serde_json::{Value, json};

use crate::load::Loader;
use crate::options::{describe_filter, describe_integrator, describe_sampler};
use crate::progress::Goal;
use crate::{memory, text};

/// Everything about one render.
#[derive(Debug)]
pub struct Record<'a> {
    /// Where the scene came from.
    pub loader: &'a Loader,
    /// The scene as it was rendered, overrides applied.
    pub description: &'a Description,
    /// The same, compiled.
    pub scene: &'a Scene,
    /// The image and its counts.
    pub rendering: &'a Rendering,
    /// How far it was to go.
    pub goal: Goal,
    /// A signal ended it early.
    pub interrupted: bool,
}

/// The number of this release.
const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Record<'_> {
    /// Keys and values for the image file.
    pub fn metadata(&self) -> Vec<(String, String)> {
        let statistics = &self.rendering.statistics;
        let sampler = &self.description.sampler;
        let pairs = [
            ("command", command()),
            ("version", VERSION.to_owned()),
            ("scene", self.loader.location.display()),
            ("sceneHash", self.loader.hash()),
            ("estimator", describe_integrator(&self.description.integrator)),
            ("maxDepth", self.max_depth().to_string()),
            ("filter", describe_filter(&self.description.film.filter)),
            ("sampler", describe_sampler(sampler.kind).to_owned()),
            ("seed", sampler.seed.to_string()),
            ("samplesPerPixel", statistics.samples_per_pixel.to_string()),
            ("mostSamplesPerPixel", statistics.most_samples_per_pixel.to_string()),
            ("seconds", format!("{:.3}", statistics.seconds)),
            ("interrupted", self.interrupted.to_string()),
        ];
        pairs.map(|(key, value)| (key.to_owned(), value)).to_vec()
    }

    /// Everything, for `--stats`. Numbers that are not finite, such as the standard error from one sample, are `null`.
    pub fn json(&self, outputs: &[PathBuf]) -> Value {
        json!({
            "version": VERSION,
            "command": command(),
            "scene": {
                "path": self.loader.location.display(),
                "name": self.description.name,
                "hash": self.loader.hash(),
                "shapes": self.scene.shape_count(),
                "triangles": self.scene.build_report().triangles,
                "quadrics": self.scene.build_report().quadrics,
                "lights": self.scene.lights().len(),
            },
            "settings": self.settings(),
            "seconds": self.seconds(),
            "result": self.result(),
            "memory": {
                "peak_bytes": memory::peak(),
                "ray_hierarchy_bytes": self.scene.build_report().bytes,
            },
            "outputs": outputs,
        })
    }

    fn settings(&self) -> Value {
        let sampler = &self.description.sampler;
        json!({
            "size": self.rendering.image.size,
            "window": self.rendering.image.window,
            "integrator": describe_integrator(&self.description.integrator),
            "max_depth": self.max_depth(),
            "filter": describe_filter(&self.description.film.filter),
            "sampler": describe_sampler(sampler.kind),
            "seed": sampler.seed,
            "samples_per_pixel": self.goal.samples_per_pixel,
            "time_limit_seconds": self.goal.time.map(|t| t.as_secs_f64()),
            "threads": rayon::current_num_threads(),
            "lenient": self.loader.diagnostics.lenient,
        })
    }

    fn seconds(&self) -> Value {
        let load = &self.loader.report;
        json!({
            "load": load.total_seconds,
            "load_parse": load.parse_seconds,
            "load_meshes": load.mesh_seconds,
            "load_images": load.image_seconds,
            "compile": self.scene.report().seconds,
            "build": self.scene.build_report().seconds,
            "render": self.rendering.statistics.seconds,
        })
    }

    fn result(&self) -> Value {
        let statistics = &self.rendering.statistics;
        let rays = &statistics.walks.rays;
        let (mean, error) = self.rendering.image.mean();
        json!({
            "samples_per_pixel": statistics.samples_per_pixel,
            "most_samples_per_pixel": statistics.most_samples_per_pixel,
            "passes": statistics.passes,
            "interrupted": self.interrupted,
            "camera_paths": statistics.paths,
            "intersection_rays": rays.closest,
            "occlusion_rays": rays.occlusion,
            "rays": self.rays(),
            "rays_per_second": self.rays() as f64 / statistics.seconds,
            "paths_per_second": statistics.paths as f64 / statistics.seconds,
            "mean_path_length": statistics.walks.edges as f64 / statistics.paths as f64,
            "mean_radiance": mean,
            "mean_radiance_standard_error": error,
            "dropped_samples": statistics.dropped,
            "first_dropped_sample": statistics.first_dropped.map(|(pixel, sample)| json!({
                "pixel": pixel,
                "sample": sample,
                "seed": self.description.sampler.seed,
            })),
        })
    }

    /// How many samples the pixels have, in words.
    pub fn samples(&self) -> String {
        let statistics = &self.rendering.statistics;
        let (least, most) = (statistics.samples_per_pixel, statistics.most_samples_per_pixel);
        let text = text::plural(most.into(), "sample");
        if least == most { text } else { format!("{least} to {text}") }
    }

    /// A few lines for the user.
    pub fn summary(&self) -> String {
        let statistics = &self.rendering.statistics;
        let (mean, error) = self.rendering.image.mean();
        let [r, g, b] = std::array::from_fn(|i| with_error(mean[i], error[i]));
        format!(
            "{} per pixel in {}: {} paths, {} rays, {:.2} Mrays/s\nmean radiance {r}, {g}, {b} (R, G, B)",
            self.samples(),
            text::seconds(statistics.seconds),
            text::count(statistics.paths),
            text::count(self.rays()),
            self.rays() as f64 / statistics.seconds * 1e-6,
        )
    }

    /// What to say about samples that were left out, if there are any.
    pub fn dropped_warning(&self) -> Option<String> {
        let statistics = &self.rendering.statistics;
        let ([x, y], sample) = statistics.first_dropped?;
        Some(format!(
            "warning: {} of {} samples were negative or not finite, and are left out; one is sample {sample} of pixel \
             {x},{y}: replay it with --crop {x},{y},1,1 --spp {} --seed {}",
            text::count(statistics.dropped),
            text::count(statistics.paths),
            u64::from(sample) + 1,
            self.description.sampler.seed,
        ))
    }

    fn rays(&self) -> u64 {
        let rays = &self.rendering.statistics.walks.rays;
        rays.closest + rays.occlusion
    }

    /// Largest number of path edges; -1 for no limit.
    fn max_depth(&self) -> i64 {
        self.description.integrator.max_depth.map_or(-1, i64::from)
    }
}

/// The command line that this process was started with.
fn command() -> String {
    let mut arguments: Vec<String> = std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect();
    if let Some(program) = arguments.first_mut() {
        "lichtweg".clone_into(program);
    }
    text::shell_command(arguments)
}

/// A number and its standard error, with as many digits as the error allows.
fn with_error(value: f64, error: f64) -> String {
    if !error.is_finite() {
        return format!("{value:.4}");
    }
    let digits = if error > 0.0 { (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize } else { 4 };
    format!("{value:.digits$} ± {error:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::with_error;

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(with_error(0.123_456, 0.00123), "0.1235 ± 0.0012");
        assert_eq!(with_error(12.3, 25.0), "12 ± 25");
        assert_eq!(with_error(0.5, f64::INFINITY), "0.5000");
        assert_eq!(with_error(0.5, 0.0), "0.5000 ± 0.0000");
    }
}
