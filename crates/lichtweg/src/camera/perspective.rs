//! A perspective camera with a pinhole or a thin lens.
//!
//! Film coordinates (x, y) run from (0, 0) at the top left corner to (1, 1). Through the lens point (u, v) goes the ray that
//! meets the pinhole's ray on the plane in focus (Cook, Porter and Carpenter 1984). Every film point has weight one: the
//! responsivity is normalised so that a film lit by unit radiance reads one.

use std::borrow::Cow;
use std::sync::Arc;

use lichtweg_montecarlo::warp;
use lichtweg_ray::math::{Affine, Motion, Vec3, Vector};
use lichtweg_ray::wide::Float;
use lichtweg_ray::{Placement, Ray};

use crate::lanes::{self, spread};
use crate::scene::description::{CameraDescription, Diagnostic, Diagnostics, FieldOfView, FovAxis};
use crate::scene::on_shutter_clock;

/// A perspective camera.
#[derive(Clone, Debug)]
pub struct Camera {
    pose: Pose,
    /// In place of `pose`, over times from the opening of the shutter, 0, to its closing, 1.
    motion: Option<Arc<Motion>>,
    /// Camera-space x and y at depth 1 of the film's top left corner, and their growth over the film.
    corner: [f32; 2],
    extent: [f32; 2],
    aperture_radius: f32,
    focus_distance: f32,
    near: f32,
    far: f32,
    /// Whether rays tell their time, which costs those who follow them.
    tells_time: bool,
}

/// Where a camera is.
#[derive(Clone, Copy, Debug)]
struct Pose {
    origin: Vec3,
    /// Camera axes in the world: left, up, forward.
    axes: [Vec3; 3],
}

impl Pose {
    fn new(to_world: &Affine) -> Self {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| to_world.vector(a).normalized());
        Self { origin: to_world.point(Vec3::ZERO), axes }
    }
}

/// Rays of unit direction, as many as `F` has lanes.
pub(crate) struct CameraRays<F> {
    pub origin: Vector<F>,
    pub direction: Vector<F>,
    /// Distances between which the camera sees.
    pub tnear: F,
    pub tfar: F,
}

/// How the camera sees in a direction from a point on its lens. Or in as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct View<F = f32> {
    /// Film coordinates, in [0, 1]^2 where they are on the film.
    pub film: [F; 2],
    /// |d film / d solid angle|: the density per solid angle of directions whose film points are even over the film. As every
    /// film point has weight one, it is the importance We cos, too.
    pub film_per_solid_angle: F,
    /// Cosine to the axis: positive before the camera, the only place where it sees.
    pub cos: F,
}

impl Camera {
    /// Compiles a description for a film of `width` by `height` pixels; reports what is wrong with it.
    pub fn compile(
        description: &CameraDescription,
        width: u32,
        height: u32,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let fault = |what: &str| {
            Diagnostic::error("bad-camera", format!("the camera {what}")).at(description.span, "stated here")
        };
        let placement = match &description.motion {
            Some(motion) => on_shutter_clock(&Placement::Moving(motion.clone()), description.shutter),
            None => Placement::Fixed(description.to_world),
        };
        let (to_world, motion) = match placement {
            Placement::Fixed(to_world) => (to_world, None),
            Placement::Moving(motion) => (motion.at(0.0), Some(motion)),
        };
        if to_world.inverse().is_none() {
            diagnostics
                .push(fault("has a singular transform").help("check the look-at's origin, target and up"));
            return None;
        }
        let Some([left, right, bottom, top]) = window(description.field_of_view, width, height) else {
            diagnostics.push(fault("has no field of view between 0 and 180 degrees"));
            return None;
        };
        let lens_sound = description.aperture_radius >= 0.0
            && (description.aperture_radius == 0.0 || description.focus_distance > 0.0);
        if !lens_sound {
            diagnostics.push(fault("needs an aperture radius of at least 0, and a focus distance above 0"));
            return None;
        }
        let [shift_x, shift_y] = description.principal_point_offset;
        // The film's x runs to the right, the camera's to the left; the film's y runs down, the camera's up.
        let extent = [-(right - left), -(top - bottom)];
        Some(Self {
            pose: Pose::new(&to_world),
            motion,
            corner: [-left - shift_x * extent[0], top - shift_y * extent[1]],
            extent,
            aperture_radius: description.aperture_radius,
            focus_distance: description.focus_distance,
            near: description.near_clip.max(0.0),
            far: description.far_clip,
            tells_time: description.shutter[0] < description.shutter[1],
        })
    }

