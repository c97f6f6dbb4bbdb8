//! One end to walk from: start, kernel and scores, made ready in the coordinates of an importance.

use std::borrow::Cow;

use super::{Options, Refusal, Solver, refusal, start};
use crate::Matrix;
use crate::convergence::{CONTRACTS, Radius, spectral_radius};
use crate::push::Push;
use crate::walk::{Ending, Kernel, Prepared, Score, Selection, Start, Walker};

/// How walks choose their next state.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// By magnitude, where no row sums to more than one; elsewhere by a vector that makes it so.
    #[default]
    Auto,
    /// By magnitude: p_ij = |K_ij| / m_i.
    Magnitude,
    /// All entries of a row alike.
    Uniform,
    /// By p_ij = |K_ij| v_j / (|K| v)_i with v near the Perron vector: weights shrink evenly.
    Perron,
    /// By p_ij = |K_ij| |y_j| / (|K| |y|)_i with an approximation y of what walks are to find (for adjoint walks, of x): with
    /// an exact one, no system with negative entries, analog ending and terminal scores, the variance is zero.
    Guide(Vec<f64>),
}

/// A walk problem s^T (I - K)^-1 r.
#[derive(Debug)]
pub(super) struct Side<'a> {
    kernel: Cow<'a, Matrix>,
    /// What is kept of the kernel's long rows.
    prepared: Option<&'a Prepared>,
    start: Cow<'a, Start>,
    score: Cow<'a, [f64]>,
    /// Largest row sum of the kernel, where it is known to be below one.
    contraction: Option<f64>,
    /// What of the answer is known without walks, where these look ahead.
    ahead: f64,
    /// What walks score, where it is not looked up ahead.
    how: Score,
}

impl Solver<'_> {
    /// The side of walks: forward from b to g, or adjoint from g to b. With a push for g, what it left takes g's place. `None`
    /// where nothing starts.
    pub(super) fn side<'b>(
        &'b self,
        forward: bool,
        target: &[(usize, f64)],
        push: Option<&Push<'_>>,
        options: &Options,
    ) -> Result<Option<Side<'b>>, Refusal> {
        let (system, terms) = (self.system, self.terms(forward, options));
        let (plain, score) = if forward {
            let mut score = vec![0.0; system.unknowns()];
            match push {
                Some(push) => push.residuals().for_each(|(i, q)| score[i] = q),
                None => target.iter().for_each(|&(i, value)| score[i] += value),
            }
            if push.is_some_and(|push| push.residuals().all(|(_, q)| q == 0.0)) {
                return Ok(None);
            }
            (self.source_start(terms)?.map(Cow::Borrowed), Cow::Owned(score))
        } else {
            let plain = match push {
                Some(push) => start(push.residuals())?,
                None => start(target.iter().copied())?,
            };
            let score = if terms > 0 { &self.ahead(terms).next } else { system.source() };
            (plain.map(Cow::Owned), Cow::Borrowed(score))
        };
        let Some(plain) = plain else { return Ok(None) };
        let ahead = match push {
            Some(push) => self.known_ahead(terms, push.residuals()),
            None => self.known_ahead(terms, target.iter().copied()),
        };
        // The next state's score is then that of this one.
        let looked_up = !forward && terms > 0 && options.score == Score::Expected;
        let how = if looked_up { Score::Collision } else { options.score };
        let matrix = if forward { system.transposed() } else { system.matrix() };
        let side = Side {
            kernel: Cow::Borrowed(matrix),
            prepared: None,
            start: plain,
            score,
            contraction: None,
            ahead,
            how,
        };
        let weighted_by = |side: Side<'b>, d: &[f64]| {
            let kernel = matrix.similar(d);
            let largest = largest_row_sum(&kernel);
            side.weighted(Cow::Owned(kernel), largest, d)
        };
        let side = match &options.choice {
            Choice::Auto => self.tamed(side, forward)?,
            Choice::Magnitude | Choice::Uniform => side,
            Choice::Perron => weighted_by(side, &perron(matrix))?,
            Choice::Guide(y) if y.len() == system.unknowns() => weighted_by(side, &positive(y)?)?,
            Choice::Guide(y) => {
                let (length, unknowns) = (y.len(), system.unknowns());
                let message = format!("the guide has {length} elements, the system {unknowns} unknowns");
                return Err(Refusal::Parameter(message));
            }
        };
        side.checked(options).map(Some)
    }

    /// The side in coordinates in which no row sums to more than one, if they are known. What that takes is kept.
    fn tamed<'b>(&'b self, side: Side<'b>, forward: bool) -> Result<Side<'b>, Refusal> {
        let system = self.system;
        let matrix = if forward { system.transposed() } else { system.matrix() };
        let kept = &self.kept[usize::from(forward)];
        let contracts =
            if forward { self.proof.columns_contract(system) } else { self.proof.rows_contract(system) };
        let certificate = self.radius_of(forward).certificate.as_ref();
        match certificate.and_then(|certificate| certificate.weights.as_ref()) {
            Some(weights) if !contracts => {
                let (scaled, largest) = kept.scaled.get_or_init(|| {
                    let scaled = matrix.similar(weights);
                    let largest = largest_row_sum(&scaled);
                    (scaled, largest)
                });
                let prepared = kept.prepared.get_or_init(|| Prepared::new(scaled));
                let side = side.weighted(Cow::Borrowed(scaled), *largest, weights)?;
                Ok(Side { prepared: Some(prepared), ..side })
            }
            _ => {
                let prepared = Some(kept.prepared.get_or_init(|| Prepared::new(matrix)));
                let contraction =
                    certificate.filter(|_| contracts).map(|certificate| certificate.contraction);
                Ok(Side { prepared, contraction, ..side })
            }
        }
    }

    /// Where forward walks start.
    fn source_start(&self, terms: usize) -> Result<Option<&Start>, Refusal> {
        let kept = &self.source_start[terms];
        if kept.get().is_none() {
            let source = if terms > 0 { &self.ahead(terms).next } else { self.system.source() };
            let _ = kept.set(start(source.iter().copied().enumerate())?);
        }
        Ok(kept.get().and_then(Option::as_ref))
    }

    fn radius_of(&self, forward: bool) -> &Radius {
        if forward { self.proof.columns(self.system) } else { self.proof.rows(self.system) }
    }
}

