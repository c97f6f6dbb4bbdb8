//! Does a sampler follow its density? Chi-squared of samples against the integrated density, over a rectangle or the
//! sphere.
//!
//! A pilot run places the cells (see the partition); an independent run fills them; the density is integrated over
//! each. Two tests come out: the shape (chi-squared over the cells, given how many samples were valid) and the mass
//! (the fraction of valid samples against the integral of the density, which may be below one).

use super::partition::{Partition, Rectangle};
use super::quadrature::integrate;
use super::{ChiSquaredError, Outcome, chi_squared_test, z_test};
use crate::{Sampler, SamplerKind};
use std::f64::consts::PI;
use std::fmt;

/// Settings of a test of a sampler against its density. Start from the default:
///
/// ```
/// use lichtweg_montecarlo::{hypothesis::DensityTest, warp};
/// let test = DensityTest { samples: 100_000, ..DensityTest::default() };
/// let sample = |sampler: &mut lichtweg_montecarlo::Sampler| Some(warp::cosine_hemisphere(sampler.next_2d()));
/// let right = test.sphere(sample, |w| warp::cosine_hemisphere_pdf(w[2])).unwrap();
/// assert!(!right.rejects(0.01), "{right}");
/// let wrong = test.sphere(sample, |w| if w[2] > 0.0 { warp::UNIFORM_HEMISPHERE_PDF } else { 0.0 }).unwrap();
/// assert!(wrong.rejects(0.01));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityTest {
    /// Samples counted. A tenth as many more are drawn to place the cells.
    pub samples: u32,
    /// Cells along the two axes before refinement: (cos theta, phi) on the sphere.
    pub grid: [usize; 2],
    /// Cells are split while they hold more than one in this many of the samples.
    pub cells: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Difference between sampled fraction and integral that is put down to quadrature and f32 rounding.
    pub integral_tolerance: f64,
}

impl Default for DensityTest {
    fn default() -> Self {
        Self { samples: 1_000_000, grid: [10, 20], cells: 500, seed: 1, integral_tolerance: 5e-4 }
    }
}

/// Result of a [`DensityTest`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityReport {
    /// Shape: chi-squared over the cells.
    pub shape: Outcome,
    /// Mass: z test of sampled fraction against integral, beyond the tolerance.
    pub mass: Outcome,
    /// Fraction of the samples that were valid (not `None`).
    pub sampled_fraction: f64,
    /// Integral of the density.
    pub pdf_integral: f64,
}

impl DensityReport {
    /// p-value of both tests together (Sidak over two).
    #[must_use]
    pub fn p_value(&self) -> f64 {
        if self.shape.p_value.is_nan() || self.mass.p_value.is_nan() {
            return f64::NAN;
        }
        let smaller = self.shape.p_value.min(self.mass.p_value);
        smaller * (2.0 - smaller)
    }

    /// Whether the sampler is found to disagree with its density at significance `alpha`.
    #[must_use]
    pub fn rejects(&self, alpha: f64) -> bool {
        let p = self.p_value();
        p.is_nan() || p < alpha
    }
}

impl fmt::Display for DensityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "chi-squared {:.1} with {} degrees of freedom (p = {:.3e}); \
             sampled fraction {:.6}, integral {:.6} (p = {:.3e})",
            self.shape.statistic,
            self.shape.dof,
            self.shape.p_value,
            self.sampled_fraction,
            self.pdf_integral,
            self.mass.p_value
        )
    }
}

/// Why a sampler could not be tested: each is a failure of the sampler or of its density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DensityTestError {
    /// A sample is not finite, a zero direction, or outside the domain.
    InvalidSample([f64; 3]),
    /// The density is negative, NaN or infinite at this point.
    InvalidDensity([f64; 3]),
    /// No sample was valid.
    NoSamples,
    /// The counts cannot be tested.
    Counts(ChiSquaredError),
}

