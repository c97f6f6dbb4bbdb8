//! Boxes of pieces of triangles.
//!
//! The corners of a triangle cut to the slab between two planes across an axis are its own corners in
//! the slab and the points where its edges cross the planes. A box around them is widened by a little
//! more than `primitive` widens a whole triangle's, for the rounding of the crossings: each is off by
//! at most 5 * 2^-24 of the triangle's extent and half a unit in the last place.

use super::primitive::Primitive;
use crate::math::Vec3;
use crate::simd::{Quad, QuadBox};

/// A triangle that can be cut.
pub(crate) struct Piece {
    corners: [Quad; 3],
    /// The corners once more, for reading single coordinates.
    coordinates: [[f32; 4]; 3],
    /// How far a box around a piece must reach beyond it, but for what depends on the position.
    margin: Quad,
    /// The reference to the part of the triangle that is to be cut further.
    whole: Primitive,
}

impl Piece {
    /// The part of a triangle that a reference stands for, unless the box of the triangle has more than
    /// `largest` half area.
    #[inline(always)]
    pub(crate) fn of(corners: [Vec3; 3], reference: &Primitive, largest: f32) -> Option<Self> {
        let coordinates = corners.map(|c| [c.x, c.y, c.z, 0.0]);
        let corners = coordinates.map(|[x, y, z, _]| Quad::new(x, y, z, 0.0));
        let lo = corners[0].min(corners[1]).min(corners[2]);
        let hi = corners[0].max(corners[1]).max(corners[2]);
        let [x, y, z, _] = hi.sub(lo).to_array();
        let size = x.max(y).max(z);
        if x * (y + z) + y * z > largest {
            return None;
        }
        let margin = Quad::splat(size * (6.0 * 2.0_f32.powi(-23)));
        Some(Self { corners, coordinates, margin, whole: *reference })
    }

    /// The box of the part of the reference between `from` and `to` along an axis; empty where there is none.
    #[inline(always)]
    pub(crate) fn between(&self, axis: usize, from: f32, to: f32) -> QuadBox {
        let mut out = QuadBox::empty();
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (a, b) = (self.coordinates[i][axis], self.coordinates[j][axis]);
            if a >= from && a <= to {
                out = out.including(self.corners[i]);
            }
            for plane in [from, to] {
                if (a < plane) != (b < plane) {
                    let share = Quad::splat((plane - a) / (b - a));
                    let step = self.corners[j].sub(self.corners[i]);
                    out = out.including(self.corners[i].add(step.mul(share)));
                }
            }
        }
        if out.is_empty() {
            return out;
        }
        let unit = Quad::splat(f32::EPSILON);
        let outwards = |p: Quad| p.max(Quad::splat(0.0).sub(p)).mul(unit).add(self.margin);
        let QuadBox { lo, hi } = out;
        let wide = QuadBox { lo: lo.sub(outwards(lo)), hi: hi.add(outwards(hi)) };
        wide.intersection(self.whole.bounds())
    }

    /// The reference cut to a box that [`Piece::between`] gave; `None` where that is empty.
    pub(crate) fn cut(&self, bounds: QuadBox) -> Option<Primitive> {
        (!bounds.is_empty()).then(|| self.whole.within(bounds))
    }
}
