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
#[inline(always)]
pub fn raise<F: Float>(heuristic: Heuristic, density: F) -> F {
    match heuristic {
        Heuristic::Balance => density,
        Heuristic::Power => density * density,
    }
}

/// What stands for two quotients that are not negative: raised, it is the sum of both raised.
#[inline(always)]
pub fn norm<F: Float>(heuristic: Heuristic, a: F, b: F) -> F {
    match heuristic {
        Heuristic::Balance => a + b,
        Heuristic::Power => {
            // By the quotient, which neither overflows nor underflows.
            let (zero, one) = (F::splat(0.0), F::splat(1.0));
            let (low, high) = (a.min(b), a.max(b));
            let ratio = (low / high).select(zero.lt(high), zero);
            high * (one + ratio * ratio).sqrt()
        }
    }
}

/// Weight of a strategy with c = `own`, where `light` and `eye` stand for all those with fewer vertices on either side.
#[inline(always)]
pub fn share<F: Float>(heuristic: Heuristic, own: F, light: F, eye: F) -> F {
    let one = F::splat(1.0);
    one / (one + raise(heuristic, light / own) + raise(heuristic, eye / own))
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

    #[test]
    fn norms_are_sums_once_raised_at_all_scales() {
        for heuristic in [Heuristic::Balance, Heuristic::Power] {
            for scale in [1.0, 1e-30, 1e30] {
                for (a, b) in [(0.0, 0.0), (3.0, 0.0), (0.0, 2.0), (3.0, 4.0), (1e-3, 5.0)] {
                    let found: f32 = norm(heuristic, a * scale, b * scale) / scale;
                    let sum = raise(heuristic, a) + raise(heuristic, b);
                    assert!((raise(heuristic, found) - sum).abs() <= 1e-6 * sum, "{a} {b} {scale} {found}");
                }
            }
        }
    }
}
