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

    /// Adds something that is not supported; see [`Diagnostics::unsupported`].
    pub fn unsupported(&mut self, diagnostic: Diagnostic, substitute: &str) {
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

/// Adds "did you mean" where one of `known` is close to `name`.
pub(super) fn suggest<'k>(
    diagnostic: Diagnostic,
    name: &str,
    known: impl IntoIterator<Item = &'k str>,
) -> Diagnostic {
    match nearest(name, known) {
        Some(best) => diagnostic.help(format!("did you mean \"{best}\"?")),
        None => diagnostic,
    }
}

/// The name of `known` that differs least from `name`, if by at most a third of its letters.
fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    const LONGEST: usize = 64;
    if name.len() > LONGEST {
        return None;
    }
    known
        .into_iter()
        .filter(|k| k.len() <= LONGEST)
        .map(|k| (edit_distance(name, k), k))
        .filter(|(distance, k)| *distance <= k.len().max(name.len()).div_ceil(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, k)| k)
}

/// Levenshtein's distance (1965), letter case aside.
fn edit_distance(a: &str, b: &str) -> usize {
    let b = b.to_ascii_lowercase();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.bytes().enumerate() {
            let substituted = diagonal + usize::from(x.to_ascii_lowercase() != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("Sphere", "sphere"), 0);
        assert_eq!(edit_distance("", "abc"), 3);
    }

    #[test]
    fn suggests_only_what_is_close() {
        let known = ["sphere", "disk", "trianglemesh"];
        assert_eq!(nearest("spheer", known), Some("sphere"));
        assert_eq!(nearest("TriangleMesh", known), Some("trianglemesh"));
        assert_eq!(nearest("hyperboloid", known), None);
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
