//! Affine maps of space.

use super::{Bounds3, Vec3};

/// The affine map p -> A p + t, held in `f64` because scene files chain many of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The rows `[A | t]`.
    pub rows: [[f64; 4]; 3],
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Affine {
    /// The identity.
    pub const IDENTITY: Self =
        Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// A translation.
    pub fn translation(x: f64, y: f64, z: f64) -> Self {
        Self { rows: [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]] }
    }

    /// A scaling along the axes.
    pub fn scaling(x: f64, y: f64, z: f64) -> Self {
        Self { rows: [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]] }
    }

    /// A right-handed rotation about `axis` (any length but zero) by `degrees`.
    pub fn rotation(axis: [f64; 3], degrees: f64) -> Self {
        let n = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        let [x, y, z] = axis.map(|a| a / n);
        let (s, c) = degrees.to_radians().sin_cos();
        let k = 1.0 - c;
        Self {
            rows: [
                [x * x * k + c, x * y * k - z * s, x * z * k + y * s, 0.0],
                [y * x * k + z * s, y * y * k + c, y * z * k - x * s, 0.0],
                [z * x * k - y * s, z * y * k + x * s, z * z * k + c, 0.0],
            ],
        }
    }

    /// A camera frame at `origin` that looks along +z at `target`, with +y near `up` and +x to its
    /// left (right-handed, Mitsuba's convention). `None` where the three do not span a frame.
    pub fn look_at(origin: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<Self> {
        let dir = unit(sub(target, origin))?;
        let left = unit(cross(up, dir))?;
        let up = cross(dir, left);
        Some(Self { rows: std::array::from_fn(|i| [left[i], up[i], dir[i], origin[i]]) })
    }

    /// The map "first `first`, then `self`".
    pub fn after(&self, first: &Self) -> Self {
        let mut rows = [[0.0; 4]; 3];
        for (row, a) in rows.iter_mut().zip(&self.rows) {
            for (c, out) in row.iter_mut().enumerate() {
                *out = a[0] * first.rows[0][c] + a[1] * first.rows[1][c] + a[2] * first.rows[2][c];
            }
            row[3] += a[3];
        }
        Self { rows }
    }

    /// Determinant of the linear part; negative where the map mirrors.
    pub fn determinant(&self) -> f64 {
        let [a, b, c] = self.columns();
        dot(a, cross(b, c))
    }

    /// Whether no entry is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.rows.iter().flatten().all(|v| v.is_finite())
    }

    /// The inverse map, or `None` where the map is singular or not finite.
    pub fn inverse(&self) -> Option<Self> {
        let [a, b, c] = self.columns();
        let det = self.determinant();
        let inverse_rows = [cross(b, c), cross(c, a), cross(a, b)].map(|r| r.map(|v| v / det));
        let t = [self.rows[0][3], self.rows[1][3], self.rows[2][3]];
        let out = Self { rows: inverse_rows.map(|r| [r[0], r[1], r[2], -dot(r, t)]) };
        (det != 0.0 && out.is_finite()).then_some(out)
    }

    /// Image of a point, rounded once.
    pub fn point(&self, p: Vec3) -> Vec3 {
        let p = [f64::from(p.x), f64::from(p.y), f64::from(p.z)];
        let [x, y, z] = self.rows.map(|r| (r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]) as f32);
        Vec3::new(x, y, z)
    }

    /// Image of a direction (no translation), rounded once; not normalised.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        let v = [f64::from(v.x), f64::from(v.y), f64::from(v.z)];
        let [x, y, z] = self.rows.map(|r| (r[0] * v[0] + r[1] * v[1] + r[2] * v[2]) as f32);
        Vec3::new(x, y, z)
    }

    /// Image of a normal: the cofactor matrix applied (the inverse transpose up to a positive factor,
    /// with the mirror's sign taken out), not normalised.
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let [a, b, c] = self.columns();
        let n = [f64::from(n.x), f64::from(n.y), f64::from(n.z)];
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let sign = self.determinant().signum();
        let [x, y, z] = std::array::from_fn(|i| (sign * (bc[i] * n[0] + ca[i] * n[1] + ab[i] * n[2])) as f32);
        Vec3::new(x, y, z)
    }

    /// Bounds of the image of a box; empty for the empty box.
    pub fn bounds(&self, b: &Bounds3) -> Bounds3 {
        if b.is_empty() {
            return Bounds3::EMPTY;
        }
        Bounds3::of(b.corners().map(|p| self.point(p)))
    }

    /// Norm of the linear part: the root of the sum of its squares.
    pub(crate) fn norm(&self) -> f64 {
        self.rows.iter().flat_map(|r| &r[..3]).map(|x| x * x).sum::<f64>().sqrt()
    }

    fn columns(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|c| std::array::from_fn(|r| self.rows[r][c]))
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let n = dot(a, a).sqrt();
    (n > 0.0 && n.is_finite()).then(|| a.map(|v| v / n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes() {
        let m = Affine::translation(1.0, 2.0, 3.0)
            .after(&Affine::rotation([1.0, 2.0, 0.5], 37.0))
            .after(&Affine::scaling(2.0, -3.0, 0.5));
        let id = m.inverse().unwrap().after(&m);
        for (row, want) in id.rows.iter().zip(&Affine::IDENTITY.rows) {
            for (a, b) in row.iter().zip(want) {
                assert!((a - b).abs() < 1e-12);
            }
        }
        assert!(Affine::scaling(1.0, 0.0, 1.0).inverse().is_none());
    }

    #[test]
    fn normals_stay_perpendicular() {
        let m = Affine::rotation([0.0, 1.0, 1.0], 20.0).after(&Affine::scaling(1.0, 4.0, -2.0));
        let (t, n) = (Vec3::new(1.0, -1.0, 0.5), Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(t.dot(n), 0.0);
        assert!(m.vector(t).dot(m.normal(n)).abs() < 1e-5);
    }

    #[test]
    fn look_at_looks() {
        let m = Affine::look_at([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        assert_eq!(m.vector(Vec3::Z), Vec3::new(0.0, 0.0, -1.0));
        assert!(m.determinant() > 0.0);
        assert!(Affine::look_at([0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]).is_none());
    }
}
