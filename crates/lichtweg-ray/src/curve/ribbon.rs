//! A chord of a ribbon: two triangles between the edges c -+ r b, b = n x c' / |n x c'|, in a ray's frame.
//!
//! A triangle's edge functions decide as for meshes: the function of a reversed edge is exactly the negative, and zero counts
//! as inside, so that rays do not slip between the triangles of a band.

use super::bezier::Point4;
use super::round::Entry;
use crate::math::Vec3;

/// A ribbon's edges at one place along it: v = 0 and v = 1.
pub(crate) type Rung = [[f64; 3]; 2];

/// The normal at `u` between two unit normals: along the great circle, or where they are opposite or missing straight.
pub(crate) fn normal([n0, n1]: [Vec3; 2], u: f64) -> [f64; 3] {
    let (a, b) = (n0.to_array().map(f64::from), n1.to_array().map(f64::from));
    let cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).clamp(-1.0, 1.0);
    let angle = cosine.acos();
    let sine = angle.sin();
    let [wa, wb] =
        if sine > 1e-6 { [((1.0 - u) * angle).sin() / sine, (u * angle).sin() / sine] } else { [1.0 - u, u] };
    std::array::from_fn(|i| wa * a[i] + wb * b[i])
}

/// The unit vector across a ribbon; zero where the normal lies along the curve.
pub(crate) fn across(normal: [f64; 3], tangent: [f64; 3]) -> [f64; 3] {
    let [n, t] = [normal, tangent];
    let b = [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]];
    let length = (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]).sqrt();
    if length > 0.0 { b.map(|x| x / length) } else { [0.0; 3] }
}

/// The edges about a point of the axis.
pub(crate) fn rung(point: &Point4, across: [f64; 3]) -> Rung {
    [-point[3], point[3]].map(|r| std::array::from_fn(|i| point[i] + r * across[i]))
}

/// Where the z axis meets the band between two rungs.
pub(crate) fn meet(begin: &Rung, end: &Rung) -> Option<Entry> {
    let lower = triangle([&begin[0], &begin[1], &end[1]]).map(|([_, _, c], z)| Entry { z, s: c });
    let upper = triangle([&begin[0], &end[1], &end[0]]).map(|([_, b, c], z)| Entry { z, s: b + c });
    match (lower, upper) {
        (Some(l), Some(u)) => Some(if u.z < l.z { u } else { l }),
        (l, u) => l.or(u),
    }
}

/// Weights of the corners and height of the point where the z axis meets a triangle.
fn triangle([a, b, c]: [&[f64; 3]; 3]) -> Option<([f64; 3], f64)> {
    let edge = |p: &[f64; 3], q: &[f64; 3]| p[0] * q[1] - p[1] * q[0];
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let sum = u + v + w;
    (inside && sum != 0.0).then(|| {
        let weights = [u / sum, v / sum, w / sum];
        (weights, weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2])
    })
}
