//! Statistics of the sample values: uniformity, independence of dimensions, samples, streams and seeds, and the
//! convergence that Sobol' points are for. Significance alpha = 0.01 for each test function, by Sidak's correction.

use lichtweg_montecarlo::hypothesis::{chi_squared_test, sidak, z_test};
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};

const INDEPENDENT: SamplerKind = SamplerKind::Independent;

/// Which of the arguments of a sample value counts up.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axis {
    Sample,
    Stream,
    Seed,
    Dimension,
    /// Streams a power of two apart, as pixels of neighbouring rows.
    Row,
}

const AXES: [Axis; 5] = [Axis::Sample, Axis::Stream, Axis::Seed, Axis::Dimension, Axis::Row];

/// Sampler number `i` along an axis, everything else held at zero.
fn along(kind: SamplerKind, axis: Axis, i: u32) -> Sampler {
    let (n, zero) = (u64::from(i), Sampler::new(kind, 0, 0, 0));
    match axis {
        Axis::Sample => Sampler::new(kind, 0, 0, i),
        Axis::Stream => Sampler::new(kind, 0, n, 0),
        Axis::Seed => Sampler::new(kind, n, 0, 0),
        Axis::Dimension => zero.at_dimension(i),
        Axis::Row => Sampler::new(kind, 0, n << 12, 0),
    }
}

/// p-value of uniformity of pairs over a grid of `n` x `n` cells.
fn uniformity(n: usize, pairs: impl Iterator<Item = [f32; 2]>) -> f64 {
    let mut counts = vec![0; n * n];
    for [x, y] in pairs {
        counts[(y * n as f32) as usize * n + (x * n as f32) as usize] += 1;
    }
    chi_squared_test(&counts, &vec![1.0; n * n]).unwrap().p_value
}

fn assert_accepted(p_values: &[(String, f64)]) {
    let level = sidak(0.01, p_values.len());
    for (what, p) in p_values {
        assert!(*p >= level, "{what}: p = {p:e}, level {level:e}");
    }
}

#[test]
fn values_are_uniform_in_one_and_two_dimensions() {
    let mut p_values = Vec::new();
    for axis in AXES {
        for kind in [INDEPENDENT, SamplerKind::Sobol] {
            // Along the sample axis Sobol points are more even than random; that is tested below.
            if kind == SamplerKind::Sobol && axis == Axis::Sample {
                continue;
            }
            let mut counts = vec![0; 1000];
            for i in 0..200_000 {
                counts[(along(kind, axis, i).next_1d() * 1000.0) as usize] += 1;
            }
            let line = chi_squared_test(&counts, &[1.0; 1000]).unwrap().p_value;
            p_values.push((format!("{kind:?} {axis:?} 1-D"), line));
            let square = uniformity(64, (0..400_000).map(|i| along(kind, axis, i).next_2d()));
            p_values.push((format!("{kind:?} {axis:?} 2-D"), square));
        }
    }
    assert_accepted(&p_values);
}

#[test]
fn low_bits_of_independent_values_are_uniform() {
    let mut p_values = Vec::new();
    for shift in [4096.0, 65_536.0] {
        let low = |u: f32| (u * shift).fract();
        let pairs = (0..400_000).map(|i| along(INDEPENDENT, Axis::Sample, i).next_2d().map(low));
        p_values.push((format!("digits below 1/{shift}"), uniformity(16, pairs)));
    }
    assert_accepted(&p_values);
}

/// Neighbours along each axis, up to 3 apart: their pairs fill the square evenly.
#[test]
fn neighbours_are_independent() {
    let mut p_values = Vec::new();
    for axis in AXES {
        for lag in 1..=3 {
            let pairs = (0..300_000).map(|i| {
                [along(INDEPENDENT, axis, i).next_1d(), along(INDEPENDENT, axis, i + lag).next_1d()]
            });
            p_values.push((format!("{axis:?} lag {lag}"), uniformity(32, pairs)));
        }
    }
    // The two values of a pair of one sampler and the first of the pair after it.
    let pairs = (0..300_000).map(|i| {
        let mut sampler = along(INDEPENDENT, Axis::Sample, i);
        [sampler.next_2d()[1], sampler.next_2d()[0]]
    });
    p_values.push(("within a pair".into(), uniformity(32, pairs)));
    assert_accepted(&p_values);
}