/// The largest sum of magnitudes in a row.
fn largest_row_sum(kernel: &Matrix) -> f64 {
    kernel.map_rows(|i| kernel.row(i).mass()).into_iter().fold(0.0, f64::max)
}

/// |y|, with what is (nearly) zero lifted: walks must be able to go there.
fn positive(y: &[f64]) -> Result<Vec<f64>, Refusal> {
    let largest = crate::vector::largest(y);
    if !(largest > 0.0 && largest.is_finite()) {
        return Err(Refusal::Parameter("the guide has to be finite, and not zero everywhere".into()));
    }
    Ok(y.iter().map(|y| y.abs().max(1e-6 * largest)).collect())
}

/// The right Perron vector of |K| by power iteration on |K| + 1/4, which has the same one and no period.
fn perron(kernel: &Matrix) -> Vec<f64> {
    let mut v = vec![1.0; kernel.rows()];
    for _ in 0..200 {
        let product = kernel.map_rows(|i| {
            0.25 * v[i] + kernel.row(i).iter().map(|(j, value)| value.abs() * v[j]).sum::<f64>()
        });
        let largest = crate::vector::largest(&product);
        // States that nothing leads back to keep a little, so that walks can pass.
        let next: Vec<f64> = product.iter().map(|p| (p / largest).max(1e-9)).collect();
        let change = next.iter().zip(&v).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        v = next;
        if change < 1e-6 {
            break;
        }
    }
    v
}

impl<'a> Side<'a> {
    /// The same problem in the coordinates of an importance d: D^-1 K D (given, with its largest row sum), s D, D^-1 r.
    fn weighted(self, kernel: Cow<'a, Matrix>, largest: f64, d: &[f64]) -> Result<Self, Refusal> {
        let overflow = || Refusal::Parameter("the importance overflows".into());
        let start = Cow::Owned(self.start.scaled(d).ok_or_else(overflow)?);
        let score: Vec<f64> = self.score.iter().zip(d).map(|(r, d)| r / d).collect();
        let contraction = (largest < CONTRACTS).then_some(largest);
        Ok(Side { kernel, prepared: None, start, score: Cow::Owned(score), contraction, ..self })
    }

