//! Ray queries: shapes, wide bounding volume hierarchies, closest-hit and occlusion.
//!
//! ```
//! use lichtweg_ray::{Accel, BuildOptions, Geometry, Ray, TriangleMesh, math::Vec3};
//!
//! let mesh = TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//! let accel = Accel::build(vec![Geometry::Triangles(mesh)], BuildOptions::default()).unwrap();
//! let ray = Ray::new(Vec3::new(0.25, 0.5, 1.0), Vec3::new(0.0, 0.0, -1.0));
//! let hit = accel.closest(&ray).unwrap();
//! assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.25, 0.5));
//! assert!(accel.occluded(&ray));
//! ```
//!
//! The answer to a query is a property of the geometry and the ray, not of the hierarchy: among equally
//! near hits the one of lowest (geometry, primitive) wins, triangle meshes do not leak along shared
//! edges, and every instruction set gives the same bits.

mod accel;
#[cfg(test)]
mod agreement;
mod build;
mod bvh;
mod curve;
mod geometry;
mod kind;
pub mod math;
mod memory;
mod ray;
mod simd;
mod triangle;

pub use accel::{Accel, BuildError, BuildOptions, BuildReport};
pub use curve::{CurveBasis, CurveError, CurvePoint, CurveStyle, CurveSurface, Curves};
pub use geometry::{Geometry, TriangleMesh};
pub use kind::{Quadric, QuadricShape};
pub use ray::{Hit, Ray};
