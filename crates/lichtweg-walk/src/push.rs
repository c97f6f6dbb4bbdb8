//! Local push: the deterministic walk. Instead of one particle that goes somewhere at random, all of what is in a state
//! goes everywhere at once, and what is too little to matter stays.
//!
//! For s^T (I - K)^-1 r keep an estimate p and a residual q with s^T (I - K)^-1 = p^T + q^T (I - K)^-1, at first p = 0,
//! q = s. To push state i: p_i += q_i, and q_i goes to the states j as q_i K_ij. Then s^T (I - K)^-1 r = p^T r + q^T x with
//! x = (I - K)^-1 r, and |q^T x| <= sum |q_i| X_i wherever |x_i| <= X_i is known.
//!
//! Andersen, Chung and Lang, *Local graph partitioning using PageRank vectors* (FOCS 2006); for linear systems Kwok, Wei
//! and Yang, *On solving asymmetric diagonally dominant linear systems in sublinear time* (ITCS 2026).
//!
//! States are pushed in the order in which they became worth it, at thresholds that fall from round to round. With a relaxation
//! above one a push takes more than there is, and leaves the negative rest. Where M = I - D^-1 A with a symmetric positive
//! definite A, that is successive over-relaxation of A (D^-1 p) = s in any order, which converges for factors below 2 (Ostrowski
//! 1954, Reich 1949), and takes about a third of the pushes; locally: Bai et al., *Faster local solvers for graph diffusion
//! equations* (NeurIPS 2024).

use crate::Matrix;

/// A push under way.
#[derive(Clone, Debug)]
pub struct Push<'a> {
    kernel: &'a Matrix,
    /// For each state of the kernel, its place in `states`, from 1; 0 for those that were never met, which cost nothing, since
    /// zeros come from the system as untouched pages.
    places: Vec<u32>,
    /// States that were met, in that order: few, and side by side.
    states: Vec<State>,
    /// Rows of states that were pushed, as (place, K_ij): the second time they are at hand.
    rows: Vec<(u32, f64)>,
    waiting: Queue,
    relaxation: f64,
    threshold: f64,
    operations: u64,
    pushes: u64,
}

/// What is known of a state that was met.
#[derive(Clone, Copy, Debug)]
struct State {
    residual: f64,
    estimate: f64,
    state: u32,
    /// Its row: where it begins among those at hand, and its entries; none where it is not there.
    row: (u32, u32),
    waits: bool,
}

/// Entries of rows that are kept at hand: as many as fit into the cache.
const AT_HAND: usize = 1 << 18;

/// By how much the threshold falls from round to round.
const FALL: f64 = 0.8;

impl<'a> Push<'a> {
    /// From s, given as (state, value), along the rows of `kernel`.
    ///
    /// # Panics
    /// When a state is out of range.
    #[must_use]
    pub fn new(kernel: &'a Matrix, start: impl IntoIterator<Item = (usize, f64)>) -> Self {
        Self::relaxed(kernel, start, 1.0)
    }

    /// The same with a relaxation, from 1 to below 2.
    ///
    /// # Panics
    /// When a state is out of range.
    #[must_use]
    pub fn relaxed(
        kernel: &'a Matrix,
        start: impl IntoIterator<Item = (usize, f64)>,
        relaxation: f64,
    ) -> Self {
        let mut push = Self {
            kernel,
            places: vec![0; kernel.rows()],
            states: Vec::new(),
            rows: Vec::new(),
            waiting: Queue::default(),
            relaxation,
            threshold: 0.0,
            operations: 0,
            pushes: 0,
        };
        for (i, value) in start {
            let place = place_of(i, &mut push.places, &mut push.states);
            let met = &mut push.states[place as usize];
            met.residual += value;
            push.threshold = push.threshold.max(met.residual.abs());
        }
        push
    }

    /// p as (state, p_i), for all states that were met.
    pub fn estimates(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.states.iter().map(|met| (met.state as usize, met.estimate))
    }

    /// q as (state, q_i), for all states that were met.
    pub fn residuals(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.states.iter().map(|met| (met.state as usize, met.residual))
    }

    /// Entries of the matrix that were used, and of rounds looked through: the cost.
    #[must_use]
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// States that were met.
    #[must_use]
    pub(crate) fn met(&self) -> usize {
        self.states.len()
    }

    /// States pushed.
    #[must_use]
    pub fn pushes(&self) -> u64 {
        self.pushes
    }

    /// p^T r.
    #[must_use]
    pub fn value(&self, r: &[f64]) -> f64 {
        self.estimates().map(|(i, p)| p * r[i]).sum()
    }

    /// Rounds until `operations` are spent; false where nothing is left to push.
    pub fn spend(&mut self, operations: u64) -> bool {
        let limit = self.operations.saturating_add(operations);
        while self.operations < limit {
            if !self.round(limit - self.operations) {
                return false;
            }
        }
        true
    }

