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
//! States are pushed in the order in which they became worth it, at thresholds that halve from round to round.

use std::collections::VecDeque;

use crate::Matrix;

/// A push under way.
#[derive(Clone, Debug)]
pub struct Push<'a> {
    kernel: &'a Matrix,
    /// Residual, estimate and mark of each state, side by side: whoever needs one needs all. As plain numbers they come
    /// zeroed by the system, and states that are never met cost nothing.
    states: Vec<[f64; 4]>,
    /// States with an estimate or a residual, in the order in which they were met.
    touched: Vec<u32>,
    waiting: VecDeque<u32>,
    threshold: f64,
    operations: u64,
    pushes: u64,
}

const RESIDUAL: usize = 0;
const ESTIMATE: usize = 1;
const MARK: usize = 2;

/// Marks; a state that was never met has 0.
const MET: f64 = 1.0;
const WAITS: f64 = 2.0;

impl<'a> Push<'a> {
    /// From s, given as (state, value), along the rows of `kernel`.
    ///
    /// # Panics
    /// When a state is out of range.
    #[must_use]
    pub fn new(kernel: &'a Matrix, start: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let n = kernel.rows();
        let mut push = Self {
            kernel,
            states: vec![[0.0; 4]; n],
            touched: Vec::new(),
            waiting: VecDeque::new(),
            threshold: 0.0,
            operations: 0,
            pushes: 0,
        };
        for (i, value) in start {
            push.add(i, value);
            push.threshold = push.threshold.max(push.residual(i).abs());
        }
        push
    }

    /// p_i.
    #[inline]
    #[must_use]
    pub fn estimate(&self, i: usize) -> f64 {
        self.states[i][ESTIMATE]
    }

    /// q_i.
    #[inline]
    #[must_use]
    pub fn residual(&self, i: usize) -> f64 {
        self.states[i][RESIDUAL]
    }

    /// States where p or q is not zero (or was).
    pub fn touched(&self) -> impl Iterator<Item = usize> + '_ {
        self.touched.iter().map(|&i| i as usize)
    }

    /// Entries of the matrix that were used, and of rounds looked through: the cost.
    #[must_use]
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// States that were met.
    #[must_use]
    pub(crate) fn met(&self) -> usize {
        self.touched.len()
    }

    /// States pushed.
    #[must_use]
    pub fn pushes(&self) -> u64 {
        self.pushes
    }

    /// p^T r.
    #[must_use]
    pub fn value(&self, r: &[f64]) -> f64 {
        self.touched().map(|i| self.estimate(i) * r[i]).sum()
    }

    /// One round at half the threshold of the last, until `operations` are spent; false where nothing is left to push. A
    /// round that was cut short is taken up again first.
    pub fn round(&mut self, operations: u64) -> bool {
        if self.waiting.is_empty() {
            self.threshold *= 0.5;
            for at in 0..self.touched.len() {
                self.offer(self.touched[at] as usize);
            }
            self.operations += self.touched.len() as u64 / 4;
        }
        let limit = self.operations.saturating_add(operations);
        while let Some(i) = self.waiting.pop_front() {
            let i = i as usize;
            let state = &mut self.states[i];
            let amount = std::mem::take(&mut state[RESIDUAL]);
            state[ESTIMATE] += amount;
            state[MARK] = MET;
            for (j, value) in self.kernel.row(i).iter() {
                self.add(j, amount * value);
                self.offer(j);
            }
            self.operations += 4 + self.kernel.row_len(i) as u64;
            self.pushes += 1;
            if self.operations > limit {
                return true;
            }
        }
        self.threshold > f64::MIN_POSITIVE && self.touched().any(|i| self.residual(i) != 0.0)
    }

    #[inline]
    fn add(&mut self, i: usize, amount: f64) {
        let state = &mut self.states[i];
        state[RESIDUAL] += amount;
        if state[MARK] == 0.0 {
            state[MARK] = MET;
            self.touched.push(i as u32);
        }
    }

    /// Lets a state wait to be pushed if its residual is worth it.
    #[inline]
    fn offer(&mut self, i: usize) {
        let state = &mut self.states[i];
        if state[RESIDUAL].abs() > self.threshold && state[MARK] != WAITS {
            state[MARK] = WAITS;
            self.waiting.push_back(i as u32);
        }
    }
}
