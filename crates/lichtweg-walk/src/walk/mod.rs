//! Random walks: creation, transitions, termination, and how they score.
//!
//! A functional of the solution of x = M x + b is <g, x> = sum_k g^T M^k b. It can be read from either end, and both
//! are the same walk with the roles of the two vectors exchanged (a "which direction?" in linear algebra):
//!
//! | direction | created by | goes along | scores |
//! |---|---|---|---|
//! | adjoint ("from the eye") | g | rows of M: from i to j by M_ij | b |
//! | forward ("from the lights") | b | rows of M^T: from j to i by M_ij | g |
//!
//! So everything below knows a start vector s, a kernel K and a score vector r, and estimates s^T (I + K + K^2 + ...) r.
//! A walk i_0, i_1, ... has the weight w_0 = s_i0 / p0_i0, w_k = w_(k-1) K_ij / p_ij. It scores
//!
//! * **terminal**: w_k r_ik / p*_ik where it ends. The factor 1/p* is missing in the lecture's rule "count how many
//!   terminate in state i"; and where p* = 0 no walk ends and nothing is counted, so that such states must not score.
//! * **collision**: the sum of w_k r_ik over all states it visits.
//! * **expected value**: s^T r + the sum of w_k (K r)_ik: what the next state will score on average.
//!
//! Forsythe and Leibler, *Matrix inversion by a Monte Carlo method* (1950); Wasow (1952) for collision scores; Spanier
//! and Gelbard, *Monte Carlo principles and neutron transport problems* (1969), for all three and for weight windows.

mod kernel;
mod quasi;
mod several;
mod tally;
mod walker;

pub(crate) use kernel::Prepared;
pub use kernel::{Kernel, Selection};
pub use quasi::quasi_random;
pub use several::Targets;
pub use tally::Tally;
pub use walker::{Ending, Score, Start, WalkError, Walker, WeightWindow};
