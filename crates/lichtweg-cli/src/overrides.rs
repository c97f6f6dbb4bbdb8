//! What the command line changes in a scene's description.

use lichtweg::scene::description::{Description, FilterDescription};
use lichtweg_montecarlo::SamplerKind;

use crate::failure::Failure;
use crate::options::IntegratorChoice;

/// Settings that win over the scene's; what is `None` stays.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Full film size.
    pub size: Option<[u32; 2]>,
    /// The part to render: x, y, width, height.
    pub crop: Option<[u32; 4]>,
    /// Reconstruction filter.
    pub filter: Option<FilterDescription>,
    /// Samples a pixel.
    pub samples_per_pixel: Option<u32>,
    /// Random numbers.
    pub sampler: Option<SamplerKind>,
    /// Seed.
    pub seed: Option<u64>,
    /// The estimator.
    pub integrator: Option<IntegratorChoice>,
    /// Largest number of path edges, `None` inside for no limit.
    pub max_depth: Option<Option<u32>>,
}

impl Overrides {
    /// Applies them; the failure where the crop does not fit the film.
    pub fn apply(&self, description: &mut Description) -> Result<(), Failure> {
        let film = &mut description.film;
        if let Some([width, height]) = self.size {
            // The scene's crop goes on showing the same part of the picture.
            film.crop = film.crop.map(|crop| scale_crop(crop, [film.width, film.height], [width, height]));
            (film.width, film.height) = (width, height);
        }
        if let Some(crop) = self.crop {
            check_crop(crop, film.width, film.height)?;
            film.crop = Some(crop);
        }
        film.filter = self.filter.unwrap_or(film.filter);
        let sampler = &mut description.sampler;
        sampler.samples_per_pixel = self.samples_per_pixel.unwrap_or(sampler.samples_per_pixel);
        sampler.kind = self.sampler.unwrap_or(sampler.kind);
        sampler.seed = self.seed.unwrap_or(sampler.seed);
        if let Some(choice) = &self.integrator {
            choice.apply(&mut description.integrator);
        }
        description.integrator.max_depth = self.max_depth.unwrap_or(description.integrator.max_depth);
        Ok(())
    }
}

fn check_crop([x, y, w, h]: [u32; 4], width: u32, height: u32) -> Result<(), Failure> {
    let fits = |start: u32, length: u32, all: u32| u64::from(start) + u64::from(length) <= u64::from(all);
    if fits(x, w, width) && fits(y, h, height) {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "--crop {x},{y},{w},{h}: does not lie in the image of {width}x{height} pixels; X + WIDTH may be at most \
         {width}, Y + HEIGHT at most {height}"
    )))
}

/// The same part of a film of another size, rounded to whole pixels of which there is at least one.
fn scale_crop(crop: [u32; 4], from: [u32; 2], to: [u32; 2]) -> [u32; 4] {
    let scale = |at: u64, axis: usize| {
        let (from, to) = (u64::from(from[axis].max(1)), u64::from(to[axis]));
        (at * to + from / 2) / from
    };
    let [x, y, w, h] = crop.map(u64::from);
    let span = |start: u64, length: u64, axis: usize| {
        let all = u64::from(to[axis]);
        let first = scale(start, axis).min(all.saturating_sub(1));
        let end = scale(start + length, axis).clamp(first + 1, all.max(first + 1));
        [first as u32, (end - first) as u32]
    };
    let ([x, w], [y, h]) = (span(x, w, 0), span(y, h, 1));
    [x, y, w, h]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crops_must_fit() {
        assert!(check_crop([0, 0, 10, 10], 10, 10).is_ok());
        assert!(check_crop([1, 0, 10, 10], 10, 10).is_err());
        assert!(check_crop([0, u32::MAX, 1, 10], 10, 10).is_err());
    }

    #[test]
    fn crops_scale_with_the_film() {
        assert_eq!(scale_crop([10, 20, 30, 40], [100, 100], [50, 200]), [5, 40, 15, 80]);
        assert_eq!(scale_crop([99, 0, 1, 100], [100, 100], [4, 4]), [3, 0, 1, 4]);
        assert_eq!(scale_crop([0, 0, 1, 1], [100, 100], [10, 10]), [0, 0, 1, 1]);
    }

    #[test]
    fn only_what_is_given_changes() {
        let mut description = Description::default();
        let before = format!("{description:?}");
        Overrides::default().apply(&mut description).unwrap();
        assert_eq!(format!("{description:?}"), before);
        let all = Overrides {
            size: Some([8, 4]),
            crop: Some([1, 1, 2, 2]),
            filter: Some(FilterDescription::BOX),
            samples_per_pixel: Some(3),
            sampler: Some(SamplerKind::Sobol),
            seed: Some(9),
            integrator: None,
            max_depth: Some(None),
        };
        all.apply(&mut description).unwrap();
        assert_eq!((description.film.width, description.film.height), (8, 4));
        assert_eq!(description.film.crop, Some([1, 1, 2, 2]));
        assert_eq!((description.sampler.samples_per_pixel, description.sampler.seed), (3, 9));
        assert_eq!(description.integrator.max_depth, None);
    }
}
