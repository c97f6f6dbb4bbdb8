//! The contact sheet: one row a path length, one column an s, each picture with its label.

use lichtweg_io::image::{Layer, OutputImage};

use super::font;

/// A picture and its place.
pub struct Tile<'a> {
    /// Row and column.
    pub place: [usize; 2],
    /// What is written under it.
    pub label: String,
    /// Linear, row by row.
    pub pixels: &'a [[f64; 3]],
    /// Multiplies the pixels.
    pub gain: f64,
}

const MARGIN: usize = 4;
const DOT: usize = 2;
const BACKGROUND: f32 = 0.02;
const INK: f32 = 0.8;

/// Lays out pictures of one size.
pub fn sheet(tiles: &[Tile<'_>], [width, height]: [usize; 2]) -> OutputImage {
    let longest = tiles.iter().map(|t| t.label.len()).max().unwrap_or(0);
    let cell_width = width.max(longest * font::ADVANCE * DOT) + MARGIN;
    let cell_height = height + font::HEIGHT * DOT + 2 * MARGIN;
    let count = |axis: usize| tiles.iter().map(|t| t.place[axis] + 1).max().unwrap_or(1);
    let (w, h) = (count(1) * cell_width + MARGIN, count(0) * cell_height + MARGIN);
    let mut data = vec![BACKGROUND; w * h * 3];
    let mut set = |x: usize, y: usize, color: [f32; 3]| {
        data[(y * w + x) * 3..][..3].copy_from_slice(&color);
    };
    for tile in tiles {
        let [x0, y0] = [tile.place[1] * cell_width + MARGIN, tile.place[0] * cell_height + MARGIN];
        for (i, pixel) in tile.pixels.iter().enumerate() {
            set(x0 + i % width, y0 + i / width, pixel.map(|v| (v * tile.gain) as f32));
        }
        for [x, y] in font::dots(&tile.label) {
            for i in 0..DOT * DOT {
                let (x, y) = (x * DOT + i % DOT, y * DOT + i / DOT);
                set(x0 + x, y0 + height + MARGIN + y, [INK; 3]);
            }
        }
    }
    OutputImage {
        layers: vec![Layer {
            name: String::new(),
            channels: ["R", "G", "B"].map(str::to_owned).to_vec(),
            data,
        }],
        ..OutputImage::new(w as u32, h as u32)
    }
}
