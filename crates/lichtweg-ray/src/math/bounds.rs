//! Axis-aligned boxes.

use super::Vec3;

/// An axis-aligned box, empty when `min > max` in any component.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Bounds3 {
    /// Lowest corner.
    pub min: Vec3,
    /// Highest corner.
    pub max: Vec3,
}

impl Bounds3 {
    /// The empty box: the neutral element of [`Bounds3::union`].
    pub const EMPTY: Self = Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// The smallest box that holds all `points`.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// The box grown to hold `p`.
    #[inline]
    pub fn including(self, p: Vec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box that holds both.
    #[inline]
    pub fn union(self, o: Self) -> Self {
        Self { min: self.min.min(o.min), max: self.max.max(o.max) }
    }

    /// Whether the box holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Edge lengths.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Largest absolute coordinate; zero for the empty box.
    #[inline]
    pub fn reach(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.min.abs().max(self.max.abs()).max_element() }
    }

    /// The middle.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Half the surface area: the quantity that the surface area heuristic compares.
    #[inline]
    pub fn half_area(&self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The box grown by `margin` on all sides; the empty box stays empty.
    pub fn widened(self, margin: f32) -> Self {
        Self { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        let pick = |bit: usize, lo: f32, hi: f32| if bit & 1 == 0 { lo } else { hi };
        std::array::from_fn(|i| {
            Vec3::new(
                pick(i, self.min.x, self.max.x),
                pick(i >> 1, self.min.y, self.max.y),
                pick(i >> 2, self.min.z, self.max.z),
            )
        })
    }
}
