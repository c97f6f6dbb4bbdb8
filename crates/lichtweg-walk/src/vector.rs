//! Parallel sums over vectors, whose bits do not depend on the number of threads.

use rayon::prelude::*;

/// Elements that one task takes: fixed, since sums depend on their order.
const CHUNK: usize = 8192;

/// Sum of products.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum())
        .collect();
    parts.iter().sum()
}

/// Sum of the elements.
pub(crate) fn sum(a: &[f64]) -> f64 {
    let parts: Vec<f64> = a.par_chunks(CHUNK).map(|a| a.iter().sum()).collect();
    parts.iter().sum()
}

/// Euclidean length.
pub(crate) fn length(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Largest magnitude; NaN where one is.
pub(crate) fn largest(a: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    a.par_iter().with_min_len(CHUNK).map(|a| a.abs()).reduce(|| 0.0, larger)
}

/// a = f(a, b) for each element.
pub(crate) fn update(a: &mut [f64], b: &[f64], f: impl Fn(f64, f64) -> f64 + Sync) {
    a.par_iter_mut().with_min_len(CHUNK).zip(b).for_each(|(a, &b)| *a = f(*a, b));
}
