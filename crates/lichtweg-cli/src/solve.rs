//! `lichtweg solve`: unknowns of linear systems by random walks.

mod animate;
mod input;
mod report;
pub mod stage;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use lichtweg_walk::solver::Choice;
use lichtweg_walk::stopping::Goal;
use lichtweg_walk::walk::{Ending, Score, WeightWindow};
use lichtweg_walk::{Answer, Functional, Method, Options, Refusal, Solver};

use crate::console::Console;
use crate::failure::Failure;
use input::Problem;
pub use input::{write_text, write_vector};
use stage::Stage;

const EXAMPLES: &str = "\
Examples:
  lichtweg solve A.mtx --rhs b.mtx --unknown 17                       one unknown of A x = b, to 1 % at 95 %
  lichtweg solve A.mtx -b ones -u 17,42 --tolerance 1e-3 --confidence 99%
  lichtweg solve A.mtx.gz -b b.txt -u 17 --splitting block:4          where Jacobi's splitting does not converge
  lichtweg solve M.mtx -b b.mtx --problem fixed-point -u 1 --neumann  x = M x + b; contributions by walk length
  lichtweg solve P.mtx --problem chain --start 1 --unknown 5          visits to state 5 of a chain that starts in 1
  lichtweg solve P.mtx --problem chain --start 1 -u 5 --animate chain.html
  lichtweg solve web-Google.txt.gz --start 0 --unknown 1234           PageRank of 1234, personalised to node 0
  lichtweg solve A.mtx -b b.mtx --all --write x.mtx                   all unknowns, by a deterministic solver

Unknowns of Matrix Market files are counted from 1, as in the files; nodes of edge lists go by their ids.";

