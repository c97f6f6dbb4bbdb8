//! What a tree needs to know of lights: where they are, where they shine, and how bright.

use std::f32::consts::{FRAC_PI_2, PI};

use lichtweg_ray::math::{Bounds3, Vec3};

/// Bounds on a light, or on several together.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// Around its places.
    pub bounds: Bounds3,
    /// Unit axis of the cone of its normals.
    pub axis: Vec3,
    /// Half-angle of that cone in radians; pi is every direction. Light leaves at less than pi / 2 from a normal.
    pub spread: f32,
    /// Whether light leaves against the normals, too.
    pub two_sided: bool,
    /// What leaves it in the direction where that is most: power per solid angle, of any unit.
    pub intensity: f32,
}

impl LightBounds {
    /// Those of two sets of lights together.
    pub(super) fn union(&self, other: &Self) -> Self {
        let two_sided = self.two_sided || other.two_sided;
        // With two sides a normal is as good as its opposite.
        let turned = if two_sided && self.axis.dot(other.axis) < 0.0 { -other.axis } else { other.axis };
        let (axis, spread) = cone_union((self.axis, self.spread), (turned, other.spread));
        let bounds = self.bounds.union(other.bounds);
        Self { bounds, axis, spread, two_sided, intensity: self.intensity + other.intensity }
    }

    /// The surface area orientation heuristic (Conty Estevez and Kulla 2018, section 4.4): a measure of how badly the importance of
    /// a node can judge its lights.
    pub(super) fn cost(&self) -> f32 {
        let (o, w) = (self.spread, (self.spread + FRAC_PI_2).min(PI));
        let orientation = 2.0 * PI * (1.0 - o.cos())
            + FRAC_PI_2 * (2.0 * w * o.sin() - (o - 2.0 * w).cos() - 2.0 * o * o.sin() + o.cos());
        self.intensity * orientation * self.bounds.extent().length_squared()
    }
}

/// The smallest cone (axis, half-angle) about two.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    if a.1 >= PI {
        return a;
    }
    let between = a.0.dot(b.0).clamp(-1.0, 1.0).acos();
    if (between + b.1).min(PI) <= a.1 {
        return a;
    }
    let spread = 0.5 * (a.1 + between + b.1);
    // Turn the wider one's axis towards the other's, by what its cone grows.
    match (b.0 - a.0 * a.0.dot(b.0)).try_normalized() {
        Some(side) if spread < PI => {
            let (sin, cos) = (spread - a.1).sin_cos();
            ((a.0 * cos + side * sin).normalized(), spread)
        }
        _ => (a.0, PI),
    }
}
