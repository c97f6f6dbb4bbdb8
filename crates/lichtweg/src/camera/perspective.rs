//! A perspective camera with a pinhole or a thin lens.
//!
//! Film coordinates (x, y) run from (0, 0) at the top left corner to (1, 1). Through the lens point (u, v) goes the ray that
//! meets the pinhole's ray on the plane in focus (Cook, Porter and Carpenter 1984). Every film point has weight one: the
//! responsivity is normalised so that a film lit by unit radiance reads one.

use std::sync::Arc;

use lichtweg_montecarlo::warp;
use lichtweg_ray::math::{Affine, Motion, Vec3};
use lichtweg_ray::{Placement, Ray};

use crate::scene::description::{CameraDescription, Diagnostic, Diagnostics, FieldOfView, FovAxis};
use crate::scene::on_shutter_clock;

/// A perspective camera.
#[derive(Clone, Debug)]
pub struct Camera {
    view: View,
    /// In place of `view`, over times from the opening of the shutter, 0, to its closing, 1.
    motion: Option<Arc<Motion>>,
    /// Camera-space x and y at depth 1 of the film's top left corner, and their growth over the film.
    corner: [f32; 2],
    extent: [f32; 2],
    aperture_radius: f32,
    focus_distance: f32,
    near: f32,
    far: f32,
}

/// Where a camera is.
#[derive(Clone, Copy, Debug)]
struct View {
    origin: Vec3,
    /// Camera axes in the world: left, up, forward.
    axes: [Vec3; 3],
}

impl View {
    fn new(to_world: &Affine) -> Self {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| to_world.vector(a).normalized());
        Self { origin: to_world.point(Vec3::ZERO), axes }
    }
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
            view: View::new(&to_world),
            motion,
            corner: [-left - shift_x * extent[0], top - shift_y * extent[1]],
            extent,
            aperture_radius: description.aperture_radius,
            focus_distance: description.focus_distance,
            near: description.near_clip.max(0.0),
            far: description.far_clip,
        })
    }

    /// The ray through a film point, a lens point and a time, each from uniform numbers. Its direction has unit length; its
    /// time counts from the opening of the shutter, 0, to its closing, 1.
    #[inline]
    pub fn ray(&self, film: [f32; 2], lens: [f32; 2], time: f32) -> Ray {
        let x = self.corner[0] + film[0] * self.extent[0];
        let y = self.corner[1] + film[1] * self.extent[1];
        let (mut lx, mut ly) = (0.0, 0.0);
        let mut direction = Vec3::new(x, y, 1.0);
        if self.aperture_radius > 0.0 {
            [lx, ly] = warp::uniform_disk(lens).map(|c| c * self.aperture_radius);
            let focus = direction * self.focus_distance;
            direction = Vec3::new(focus.x - lx, focus.y - ly, focus.z);
        }
        let direction = direction.normalized();
        let view = self.motion.as_ref().map_or(self.view, |motion| View::new(&motion.at(time)));
        let [left, up, forward] = view.axes;
        let per_depth = 1.0 / direction.z;
        let origin = view.origin + left * lx + up * ly;
        let direction = left * direction.x + up * direction.y + forward * direction.z;
        Ray::new(origin, direction).between(self.near * per_depth, self.far * per_depth).at_time(time)
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