/// Estimate unknowns of a linear system by random walks
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SolveArgs {
    /// Matrix Market file, or edge list of a graph; plain or .gz
    system: PathBuf,

    /// What the matrix is; a graph is one of PageRank, all else of A x = b
    #[arg(long, value_enum)]
    problem: Option<Problem>,

    /// Right side b: Matrix Market or plain numbers, or the word "ones"
    #[arg(short = 'b', long, value_name = "FILE")]
    rhs: Option<PathBuf>,

    /// Where a chain starts, or PageRank teleports to: a state, or a file of weights [default: everywhere alike]
    #[arg(long, value_name = "STATE|FILE")]
    start: Option<String>,

    /// Probabilities of a chain to end in each state, to be checked [default: what its rows lack to 1]
    #[arg(long, value_name = "FILE")]
    absorption: Option<PathBuf>,

    /// Unknowns, separated by commas; their intervals hold together
    #[arg(short = 'u', long, value_name = "I,...", value_delimiter = ',')]
    unknown: Vec<u64>,

    /// A functional <g, x> instead: weights g of all unknowns
    #[arg(long, value_name = "FILE", conflicts_with = "unknown")]
    functional: Option<PathBuf>,

    /// All unknowns, to be written by --write
    #[arg(long, conflicts_with_all = ["unknown", "functional"])]
    all: bool,

    /// Where to write all unknowns, where the method finds them
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,

    /// Half width of the interval, relative to the value
    #[arg(long, value_name = "REL", default_value_t = 0.01, value_parser = positive)]
    tolerance: f64,

    /// Half width that is enough in any case
    #[arg(long, value_name = "ABS", default_value_t = 0.0, value_parser = not_negative)]
    absolute: f64,

    /// Probability that the intervals cover the truth: 0.99 or 99%
    #[arg(long, value_name = "LEVEL", default_value = "95%", value_parser = confidence)]
    confidence: f64,

    /// How: by plan, or as asked for
    #[arg(long, value_name = "METHOD", default_value = "auto", value_parser = method)]
    method: Method,

    /// How A is split: jacobi, block:SIZE or richardson [default: jacobi]
    #[arg(long, value_name = "SPLITTING", value_parser = input::splitting)]
    splitting: Option<input::SplittingKind>,

    /// Damping of the splitting [default: 1], or of PageRank [default: 0.85]
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    damping: Option<f64>,

    /// What walks score
    #[arg(long, value_enum, value_name = "SCORE")]
    score: Option<ScoreName>,

    /// When walks end: analog, constant:P, window or window:LOW,SURVIVAL,HIGH
    #[arg(long, value_name = "ENDING", value_parser = ending)]
    ending: Option<Ending>,

    /// How walks choose the next state: auto, magnitude, uniform, perron or guide:FILE
    #[arg(long, value_name = "CHOICE", default_value = "auto")]
    choice: String,

    /// Intervals that hold for any number of walks (empirical Bernstein), not only for many
    #[arg(long)]
    rigorous: bool,

    /// Quasi-random walks (scrambled Sobol' points) with intervals from independent scrambles, adjoint where nothing else is said
    #[arg(long, conflicts_with_all = ["rigorous", "neumann"])]
    quasi: bool,

    /// Show contributions by walk length: the terms of the Neumann series; of adjoint walks where nothing else is said
    #[arg(long)]
    neumann: bool,

    /// Write a page that shows particles on a small chain
    #[arg(long, value_name = "FILE.html")]
    animate: Option<PathBuf>,

    /// Transitions, or entries pushed, at most
    #[arg(long, value_name = "N", default_value_t = 2_000_000_000)]
    max_steps: u64,

    /// Seed of the walks; the same seed gives the same digits, for any number of threads
    #[arg(long, default_value_t = 0)]
    seed: u64,

    /// Threads [default: all]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    /// Warnings and errors only, besides the answer
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ScoreName {
    /// Where a walk ends, over the probability to end there
    Terminal,
    /// Wherever a walk is
    Collision,
    /// What the next state scores on average
    Expected,
}

/// Solves.
pub fn run(args: &SolveArgs) -> Result<(), Failure> {
    if let Some(threads) = args.threads {
        // Fails only where a pool was made before, of which there is none.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let console = Console::new(args.quiet || args.json);
    let began = Instant::now();
    let input = console.stage(&format!("reading {}", args.system.display()), || input::read(args))?;
    let load_seconds = began.elapsed().as_secs_f64();
    if let Some(path) = &args.animate {
        animate::write(&input, path, args.seed)?;
        console.say(&format!("wrote {}", path.display()));
        return Ok(());
    }
    let functionals = input.functionals(args)?;
    let mut options = options(args)?;
    if args.all {
        if options.method == Method::Auto {
            options.method = Method::Deterministic;
            console.say(
                "note: for all unknowns a direct or Krylov solver is the right tool, and is taken; \
                 --method sequential does it by walks",
            );
        }
        if !matches!(options.method, Method::Deterministic | Method::Direct | Method::Sequential) {
            let message = "--all needs --method deterministic, direct or sequential: the others find one number at a time";
            return Err(Failure::Usage(message.to_owned()));
        }
    }
    let solver = Solver::new(&input.system);
    let answers =
        watched(&solver, &functionals, &options, console).map_err(|refusal| refused(&refusal, &input))?;
    if let Some(path) = &args.write {
        let Some(x) = answers.iter().find_map(|answer| answer.x.as_ref()) else {
            return Err(Failure::Failed(
                "this method did not find all unknowns: take --all, or --method deterministic, direct or sequential"
                    .into(),
            ));
        };
        input::write_vector(path, &x[..input.shown])?;
    }
    report::print(args, &input, &solver, &answers, load_seconds)?;
    let reached = answers.iter().all(|answer| answer.reached);
    if !reached {
        crate::console::tell("warning: not known as well as was asked for; --max-steps allows more");
    }
    Ok(())
}

/// Solves, where one can see how far it is.
fn watched(
    solver: &Solver<'_>,
    functionals: &[Functional],
    options: &Options,
    console: Console,
) -> Result<Vec<Answer>, Refusal> {
    if console == Console::Plain {
        console.say("solving");
    }
    let walks = functionals.len() == 1 || options.method == Method::Forward;
    let unit = if walks { "walks" } else { "unknowns" };
    let stage = Stage { channel: 0, channels: 1, began: Instant::now(), unit };
    let _ticker = stage.show(console, options.watch.clone(), None);
    solver.solve_all(functionals, options)
}

fn refused(refusal: &Refusal, input: &input::SystemInput) -> Failure {
    let endless = matches!(refusal, Refusal::Diverges { .. }) && input.problem == Problem::Chain;
    let help = if endless {
        "\nOf a chain that is so where particles never end: a state has to be absorbing, or its row to sum to less than one."
    } else {
        ""
    };
    Failure::Failed(format!("{refusal}{help}"))
}

fn options(args: &SolveArgs) -> Result<Options, Failure> {
    let standard = Options::default();
    // Bounded scores are what rigorous intervals rest on; terminal scores need an end.
    let terminal = args.rigorous || matches!(args.score, Some(ScoreName::Terminal));
    let (score, ending) =
        if terminal { (Score::Terminal, Ending::Analog) } else { (standard.score, standard.ending) };
    let choice = match args.choice.split_once(':') {
        None => match args.choice.as_str() {
            "auto" => Choice::Auto,
            "magnitude" => Choice::Magnitude,
            "uniform" => Choice::Uniform,
            "perron" => Choice::Perron,
            other => {
                return Err(Failure::Usage(format!(
                    "unknown choice \"{other}\": auto, magnitude, uniform, perron or guide:FILE"
                )));
            }
        },
        Some(("guide", file)) if !file.is_empty() => Choice::Guide(input::vector(file.as_ref())?),
        Some(_) => return Err(Failure::Usage("a guide is given as guide:FILE".to_owned())),
    };
    Ok(Options {
        goal: Goal { relative: args.tolerance, absolute: args.absolute, confidence: args.confidence },
        // Who asks for what walks alone can show wants walks.
        method: match args.method {
            Method::Auto if args.neumann || args.quasi => Method::Adjoint,
            method => method,
        },
        score: args.score.map_or(score, |name| match name {
            ScoreName::Terminal => Score::Terminal,
            ScoreName::Collision => Score::Collision,
            ScoreName::Expected => Score::Expected,
        }),
        ending: args.ending.unwrap_or(ending),
        choice,
        seed: args.seed,
        most_steps: args.max_steps,
        rigorous: args.rigorous,
        lengths: args.neumann,
        quasi: args.quasi,
        ..standard
    })
}

fn number(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| "not a number".to_owned())
}

/// Parses a number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| if value > 0.0 { Ok(value) } else { Err("has to be above 0".to_owned()) })
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(text)
        .and_then(|value| if value >= 0.0 { Ok(value) } else { Err("must not be negative".to_owned()) })
}

