//! From files to a system and what is asked of it.

use std::fmt::Write;
use std::path::Path;

use clap::ValueEnum;
use lichtweg_walk::read::{Graph, Input, ReadError, read_input, read_vector};
use lichtweg_walk::system::SystemError;
use lichtweg_walk::{Functional, Matrix, Splitting, System};

use super::SolveArgs;
use crate::failure::Failure;

/// What a matrix stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Problem {
    /// A x = b
    Linear,
    /// x = M x + b
    FixedPoint,
    /// Expected visits of an absorbing Markov chain, whose matrix has a row for each state to go from
    Chain,
    /// Personalised PageRank of a graph
    Pagerank,
}

/// A splitting without its damping.
#[derive(Clone, Copy, Debug)]
pub enum SplittingKind {
    /// By the diagonal.
    Jacobi,
    /// By blocks.
    Block(usize),
    /// By the identity.
    Richardson,
}

/// Parses `jacobi`, `block:4`, `richardson`.
pub fn splitting(text: &str) -> Result<SplittingKind, String> {
    match text.split_once(':') {
        None if text == "jacobi" => Ok(SplittingKind::Jacobi),
        None if text == "richardson" => Ok(SplittingKind::Richardson),
        Some(("block", size)) => {
            size.parse().map(SplittingKind::Block).map_err(|_| "expected block:SIZE".to_owned())
        }
        _ => Err("jacobi, block:SIZE or richardson".to_owned()),
    }
}

/// A system, and the names of its unknowns.
#[derive(Debug)]
pub struct SystemInput {
    /// x = M x + b.
    pub system: System,
    /// What it stands for.
    pub problem: Problem,
    /// Unknowns that are the user's, which come first.
    pub shown: usize,
    labels: Option<Vec<u64>>,
}

/// Reads what the arguments name.
pub fn read(args: &SolveArgs) -> Result<SystemInput, Failure> {
    let (matrix, labels) = match read_input(&args.system).map_err(|error| failed(&error))? {
        Input::Matrix(matrix) => (matrix, None),
        Input::Graph(Graph { adjacency, labels }) => (adjacency, Some(labels)),
    };
    let problem = args.problem.unwrap_or(if labels.is_some() { Problem::Pagerank } else { Problem::Linear });
    check_that_all_is_used(args, problem)?;
    let shown = matrix.rows();
    let labels = labels.filter(|labels| labels.iter().zip(1..).any(|(&label, i)| label != i));
    let start = |what: &str| match &args.start {
        None => Ok(vec![1.0; shown]),
        Some(text) => start_vector(text, shown, labels.as_deref(), what),
    };
    let system = match problem {
        Problem::Linear => System::linear(&matrix, &right_side(args, &matrix)?, chosen_splitting(args)),
        Problem::FixedPoint => right_side(args, &matrix).map(|b| System::fixed_point(matrix, b))?,
        Problem::Chain => {
            let mut p0 = start("state")?;
            let total: f64 = p0.iter().sum();
            if args.start.is_none() {
                p0.iter_mut().for_each(|p| *p /= total);
            }
            match &args.absorption {
                None => System::absorbing_chain(&matrix, p0),
                Some(path) => System::absorbing_chain_with(&matrix, &vector(path)?, p0),
            }
        }
        Problem::Pagerank => {
            System::personalised_pagerank(&matrix, &start("node")?, args.damping.unwrap_or(0.85))
        }
    };
    let system = system.map_err(|error| wrong(&error))?;
    Ok(SystemInput { system, problem, shown, labels })
}

/// What has no meaning for a problem is refused, not ignored.
fn check_that_all_is_used(args: &SolveArgs, problem: Problem) -> Result<(), Failure> {
    let linear = problem == Problem::Linear;
    let chain = problem == Problem::Chain;
    let has_start = chain || problem == Problem::Pagerank;
    let unused = [
        ("--rhs", args.rhs.is_some() && has_start, "a chain and a graph have --start instead"),
        ("--start", args.start.is_some() && !has_start, "a system has --rhs instead"),
        ("--absorption", args.absorption.is_some() && !chain, "it belongs to --problem chain"),
        ("--splitting", args.splitting.is_some() && !linear, "it belongs to A x = b"),
        ("--damping", args.damping.is_some() && (chain || problem == Problem::FixedPoint), "it has none"),
    ];
    match unused.into_iter().find(|&(_, unused, _)| unused) {
        Some((option, _, why)) => {
            Err(Failure::Usage(format!("{option} has no meaning for this problem: {why}")))
        }
        None => Ok(()),
    }
}

