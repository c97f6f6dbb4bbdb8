//! The camera: pbrt's `perspective` (`cameras.cpp`).
//!
//! The screen window is [-1, 1] along the shorter side of the image, and `fov` is the angle across it.
//!
//! Limits: no orthographic, spherical or realistic cameras.

use std::sync::Arc;

use lichtweg::scene::description::{CameraDescription, Diagnostic, FieldOfView, FovAxis};
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Motion};

use super::build::Builder;
use super::params::Type;
use super::report::{Report, suggest};
use super::state::{Entity, Statements};

/// pbrt's default angle of view.
const DEFAULT_FOV: f32 = 90.0;

/// Describes the camera; without one, pbrt's default looks along +z from the origin.
pub(super) fn build(builder: &mut Builder, statements: &Statements) {
    let default = (
        Entity { directive: "Camera", kind: "perspective".to_owned(), ..Entity::default() },
        Placement::Fixed(Affine::IDENTITY),
    );
    let (entity, to_world) = statements.camera.as_ref().unwrap_or(&default);
    let film = &builder.scene.film;
    let aspect = film.width as f32 / film.height as f32;
    let shutter = builder.scene.camera.shutter;
    builder.scene.camera =
        CameraDescription { shutter, ..camera(entity, to_world, aspect, &mut builder.report) };
}

fn camera(entity: &Entity, to_world: &Placement, aspect: f32, report: &mut Report) -> CameraDescription {
    let params = &entity.params;
    check_type(entity, report);
    let positive = |v: f32| v > 0.0;
    let fov = params.float_where(
        "fov",
        DEFAULT_FOV,
        |v| v > 0.0 && v < 180.0,
        "must be in (0, 180) degrees",
        report,
    );
    let aperture_radius = params.float_where("lensradius", 0.0, |v| v >= 0.0, "cannot be negative", report);
    let focus_distance = params.float_where("focaldistance", 1e6, positive, "must be positive", report);
    let frame = params.float_where("frameaspectratio", aspect, positive, "must be positive", report);
    let mut field_of_view = FieldOfView::Angle { degrees: fov, axis: FovAxis::Smaller };
    let half = (fov.to_radians() / 2.0).tan();
    if params.has("frameaspectratio") {
        let (x, y) = if frame > 1.0 { (frame, 1.0) } else { (1.0, 1.0 / frame) };
        field_of_view = FieldOfView::Window([-x, x, -y, y].map(|v| v * half));
    }
    if let Some(param) = params.array("screenwindow", Type::Float, report) {
        match param.numbers() {
            &[x0, x1, y0, y1] if x0 < x1 && y0 < y1 => {
                field_of_view = FieldOfView::Window([x0, x1, y0, y1].map(|v| v * half));
            }
            _ => {
                let text = "\"screenwindow\" takes 4 numbers: x from and to, y from and to, each in increasing order";
                report.substitute(param.bad_value(text, "expected 4 numbers"), "the whole window is used");
            }
        }
    }
    params.report_unused(&entity.title(), report);
    let mirrored = |map: &Affine| map.after(&Affine::scaling(-1.0, 1.0, 1.0));
    let (to_world, motion) = match to_world {
        Placement::Fixed(map) => (mirrored(map), None),
        Placement::Moving(motion) => {
            (Affine::IDENTITY, Motion::new(motion.keys().map(|(time, map)| (time, mirrored(map)))))
        }
    };
    CameraDescription {
        span: entity.span,
        to_world,
        motion: motion.map(Arc::new),
        field_of_view,
        aperture_radius,
        focus_distance,
        ..CameraDescription::default()
    }
}

fn check_type(entity: &Entity, report: &mut Report) {
    const UNSUPPORTED: [&str; 3] = ["orthographic", "realistic", "spherical"];
    let kind = entity.kind.as_str();
    if kind == "perspective" {
        return;
    }
    if UNSUPPORTED.contains(&kind) {
        let text = format!("{kind} cameras are not supported");
        let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this camera");
        report.substitute(diagnostic, "a perspective camera is used");
    } else {
        let diagnostic = Diagnostic::error("unknown-type", format!("\"{kind}\" is no type of camera"))
            .at(entity.span, "unknown camera");
        report.substitute(
            suggest(diagnostic, kind, UNSUPPORTED.into_iter().chain(["perspective"])),
            "a perspective camera is used",
        );
    }
    // Parameters that the perspective camera shares keep their meaning.
    for (name, kind) in [
        ("mapping", Type::String),
        ("lensfile", Type::String),
        ("aperture", Type::String),
        ("aperturediameter", Type::Float),
        ("focusdistance", Type::Float),
    ] {
        entity.params.accept(name, kind);
    }
}

/// The times at which the shutter opens and closes, in this order and apart.
pub(super) fn shutter(statements: &Statements, report: &mut Report) -> [f32; 2] {
    const DEFAULT: [f32; 2] = [0.0, 1.0];
    let Some((entity, _)) = &statements.camera else { return DEFAULT };
    let open = entity.params.float("shutteropen", DEFAULT[0], report);
    let close = entity.params.float("shutterclose", DEFAULT[1], report);
    if open < close {
        return [open, close];
    }
    let text = format!("the shutter opens at {open}, which is not before it closes at {close}");
    let diagnostic = Diagnostic::error("bad-value", text).at(entity.span, "this camera");
    report.substitute(diagnostic, "it is open from 0 to 1");
    DEFAULT
}
