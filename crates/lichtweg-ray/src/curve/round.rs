//! A chord of a round curve: the union of the balls between its ends, in a ray's frame.
//!
//! With ends a, b, A = b - a and the radius a linear function from ra to rb = ra + R, a point q (relative to a) lies on
//! the side of the cone where, for its contact s in [0, 1],
//!
//!   s K = q.A + ra R   and   q.q - ra^2 - (q.A + ra R)^2 / K = 0,   K = A.A - R^2,
//!
//! which with q = -a + (0, 0, z) is a quadratic in z. The body is convex and all candidates lie in it: roots with
//! s in [0, 1] and the near sides of the two balls. So the entry is the nearest of them, without distinction of cases.
//! Where K <= 0 one ball holds the other.

use super::bezier::Point4;

/// Below this part of A.A the side K of a cone is too small to see beside its larger ball.
const BLUNT: f64 = 1e-10;
/// How deep, in squared radii, a point must be inside a neighbour to count as hidden by it.
const HIDDEN: f64 = 1e-6;

/// Where the z axis meets a chord: distance and part of the chord, for balls 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub z: f64,
    pub s: f64,
}

/// The side of a cone between two balls.
struct Cone {
    axis: [f64; 3],
    slope: f64,
    k: f64,
}

impl Cone {
    fn new(a: &Point4, b: &Point4) -> Option<Self> {
        let axis = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let slope = b[3] - a[3];
        let length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
        let k = length2 - slope * slope;
        (k > BLUNT * length2).then_some(Self { axis, slope, k })
    }
}

/// Where the z axis enters the union of the balls from `a` to `b`.
pub(crate) fn enter(a: &Point4, b: &Point4) -> Option<Entry> {
    let mut best = None;
    let mut consider = |z: f64, s: f64| {
        if best.is_none_or(|e: Entry| z < e.z) && z.is_finite() {
            best = Some(Entry { z, s });
        }
    };
    for (ball, s) in [(a, 0.0), (b, 1.0)] {
        let square = ball[3] * ball[3] - ball[0] * ball[0] - ball[1] * ball[1];
        if square >= 0.0 {
            consider(ball[2] - square.sqrt(), s);
        }
    }
    if let Some(cone) = Cone::new(a, b) {
        let [x, y, z] = cone.axis;
        // The origin is moved to the height of a, against cancellation.
        let m = a[3] * cone.slope - a[0] * x - a[1] * y;
        let quadratic = cone.k - z * z;
        let half_linear = -m * z;
        let constant = (a[0] * a[0] + a[1] * a[1] - a[3] * a[3]) * cone.k - m * m;
        let discriminant = half_linear * half_linear - quadratic * constant;
        if discriminant >= 0.0 {
            let q = -half_linear - discriminant.sqrt().copysign(half_linear);
            for root in [q / quadratic, constant / q] {
                let s = (m + z * root) / cone.k;
                if (0.0..=1.0).contains(&s) {
                    consider(a[2] + root, s);
                }
            }
        }
    }
    best
}

/// Whether the point at height `z` on the axis is well inside the union of the balls from `a` to `b`.
///
/// The squared distance to a ball's surface is quadratic in s: its minimum decides.
pub(crate) fn hides(a: &Point4, b: &Point4, z: f64) -> bool {
    let excess = |s: f64| {
        let [x, y, z, r]: Point4 = std::array::from_fn(|i| {
            let p = a[i] + (b[i] - a[i]) * s;
            if i == 2 { p - z } else { p }
        });
        x * x + y * y + z * z - r * r * (1.0 - HIDDEN)
    };
    let middle = Cone::new(a, b).map_or(0.0, |cone| {
        let [x, y, dz] = cone.axis;
        ((a[3] * cone.slope - a[0] * x - a[1] * y - (a[2] - z) * dz) / cone.k).clamp(0.0, 1.0)
    });
    [0.0, middle, 1.0].into_iter().any(|s| excess(s) < 0.0)
}
