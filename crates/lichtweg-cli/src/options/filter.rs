//! `--filter NAME[:radius]`.

use lichtweg::scene::description::{FilterDescription, FilterKind};

use super::listed;

const NAMES: [&str; 6] = ["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"];

/// Largest radius in pixels.
const LARGEST: f32 = 100.0;

/// A filter by its name, with a radius in pixels or the usual one. As in Mitsuba, a Gaussian ends at four standard
/// deviations, and a Lanczos filter has as many lobes as its radius is pixels long.
pub fn parse_filter(text: &str) -> Result<FilterDescription, String> {
    let (name, radius) = match text.split_once(':') {
        None => (text, None),
        Some((name, radius)) => (name, Some(parse_radius(radius)?)),
    };
    let third = 1.0 / 3.0;
    let filter = |kind, usual| FilterDescription::new(kind, radius.unwrap_or(usual));
    Ok(match name.to_ascii_lowercase().as_str() {
        "box" => filter(FilterKind::Box, 0.5),
        "tent" => filter(FilterKind::Tent, 1.0),
        "gaussian" => filter(FilterKind::Gaussian { standard_deviation: radius.unwrap_or(2.0) / 4.0 }, 2.0),
        "mitchell" => filter(FilterKind::Mitchell { b: third, c: third }, 2.0),
        "catmullrom" => filter(FilterKind::CatmullRom, 2.0),
        "lanczos" => filter(FilterKind::Lanczos { lobes: radius.unwrap_or(3.0) }, 3.0),
        _ => return Err(format!("no such filter; there are {}", listed(&NAMES))),
    })
}

fn parse_radius(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(radius) if radius > 0.0 && radius <= LARGEST => Ok(radius),
        Ok(_) => Err(format!("the radius must be above 0 and at most {LARGEST} pixels")),
        Err(_) => Err("expected NAME or NAME:RADIUS with a radius in pixels, for example gaussian:2".into()),
    }
}

/// A filter in the words [`parse_filter`] takes, as far as they go.
pub fn describe_filter(filter: &FilterDescription) -> String {
    let name = match filter.kind {
        FilterKind::Box => "box",
        FilterKind::Tent => "tent",
        FilterKind::Gaussian { .. } => "gaussian",
        FilterKind::Mitchell { .. } => "mitchell",
        FilterKind::CatmullRom => "catmullrom",
        FilterKind::Lanczos { .. } => "lanczos",
    };
    let [x, y] = filter.radius;
    if x == y { format!("{name}:{x}") } else { format!("{name}:{x}x{y}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_radii() {
        assert_eq!(parse_filter("box"), Ok(FilterDescription::BOX));
        assert_eq!(parse_filter("gaussian"), Ok(FilterDescription::default()));
        assert_eq!(parse_filter("tent:1.5"), Ok(FilterDescription::new(FilterKind::Tent, 1.5)));
        for name in NAMES {
            let filter = parse_filter(name).unwrap();
            assert_eq!(parse_filter(&describe_filter(&filter)), Ok(filter));
        }
    }

    #[test]
    fn errors_list_what_there_is() {
        assert!(parse_filter("sinc").unwrap_err().contains("catmullrom and lanczos"));
        assert!(parse_filter("box:wide").unwrap_err().contains("gaussian:2"));
        for radius in ["0", "-1", "nan", "inf", "1000"] {
            assert!(parse_filter(&format!("box:{radius}")).unwrap_err().contains("above 0"));
        }
    }
}
