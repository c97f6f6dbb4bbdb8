//! "Did you mean": the known word nearest to a misspelt one.

use std::fmt::Write as _;

/// The candidate with the fewest edits from `word`, if at most a third of the letters differ.
pub(super) fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let word = fold(word);
    let allowed = (word.len() / 3).max(1);
    candidates
        .into_iter()
        .map(|c| (edit_distance(&word, &fold(c)), c))
        .filter(|(distance, _)| *distance <= allowed)
        .min()
        .map(|(_, c)| c)
}

/// `did you mean "x"?`, or where nothing is near, `label: a, b, c` (nothing where there are no candidates).
pub(super) fn hint<'c>(word: &str, label: &str, candidates: &[&'c str]) -> Option<String> {
    if let Some(best) = nearest(word, candidates.iter().copied()) {
        return Some(format!("did you mean \"{best}\"?"));
    }
    const MOST_LISTED: usize = 40;
    let mut sorted: Vec<&'c str> = candidates.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    (!sorted.is_empty()).then(|| {
        let mut text = format!("{label}: {}", sorted[..sorted.len().min(MOST_LISTED)].join(", "));
        if sorted.len() > MOST_LISTED {
            let _ = write!(text, " and {} more", sorted.len() - MOST_LISTED);
        }
        text
    })
}

/// Lower case without underscores, and cut: spelling conventions are not spelling mistakes.
fn fold(word: &str) -> Vec<char> {
    word.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).take(64).collect()
}

/// The least number of insertions, deletions, replacements and swaps of neighbours (optimal string alignment).
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        let distance = |a: &str, b: &str| edit_distance(&fold(a), &fold(b));
        assert_eq!(distance("diffuse", "difuse"), 1);
        assert_eq!(distance("plastic", "palstic"), 1);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("toWorld", "to_world"), 0);
        assert_eq!(distance("kitten", "sitting"), 3);
    }

    #[test]
    fn suggests_what_is_near() {
        let known = ["diffuse", "dielectric", "plastic"];
        assert_eq!(nearest("difuse", known), Some("diffuse"));
        assert_eq!(nearest("principled", known), None);
        assert_eq!(hint("x1234", "known", &known).unwrap(), "known: dielectric, diffuse, plastic");
        assert_eq!(hint("x", "known", &[]), None);
    }
}