    /// The same camera for a scene in which nothing moves: unless the camera does, the time of all rays is 0.
    pub fn for_still_scene(self) -> Self {
        Self { tells_time: self.motion.is_some(), ..self }
    }

    /// The ray through a film point, a lens point and a time, each from uniform numbers. Its direction has unit length; its
    /// time counts from the opening of the shutter, 0, to its closing, 1.
    #[inline]
    pub fn ray(&self, film: [f32; 2], lens: [f32; 2], time: f32) -> Ray {
        let rays = self.rays_from(&self.pose(time), film, lens);
        let time = if self.tells_time { time } else { 0.0 };
        Ray::new(rays.origin, rays.direction).between(rays.tnear, rays.tfar).at_time(time)
    }

    /// Whether all rays have the time 0.
    pub(crate) fn is_still(&self) -> bool {
        self.motion.is_none() && !self.tells_time
    }

    /// [`Camera::ray`] of a still camera, at any width.
    #[inline(always)]
    pub(crate) fn rays<F: Float>(&self, film: [F; 2], lens: [F; 2]) -> CameraRays<F> {
        self.rays_from(&self.pose, film, lens)
    }

    #[inline(always)]
    fn rays_from<F: Float>(&self, pose: &Pose, film: [F; 2], lens: [F; 2]) -> CameraRays<F> {
        let splat = F::splat;
        let x = splat(self.corner[0]) + film[0] * splat(self.extent[0]);
        let y = splat(self.corner[1]) + film[1] * splat(self.extent[1]);
        let mut origin: Vector<F> = spread(pose.origin);
        let mut direction = Vector::new(x, y, splat(1.0));
        let (left, up) = (spread(pose.axes[0]), spread(pose.axes[1]));
        if self.aperture_radius > 0.0 {
            let [lx, ly] = lanes::warp::uniform_disk(lens);
            let (lx, ly) = (lx * splat(self.aperture_radius), ly * splat(self.aperture_radius));
            let focus = direction * splat(self.focus_distance);
            direction = Vector::new(focus.x - lx, focus.y - ly, focus.z);
            origin = origin + left * lx + up * ly;
        }
        let direction = direction.normalized();
        let [tnear, tfar] = self.clip(direction.z);
        CameraRays {
            origin,
            direction: left * direction.x + up * direction.y + spread(pose.axes[2]) * direction.z,
            tnear,
            tfar,
        }
    }

    #[inline]
    fn pose(&self, time: f32) -> Pose {
        self.motion.as_ref().map_or(self.pose, |motion| Pose::new(&motion.at(time)))
    }

