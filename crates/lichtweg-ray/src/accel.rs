//! The structure that answers queries.

use std::time::Instant;

use crate::build;
use crate::bvh::{self, Bvh, Others};
use crate::geometry::Geometry;
use crate::math::Bounds3;
use crate::quadric::PlacedQuadric;
use crate::ray::{Hit, Ray};
use crate::simd::Isa;

/// How much work to put into a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Few bins, no splits through triangles: for what changes often.
    Fast,
    /// The surface area heuristic with splits through triangles, which add at most a fifth to the number
    /// of references.
    #[default]
    High,
}

/// How to build.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildOptions {
    /// How much work to put into the structure.
    pub quality: BuildQuality,
}

impl From<BuildQuality> for BuildOptions {
    fn from(quality: BuildQuality) -> Self {
        Self { quality }
    }
}

/// What a build did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildReport {
    /// Triangles in the structure.
    pub triangles: usize,
    /// Quadrics in the structure.
    pub quadrics: usize,
    /// Triangles left out because they have no area.
    pub dropped_degenerate: usize,
    /// Triangles left out because a corner is NaN or infinite.
    pub dropped_non_finite: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Memory of the structure, without the caller's meshes.
    pub bytes: usize,
    /// Wall-clock time of the build.
    pub seconds: f64,
}

/// Why a structure could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A triangle names a vertex that does not exist.
    #[error("geometry {geometry}, triangle {primitive}: vertex {index} of {vertices} does not exist")]
    IndexOutOfRange {
        /// Index of the geometry.
        geometry: u32,
        /// Index of the triangle.
        primitive: u32,
        /// The vertex it names.
        index: u32,
        /// The number of vertices there are.
        vertices: usize,
    },
    /// A quadric's map has no inverse or is not finite.
    #[error("geometry {geometry}: the map to the world is singular or not finite")]
    SingularTransform {
        /// Index of the geometry.
        geometry: u32,
    },
    /// A quadric's parameters make no sense.
    #[error("geometry {geometry}: {reason}")]
    InvalidQuadric {
        /// Index of the geometry.
        geometry: u32,
        /// What is wrong.
        reason: &'static str,
    },
    /// More primitives than 32-bit references can name.
    #[error("{primitives} primitives are more than a structure can hold")]
    TooLarge {
        /// The number asked for.
        primitives: usize,
    },
}

/// An immutable structure over a list of geometries; queries may run from any number of threads.
#[derive(Debug)]
pub struct Accel {
    geometries: Vec<Geometry>,
    quadrics: Vec<PlacedQuadric>,
    pub(crate) bvh: Bvh,
    pub(crate) isa: Isa,
    bounds: Bounds3,
    report: BuildReport,
}

impl Accel {
    /// Builds the structure on rayon's current thread pool; the result does not depend on its size.
    /// Triangles that are not finite, beyond 2^40 or without area are dropped and counted.
    pub fn build(geometries: Vec<Geometry>, options: BuildOptions) -> Result<Self, BuildError> {
        let start = Instant::now();
        let mut census = build::census(&geometries)?;
        let bvh = build::build(&geometries, &mut census, options.quality)?;
        let report = BuildReport {
            triangles: census.triangles,
            quadrics: census.quadrics.len(),
            dropped_degenerate: census.dropped_degenerate,
            dropped_non_finite: census.dropped_non_finite,
            nodes: bvh.nodes.len(),
            bytes: bvh.bytes(),
            seconds: start.elapsed().as_secs_f64(),
        };
        let (bounds, quadrics) = (census.bounds, census.quadrics);
        Ok(Self { geometries, quadrics, bvh, isa: Isa::best(), bounds, report })
    }

    /// The nearest hit with `tnear < t <= tfar`; of equally near ones that of the lowest geometry and
    /// primitive. Rays that are not finite (but for `tfar`) or have no direction hit nothing.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        bvh::closest(self.isa, &self.bvh, &self.others(), ray)
    }

    /// Whether anything lies at `tnear < t <= tfar`.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        bvh::occluded(self.isa, &self.bvh, &self.others(), ray)
    }

    /// The box around everything that can be hit; empty for an empty scene.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The geometries the structure was built from.
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// What the build did.
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    #[inline(always)]
    fn others(&self) -> Others<'_> {
        Others { quadrics: &self.quadrics }
    }
}
