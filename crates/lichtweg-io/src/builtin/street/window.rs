//! Windows: panes between glazing bars, frames, sills, surrounds, louvred shutters, boxes of flowers.

use super::builder::Builder;
use super::foliage::{Foliage, scatter};
use super::palette::Material;
use super::random::Random;
use super::solids::{Rectangle, cuboid, prism, v};

/// How deep panes lie behind the wall.
pub const DEPTH: f32 = 0.2;

/// What the windows of a house have in common.
#[derive(Clone, Copy, Debug)]
pub struct WindowStyle {
    /// Panes in a row.
    pub columns: u8,
    /// Rows of panes.
    pub rows: u8,
    /// What shutters are painted with, if there are any.
    pub shutters: Option<Material>,
    /// What is around the opening.
    pub surround: Surround,
    /// What the surround is made of.
    pub stone: Material,
}

/// What is around an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surround {
    /// A flat band.
    Band,
    /// A band with a cornice on top.
    Cornice,
    /// A lintel with a keystone.
    Keystone,
}

/// Fills an opening of the wall z = 0.
pub fn window(b: &mut Builder, rng: &mut Random, opening: Rectangle, style: &WindowStyle) {
    let (w, h) = (opening.width(), opening.height());
    b.at(opening.middle(), opening.y0, 0.0, |b| {
        sash(b, rng, w, h, style);
        surround(b, w, h, style);
        cuboid(b, style.stone, [-0.5 * w - 0.12, -0.09, -DEPTH], [0.5 * w + 0.12, 0.0, 0.13]);
        if let Some(paint) = style.shutters {
            let leaf = 0.5 * w;
            for x in [-0.5 * w - 0.09 - leaf, 0.5 * w + 0.09] {
                b.at(x, 0.0, 0.05, |b| shutter(b, paint, leaf, h));
            }
        }
        if rng.chance(0.22) {
            flower_box(b, rng, w);
        }
    });
}

/// Frame, bars and panes. No two panes lie quite in a plane, which one sees in what they mirror.
fn sash(b: &mut Builder, rng: &mut Random, w: f32, h: f32, style: &WindowStyle) {
    let (half, frame, bar) = (0.5 * w, 0.07, 0.016);
    let (back, front) = (-DEPTH, -DEPTH + 0.07);
    for x in [-half, half - frame] {
        cuboid(b, Material::Trim, [x, 0.0, back], [x + frame, h, front]);
    }
    for y in [0.0, h - frame] {
        cuboid(b, Material::Trim, [-half + frame, y, back], [half - frame, y + frame, front]);
    }
    let glass = Material::Glass(if rng.chance(0.3) { 1 + rng.below(2) } else { 0 });
    let step = [(w - 2.0 * frame) / f32::from(style.columns), (h - 2.0 * frame) / f32::from(style.rows)];
    for i in 0..style.columns {
        let x = -half + frame + f32::from(i) * step[0];
        if i > 0 {
            cuboid(b, Material::Trim, [x - bar, frame, back], [x + bar, h - frame, front - 0.02]);
        }
        for j in 0..style.rows {
            let y = frame + f32::from(j) * step[1];
            let z = back + 0.02;
            let mut z = || z + rng.jitter(0.004);
            b.quad(
                glass,
                [
                    v(x, y, z()),
                    v(x + step[0], y, z()),
                    v(x + step[0], y + step[1], z()),
                    v(x, y + step[1], z()),
                ],
            );
        }
    }
    for j in 1..style.rows {
        let y = frame + f32::from(j) * step[1];
        cuboid(b, Material::Trim, [-half + frame, y - bar, back], [half - frame, y + bar, front - 0.022]);
    }
}

fn surround(b: &mut Builder, w: f32, h: f32, style: &WindowStyle) {
    let (half, band, stone) = (0.5 * w, 0.13, style.stone);
    if style.surround != Surround::Keystone {
        for x in [-half - band, half] {
            cuboid(b, stone, [x, 0.0, 0.0], [x + band, h, 0.045]);
        }
        cuboid(b, stone, [-half - band, h, 0.0], [half + band, h + band, 0.045]);
    }
    match style.surround {
        Surround::Band => {}
        Surround::Cornice => {
            let y = h + band;
            let profile = [[0.0, y], [0.07, y], [0.16, y + 0.07], [0.16, y + 0.11], [0.0, y + 0.15]];
            b.turned(-90.0, |b| prism(b, stone, &profile, -half - band - 0.08, half + band + 0.08));
        }
        Surround::Keystone => {
            cuboid(b, stone, [-half - 0.16, h, 0.0], [half + 0.16, h + 0.2, 0.04]);
            prism(
                b,
                stone,
                &[[-0.09, h - 0.03], [0.09, h - 0.03], [0.14, h + 0.27], [-0.14, h + 0.27]],
                0.0,
                0.08,
            );
        }
    }
}

/// One leaf from the origin to the right: a frame around slanting louvres.
fn shutter(b: &mut Builder, paint: Material, w: f32, h: f32) {
    let (frame, thick) = (0.055, 0.035);
    for x in [0.0, w - frame] {
        cuboid(b, paint, [x, 0.0, -thick], [x + frame, h, thick * 0.5]);
    }
    for y in [0.0, 0.5 * (h - frame), h - frame] {
        cuboid(b, paint, [frame, y, -thick], [w - frame, y + frame, thick * 0.5]);
    }
    let count = b.count_along(11.0, 4);
    let step = (h - 2.0 * frame) / count as f32;
    for i in 0..count {
        let y = frame + i as f32 * step;
        let (front, back) = (thick * 0.3, -thick * 0.7);
        let top = y + 1.1 * step;
        b.quad(
            paint,
            [v(frame, y, front), v(w - frame, y, front), v(w - frame, top, back), v(frame, top, back)],
        );
    }
    b.quad(paint, [v(0.0, 0.0, -thick), v(w, 0.0, -thick), v(w, h, -thick), v(0.0, h, -thick)]);
}

fn flower_box(b: &mut Builder, rng: &mut Random, w: f32) {
    let half = 0.42 * w;
    let box_ = [[-half, 0.0], [half, 0.0], [half + 0.04, 0.19], [-half - 0.04, 0.19]];
    b.at(0.0, 0.0, 0.03, |b| prism(b, Material::Wood, &box_, 0.0, 0.2));
    let flower = Material::Flower(rng.below(2));
    let leaves = Foliage { size: 0.075, spread: 0.5, tones: [Material::Leaf(1), Material::Leaf(0), flower] };
    for _ in 0..b.count(90.0) {
        let centre = v(rng.jitter(half), 0.2 + rng.within(-0.06..0.16), 0.13 + rng.jitter(0.12));
        scatter(b, rng, &leaves, centre, v(0.0, 0.3, 0.6));
    }
}
