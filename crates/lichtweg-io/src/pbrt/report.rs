//! Collecting findings: a bounded list, and suggestions for misspelt names.

use lichtweg::scene::description::{Diagnostic, Diagnostics};

/// Findings beyond this many are counted and not listed: nobody reads them, and a file of garbage has millions.
const MOST_FINDINGS: usize = 500;

/// Where the reader puts what it finds.
pub(super) struct Report<'a> {
    diagnostics: &'a mut Diagnostics,
    room: usize,
    left_out: usize,
}

impl<'a> Report<'a> {
    pub fn new(diagnostics: &'a mut Diagnostics) -> Self {
        Self { diagnostics, room: MOST_FINDINGS, left_out: 0 }
    }

    /// Adds a finding.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.takes_one_more() {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Adds something that is replaced in lenient mode, and an error otherwise; see [`Diagnostics::unsupported`].
    pub fn substitute(&mut self, diagnostic: Diagnostic, substitute: &str) {
        if self.takes_one_more() {
            self.diagnostics.unsupported(diagnostic, substitute);
        }
    }

    /// Whether further findings are only counted.
    pub fn is_full(&self) -> bool {
        self.room == 0
    }

    /// Says how many findings were left out.
    pub fn finish(self) {
        if self.left_out > 0 {
            let text = format!("{} more problems are not shown", self.left_out);
            self.diagnostics.push(Diagnostic::error("too-many-problems", text));
        }
    }

    fn takes_one_more(&mut self) -> bool {
        let takes = self.room > 0;
        self.room = self.room.saturating_sub(1);
        self.left_out += usize::from(!takes);
        takes
    }
}

/// Adds the one of the `known` names that is close to `name`; failing that all of them, if they are few.
pub(super) fn suggest<'k>(
    diagnostic: Diagnostic,
    name: &str,
    known: impl IntoIterator<Item = &'k str>,
) -> Diagnostic {
    /// Longer lists help nobody.
    const MOST_LISTED: usize = 16;
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_unstable();
    known.dedup();
    match nearest(name, &known) {
        Some(best) => diagnostic.help(format!("did you mean \"{best}\"?")),
        None if known.is_empty() || known.len() > MOST_LISTED => diagnostic,
        None => diagnostic.help(format!("known here: {}", known.join(", "))),
    }
}

/// The first name of `known` that differs least from `name`, if by at most a third of its letters.
fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    const LONGEST: usize = 64;
    if name.len() > LONGEST {
        return None;
    }
    let distances = known.iter().filter(|k| k.len() <= LONGEST).map(|k| (edit_distance(name, k), *k));
    distances
        .filter(|(distance, k)| {
            let length = k.len().max(name.len());
            *distance <= length.div_ceil(3) && *distance < length
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, k)| k)
}

/// The number of letters to insert, delete, replace or swap with their neighbour (optimal string alignment, after
/// Damerau 1964), letter case aside.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b) = (a.to_ascii_lowercase().into_bytes(), b.to_ascii_lowercase().into_bytes());
    let width = b.len() + 1;
    let mut table: Vec<usize> = (0..width * (a.len() + 1)).map(|i| i / width + i % width).collect();
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let at = |i: usize, j: usize| table[i * width + j];
            let replaced = at(i - 1, j - 1) + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(at(i - 1, j) + 1).min(at(i, j - 1) + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(at(i - 2, j - 2) + 1);
            }
            table[i * width + j] = best;
        }
    }
    table[width * (a.len() + 1) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("Sphere", "sphere"), 0);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("rbg", "rgb"), 1);
    }

    #[test]
    fn suggests_only_what_is_close() {
        let known = ["sphere", "disk", "trianglemesh"];
        assert_eq!(nearest("spheer", &known), Some("sphere"));
        assert_eq!(nearest("TriangleMesh", &known), Some("trianglemesh"));
        assert_eq!(nearest("hyperboloid", &known), None);
        assert_eq!(nearest("q", &["o"]), None);
    }

    #[test]
    fn the_list_is_bounded() {
        let mut diagnostics = Diagnostics::new(false);
        let mut report = Report::new(&mut diagnostics);
        for _ in 0..MOST_FINDINGS + 7 {
            report.push(Diagnostic::note("x", "y"));
        }
        assert!(report.is_full());
        report.finish();
        assert_eq!(diagnostics.list.len(), MOST_FINDINGS + 1);
        assert_eq!(diagnostics.list.last().unwrap().message, "7 more problems are not shown");
    }
}
