//! Values of options: parsers whose errors say what was expected, with an example.

mod filter;
mod integrator;
mod layers;

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PathBufValueParser, TypedValueParser};
use lichtweg_montecarlo::SamplerKind;

pub use filter::{describe_filter, parse_filter};
pub use integrator::{IntegratorChoice, describe_integrator, parse_integrator};
pub use layers::parse_layers;

/// Images wider or higher than this are refused.
const LARGEST: u32 = 65_536;

/// More threads than this are refused.
const MOST_THREADS: usize = 4096;

/// `640x480`.
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let expected = || "expected WIDTHxHEIGHT, for example 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let mut size = [0; 2];
    for (out, part) in size.iter_mut().zip([width, height]) {
        *out = whole(part).ok_or_else(expected)?;
    }
    match size {
        [0, _] | [_, 0] => Err("an image of no pixels; both sizes must be at least 1".into()),
        [w, h] if w > u64::from(LARGEST) || h > u64::from(LARGEST) => {
            Err(format!("too large: at most {LARGEST}x{LARGEST}"))
        }
        size => Ok(size.map(|n| n as u32)),
    }
}

/// `100,50,64,64`: x, y, width and height.
pub fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    let expected = "expected X,Y,WIDTH,HEIGHT in pixels from the top left corner, for example 100,50,64,64";
    let numbers: Option<Vec<u64>> = text.split(',').map(whole).collect();
    match numbers.as_deref() {
        Some([_, _, 0, _] | [_, _, _, 0]) => {
            Err("a crop of no pixels; its width and height must be at least 1".into())
        }
        Some(&[x, y, w, h]) if [x, y, w, h].iter().all(|&n| n <= u64::from(LARGEST)) => {
            Ok([x, y, w, h].map(|n| n as u32))
        }
        Some(&[_, _, _, _]) => Err(format!("too large: no number may exceed {LARGEST}")),
        _ => Err(expected.into()),
    }
}

/// A number of samples a pixel.
pub fn parse_spp(text: &str) -> Result<u32, String> {
    match whole(text) {
        Some(0) => Err("an image needs at least 1 sample per pixel".into()),
        Some(n) => u32::try_from(n).map_err(|_| format!("too many: at most {}", u32::MAX)),
        None => Err("expected a whole number of samples per pixel, for example 256".into()),
    }
}

/// A number of path edges: `None` for -1, unlimited.
pub fn parse_max_depth(text: &str) -> Result<Option<u32>, String> {
    match text.trim().parse::<i64>() {
        Ok(-1) => Ok(None),
        Ok(0) => Err("paths of 0 edges carry no light: 1 shows emitters alone, 2 adds direct light".into()),
        Ok(n @ 1..) => Ok(Some(u32::try_from(n).unwrap_or(u32::MAX))),
        _ => Err("expected the largest number of path edges, for example 5, or -1 for no limit".into()),
    }
}

/// `independent` or `sobol`.
pub fn parse_sampler(text: &str) -> Result<SamplerKind, String> {
    match text.to_ascii_lowercase().as_str() {
        "independent" => Ok(SamplerKind::Independent),
        "sobol" => Ok(SamplerKind::Sobol),
        _ => Err("no such sampler; there are independent and sobol".into()),
    }
}

/// The name [`parse_sampler`] takes.
pub fn describe_sampler(kind: SamplerKind) -> &'static str {
    match kind {
        SamplerKind::Independent => "independent",
        SamplerKind::Sobol => "sobol",
    }
}

/// A seed.
pub fn parse_seed(text: &str) -> Result<u64, String> {
    let expected = || format!("expected a whole number from 0 to {}", u64::MAX);
    text.trim().parse().map_err(|_| expected())
}

/// A number of threads.
pub fn parse_threads(text: &str) -> Result<usize, String> {
    match whole(text) {
        Some(0) => {
            Err("rendering takes at least 1 thread; leave the option out to use all processors".into())
        }
        Some(n) if n <= MOST_THREADS as u64 => Ok(n as usize),
        Some(_) => Err(format!("too many: at most {MOST_THREADS}")),
        None => Err("expected a number of threads, for example 4".into()),
    }
}