/// Correlation of every pair of the first 24 dimensions over 4096 samples, for both kinds and many streams.
#[test]
fn dimensions_are_uncorrelated() {
    const DIMENSIONS: usize = 24;
    let (samples, streams) = (256_u32, 64_u64);
    for kind in [INDEPENDENT, SamplerKind::Sobol] {
        let mut products = vec![Moments::default(); DIMENSIONS * DIMENSIONS];
        for stream in 0..streams {
            // The sum over the samples of a stream is one independent trial, whatever its inner structure.
            let mut sums = vec![0.0; DIMENSIONS * DIMENSIONS];
            for sample in 0..samples {
                let mut sampler = Sampler::new(kind, 5, stream, sample);
                let mut values = [0.0; DIMENSIONS];
                for pair in values.chunks_exact_mut(2) {
                    pair.copy_from_slice(&sampler.next_2d().map(|u| f64::from(u) - 0.5));
                }
                for i in 0..DIMENSIONS {
                    for j in 0..i {
                        sums[i * DIMENSIONS + j] += values[i] * values[j];
                    }
                }
            }
            for (moments, sum) in products.iter_mut().zip(sums) {
                moments.push(sum);
            }
        }
        let mut p_values = Vec::new();
        for i in 0..DIMENSIONS {
            for j in 0..i {
                let product = &products[i * DIMENSIONS + j];
                // Student's t with 63 degrees of freedom, as a Welch test against an exact zero.
                let dof = (product.count() - 1) as f64;
                let zero = (0.0, 0.0, dof);
                let estimate = (product.mean(), product.variance_of_mean(), dof);
                let outcome = lichtweg_montecarlo::hypothesis::welch_t_test(estimate, zero);
                p_values.push((format!("{kind:?} {i} {j}"), outcome.p_value));
            }
        }
        assert_accepted(&p_values);
    }
}

/// Mean over `n` samples of a smooth function of four dimensions with integral 1, for many streams: returns the mean
/// squared error and the z value of the mean.
fn error_of_smooth_integral(kind: SamplerKind, half: Option<u32>, n: u32) -> (f64, f64) {
    let mut estimates = Moments::default();
    for stream in 0..400 {
        let sum: f64 = (0..n)
            .map(|i| half.map_or(i, |half| 2 * i + half))
            .map(|sample| {
                let mut sampler = Sampler::new(kind, 77, stream, sample);
                let [[x, y], [z, w]] = [sampler.next_2d(), sampler.next_2d()].map(|p| p.map(f64::from));
                // Sums of functions of one pair: what padding can integrate well.
                (9.0 * x * x * y * y) * 0.5
                    + 0.5 * (std::f64::consts::PI * z).sin() * (std::f64::consts::FRAC_PI_2) * 2.0 * w
            })
            .sum();
        estimates.push(sum / f64::from(n));
    }
    let z = (estimates.mean() - 1.0) / estimates.standard_error();
    (estimates.variance(), z)
}

#[test]
fn sobol_converges_faster_and_without_bias() {
    // 8 z values at 4 sigma: alpha = 5e-4 together.
    let mut variance = Vec::new();
    for half in [None, Some(0), Some(1)] {
        for n in [64, 1024] {
            let (sobol, z) = error_of_smooth_integral(SamplerKind::Sobol, half, n);
            assert!(z.abs() < 4.0, "half {half:?}, {n} samples: z = {z}");
            variance.push(sobol);
        }
    }
    let (random_64, _) = error_of_smooth_integral(INDEPENDENT, None, 64);
    let (random_1024, _) = error_of_smooth_integral(INDEPENDENT, None, 1024);
    // Random: N^-1, a factor of 16. Scrambled nets: about N^-3, 4096; ask for N^-2.5.
    assert!((8.0..32.0).contains(&(random_64 / random_1024)));
    for pair in variance.chunks_exact(2) {
        assert!(pair[0] < 0.02 * random_64, "{} {random_64}", pair[0]);
        assert!(pair[0] / pair[1] > 1024.0, "variance fell by {} only", pair[0] / pair[1]);
    }
}

/// Half-buffers are independent estimates: means over even and odd samples are uncorrelated.
#[test]
fn halves_are_independent() {
    let mut product = Moments::default();
    for stream in 0..4000 {
        let mean = |half| {
            let value =
                |i: u32| f64::from(Sampler::new(SamplerKind::Sobol, 3, stream, 2 * i + half).next_1d());
            (0..16_u32).map(|i| value(i) - 0.5).sum::<f64>()
        };
        product.push(mean(0) * mean(1));
    }
    assert!(!z_test(product.mean(), product.variance_of_mean()).rejects(0.01), "{product:?}");
}
