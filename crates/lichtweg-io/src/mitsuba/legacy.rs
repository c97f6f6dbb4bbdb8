//! Names of Mitsuba 0.x, and what they are called today.
//!
//! The rules of Mitsuba 3's `upgrade_from_v1` (`src/core/parser.cpp`): `camelCase` becomes `snake_case`, and a few
//! parameters have other names. What concerns one plugin alone is with that plugin.

use std::borrow::Cow;

/// Whether a scene of this `version` attribute is for Mitsuba 0.x or 1.x; `None` where it is no version number.
pub(super) fn is_legacy(version: &str) -> Option<bool> {
    let numbers: Option<Vec<u32>> = version.trim().split('.').map(|n| n.parse().ok()).collect();
    numbers.filter(|n| (1..=3).contains(&n.len())).map(|n| n[0] < 2)
}

/// `toWorld` as `to_world`, `intIOR` as `int_ior`.
pub(super) fn snake_case(name: &str) -> Cow<'_, str> {
    if !name.chars().any(char::is_uppercase) {
        return Cow::Borrowed(name);
    }
    let mut out = String::with_capacity(name.len() + 4);
    let mut after_lower = false;
    let mut in_capitals = false;
    for c in name.chars() {
        let upper = c.is_uppercase();
        if upper && after_lower {
            out.push('_');
            in_capitals = true;
        }
        if upper && in_capitals {
            out.extend(c.to_lowercase());
        } else {
            out.push(c);
            in_capitals = false;
        }
        after_lower = c.is_lowercase();
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn renames_camel_case() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("fovAxis", "fov_axis"),
            ("cropOffsetX", "crop_offset_x"),
            ("B", "B"),
            ("p0", "p0"),
            ("max_depth", "max_depth"),
            ("specularReflectance", "specular_reflectance"),
        ] {
            assert_eq!(snake_case(old), new);
        }
    }

    #[test]
    fn knows_versions() {
        assert_eq!(is_legacy("0.6.0"), Some(true));
        assert_eq!(is_legacy("3.0.0"), Some(false));
        assert_eq!(is_legacy("2"), Some(false));
        assert_eq!(is_legacy("three"), None);
        assert_eq!(is_legacy(""), None);
    }
}
