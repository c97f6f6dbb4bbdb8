//! What `lichtweg solve` prints.

use std::io::{self, Write};

use lichtweg_walk::solver::Evidence;
use lichtweg_walk::{Answer, Solver};
use serde_json::{Value, json};

use super::SolveArgs;
use super::input::SystemInput;
use crate::failure::Failure;
use crate::text::{count, seconds};

/// Prints answers with names, as text or JSON.
pub fn print(
    args: &SolveArgs,
    input: &SystemInput,
    solver: &Solver<'_>,
    answers: &[Answer],
    load_seconds: f64,
) -> Result<(), Failure> {
    let names: Vec<String> = input.named_functionals(args)?.into_iter().map(|(name, _)| name).collect();
    let mut out = io::stdout().lock();
    if args.json {
        let answers: Vec<Value> =
            names.iter().zip(answers).map(|(name, answer)| json(name, answer)).collect();
        let system = json!({
            "unknowns": input.system.unknowns(),
            "entries": input.system.matrix().entries(),
            "confidence": args.confidence,
            "load_seconds": load_seconds,
            "answers": answers,
        });
        return Ok(writeln!(out, "{system:#}")?);
    }
    let level = 100.0 * args.confidence;
    for (name, answer) in names.iter().zip(answers) {
        write_answer(&mut out, name, answer, level, answers.len())?;
    }
    if answers.iter().any(|answer| answer.walks > 0) {
        let radius = solver.radius();
        let proven =
            if radius.high < 1.0 - 5e-7 { format!("<= {:.6}", radius.high) } else { "< 1".to_owned() };
        writeln!(out, "  {:9}rho(|M|) {proven}: walks converge", "proof")?;
    }
    Ok(())
}

fn write_answer(
    out: &mut impl Write,
    name: &str,
    answer: &Answer,
    level: f64,
    count_all: usize,
) -> io::Result<()> {
    let Answer { value, half_width, .. } = *answer;
    let digits = digits(value, half_width);
    match answer.evidence {
        Evidence::Residual(residual) => {
            writeln!(out, "{name} = {value:.10e}")?;
            writeln!(
                out,
                "  {:9}relative residual {residual:.1e}; no bound of the error is proven",
                "error"
            )?;
        }
        evidence => {
            let meaning = match evidence {
                Evidence::Proven => "proven".to_owned(),
                _ if count_all > 1 => format!("{level} % for all {count_all} together"),
                _ => format!("{level} %"),
            };
            writeln!(out, "{name} = {value:.digits$e} +- {half_width:.1e}")?;
            writeln!(
                out,
                "  {:9}{:.digits$e} to {:.digits$e} ({meaning})",
                "interval",
                answer.low(),
                answer.high()
            )?;
        }
    }
    writeln!(out, "  {:9}{}: {}", "method", answer.method.name(), answer.why)?;
    let mut work = Vec::new();
    if answer.walks > 0 {
        work.push(format!("{} walks, {} steps", count(answer.walks), count(answer.steps)));
    }
    if answer.operations > 0 {
        work.push(format!("{} matrix entries used", count(answer.operations)));
    }
    work.push(seconds(answer.seconds));
    let shared = if answer.shared > 1 { format!(" (shared by {})", answer.shared) } else { String::new() };
    writeln!(out, "  {:9}{}{shared}", "work", work.join(", "))?;
    for warning in &answer.warnings {
        writeln!(out, "  {:9}{warning}", "warning")?;
    }
    write_terms(out, &answer.by_length)
}

/// The terms of the Neumann series as a table with bars.
fn write_terms(out: &mut impl Write, terms: &[f64]) -> io::Result<()> {
    if terms.is_empty() {
        return Ok(());
    }
    let largest = terms.iter().fold(0.0_f64, |largest, term| largest.max(term.abs()));
    writeln!(out, "  {:9}length  contribution", "Neumann")?;
    let mut sum = 0.0;
    for (length, term) in terms.iter().enumerate().take(40) {
        sum += term;
        let bar = "#".repeat((40.0 * term.abs() / largest).round() as usize);
        writeln!(out, "  {:9}{length:6}  {term:+.4e}  {bar}", "")?;
    }
    if terms.len() > 40 {
        let rest: f64 = terms[40..].iter().sum();
        writeln!(out, "  {:9}longer  {rest:+.4e}  (of {:+.4e} in all)", "", sum + rest)?;
    }
    Ok(())
}

/// Digits after the first that an interval of this width leaves meaningful, and two.
fn digits(value: f64, half_width: f64) -> usize {
    if value == 0.0 || half_width == 0.0 {
        return 12;
    }
    ((value.abs() / half_width).log10() + 2.0).clamp(1.0, 15.0) as usize
}

fn json(name: &str, answer: &Answer) -> Value {
    let (evidence, residual) = match answer.evidence {
        Evidence::Statistical => ("statistical", None),
        Evidence::Proven => ("proven", None),
        Evidence::Residual(residual) => ("residual", Some(residual)),
    };
    let bounded = residual.is_none();
    let costs: serde_json::Map<String, Value> =
        answer.costs.iter().map(|cost| (cost.method.name().to_owned(), json!(cost.seconds))).collect();
    json!({
        "name": name,
        "value": answer.value,
        "half_width": bounded.then_some(answer.half_width),
        "low": bounded.then(|| answer.low()),
        "high": bounded.then(|| answer.high()),
        "evidence": evidence,
        "residual": residual,
        "reached": answer.reached,
        "method": answer.method.name(),
        "why": answer.why,
        "expected_seconds": costs,
        "walks": answer.walks,
        "steps": answer.steps,
        "matrix_entries_used": answer.operations,
        "seconds": answer.seconds,
        "shared_by": answer.shared,
        "warnings": answer.warnings,
        "neumann": answer.by_length,
    })
}