    /// One round at a lower threshold than the last, until `operations` are spent; false where nothing is left to push. A
    /// round that was cut short is taken up again first.
    pub fn round(&mut self, operations: u64) -> bool {
        let Self { kernel, places, states, rows, waiting, threshold, .. } = self;
        if waiting.is_empty() {
            *threshold *= FALL;
            waiting.make_room(states.len());
            for (place, met) in (0..).zip(states.iter_mut()) {
                met.offer(place, *threshold, waiting);
            }
            self.operations += states.len() as u64 / 4;
        }
        let threshold = *threshold;
        let limit = self.operations.saturating_add(operations);
        while let Some(place) = waiting.pop() {
            let met = &mut states[place as usize];
            let amount = self.relaxation * met.residual;
            met.residual -= amount;
            met.estimate += amount;
            met.waits = false;
            let (state, mut at_hand) = (met.state as usize, met.row);
            let entries = kernel.row_len(state);
            waiting.make_room(states.len() + entries);
            let mut spread = |states: &mut [State], neighbour: u32, value: f64| {
                let met = &mut states[neighbour as usize];
                met.residual += amount * value;
                met.offer(neighbour, threshold, waiting);
            };
            if at_hand.1 == 0 && rows.len() + entries <= AT_HAND {
                at_hand = (rows.len() as u32, entries as u32);
                rows.extend(kernel.row(state).iter().map(|(j, value)| (place_of(j, places, states), value)));
                states[place as usize].row = at_hand;
            }
            if at_hand.1 > 0 {
                let first = at_hand.0 as usize;
                for &(neighbour, value) in &rows[first..first + at_hand.1 as usize] {
                    spread(states, neighbour, value);
                }
            } else {
                for (j, value) in kernel.row(state).iter() {
                    let neighbour = place_of(j, places, states);
                    spread(states, neighbour, value);
                }
            }
            states[place as usize].offer(place, threshold, waiting);
            self.operations += 4 + entries as u64;
            self.pushes += 1;
            if self.operations > limit {
                return true;
            }
        }
        threshold > f64::MIN_POSITIVE && states.iter().any(|met| met.residual != 0.0)
    }
}

impl State {
    /// Waits to be pushed if its residual is worth it.
    #[inline]
    fn offer(&mut self, place: u32, threshold: f64, waiting: &mut Queue) {
        let is_new = (self.residual.abs() > threshold) & !self.waits;
        self.waits |= is_new;
        waiting.push_if(is_new, place);
    }
}

/// States that wait, first in, first out, each at most once: a ring with a free slot after the last, into which is written
/// without asking, since whether a state is worth it cannot be predicted.
#[derive(Clone, Debug, Default)]
struct Queue {
    /// A power of two.
    ring: Vec<u32>,
    first: usize,
    end: usize,
}

impl Queue {
    fn is_empty(&self) -> bool {
        self.first == self.end
    }

    /// Lets at least so many wait.
    #[inline]
    fn make_room(&mut self, states: usize) {
        if self.ring.len() <= states {
            let waiting: Vec<u32> = std::iter::from_fn(|| self.pop()).collect();
            (self.first, self.end) = (0, waiting.len());
            self.ring = waiting;
            self.ring.resize((2 * states + 2).next_power_of_two(), 0);
        }
    }

    /// Needs room for one more.
    #[inline]
    fn push_if(&mut self, condition: bool, place: u32) {
        let slot = self.end & (self.ring.len() - 1);
        self.ring[slot] = place;
        self.end = self.end.wrapping_add(usize::from(condition));
    }

    #[inline]
    fn pop(&mut self) -> Option<u32> {
        if self.is_empty() {
            return None;
        }
        let place = self.ring[self.first & (self.ring.len() - 1)];
        self.first = self.first.wrapping_add(1);
        Some(place)
    }
}

/// Where a state is kept, from 0; it is met now, if it was not before.
#[inline]
fn place_of(i: usize, places: &mut [u32], states: &mut Vec<State>) -> u32 {
    if places[i] == 0 {
        states.push(State { residual: 0.0, estimate: 0.0, state: i as u32, row: (0, 0), waits: false });
        places[i] = states.len() as u32;
    }
    places[i] - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line whose rows sum to 0.96 inside; M = I - D^-1 A with a symmetric A.
    fn line(n: u32) -> Matrix {
        let entries = (0..n).flat_map(|i| [(i, i.wrapping_sub(1), 0.48), (i, i + 1, 0.48)]);
        let entries: Vec<_> = entries.filter(|&(_, j, _)| j < n).collect();
        Matrix::from_triplets(n as usize, n as usize, &entries).unwrap()
    }

    /// p^T (I - K) = s^T - q^T after each round, and over-relaxation leaves as little with fewer operations.
    #[test]
    fn what_is_pushed_and_what_is_left_make_up_the_start() {
        let kernel = line(200);
        let operations = [1.0, 1.5].map(|relaxation| {
            let mut push = Push::relaxed(&kernel, [(100, 2.0), (3, -1.0)], relaxation);
            while push.residuals().map(|(_, q)| q.abs()).sum::<f64>() > 1e-3 {
                assert!(push.round(1 << 20));
                let mut sum = vec![0.0; 200];
                push.residuals().for_each(|(i, q)| sum[i] += q);
                for (i, p) in push.estimates() {
                    sum[i] += p;
                    kernel.row(i).iter().for_each(|(j, value)| sum[j] -= p * value);
                }
                (sum[100], sum[3]) = (sum[100] - 2.0, sum[3] + 1.0);
                assert!(sum.iter().all(|sum| sum.abs() < 1e-12));
            }
            push.operations()
        });
        assert!(2 * operations[1] < operations[0], "{operations:?}");
    }

    #[test]
    fn nothing_is_left_of_a_chain_that_ends() {
        let chain = Matrix::from_triplets(3, 3, &[(0, 1, 0.5), (1, 2, 4.0)]).unwrap();
        let mut push = Push::new(&chain, [(0, 1.0)]);
        while push.spend(10) {}
        assert_eq!(push.value(&[1.0, 10.0, 100.0]), 206.0);
        assert!(push.residuals().all(|(_, q)| q == 0.0));
    }
}
