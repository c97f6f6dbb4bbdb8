//! What is asked, and what is answered.

use super::Refusal;

/// A linear functional of the solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Functional {
    /// x_i, from 0.
    Unknown(usize),
    /// <g, x>, with g as pairs of index and value.
    Weighted(Vec<(usize, f64)>),
}

/// g as pairs of index and value, without zeros.
pub(super) type Entries = Vec<(usize, f64)>;

impl Functional {
    /// g, checked.
    pub(super) fn entries(&self, unknowns: usize) -> Result<Entries, Refusal> {
        let entries = match self {
            Self::Unknown(i) => vec![(*i, 1.0)],
            Self::Weighted(entries) => entries.iter().copied().filter(|&(_, value)| value != 0.0).collect(),
        };
        match entries.iter().find(|&&(i, value)| i >= unknowns || !value.is_finite()) {
            Some(&(i, _)) if i >= unknowns => Err(Refusal::OutOfRange { unknown: i, unknowns }),
            Some(&(i, _)) => Err(Refusal::Parameter(format!("the weight of unknown {i} is not finite"))),
            None => Ok(entries),
        }
    }
}

/// How a number is found; see [the module](super).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// What promises to be cheapest.
    #[default]
    Auto,
    /// Walks from the unknown.
    Adjoint,
    /// Walks from the source vector.
    Forward,
    /// Local push with proven bounds.
    Push,
    /// Push from the unknown, walks from the source vector.
    Bidirectional,
    /// Push from the unknown, walks onward from what is left.
    PushWalk,
    /// Sequential Monte Carlo for all unknowns.
    Sequential,
    /// Krylov iterations.
    Deterministic,
    /// A sparse factorisation, with the feature `faer`.
    Direct,
}

impl Method {
    /// All of them but [`Method::Auto`].
    pub const ALL: [Self; 8] = [
        Self::Adjoint,
        Self::Forward,
        Self::Push,
        Self::Bidirectional,
        Self::PushWalk,
        Self::Sequential,
        Self::Deterministic,
        Self::Direct,
    ];

    /// Whether this build has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self != Self::Direct || cfg!(feature = "faer")
    }

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Adjoint => "adjoint",
            Self::Forward => "forward",
            Self::Push => "push",
            Self::Bidirectional => "bidirectional",
            Self::PushWalk => "push-walk",
            Self::Sequential => "sequential",
            Self::Deterministic => "deterministic",
            Self::Direct => "direct",
        }
    }
}

/// On what the interval rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evidence {
    /// It covers the truth with the confidence asked for.
    Statistical,
    /// A bound that holds for certain, up to rounding.
    Proven,
    /// There is no bound of the error, only this relative residual.
    Residual(f64),
}

/// What a method is expected to cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Which.
    pub method: Method,
    /// Seconds of one core, by a fixed model of the machine.
    pub seconds: f64,
}

/// A number, how well it is known, and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// <g, x>.
    pub value: f64,
    /// Half width of the interval around it.
    pub half_width: f64,
    /// What the interval means.
    pub evidence: Evidence,
    /// The method that was used.
    pub method: Method,
    /// Whether it is known as well as was asked for.
    pub reached: bool,
    /// Walks in the mean.
    pub walks: u64,
    /// Transitions of all walks, those of pilots included.
    pub steps: u64,
    /// Matrix entries used by push or by a solver.
    pub operations: u64,
    /// Time by the clock.
    pub seconds: f64,
    /// Why this method.
    pub why: String,
    /// What the planner expected of each method that it considered.
    pub costs: Vec<Cost>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Mean contribution of walks after 0, 1, 2, ... transitions, where asked for; the 257th holds all longer ones.
    pub by_length: Vec<f64>,
    /// Answers that the same work gave, this one included: walks, steps, operations and seconds are those of all of them.
    pub shared: usize,
    /// All unknowns, where the method gave them; of answers that share their work, the first has them.
    pub x: Option<Vec<f64>>,
}

impl Answer {
    /// Lower end of the interval.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.value - self.half_width
    }

    /// Upper end of the interval.
    #[must_use]
    pub fn high(&self) -> f64 {
        self.value + self.half_width
    }

    /// A number known for certain.
    pub(super) fn exact(value: f64, why: &str) -> Self {
        Self {
            value,
            half_width: 0.0,
            evidence: Evidence::Proven,
            method: Method::Push,
            reached: true,
            walks: 0,
            steps: 0,
            operations: 0,
            seconds: 0.0,
            why: why.to_owned(),
            costs: Vec::new(),
            warnings: Vec::new(),
            by_length: Vec::new(),
            shared: 1,
            x: None,
        }
    }
}