/// A time in seconds.
pub fn parse_seconds(text: &str) -> Result<Duration, String> {
    let number = text.trim().strip_suffix('s').unwrap_or(text.trim()).parse::<f64>();
    match number {
        Ok(seconds) if seconds > 0.0 => Duration::try_from_secs_f64(seconds).map_err(|_| "too long".into()),
        Ok(_) => Err("the time must be more than 0 seconds".into()),
        Err(_) => Err("expected a time in seconds, for example 90 or 0.5".into()),
    }
}

/// `name=value`.
pub fn parse_define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("expected NAME=VALUE, for example spp=64".into()),
    }
}

/// An exposure in stops.
pub fn parse_exposure(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(stops) if stops.abs() <= 100.0 => Ok(stops),
        Ok(_) => Err("expected a number of stops between -100 and 100".into()),
        Err(_) => Err("expected a number of stops, for example 1.5 or -2".into()),
    }
}

/// Takes an image file from the command line.
pub fn output_parser() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(parse_output)
}

/// An image file, by its extension.
fn parse_output(path: PathBuf) -> Result<PathBuf, String> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if matches!(extension.as_str(), "exr" | "png" | "jpg" | "jpeg" | "hdr" | "pfm") {
        return Ok(path);
    }
    Err("its extension must name a format: .exr (all layers), .png or .jpg (8-bit), .hdr or .pfm".into())
}

/// A whole number without a sign.
fn whole(text: &str) -> Option<u64> {
    let text = text.trim();
    text.bytes().all(|b| b.is_ascii_digit()).then_some(())?;
    // Digits alone: what does not fit is large, not wrong.
    (!text.is_empty()).then(|| text.parse().unwrap_or(u64::MAX))
}

/// Names as messages list them: `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        assert_eq!(parse_size("1X2"), Ok([1, 2]));
        for wrong in ["100", "100x", "x", "-1x5", "axb", "1x2x3", ""] {
            assert!(parse_size(wrong).unwrap_err().contains("640x480"), "{wrong}");
        }
        assert!(parse_size("0x5").unwrap_err().contains("no pixels"));
        for large in ["65537x1", "1x99999999999999999999999"] {
            assert!(parse_size(large).unwrap_err().contains("65536x65536"));
        }
    }

    #[test]
    fn crops() {
        assert_eq!(parse_crop("0, 1,2,3"), Ok([0, 1, 2, 3]));
        assert!(parse_crop("1,2,3").unwrap_err().contains("X,Y,WIDTH,HEIGHT"));
        assert!(parse_crop("1,2,0,3").unwrap_err().contains("no pixels"));
        assert!(parse_crop("1,2,3,99999999999").unwrap_err().contains("too large"));
    }

    #[test]
    fn numbers() {
        assert_eq!(parse_spp("64"), Ok(64));
        assert!(parse_spp("0").is_err() && parse_spp("-1").is_err() && parse_spp("9999999999").is_err());
        assert_eq!(parse_max_depth("-1"), Ok(None));
        assert_eq!(parse_max_depth("7"), Ok(Some(7)));
        assert!(parse_max_depth("0").is_err() && parse_max_depth("-2").is_err());
        assert_eq!(parse_seconds("0.5s"), Ok(Duration::from_millis(500)));
        assert!(["0", "-1", "nan", "inf", "1e300", "x"].iter().all(|t| parse_seconds(t).is_err()));
        assert!(["nan", "inf", "x", "200"].iter().all(|t| parse_exposure(t).is_err()));
        assert!(parse_threads("0").is_err() && parse_threads("100000").is_err());
        assert_eq!(parse_threads("7"), Ok(7));
        assert_eq!(parse_define("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert!(parse_define("a").is_err() && parse_define("=a").is_err());
    }

    #[test]
    fn outputs() {
        assert!(parse_output("a/b.EXR".into()).is_ok());
        for wrong in ["a", "a.gif", ".png", "exr"] {
            assert!(parse_output(wrong.into()).unwrap_err().contains(".hdr"), "{wrong}");
        }
    }

    #[test]
    fn lists() {
        assert_eq!(listed(&["a"]), "a");
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
    }
}