    /// The camera as it stands at a time, at which it is to be asked for all that follows.
    #[inline]
    pub fn at(&self, time: f32) -> Cow<'_, Self> {
        match self.motion {
            None => Cow::Borrowed(self),
            Some(_) => Cow::Owned(Self { pose: self.pose(time), motion: None, ..self.clone() }),
        }
    }

    /// Distances between which the camera sees, in a direction whose cosine to the axis is given.
    #[inline(always)]
    pub fn clip<F: Float>(&self, cos: F) -> [F; 2] {
        let per_depth = F::splat(1.0) / cos;
        [F::splat(self.near) * per_depth, F::splat(self.far) * per_depth]
    }

    /// A point on the lens, in the world.
    #[inline]
    pub fn lens_point(&self, u: [f32; 2]) -> Vec3 {
        self.lens_points(u)
    }

    /// [`Camera::lens_point`] of a camera that does not move, at any width.
    #[inline(always)]
    pub(crate) fn lens_points<F: Float>(&self, u: [F; 2]) -> Vector<F> {
        let origin = spread(self.pose.origin);
        if self.aperture_radius == 0.0 {
            return origin;
        }
        let radius = F::splat(self.aperture_radius);
        let [x, y] = lanes::warp::uniform_disk(u);
        origin + spread::<F>(self.pose.axes[0]) * (x * radius) + spread::<F>(self.pose.axes[1]) * (y * radius)
    }

    /// Whether it stays where it is.
    pub(crate) fn is_fixed(&self) -> bool {
        self.motion.is_none()
    }

    /// Density per area of points on the lens; `None` for a pinhole, which light cannot hit.
    #[inline]
    pub fn lens_pdf(&self) -> Option<f32> {
        let area = self.aperture_radius * self.aperture_radius;
        (area > 0.0).then(|| warp::UNIFORM_DISK_PDF / area)
    }

    /// Unit vector the camera looks along.
    #[inline]
    pub fn forward(&self) -> Vec3 {
        self.pose.axes[2]
    }

    /// Where and how strongly the camera sees in a unit direction from a point on its lens; `None` behind it.
    #[inline]
    pub fn view(&self, lens_point: Vec3, direction: Vec3) -> Option<View> {
        let view = self.views(lens_point, direction);
        (view.cos > 0.0).then_some(view)
    }

    /// [`Camera::view`] of a camera that does not move, at any width.
    #[inline(always)]
    pub(crate) fn views<F: Float>(&self, lens_point: Vector<F>, direction: Vector<F>) -> View<F> {
        let splat = F::splat;
        let [left, up, forward] = self.pose.axes;
        let (left, up, forward) = (spread(left), spread(up), spread::<F>(forward));
        let cos = direction.dot(forward);
        // In camera space, at depth 1 from the pinhole: where the plane in focus is met, scaled back.
        let (mut x, mut y) = (direction.dot(left) / cos, direction.dot(up) / cos);
        if self.aperture_radius > 0.0 {
            let offset = lens_point - spread(self.pose.origin);
            x = x + offset.dot(left) / splat(self.focus_distance);
            y = y + offset.dot(up) / splat(self.focus_distance);
        }
        let [left, top] = self.corner.map(splat);
        let [width, height] = self.extent.map(splat);
        let film = [(x - left) / width, (y - top) / height];
        // An area on the plane at depth 1 is seen under that area times cos^3, from any point of the lens.
        let film_area = (self.extent[0] * self.extent[1]).abs();
        let film_per_solid_angle = splat(1.0) / (splat(film_area) * cos * cos * cos);
        View { film, film_per_solid_angle, cos }
    }

    /// Where a half line meets the lens, from before it.
    pub fn hit_lens(&self, ray: &Ray) -> Option<Vec3> {
        let approach = ray.direction.dot(self.pose.axes[2]);
        let t = (self.pose.origin - ray.origin).dot(self.pose.axes[2]) / approach;
        if !(approach < 0.0 && t > 0.0) {
            return None;
        }
        let point = ray.at(t);
        let radius_squared = self.aperture_radius * self.aperture_radius;
        ((point - self.pose.origin).length_squared() < radius_squared).then_some(point)
    }
}

