//! What walks have scored.

use lichtweg_montecarlo::Moments;

/// Scores of some walks, mergeable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Count, mean and variance of the scores.
    pub moments: Moments,
    /// Transitions made.
    pub steps: u64,
    /// Scores that are not zero.
    pub nonzero: u64,
    /// Scores that differ from the first one.
    pub unlike_first: u64,
    /// Largest squared score.
    pub largest_square: f64,
    /// Sum of the squared scores.
    pub squares: f64,
    /// Contributions by number of transitions before them, summed over walks; the last entry holds all longer ones.
    /// Empty unless asked for.
    pub by_length: Vec<f64>,
    first: Option<f64>,
}

/// Entries of [`Tally::by_length`].
pub(super) const LENGTHS: usize = 257;

impl Tally {
    /// Adds the score of one walk.
    pub fn push(&mut self, score: f64, steps: u64) {
        let first = *self.first.get_or_insert(score);
        self.moments.push(score);
        self.steps += steps;
        self.nonzero += u64::from(score != 0.0);
        self.unlike_first += u64::from(score != first);
        self.largest_square = self.largest_square.max(score * score);
        self.squares += score * score;
    }

    /// Adds walks that scored nothing.
    pub(super) fn push_zeros(&mut self, walks: u64) {
        if walks > 0 && *self.first.get_or_insert(0.0) != 0.0 {
            self.unlike_first += walks;
        }
        self.moments.merge(&Moments::from_parts(walks, 0.0, 0.0));
    }

    /// Adds a contribution of one walk after `length` transitions.
    pub(super) fn push_contribution(&mut self, length: u64, contribution: f64) {
        if self.by_length.is_empty() {
            self.by_length.resize(LENGTHS, 0.0);
        }
        self.by_length[length.min(LENGTHS as u64 - 1) as usize] += contribution;
    }

    /// Adds all walks of `other`.
    pub fn merge(&mut self, other: &Self) {
        let (Some(first), Some(theirs)) = (self.first, other.first) else {
            if self.first.is_none() {
                self.clone_from(other);
            }
            return;
        };
        // Theirs were compared with their own first one.
        self.unlike_first += if first == theirs {
            other.unlike_first
        } else {
            other.unlike_first.max(other.moments.count() - other.unlike_first)
        };
        self.moments.merge(&other.moments);
        self.steps += other.steps;
        self.nonzero += other.nonzero;
        self.largest_square = self.largest_square.max(other.largest_square);
        self.squares += other.squares;
        if self.by_length.is_empty() {
            self.by_length.clone_from(&other.by_length);
        } else {
            self.by_length.iter_mut().zip(&other.by_length).for_each(|(sum, theirs)| *sum += theirs);
        }
    }

    /// Share of the largest score in the sum of squares: near 1/n for good walks, large for heavy tails.
    #[must_use]
    pub fn largest_share(&self) -> f64 {
        if self.squares > 0.0 { self.largest_square / self.squares } else { 0.0 }
    }

    /// Transitions of a walk on average.
    #[must_use]
    pub fn steps_per_walk(&self) -> f64 {
        self.steps as f64 / self.moments.count().max(1) as f64
    }
}
