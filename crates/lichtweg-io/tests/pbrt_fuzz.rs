//! Mutated scenes: the pbrt reader neither panics nor hangs nor points outside of a file.
//!
//! The sequence of mutations is fixed. Two seconds by default; `LICHTWEG_FUZZ_SECONDS` asks for more.

mod random;

use std::path::Path;
use std::time::{Duration, Instant};

use lichtweg::scene::description::{Diagnostics, SourceMap};
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_io::pbrt;
use random::Random;

/// Pieces that mutations insert.
const PIECES: [&str; 28] = [
    "\"",
    "[",
    "]",
    "#",
    "\\",
    "\n",
    " ",
    "-1",
    "0",
    "1e38",
    "1e-38",
    "nan",
    "true",
    "AttributeBegin\n",
    "AttributeEnd\n",
    "ObjectBegin \"a\"\n",
    "ObjectEnd\n",
    "ObjectInstance \"a\"\n",
    "WorldBegin\n",
    "ReverseOrientation\n",
    "Scale 1e300 1e300 1e300\n",
    "ActiveTransform EndTime\n",
    "\u{fc}",
    "\u{1f600}",
    "\"float radius\" 1e-30",
    "\"float power\" 3",
    "Include \"x\"\n",
    "Attribute \"shape\" \"float alpha\" .5\n",
];

fn mutate(text: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..1 + random.below(6) {
        let at = random.below(text.len() + 1);
        let end = (at + random.below(40)).min(text.len());
        match random.below(5) {
            0 => drop(text.drain(at..end)),
            1 => {
                let copy = text[at..end].to_vec();
                let to = random.below(text.len() + 1);
                text.splice(to..to, copy);
            }
            2 => {
                let piece = PIECES[random.below(PIECES.len())];
                text.splice(at..at, piece.bytes());
            }
            3 if at < text.len() => text[at] = random.next() as u8,
            _ => {
                let from = random.below(other.len());
                let to = (from + random.below(200)).min(other.len());
                text.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
}

fn seeds() -> Vec<Vec<u8>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad/pbrt");
    let mut files: Vec<_> = std::fs::read_dir(directory).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let mut seeds: Vec<Vec<u8>> = files.iter().filter_map(|f| std::fs::read(f).ok()).collect();
    seeds.push(include_bytes!("pbrt_everything.pbrt").to_vec());
    seeds
}

#[test]
fn mutated_scenes_are_survived() {
    let seconds = std::env::var("LICHTWEG_FUZZ_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(2.0);
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let seeds = seeds();
    let mut random = Random(1);
    let mut count = 0_u64;
    while Instant::now() < end {
        let mut text = seeds[random.below(seeds.len())].clone();
        mutate(&mut text, &seeds[random.below(seeds.len())], &mut random);
        let text = String::from_utf8_lossy(&text);
        let lenient = random.below(2) == 0;
        let mut sources = SourceMap::default();
        let mut diagnostics = Diagnostics::new(lenient);
        let options = ReadOptions::default();
        // No file is there to be found.
        let directory = Path::new("/nonexistent");
        let scene = pbrt::read_str(
            &text,
            "fuzz.pbrt",
            directory,
            &options,
            &mut sources,
            &mut diagnostics,
            &mut LoadReport::default(),
        );
        assert_eq!(scene.is_some(), !diagnostics.has_errors(), "{text}");
        for (span, _) in diagnostics.list.iter().filter_map(|d| d.label.as_ref()) {
            let source = &sources.file(span.file).text;
            assert!(source.get(span.start as usize..span.end as usize).is_some(), "{span:?} of {text}");
        }
        for shape in scene.iter().flat_map(|s| &s.shapes) {
            assert!((shape.material.0 as usize) < scene.as_ref().unwrap().materials.len(), "{text}");
        }
        count += 1;
    }
    eprintln!("{count} mutated scenes");
    assert!(count > 0);
}
