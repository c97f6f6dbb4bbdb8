//! Systems with known solutions, and what tests need to judge walks.
#![allow(dead_code)] // Each test file takes what it needs.

use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_walk::Matrix;

/// Uniform numbers of a fixed sequence.
pub struct Random(Sampler);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Sampler::new(SamplerKind::Independent, seed, 77, 0))
    }

    pub fn unit(&mut self) -> f64 {
        self.0.next_1d_f64()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

pub fn matrix(n: usize, triplets: &[(usize, usize, f64)]) -> Matrix {
    let triplets: Vec<_> = triplets.iter().map(|&(i, j, value)| (i as u32, j as u32, value)).collect();
    Matrix::from_triplets(n, n, &triplets).unwrap()
}

/// A random sparse matrix whose rows of magnitudes sum to `mass`; a share of entries is negative.
pub fn random_matrix(n: usize, per_row: usize, mass: f64, negative: f64, seed: u64) -> Matrix {
    let mut random = Random::new(seed);
    let mut triplets = Vec::new();
    for i in 0..n {
        let entries: Vec<(usize, f64)> = (0..per_row)
            .map(|_| {
                let sign = if random.unit() < negative { -1.0 } else { 1.0 };
                (random.below(n), sign * random.between(0.1, 1.0))
            })
            .collect();
        let total: f64 = entries.iter().map(|(_, value)| value.abs()).sum();
        triplets.extend(entries.into_iter().map(|(j, value)| (i, j, value * mass / total)));
    }
    matrix(n, &triplets)
}

/// Five-point Laplacian on a square of `side` x `side` unknowns, plus `shift` on the diagonal.
pub fn poisson(side: usize, shift: f64) -> Matrix {
    let mut triplets = Vec::new();
    for y in 0..side {
        for x in 0..side {
            let i = y * side + x;
            triplets.push((i, i, 4.0 + shift));
            let mut link = |inside: bool, j: usize| {
                if inside {
                    triplets.push((i, j, -1.0));
                }
            };
            link(x > 0, i.wrapping_sub(1));
            link(x + 1 < side, i + 1);
            link(y > 0, i.wrapping_sub(side));
            link(y + 1 < side, i + side);
        }
    }
    matrix(side * side, &triplets)
}

/// (I - M)^-1 by Gauss-Jordan elimination: independent of everything under test. Row by row.
pub fn inverse_of_one_minus(m: &Matrix) -> Vec<Vec<f64>> {
    let n = m.rows();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j)) - m.get(i, j)).collect();
            row.extend((0..n).map(|j| f64::from(u8::from(i == j))));
            row
        })
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs())).unwrap();
        rows.swap(k, pivot);
        let scale = 1.0 / rows[k][k];
        rows[k].iter_mut().for_each(|value| *value *= scale);
        let row = rows[k].clone();
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[k];
            if i != k && factor != 0.0 {
                other.iter_mut().zip(&row).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    rows.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// The solution of x = M x + b.
pub fn solution(m: &Matrix, b: &[f64]) -> Vec<f64> {
    inverse_of_one_minus(m).iter().map(|row| row.iter().zip(b).map(|(a, b)| a * b).sum()).collect()
}
