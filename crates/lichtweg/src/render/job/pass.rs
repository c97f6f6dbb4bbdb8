//! One pass over the tiles, which can be cut short and survives a panic.
//!
//! Passes are as short as Ctrl-C may have to wait, but not shorter than one sample of each pixel. Where that takes long (large images,
//! slow scenes) such a pass ends between two tiles once it was asked to. The pixels then have different numbers of samples, perhaps
//! none, and each knows how many.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::Tile;

/// What a thread panicked with.
pub(super) type Panic = Box<dyn Any + Send>;

/// Lets `action` take `samples` more of the pixels of each tile, on all threads, each with its own workspace by `workspace`; begins
/// no tile once `ends` is true, or after a panic, which is returned.
pub(super) fn run<W>(
    tiles: &mut [Tile],
    samples: u32,
    ends: impl Fn() -> bool + Sync,
    workspace: impl Fn() -> W + Sync,
    action: impl Fn(&mut Tile, &mut W) + Sync,
) -> Option<Panic> {
    let panic: Mutex<Option<Panic>> = Mutex::new(None);
    let has_panicked = AtomicBool::new(false);
    tiles.par_iter_mut().for_each_init(&workspace, |w, tile| {
        if has_panicked.load(Ordering::Relaxed) || ends() {
            return;
        }
        // The tile's sums are those of whole samples at any moment; the workspace is not used again.
        match catch_unwind(AssertUnwindSafe(|| action(tile, w))) {
            Ok(()) => tile.samples += samples,
            Err(payload) => {
                has_panicked.store(true, Ordering::Relaxed);
                *w = workspace();
                if let Ok(mut panic) = panic.lock() {
                    panic.get_or_insert(payload);
                }
            }
        }
    });
    panic.into_inner().unwrap_or_default()
}

/// The words of a panic.
pub(super) fn message(panic: &Panic) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".to_owned())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;
    use crate::color::Spectrum;

    fn tiles(count: u32) -> Vec<Tile> {
        (0..count).map(|i| Tile::new([16 * i, 0, 16, 16], false)).collect()
    }

    fn shade(tile: &mut Tile, _: &mut ()) {
        tile.add(0, 0, Spectrum::ONE, 1.0, 1.0);
    }

    #[test]
    fn passes_reach_all_tiles() {
        let mut tiles = tiles(50);
        assert!(run(&mut tiles, 3, || false, || (), shade).is_none());
        assert!(tiles.iter().all(|t| t.samples == 3 && t.pixels[0].count == 1));
    }

    #[test]
    fn passes_end_between_tiles() {
        let mut tiles = tiles(200);
        let asked = AtomicU32::new(0);
        let ends = || asked.fetch_add(1, Ordering::Relaxed) >= 20;
        assert!(run(&mut tiles, 1, ends, || (), shade).is_none());
        let done = tiles.iter().filter(|t| t.samples == 1).count();
        assert_eq!(done, 20);
        assert!(tiles.iter().all(|t| t.pixels[0].count == t.samples));
    }

    #[test]
    fn a_panic_loses_no_other_tile() {
        let mut tiles = tiles(50);
        assert!(run(&mut tiles, 1, || false, || (), shade).is_none());
        let action = |tile: &mut Tile, w: &mut ()| match tile.window[0] {
            320 => panic!("tile {}", 20),
            _ => shade(tile, w),
        };
        let panic = run(&mut tiles, 1, || false, || (), action).expect("panics");
        assert_eq!(message(&panic), "tile 20");
        assert_eq!(tiles[20].samples, 1);
        assert!(tiles.iter().all(|t| t.pixels[0].count == t.samples && t.samples >= 1));
    }
}
