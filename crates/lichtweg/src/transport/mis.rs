//! Weights for paths that more than one strategy can make (Veach 1997, section 9.2).

use crate::scene::description::Heuristic;

/// Weight of a strategy of density `p` against one of density `q`, both per the same measure.
#[inline]
pub fn weight(heuristic: Heuristic, p: f32, q: f32) -> f32 {
    // By the quotient, which neither overflows nor loses small densities when squared.
    let ratio = q / p;
    match heuristic {
        Heuristic::Balance => 1.0 / (1.0 + ratio),
        Heuristic::Power => 1.0 / (1.0 + ratio * ratio),
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
