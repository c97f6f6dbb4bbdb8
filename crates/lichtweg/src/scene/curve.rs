//! Curves as shapes.
//!
//! The first surface coordinate goes from 0 to 1 along a curve, the second across it as it is seen. Normals point outwards; those
//! of flat curves turn towards the ray, those of ribbons are given.

use lichtweg_ray::math::{Affine, Vec2, Vec3};
use lichtweg_ray::{CurveError, CurvePoint, CurveStyle, Curves, Hit, Ray};

use super::description::CurvesDescription;
use super::offset::position_error;
use super::surface::{Place, SurfacePoint};

/// Curves in the world.
#[derive(Debug)]
pub struct CurveForm {
    /// What the ray engine sees.
    pub curves: Curves,
    /// -1 where normals point inwards.
    orientation: f32,
}

impl CurveForm {
    /// Curves under a regular map.
    pub fn new(source: &CurvesDescription, to_world: &Affine, flip: bool) -> Result<Self, CurveError> {
        let scale = if source.scales_radii { to_world.determinant().abs().cbrt() as f32 } else { 1.0 };
        let place =
            |p: &CurvePoint| CurvePoint { position: to_world.point(p.position), radius: p.radius * scale };
        let points: Vec<CurvePoint> = source.points.iter().map(place).collect();
        let normals: Vec<Vec3> = source.normals.iter().map(|n| to_world.normal(*n)).collect();
        let curves = Curves::new(source.style, source.basis, points, &source.counts, &normals)?;
        Ok(Self { curves, orientation: if flip { -1.0 } else { 1.0 } })
    }

    /// The point that a ray hit; both in the space of the form.
    #[inline(never)]
    pub fn point(&self, shape: u32, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let surface = self.curves.surface(ray, hit.primitive, hit.u);
        let (index, segments) = self.curves.place_in_curve(hit.primitive);
        let size = surface.position.abs().max_element() + surface.radius;
        SurfacePoint {
            position: surface.position,
            error: position_error(size) + self.stand_off() * surface.radius,
            geometric_normal: surface.geometric_normal * self.orientation,
            shading_normal: surface.shading_normal * self.orientation,
            uv: Vec2::new((index as f32 + hit.u) / segments as f32, hit.v),
            shape,
            primitive: hit.primitive,
            place: Place::WORLD,
        }
    }

    /// How far a ray must start from the surface, in radii. A band that faces the ray turns with the ray, within a tube: a ray
    /// that goes on from it must start outside (pbrt does the same). In a round joint that is seen at a slant, the point may lie a
    /// radius behind the axis. A ribbon's triangles are not quite in one plane.
    fn stand_off(&self) -> f32 {
        match self.curves.style() {
            CurveStyle::Round => 0.0,
            CurveStyle::Flat => 2.01,
            CurveStyle::Ribbon => 1e-3,
        }
    }

    /// Derivatives of the position with respect to the surface coordinates; none where the curve has no direction.
    pub fn partials(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        let (index, segments) = self.curves.place_in_curve(point.primitive);
        let u = (point.uv.x * segments as f32 - index as f32).clamp(0.0, 1.0);
        let along = self.curves.tangent(point.primitive, u) * segments as f32;
        // The engine's v grows to this side of a curve that is looked at along its normal, of a ribbon to the other.
        let side = if self.curves.style() == CurveStyle::Ribbon { -1.0 } else { 1.0 };
        let across = along.cross(point.shading_normal * self.orientation).try_normalized()?;
        let width = 2.0 * self.curves.axis(point.primitive, u).radius;
        let partials = [along, across * (side * width)];
        partials.iter().all(|p| p.is_finite() && p.length_squared() > 0.0).then_some(partials)
    }
}
