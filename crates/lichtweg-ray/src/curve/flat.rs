//! A chord of a flat curve: a band that faces the ray, in the ray's frame.
//!
//! The chord is projected along the ray; it is hit where its nearest point is closer to the ray than the radius there, at the
//! depth of that point. Neighbours meet in a common round joint. The ends of a curve are cut at right angles, as in
//! Pharr, Jakob and Humphreys 2023, section 6.7.

use super::bezier::Point4;
use super::round::Entry;

/// Where the z axis meets the band from `a` to `b`; `cut` says which ends are straight rather than round.
pub(crate) fn meet(a: &Point4, b: &Point4, cut: [bool; 2]) -> Option<Entry> {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let length2 = x * x + y * y;
    let nearest = if length2 > 0.0 { -(a[0] * x + a[1] * y) / length2 } else { 0.5 };
    if (cut[0] && nearest < 0.0) || (cut[1] && nearest > 1.0) {
        return None;
    }
    let s = nearest.clamp(0.0, 1.0);
    let [px, py, z, r]: Point4 = std::array::from_fn(|i| a[i] * (1.0 - s) + b[i] * s);
    (px * px + py * py <= r * r && r > 0.0).then_some(Entry { z, s })
}
