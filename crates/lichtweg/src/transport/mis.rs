//! Weights for paths that more than one strategy can make (Veach 1997, section 9.2).

use lichtweg_ray::wide::Float;

use crate::scene::description::Heuristic;

/// Weight of a strategy of density `p` against one of density `q`, both per the same measure.
#[inline(always)]
pub fn weight<F: Float>(heuristic: Heuristic, p: F, q: F) -> F {
    // By the quotient, which neither overflows nor loses small densities when squared.
    let one = F::splat(1.0);
    let ratio = q / p;
    match heuristic {
        Heuristic::Balance => one / (one + ratio),
        Heuristic::Power => one / (one + ratio * ratio),
    }
}

/// A density, or a quotient of densities, as it enters the sums of a heuristic.
#[inline]
pub fn raise(heuristic: Heuristic, density: f32) -> f64 {
    let density = f64::from(density);
    match heuristic {
        Heuristic::Balance => density,
        Heuristic::Power => density * density,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_at_all_scales() {
        for heuristic in [Heuristic::Balance, Heuristic::Power] {
            for (p, q) in [(1.0, 1.0), (1e-30, 3e-30), (1e30, 2e29), (0.5, 0.0), (1e-20, 1e20)] {
                let sum = weight(heuristic, p, q) + weight(heuristic, q, p);
                assert!((sum - 1.0).abs() < 1e-6, "{p} {q} {sum}");
            }
        }
    }
}
