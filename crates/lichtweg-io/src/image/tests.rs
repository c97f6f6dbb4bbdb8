//! Tests of reading and writing images.

mod formats;
mod output;

use std::path::{Path, PathBuf};

use lichtweg::scene::description::{Image, Pixels};

use super::LoadedImage;

/// The numbers as `f32`, integers as they are.
fn numbers(image: &Image) -> Vec<f32> {
    match &image.pixels {
        Pixels::U8(numbers) => numbers.iter().map(|&x| f32::from(x)).collect(),
        Pixels::U16(numbers) => numbers.iter().map(|&x| f32::from(x)).collect(),
        Pixels::F32(numbers) => numbers.clone(),
    }
}

/// Panics unless the promises of [`LoadedImage`] hold.
fn assert_valid(loaded: &LoadedImage) {
    let Image { width, height, channels, .. } = loaded.image;
    let numbers = numbers(&loaded.image);
    assert!(width > 0 && height > 0 && (1..=4).contains(&channels));
    assert_eq!(numbers.len(), width as usize * height as usize * channels as usize);
    assert!(numbers.iter().all(|x| x.is_finite()));
}

/// A directory of its own for one test, removed with its contents at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("lichtweg-image-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A file of the directory `shared` beside the checkout, or `None` with a notice.
fn shared(path: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path);
    if !path.exists() {
        println!("skipped: {} is absent", path.display());
        return None;
    }
    Some(path)
}