/// What is wrong with a system, counted as the user does.
fn wrong(error: &SystemError) -> Failure {
    let told = error.to_string();
    let place = match error {
        SystemError::Singular { row, .. } => Some(("row", row)),
        SystemError::NotFinite { index, .. } => Some(("element", index)),
        SystemError::Probability { state, .. } => Some(("state", state)),
        _ => None,
    };
    Failure::Failed(match place {
        Some((what, at)) => told.replace(&format!("{what} {at} (from 0)"), &format!("{what} {}", at + 1)),
        None => told,
    })
}

fn chosen_splitting(args: &SolveArgs) -> Splitting {
    let damping = args.damping.unwrap_or(1.0);
    match args.splitting.unwrap_or(SplittingKind::Jacobi) {
        SplittingKind::Jacobi => Splitting::Jacobi { damping },
        SplittingKind::Block(size) => Splitting::BlockJacobi { size, damping },
        SplittingKind::Richardson => Splitting::Richardson { damping },
    }
}

fn right_side(args: &SolveArgs, matrix: &Matrix) -> Result<Vec<f64>, Failure> {
    match &args.rhs {
        None => Err(Failure::Usage("the right side is missing: --rhs FILE, or --rhs ones".to_owned())),
        Some(path) if path.as_os_str() == "ones" => Ok(vec![1.0; matrix.rows()]),
        Some(path) => vector(path),
    }
}

/// A vector from a file.
pub fn vector(path: &Path) -> Result<Vec<f64>, Failure> {
    read_vector(path).map_err(|error| failed(&error))
}

/// A unit vector by the name of a state, or a file.
fn start_vector(text: &str, size: usize, labels: Option<&[u64]>, what: &str) -> Result<Vec<f64>, Failure> {
    let Ok(name) = text.parse::<u64>() else { return vector(text.as_ref()) };
    let state = index(name, size, labels).ok_or_else(|| Failure::Usage(missing(what, name, size, labels)))?;
    let mut unit = vec![0.0; size];
    unit[state] = 1.0;
    Ok(unit)
}

/// From the user's name of an unknown to its index.
fn index(name: u64, size: usize, labels: Option<&[u64]>) -> Option<usize> {
    match labels {
        Some(labels) => labels.binary_search(&name).ok(),
        None => usize::try_from(name.checked_sub(1)?).ok().filter(|&i| i < size),
    }
}

fn missing(what: &str, name: u64, size: usize, labels: Option<&[u64]>) -> String {
    match labels {
        Some(_) => format!("there is no {what} {name} in the graph"),
        None => format!("there is no {what} {name}: they are counted from 1 to {size}"),
    }
}

fn failed(error: &ReadError) -> Failure {
    Failure::Failed(error.to_string())
}

impl SystemInput {
    /// What is asked, with names.
    pub fn named_functionals(&self, args: &SolveArgs) -> Result<super::Named, Failure> {
        if let Some(path) = &args.functional {
            let g = vector(path)?;
            if g.len() != self.shown {
                let message =
                    format!("the functional has {} elements, the system {} unknowns", g.len(), self.shown);
                return Err(Failure::Failed(message));
            }
            return Ok(vec![(
                "<g, x>".to_owned(),
                Functional::Weighted(g.into_iter().enumerate().collect()),
            )]);
        }
        if args.all {
            let sum = (0..self.shown).map(|i| (i, 1.0)).collect();
            return Ok(vec![("sum of x".to_owned(), Functional::Weighted(sum))]);
        }
        if args.unknown.is_empty() {
            return Err(Failure::Usage("which unknown? --unknown I, --functional FILE or --all".to_owned()));
        }
        let what = match self.problem {
            Problem::Linear | Problem::FixedPoint => "x",
            Problem::Chain => "visits",
            Problem::Pagerank => "rank",
        };
        let one = |&name: &u64| match index(name, self.shown, self.labels.as_deref()) {
            Some(i) => Ok((format!("{what}[{name}]"), Functional::Unknown(i))),
            None => Err(Failure::Usage(missing("unknown", name, self.shown, self.labels.as_deref()))),
        };
        args.unknown.iter().map(one).collect()
    }

    /// What is asked.
    pub fn functionals(&self, args: &SolveArgs) -> Result<Vec<Functional>, Failure> {
        Ok(self.named_functionals(args)?.into_iter().map(|(_, functional)| functional).collect())
    }
}

/// Writes a Matrix Market array of one column.
pub fn write_vector(path: &Path, x: &[f64]) -> Result<(), Failure> {
    let mut text = format!("%%MatrixMarket matrix array real general\n{} 1\n", x.len());
    for value in x {
        // The shortest digits that read back as the same number. Writing to a string cannot fail.
        let _ = writeln!(text, "{value:e}");
    }
    write_text(path, &text)
}

/// Writes a file beside its target, and renames it.
pub fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| Failure::Failed(format!("{} cannot be written: {error}", path.display()));
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, path)).map_err(failed)
}