    /// The same, if the variance matrix has a radius below 1. Where rows sum to at most one it has that of |K|, which was
    /// checked already.
    fn checked(self, options: &Options) -> Result<Self, Refusal> {
        let uniform = options.choice == Choice::Uniform;
        let constant = matches!(options.ending, Ending::Constant(_));
        let at_most_one = || (0..self.kernel.rows()).all(|i| self.kernel.row(i).mass() <= 1.0 + 1e-12);
        if !uniform && !constant && (self.contraction.is_some() || at_most_one()) {
            return Ok(self);
        }
        let found = spectral_radius(&variance_matrix(&self.kernel, uniform, options.ending), None, 500);
        if found.is_below_one() {
            Ok(self)
        } else {
            Err(Refusal::InfiniteVariance { radius: refusal::describe(&found) })
        }
    }

    /// What is known without a walk.
    pub(super) fn ahead(&self) -> f64 {
        self.ahead
    }

    /// What a visit of state `i` scores.
    pub(super) fn score_of(&self, i: usize) -> f64 {
        self.score[i]
    }

    /// Whether walks can come to a state that scores at all.
    pub(super) fn reaches_a_score(&self) -> bool {
        self.reachable().iter().zip(self.score.iter()).any(|(&seen, &score)| seen && score != 0.0)
    }

    /// States that walks can come to.
    pub(super) fn reachable(&self) -> Vec<bool> {
        let mut seen = vec![false; self.score.len()];
        let mut waiting: Vec<usize> = self.start.states().collect();
        waiting.iter().for_each(|&i| seen[i] = true);
        while let Some(i) = waiting.pop() {
            for (j, _) in self.kernel.row(i).iter() {
                if !std::mem::replace(&mut seen[j], true) {
                    waiting.push(j);
                }
            }
        }
        seen
    }

    /// The kernel to walk on.
    pub(super) fn kernel(&self, options: &Options) -> Kernel<'_> {
        let uniform = options.choice == Choice::Uniform;
        let selection = if uniform { Selection::Uniform } else { Selection::Proportional };
        match self.prepared {
            Some(prepared) => Kernel::with(&self.kernel, selection, prepared),
            None => Kernel::new(&self.kernel, selection),
        }
    }

    /// Walks as the options say.
    pub(super) fn walker<'b>(
        &'b self,
        kernel: &'b Kernel<'b>,
        options: &Options,
    ) -> Result<Walker<'b>, Refusal> {
        Ok(Walker::new(kernel, &self.start, &self.score, self.how, options.ending)?)
    }

    /// A bound of the magnitude of any score: known for rows that sum to less than one, without roulette.
    pub(super) fn score_bound(&self, options: &Options) -> Option<f64> {
        let contraction = self.contraction?;
        let largest = crate::vector::largest(&self.score);
        let per_walk = match (options.score, options.ending) {
            (Score::Terminal, Ending::Analog) => largest / (1.0 - contraction),
            (Score::Terminal, Ending::Constant(p)) if contraction <= 1.0 - p => largest / p,
            // A window keeps weights at or below what they would be without roulette, or at its survivors' weight: not
            // bounded in sum.
            _ => return None,
        };
        Some(self.start.mass() * per_walk)
    }
}

/// V_ij = K_ij^2 / p_ij, by which second moments of weights propagate.
pub(super) fn variance_matrix(kernel: &Matrix, uniform: bool, ending: Ending) -> Matrix {
    let entries = (0..kernel.rows()).flat_map(|i| {
        let row = kernel.row(i);
        let (mass, count) = (row.mass(), row.indices.len() as f64);
        let survival = match ending {
            Ending::Analog => mass.min(1.0),
            Ending::Constant(p) => 1.0 - p,
            Ending::Window(_) => 1.0,
        };
        row.iter().map(move |(j, value)| {
            let chosen = if uniform { 1.0 / count } else { value.abs() / mass };
            (i as u32, j as u32, value * value / (survival * chosen))
        })
    });
    // A survival of zero makes an infinite entry, which no finite matrix holds: the largest number diverges as well.
    let entries: Vec<_> = entries.map(|(i, j, value)| (i, j, value.min(1e150))).collect();
    Matrix::from_triplets(kernel.rows(), kernel.rows(), &entries).unwrap_or_default()
}
