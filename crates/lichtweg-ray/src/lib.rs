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
//!
//! # Instances, motion, masks and filters
//!
//! A structure can be placed in others, two levels deep, under affine maps that may move; a hit names the instances
//! it went through. Vertices move in a [`MovingMesh`]. Rays carry the time.
//!
//! ```
//! use std::sync::Arc;
//! use lichtweg_ray::math::{Affine, Motion, Vec3};
//! use lichtweg_ray::{Accel, BuildOptions, Hit, Instance, Quadric, QuadricShape, Ray};
//!
//! let ball = Quadric { shape: QuadricShape::SPHERE, object_to_world: Affine::IDENTITY };
//! let ball = Arc::new(Accel::build(vec![ball.into()], BuildOptions::default()).unwrap());
//!
//! let still = Instance::new(ball.clone(), Affine::scaling(1.0, 1.0, 2.0));
//! let path = [(0.0, Affine::translation(5.0, 0.0, 0.0)), (1.0, Affine::translation(5.0, 8.0, 0.0))];
//! let moving = Instance::moving(ball, Motion::new(path).unwrap());
//! let mut accel = Accel::build(vec![still.into(), moving.into()], BuildOptions::default()).unwrap();
//!
//! let down = |x, y| Ray::new(Vec3::new(x, y, 10.0), -Vec3::Z);
//! let hit = accel.closest(&down(0.0, 0.0)).unwrap();
//! assert_eq!((hit.t, hit.geometry, hit.instances), (8.0, 0, [0, Hit::NO_INSTANCE]));
//! assert!(accel.normal(&down(0.0, 0.0), &hit).z > 0.0);
//!
//! let late = down(5.0, 4.0).at_time(0.5);
//! assert_eq!(accel.closest(&late).unwrap().instances[0], 1);
//! assert!(!accel.occluded(&late.at_time(0.0)));
//! // Holes: hits that do not count.
//! assert!(!accel.occluded_filtered(&late, |hit| hit.instances[0] != 1));
//! // Some geometry for some rays.
//! accel.set_mask(1, 0b10);
//! assert!(!accel.occluded(&Ray { mask: 0b01, ..late }));
//! ```
//!
//! # Limits
//!
//! Coordinates reach to 2^40, in every instance's own space too. A ray is rounded once for each instance that it
//! enters, so meshes do not leak by themselves, but seams between instances may. Instances are enclosed safely for
//! rays that start within about twice the extent of the scene.
//!
//! # Instruction sets
//!
//! The best that the machine has is used. `LICHTWEG_ISA` in the environment may name one of them, `portable`, `avx2` or
//! `avx512`, before the first structure is built: for comparisons, and for tools that do not know the newest instructions. What the
//! machine does not have is not taken. All of them answer alike.
//!
//! # Checking memory
//!
//! Under Miri queries run on the portable instructions, and rayon needs some leave:
//! `MIRIFLAGS="-Zmiri-tree-borrows -Zmiri-ignore-leaks -Zmiri-permissive-provenance" cargo +nightly miri test
//! -p lichtweg-ray --test instances`. With the others, valgrind knows AVX2, and AddressSanitizer all: `valgrind target/release/deps/differential-*`;
//! `RUSTFLAGS=-Zsanitizer=address cargo +nightly test --release --lib --tests -p lichtweg-ray --target x86_64-unknown-linux-gnu`.

mod accel;
#[cfg(test)]
mod agreement;
mod build;
mod bvh;
#[cfg(feature = "count")]
pub mod counts;
#[cfg(not(feature = "count"))]
mod counts;
mod curve;
mod geometry;
mod kind;
pub mod math;
mod memory;
mod packet;
mod ray;
mod refit;
mod simd;
mod triangle;
pub mod wide;

pub use accel::{Accel, BuildError, BuildOptions, BuildQuality, BuildReport};
pub use curve::{CurveBasis, CurveError, CurvePoint, CurveStyle, CurveSurface, Curves};
pub use geometry::{Geometry, TriangleMesh};
pub use kind::{Instance, MovingMesh, Placement, Quadric, QuadricShape, UserHit, UserPrimitives};
pub use packet::{HitPacket, RayPacket};
pub use ray::{Hit, Ray};
pub use refit::RefitError;
