//! Damaged scenes, and scenes put together at random, never make the reader panic, hang or return a scene with errors.
//!
//! Runs for two seconds with fixed seeds; `LICHTWEG_FUZZ_SECONDS=600 cargo test --release --test mitsuba_fuzz` goes on for
//! longer, through the same sequence of inputs and beyond.

mod random;

use std::path::Path;
use std::time::{Duration, Instant};

use lichtweg::scene::description::{Diagnostics, SourceMap};
use lichtweg_io::diagnostics::render;
use lichtweg_io::mitsuba::read_str;
use lichtweg_io::options::{LoadReport, ReadOptions};
use random::Random;

const FOLDER: &str = "tests/bad/mitsuba";

fn budget() -> Duration {
    let seconds = std::env::var("LICHTWEG_FUZZ_SECONDS").ok().and_then(|s| s.parse().ok());
    Duration::from_secs_f64(seconds.unwrap_or(2.0))
}

fn check(text: &str) {
    for lenient in [false, true] {
        let mut sources = SourceMap::default();
        let mut diagnostics = Diagnostics::new(lenient);
        let options = ReadOptions { defines: vec![("size".to_owned(), "3".to_owned())] };
        let name = Path::new(FOLDER).join("fuzz.xml");
        let scene =
            read_str(&name, text, &options, &mut sources, &mut diagnostics, &mut LoadReport::default());
        assert_eq!(scene.is_none(), diagnostics.has_errors());
        let text = render(&diagnostics, &sources, false);
        assert_eq!(text.is_empty(), diagnostics.list.is_empty());
    }
}

fn seeds() -> Vec<String> {
    let mut paths: Vec<_> = ["tests/good/mitsuba", FOLDER]
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()))
        .filter(|p| p.extension().is_some_and(|e| e == "xml"))
        .collect();
    paths.sort();
    paths.iter().filter_map(|p| std::fs::read_to_string(p).ok()).collect()
}

/// One of four kinds of damage: bytes, deleted pieces, pieces of other scenes, and attribute values.
fn mutate(text: &str, others: &[String], random: &mut Random) -> String {
    const VALUES: [&str; 22] = [
        "",
        "0",
        "-1",
        "1e38",
        "1e-45",
        "1e300",
        "nan",
        "inf",
        "65536",
        "99999999999999999999",
        "$size",
        "$",
        "\\$",
        "#fff",
        "400:1 500:2",
        "1 2 3",
        "true",
        "twosided",
        "obj",
        "diffuse",
        "id",
        "ü",
    ];
    let mut bytes = text.as_bytes().to_vec();
    match random.below(4) {
        0 => {
            for _ in 0..=random.below(4) {
                let at = random.below(bytes.len());
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = b"<>/\"=&; \n$0-e\xff"[random.below(14)];
                }
            }
        }
        1 => {
            let start = random.below(bytes.len());
            let end = (start + random.below(80)).min(bytes.len());
            bytes.drain(start..end);
        }
        2 => {
            let other = others[random.below(others.len())].as_bytes();
            let lines: Vec<&[u8]> = other.split_inclusive(|b| *b == b'\n').collect();
            let line = lines.get(random.below(lines.len())).copied().unwrap_or_default();
            let breaks: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i] == b'\n').collect();
            let at = breaks.get(random.below(breaks.len())).map_or(0, |i| i + 1);
            bytes.splice(at..at, line.iter().copied());
        }
        _ => {
            let quotes: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i] == b'"').collect();
            let pair = 2 * random.below(quotes.len() / 2);
            if let (Some(&open), Some(&close)) = (quotes.get(pair), quotes.get(pair + 1)) {
                let value = VALUES[random.below(VALUES.len())];
                bytes.splice(open + 1..close, value.bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn damaged_scenes_are_refused_in_peace() {
    let seeds = seeds();
    assert!(seeds.len() > 40);
    seeds.iter().for_each(|s| check(s));
    let (start, mut random, mut count) = (Instant::now(), Random(2026), 0);
    while start.elapsed() < budget() {
        let mut text = seeds[random.below(seeds.len())].clone();
        for _ in 0..=random.below(3) {
            text = mutate(&text, &seeds, &mut random);
        }
        check(&text);
        count += 1;
    }
    println!("{count} damaged scenes");
}

/// The files beside a scene, each damaged in turn.
#[test]
fn damaged_files_are_refused_in_peace() {
    let folder = std::env::temp_dir().join(format!("lichtweg-mitsuba-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let names = ["triangle.obj", "triangle.ply", "dots.png", "eta.spd"];
    let originals = names.map(|n| std::fs::read(Path::new("tests/good/mitsuba/part").join(n)).unwrap());
    let shape = |kind: &str| {
        format!("<shape type=\"{kind}\"><string name=\"filename\" value=\"triangle.{kind}\"/></shape>")
    };
    let text = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{}{}<emitter type=\"envmap\">\
         <string name=\"filename\" value=\"dots.png\"/></emitter><bsdf type=\"diffuse\">\
         <spectrum name=\"reflectance\" filename=\"eta.spd\"/></bsdf></scene>",
        shape("obj"),
        shape("ply")
    );
    let (start, mut random) = (Instant::now(), Random(7));
    while start.elapsed() < budget() / 4 {
        for (name, original) in names.iter().zip(&originals) {
            let mut bytes = original.clone();
            for _ in 0..random.below(4) {
                let at = random.below(bytes.len());
                bytes[at] =
                    if random.below(2) == 0 { random.next() as u8 } else { b"0 9-.\n"[random.below(6)] };
            }
            bytes.truncate(bytes.len() - random.below(bytes.len()) * usize::from(random.below(4) == 0));
            std::fs::write(folder.join(name), bytes).unwrap();
        }
        let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::new(true));
        let (options, mut report) = (ReadOptions::default(), LoadReport::default());
        let name = folder.join("scene.xml");
        let scene = read_str(&name, &text, &options, &mut sources, &mut diagnostics, &mut report);
        assert_eq!(scene.is_none(), diagnostics.has_errors());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn deep_and_wide_scenes_end() {
    let nested = |open: &str, close: &str| {
        format!("<scene version=\"3.0.0\">{}{}</scene>", open.repeat(100_000), close.repeat(100_000))
    };
    check(&nested("<bsdf type=\"twosided\">", "</bsdf>"));
    check(&nested("<a>", "</a>"));
    check(&format!("<scene version=\"3.0.0\">{}</scene>", "<shape type=\"ball\"/>".repeat(20_000)));
    let twins = "<bsdf type=\"diffuse\" id=\"a\"/>".repeat(20_000);
    check(&format!("<scene version=\"3.0.0\">{twins}</scene>"));
    let chain: String = (0..20_000)
        .map(|i| format!("<bsdf type=\"twosided\" id=\"b{i}\"><ref id=\"b{}\"/></bsdf>", i + 1))
        .collect();
    check(&format!("<scene version=\"3.0.0\">{chain}</scene>"));
    let growth: String =
        (0..64).map(|i| format!("<default name=\"a{}\" value=\"$a{i}$a{i}\"/>", i + 1)).collect();
    check(&format!("<scene version=\"3.0.0\"><default name=\"a0\" value=\"xx\"/>{growth}</scene>"));
    let lost: String =
        (0..20_000).map(|i| format!("<shape type=\"sphere\"><ref id=\"c{i}\"/></shape>")).collect();
    check(&format!("<scene version=\"3.0.0\">{lost}</scene>"));
}
