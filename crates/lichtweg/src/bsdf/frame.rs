//! Orthonormal frames, and the trigonometry of directions in them.

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

/// Three orthonormal vectors; `normal` is the local z axis. Or as many frames as `F` has lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<F = f32> {
    /// Local x axis.
    pub tangent: Vector<F>,
    /// Local y axis.
    pub bitangent: Vector<F>,
    /// Local z axis.
    pub normal: Vector<F>,
}

impl<F: Float> Frame<F> {
    /// A frame about a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    #[inline(always)]
    pub fn from_normal(n: Vector<F>) -> Self {
        let one = F::splat(1.0);
        let sign = one.copysign(n.z);
        let a = F::splat(-1.0) / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            tangent: Vector::new(one + sign * n.x * n.x * a, sign * b, -sign * n.x),
            bitangent: Vector::new(b, sign + n.y * n.y * a, -n.y),
            normal: n,
        }
    }

    /// World to local.
    #[inline(always)]
    pub fn to_local(&self, v: Vector<F>) -> Vector<F> {
        Vector::new(v.dot(self.tangent), v.dot(self.bitangent), v.dot(self.normal))
    }

    /// Local to world.
    #[inline(always)]
    pub fn to_world(&self, v: Vector<F>) -> Vector<F> {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }
}

impl Frame {
    /// A frame about the unit vector `n` whose tangent lies in the plane of `n` and `tangent`; any frame about `n` where those
    /// are parallel.
    #[inline]
    pub fn from_normal_tangent(n: Vec3, tangent: Vec3) -> Self {
        match (tangent - n * n.dot(tangent)).try_normalized() {
            Some(t) => Self { tangent: t, bitangent: n.cross(t), normal: n },
            None => Self::from_normal(n),
        }
    }
}
