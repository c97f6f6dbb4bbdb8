//! Scene parameters: `<default name="spp" value="64"/>`, `-D spp=16`, and `$spp` in any attribute.
//!
//! As in Mitsuba 3 (`src/core/parser.cpp`): the command line wins over the file, a name ends where the longest defined one
//! does, and `\$` is a plain dollar sign.

use lichtweg::scene::description::Span;

/// Longest text that a substitution may yield; without a limit, defaults that mention each other grow exponentially.
const LONGEST: usize = 1 << 20;

/// The parameters known so far.
#[derive(Debug, Default)]
pub(super) struct Definitions {
    list: Vec<Definition>,
}

/// One parameter.
#[derive(Debug)]
pub(super) struct Definition {
    pub name: String,
    pub value: String,
    /// It was given on the command line.
    pub given: bool,
    /// Where a file declares it.
    pub declared: Option<Span>,
    pub used: bool,
}

/// Why a text could not be expanded.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum ExpandError {
    /// No parameter of this name is defined.
    Undefined(String),
    /// The result is longer than a megabyte.
    TooLong,
}

impl Definitions {
    /// Starts with the values of the command line; of two for one name the last counts.
    pub fn new(defines: &[(String, String)]) -> Self {
        let mut this = Self::default();
        for (name, value) in defines {
            match this.list.iter_mut().find(|d| d.name == *name) {
                Some(known) => known.value.clone_from(value),
                None => this.list.push(Definition {
                    name: name.clone(),
                    value: value.clone(),
                    given: true,
                    declared: None,
                    used: false,
                }),
            }
        }
        this
    }

    /// A `<default>`: counts where nothing of that name is known yet.
    pub fn declare(&mut self, name: &str, value: &str, span: Span) {
        match self.list.iter_mut().find(|d| d.name == name) {
            Some(known) => known.declared = known.declared.or(Some(span)),
            None => self.list.push(Definition {
                name: name.to_owned(),
                value: value.to_owned(),
                given: false,
                declared: Some(span),
                used: false,
            }),
        }
    }

    /// The text with every `$name` replaced.
    pub fn expand(&mut self, text: &str) -> Result<String, ExpandError> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            let found = self.list.iter_mut().filter(|d| after.starts_with(&d.name) && !d.name.is_empty());
            let Some(found) = found.max_by_key(|d| d.name.len()) else {
                let end = after.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(after.len());
                return Err(ExpandError::Undefined(after[..end].to_owned()));
            };
            found.used = true;
            out.push_str(&found.value);
            if out.len() > LONGEST {
                return Err(ExpandError::TooLong);
            }
            rest = &after[found.name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }

    /// The names that can be used.
    pub fn names(&self) -> Vec<&str> {
        self.list.iter().map(|d| d.name.as_str()).collect()
    }

    /// The names that a file declares.
    pub fn declared(&self) -> Vec<&str> {
        self.list.iter().filter(|d| d.declared.is_some()).map(|d| d.name.as_str()).collect()
    }

    /// Those from the command line that nothing refers to.
    pub fn unused(&self) -> impl Iterator<Item = &Definition> {
        self.list.iter().filter(|d| d.given && !d.used)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn definitions() -> Definitions {
        let mut definitions = Definitions::new(&[
            ("spp".into(), "1".into()),
            ("spp".into(), "16".into()),
            ("x".into(), "7".into()),
        ]);
        definitions.declare("spp", "64", Span::default());
        definitions.declare("spp_high", "256", Span::default());
        definitions
    }

    #[test]
    fn expands_the_longest_name() {
        let mut d = definitions();
        assert_eq!(d.expand("$spp/$spp_high, $spp_low").unwrap(), "16/256, 16_low");
        assert_eq!(d.expand(r"costs 5\$ of $spp").unwrap(), "costs 5$ of 16");
        assert_eq!(d.expand("plain").unwrap(), "plain");
    }

    #[test]
    fn names_what_is_undefined_or_unused() {
        let mut d = definitions();
        assert_eq!(d.expand("a $resx b"), Err(ExpandError::Undefined("resx".into())));
        assert_eq!(d.expand("$"), Err(ExpandError::Undefined(String::new())));
        assert_eq!(d.unused().map(|d| d.name.as_str()).collect::<Vec<_>>(), ["spp", "x"]);
        d.expand("$x").unwrap();
        assert_eq!(d.unused().map(|d| d.name.as_str()).collect::<Vec<_>>(), ["spp"]);
        assert_eq!(d.declared(), ["spp", "spp_high"]);
    }

    #[test]
    fn refuses_to_grow_without_bound() {
        let mut d = Definitions::default();
        d.declare("a0", "xxxxxxxx", Span::default());
        let failed = (0..40).any(|i| match d.expand(&format!("$a{i}$a{i}")) {
            Ok(value) => {
                d.declare(&format!("a{}", i + 1), &value, Span::default());
                false
            }
            Err(error) => error == ExpandError::TooLong,
        });
        assert!(failed);
    }
}