/// `[left, right, bottom, top]` of the view at depth 1, x to the right.
fn window(field_of_view: FieldOfView, width: u32, height: u32) -> Option<[f32; 4]> {
    let (degrees, axis) = match field_of_view {
        FieldOfView::Window(w) => {
            let sound = w.iter().all(|v| v.is_finite()) && w[0] < w[1] && w[2] < w[3];
            return sound.then_some(w);
        }
        FieldOfView::Angle { degrees, axis } => (degrees, axis),
    };
    if !(degrees > 0.0 && degrees < 180.0) {
        return None;
    }
    let half = (0.5 * degrees.to_radians()).tan();
    let (w, h) = (width as f32, height as f32);
    // Half the film's width at depth 1, per pixel of it.
    let per_pixel = half
        / match axis {
            FovAxis::X => w,
            FovAxis::Y => h,
            FovAxis::Diagonal => w.hypot(h),
            FovAxis::Smaller => w.min(h),
            FovAxis::Larger => w.max(h),
        };
    let (x, y) = (w * per_pixel, h * per_pixel);
    Some([-x, x, -y, y])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(description: &CameraDescription) -> Camera {
        Camera::compile(description, 200, 100, &mut Diagnostics::default()).unwrap()
    }

    #[test]
    fn corners_of_the_view() {
        let camera = camera(&CameraDescription {
            field_of_view: FieldOfView::Angle { degrees: 90.0, axis: FovAxis::X },
            ..Default::default()
        });
        let d = camera.ray([0.5, 0.5], [0.3, 0.7], 0.0).direction;
        assert!((d - Vec3::Z).length() < 1e-6);
        let d = camera.ray([0.0, 0.0], [0.3, 0.7], 0.0).direction;
        // Top left: +x is left, +y up; 45 degrees to the side, half of it (in tangents) up.
        assert!((d * (1.0 / d.z) - Vec3::new(1.0, 0.5, 1.0)).length() < 1e-5, "{d:?}");
    }

    #[test]
    fn lens_rays_meet_in_focus() {
        let camera =
            camera(&CameraDescription { aperture_radius: 0.5, focus_distance: 3.0, ..Default::default() });
        let at_focus = |lens| {
            let ray = camera.ray([0.2, 0.6], lens, 0.0);
            ray.at(3.0 / ray.direction.z)
        };
        assert!((at_focus([0.1, 0.9]) - at_focus([0.8, 0.3])).length() < 1e-5);
    }

    /// A view undoes a ray, and its density is the determinant of the map from directions to the film.
    #[test]
    fn views_are_rays_backwards() {
        let skewed = lichtweg_ray::math::Affine::look_at([1.0, 2.0, 3.0], [-1.0, 0.5, 2.0], [0.1, 1.0, 0.0]);
        for aperture_radius in [0.0, 0.3] {
            let camera = camera(&CameraDescription {
                to_world: skewed.unwrap(),
                aperture_radius,
                focus_distance: 2.5,
                ..Default::default()
            });
            for (film, lens) in [([0.2, 0.7], [0.1, 0.9]), ([0.9, 0.1], [0.8, 0.3])] {
                let ray = camera.ray(film, lens, 0.0);
                assert!((camera.lens_point(lens) - ray.origin).length() < 1e-6);
                let view = camera.view(ray.origin, ray.direction).unwrap();
                assert!((view.film[0] - film[0]).abs() < 1e-4 && (view.film[1] - film[1]).abs() < 1e-4);
                const H: f32 = 1e-2;
                let moved = |dx, dy| camera.ray([film[0] + dx, film[1] + dy], lens, 0.0).direction;
                let [along_x, along_y] = [moved(H, 0.0) - moved(-H, 0.0), moved(0.0, H) - moved(0.0, -H)];
                let solid_angle = along_x.cross(along_y).length() / (4.0 * H * H);
                assert!((solid_angle * view.film_per_solid_angle - 1.0).abs() < 1e-3);
                assert!(camera.view(ray.origin, -ray.direction).is_none());
                let back = Ray::new(ray.at(2.0), -ray.direction);
                let hit = camera.hit_lens(&back);
                assert_eq!(hit.is_some(), aperture_radius > 0.0);
                assert!(hit.is_none_or(|p| (p - ray.origin).length() < 1e-5));
                assert!(camera.hit_lens(&ray).is_none());
            }
        }
    }

    #[test]
    fn bad_cameras_are_reported() {
        let singular = lichtweg_ray::math::Affine::scaling(1.0, 0.0, 1.0);
        let cases = [
            CameraDescription { to_world: singular, ..Default::default() },
            CameraDescription { aperture_radius: -1.0, ..Default::default() },
            CameraDescription { aperture_radius: 1.0, focus_distance: 0.0, ..Default::default() },
            CameraDescription {
                field_of_view: FieldOfView::Window([1.0, 0.0, 0.0, 1.0]),
                ..Default::default()
            },
        ];
        for case in cases {
            let mut diagnostics = Diagnostics::default();
            assert!(Camera::compile(&case, 8, 8, &mut diagnostics).is_none());
            assert_eq!(diagnostics.list.len(), 1);
        }
    }
}