fn confidence(text: &str) -> Result<f64, String> {
    let value = match text.strip_suffix('%') {
        Some(percent) => number(percent.trim())? / 100.0,
        None => number(text)?,
    };
    if value > 0.0 && value < 1.0 {
        Ok(value)
    } else {
        Err("has to be between 0 and 100 %, both excluded".to_owned())
    }
}

/// Parses the name of a method.
pub fn method(text: &str) -> Result<Method, String> {
    let all = [&[Method::Auto][..], &Method::ALL].concat();
    let names: Vec<&str> = all.iter().map(|method| method.name()).collect();
    all.iter()
        .copied()
        .find(|method| method.name() == text)
        .ok_or_else(|| format!("one of {}", names.join(", ")))
}

fn ending(text: &str) -> Result<Ending, String> {
    let expected = || "analog, constant:P, window or window:LOW,SURVIVAL,HIGH".to_owned();
    match text.split_once(':') {
        None if text == "analog" => Ok(Ending::Analog),
        None if text == "window" => Ok(Ending::Window(WeightWindow::default())),
        Some(("constant", p)) => match number(p)? {
            p if p > 0.0 && p < 1.0 => Ok(Ending::Constant(p)),
            _ => Err("the probability to end has to be between 0 and 1, both excluded".to_owned()),
        },
        Some(("window", numbers)) => {
            let numbers: Result<Vec<f64>, String> = numbers.split(',').map(number).collect();
            match numbers?[..] {
                [low, survival, high] if 0.0 < low && low <= survival && survival <= high => {
                    Ok(Ending::Window(WeightWindow { low, survival, high }))
                }
                _ => Err("a window has 0 < LOW <= SURVIVAL <= HIGH".to_owned()),
            }
        }
        _ => Err(expected()),
    }
}

/// The functionals and the names of what they give.
type Named = Vec<(String, Functional)>;