impl fmt::Display for DensityTestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidSample(p) => write!(f, "invalid sample {p:?}"),
            Self::InvalidDensity(p) => write!(f, "invalid density at {p:?}"),
            Self::NoSamples => write!(f, "no valid samples"),
            Self::Counts(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for DensityTestError {}

impl From<ChiSquaredError> for DensityTestError {
    fn from(error: ChiSquaredError) -> Self {
        Self::Counts(error)
    }
}

/// Samples in cells of no density that are put down to rounding at a boundary, as a fraction of all.
const STRAY_FRACTION: f64 = 1e-5;

impl DensityTest {
    /// Tests directions against a density per solid angle. `sample` draws one (of any length) or `None` for an
    /// invalid sample, a delta lobe and the like; `pdf` takes a unit direction.
    ///
    /// # Errors
    /// See [`DensityTestError`].
    pub fn sphere(
        &self,
        mut sample: impl FnMut(&mut Sampler) -> Option<[f32; 3]>,
        mut pdf: impl FnMut([f32; 3]) -> f32,
    ) -> Result<DensityReport, DensityTestError> {
        // The cylinder (cos theta, phi) has the area of the sphere (Archimedes).
        let domain = Rectangle { min: [-1.0, -PI], max: [1.0, PI] };
        let point = |sampler: &mut Sampler| {
            let Some(direction) = sample(sampler) else { return Ok(None) };
            let direction = direction.map(f64::from);
            cylinder_point(direction).map(Some).ok_or(DensityTestError::InvalidSample(direction))
        };
        let density = |[cos_theta, phi]: [f64; 2]| {
            let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
            let direction = [sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta];
            (f64::from(pdf(direction.map(|c| c as f32))), direction)
        };
        self.run(domain, point, density)
    }

    /// Tests points of the rectangle from `min` to `max` against a density per area.
    ///
    /// # Errors
    /// See [`DensityTestError`].
    pub fn rectangle(
        &self,
        min: [f32; 2],
        max: [f32; 2],
        mut sample: impl FnMut(&mut Sampler) -> Option<[f32; 2]>,
        mut pdf: impl FnMut([f32; 2]) -> f32,
    ) -> Result<DensityReport, DensityTestError> {
        let domain = Rectangle { min: min.map(f64::from), max: max.map(f64::from) };
        let point = |sampler: &mut Sampler| {
            let Some(p) = sample(sampler) else { return Ok(None) };
            let p = p.map(f64::from);
            if domain.contains(p) {
                Ok(Some(p))
            } else {
                Err(DensityTestError::InvalidSample([p[0], p[1], 0.0]))
            }
        };
        let density = |p: [f64; 2]| (f64::from(pdf(p.map(|c| c as f32))), [p[0], p[1], 0.0]);
        self.run(domain, point, density)
    }

    fn run(
        &self,
        domain: Rectangle,
        mut sample: impl FnMut(&mut Sampler) -> Result<Option<[f64; 2]>, DensityTestError>,
        density: impl FnMut([f64; 2]) -> (f64, [f64; 3]),
    ) -> Result<DensityReport, DensityTestError> {
        let mut draw = |stream, i| sample(&mut Sampler::new(SamplerKind::Independent, self.seed, stream, i));
        let mut pilot = Vec::new();
        for i in 0..self.samples / 10 {
            pilot.extend(draw(0, i)?);
        }
        let capacity = (pilot.len() / self.cells.max(1)).max(10);
        let partition = Partition::new(domain, self.grid, &pilot, capacity);

        let mut counts = vec![0_u64; partition.len()];
        for i in 0..self.samples {
            if let Some(p) = draw(1, i)? {
                counts[partition.locate(p)] += 1;
            }
        }
        let expected = self.probabilities(&partition, density)?;
        self.compare(counts, &expected)
    }

    /// Integral of the density over each cell.
    fn probabilities(
        &self,
        partition: &Partition,
        mut density: impl FnMut([f64; 2]) -> (f64, [f64; 3]),
    ) -> Result<Vec<f64>, DensityTestError> {
        let mut invalid = None;
        let mut f = |p| {
            let (value, place) = density(p);
            if value >= 0.0 && value.is_finite() {
                return value;
            }
            invalid.get_or_insert(place);
            // Ends the refinement of the cell.
            f64::NAN
        };
        let tolerance = 1e-4 / partition.cells().count() as f64;
        let mut probabilities = vec![0.0; partition.len()];
        for (cell, bounds) in partition.cells() {
            probabilities[cell] = integrate(&mut f, bounds, tolerance, 10);
        }
        invalid.map_or(Ok(probabilities), |place| Err(DensityTestError::InvalidDensity(place)))
    }

    fn compare(&self, mut counts: Vec<u64>, expected: &[f64]) -> Result<DensityReport, DensityTestError> {
        let valid: u64 = counts.iter().sum();
        if valid == 0 {
            return Err(DensityTestError::NoSamples);
        }
        let samples = f64::from(self.samples);
        let impossible = |cell: usize| expected[cell] == 0.0;
        let strays: u64 = (0..counts.len()).filter(|&c| impossible(c)).map(|c| counts[c]).sum();
        if strays as f64 <= STRAY_FRACTION * samples {
            (0..counts.len()).filter(|&c| impossible(c)).for_each(|c| counts[c] = 0);
        }
        let shape = chi_squared_test(&counts, expected)?;

        let sampled_fraction = valid as f64 / samples;
        let pdf_integral: f64 = expected.iter().sum();
        let excess = ((sampled_fraction - pdf_integral).abs() - self.integral_tolerance).max(0.0);
        // A fraction of exactly 0 or 1 still is known to 1/N only.
        let deviation = (sampled_fraction * (1.0 - sampled_fraction) / samples).sqrt() + 1.0 / samples;
        let mass = z_test(excess, deviation * deviation);
        Ok(DensityReport { shape, mass, sampled_fraction, pdf_integral })
    }
}

/// (cos theta, phi) of a direction of any length; `None` if it is zero or not finite.
fn cylinder_point([x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let length = (x * x + y * y + z * z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    // z alone has lost the digits that tell directions near a pole apart.
    let from_pole = (x * x + y * y) / (length * (length + z.abs()));
    let cos_theta = (1.0 - from_pole).copysign(z);
    Some([cos_theta, y.atan2(x)])
}
