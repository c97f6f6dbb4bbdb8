//! Judgement: do two images have the same expectation, and is an estimate that of a known number?
//!
//! Images are compared by Welch's t test over blocks of 4 x 4 pixels and each channel, and over the image as a whole.
//! All of these tests of a comparison together falsely reject with probability [`ALPHA`] or less (Sidak; the channels
//! are not independent, which makes it less). To every variance the square of [`ROUNDING`] times the mean is added.

use lichtweg::render::RenderedImage;
use lichtweg_montecarlo::Moments;
use lichtweg_montecarlo::hypothesis::{Outcome, sidak, welch_t_test, z_test};

/// Probability of a false alarm of one family of tests.
pub const ALPHA: f64 = 0.01;

/// Relative error put down to the rounding of f32.
pub const ROUNDING: f64 = 1e-5;

/// Side of a block in pixels.
const BLOCK: usize = 4;

/// An estimate: mean, variance of the mean, and that variance's degrees of freedom.
type Estimate = (f64, f64, f64);

/// The evidence against the hypothesis that two images have the same expectation.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Single tests.
    pub tests: usize,
    /// The strongest single evidence.
    pub strongest: Outcome,
    /// Where: the block's column and row, or nothing for the whole image; and the channel.
    pub place: (Option<[usize; 2]>, usize),
    /// The two estimates there.
    pub means: [f64; 2],
}

impl Comparison {
    /// Whether the images are found to differ, as one of a family of so many comparisons.
    pub fn rejects_among(&self, comparisons: usize) -> bool {
        self.strongest.rejects(sidak(ALPHA, self.tests * comparisons))
    }
}

/// Compares two images of the same size.
pub fn compare(a: &RenderedImage, b: &RenderedImage) -> Comparison {
    assert_eq!(a.window, b.window);
    let [width, height] = [a.window[2] as usize, a.window[3] as usize];
    assert!(width.is_multiple_of(BLOCK) && height.is_multiple_of(BLOCK));
    let columns = width / BLOCK;
    let blocks = columns * (height / BLOCK);
    let mut tests = Vec::with_capacity(3 * (blocks + 1));
    for channel in 0..3 {
        for block in 0..blocks {
            let place = [block % columns, block / columns];
            let pixels = |i: usize| {
                let (x, y) = (place[0] * BLOCK + i % BLOCK, place[1] * BLOCK + i / BLOCK);
                y * width + x
            };
            let estimate = |image| mean_of(image, channel, (0..BLOCK * BLOCK).map(pixels));
            tests.push((estimate(a), estimate(b), (Some(place), channel)));
        }
        let whole = |image| mean_of(image, channel, 0..width * height);
        tests.push((whole(a), whole(b), (None, channel)));
    }
    let outcomes = tests.iter().map(|&(a, b, place)| (welch_t_test(a, b), place, [a.0, b.0]));
    // A NaN counts as the strongest evidence.
    let p = |o: &Outcome| if o.p_value.is_nan() { -1.0 } else { o.p_value };
    let (strongest, place, means) =
        outcomes.min_by(|x, y| p(&x.0).total_cmp(&p(&y.0))).expect("at least one block");
    Comparison { tests: tests.len(), strongest, place, means }
}

/// The mean over some pixels; the degrees of freedom by Welch and Satterthwaite.
fn mean_of(image: &RenderedImage, channel: usize, pixels: impl Iterator<Item = usize>) -> Estimate {
    let (mut mean, mut variance, mut spread, mut n) = (0.0, 0.0, 0.0, 0.0);
    for pixel in pixels.map(|i| &image.pixels[i]) {
        let v = pixel.variance_of_mean()[channel];
        mean += pixel.mean()[channel];
        variance += v;
        spread += v * v / f64::from(pixel.count - 1);
        n += 1.0;
    }
    mean /= n;
    let dof = if spread > 0.0 { variance * variance / spread } else { 1e9 };
    (mean, variance / (n * n) + (ROUNDING * mean).powi(2), dof)
}

/// Every image against every other, as one family.
pub fn assert_pairwise_agreement(what: &str, images: &[(String, RenderedImage)]) {
    let pairs: Vec<(usize, usize)> =
        (0..images.len()).flat_map(|i| (i + 1..images.len()).map(move |j| (i, j))).collect();
    for &(i, j) in &pairs {
        let comparison = compare(&images[i].1, &images[j].1);
        assert!(
            !comparison.rejects_among(pairs.len()),
            "{what}: {} and {} differ: {comparison:?}",
            images[i].0,
            images[j].0
        );
    }
}

/// Mean over an image by channel, and the evidence against the expectation being `expected`, beyond a relative
/// `tolerance`.
pub fn expectation(image: &RenderedImage, expected: [f64; 3], tolerance: f64) -> [(f64, Outcome); 3] {
    let (mean, error) = image.mean();
    std::array::from_fn(|i| {
        let excess = ((mean[i] - expected[i]).abs() - tolerance * expected[i].abs()).max(0.0);
        (mean[i], z_test(excess, error[i] * error[i]))
    })
}

/// Holds the mean of an image to a known number, as one of a family of `family` such tests.
pub fn assert_expectation(
    what: &str,
    image: &RenderedImage,
    expected: [f64; 3],
    tolerance: f64,
    family: usize,
) {
    for (mean, outcome) in expectation(image, expected, tolerance) {
        assert!(
            !outcome.rejects(sidak(ALPHA, 3 * family)),
            "{what}: {mean} instead of {expected:?}: {outcome:?}"
        );
    }
}

/// The evidence against moments having the expectation `expected`, beyond a relative tolerance.
pub fn moments_outcome(moments: &Moments, expected: f64, tolerance: f64) -> Outcome {
    let excess = ((moments.mean() - expected).abs() - tolerance * expected.abs()).max(0.0);
    z_test(excess, moments.variance_of_mean())
}
