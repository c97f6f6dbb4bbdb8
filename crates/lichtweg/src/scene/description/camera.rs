//! The eye and the image it takes.

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Motion};

use super::Span;

/// A pinhole or thin-lens perspective camera.
#[derive(Clone, Debug)]
pub struct CameraDescription {
    /// Where it was stated.
    pub span: Span,
    /// From camera space (looking along +z, +y up, +x to the left) to the world.
    pub to_world: Affine,
    /// In place of `to_world` where the camera moves, over times on the clock of the shutter.
    pub motion: Option<Arc<Motion>>,
    /// What it sees.
    pub field_of_view: FieldOfView,
    /// Shift of the principal point as fractions of the film's width and height.
    pub principal_point_offset: [f32; 2],
    /// Radius of the lens; 0 is a pinhole.
    pub aperture_radius: f32,
    /// Distance along the axis of the plane in perfect focus.
    pub focus_distance: f32,
    /// Depth along the axis before which nothing is seen.
    pub near_clip: f32,
    /// Depth along the axis behind which nothing is seen.
    pub far_clip: f32,
    /// Times at which the shutter opens and closes.
    pub shutter: [f32; 2],
}

impl Default for CameraDescription {
    fn default() -> Self {
        Self {
            span: Span::default(),
            to_world: Affine::IDENTITY,
            motion: None,
            field_of_view: FieldOfView::Angle { degrees: 50.0, axis: FovAxis::X },
            principal_point_offset: [0.0; 2],
            aperture_radius: 0.0,
            focus_distance: 1.0,
            near_clip: 0.0,
            far_clip: f32::INFINITY,
            shutter: [0.0, 0.0],
        }
    }
}

/// What part of the view falls on the film; the film's aspect ratio does the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// The full angle along one axis of the film.
    Angle {
        /// In degrees, in (0, 180).
        degrees: f32,
        /// Along which axis.
        axis: FovAxis,
    },
    /// The window `[x_min, x_max, y_min, y_max]` on the plane at distance 1, x to the right and y up (pbrt's `screenwindow`
    /// times the tangent of half its `fov`).
    Window([f32; 4]),
}

/// The film axis an angle of view is measured along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    X,
    /// The height.
    Y,
    /// The diagonal.
    Diagonal,
    /// The shorter of width and height.
    Smaller,
    /// The longer of width and height.
    Larger,
}

/// The image.
#[derive(Clone, Debug)]
pub struct FilmDescription {
    /// Where it was stated.
    pub span: Span,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The part to render, as `[x, y, width, height]` in pixels, top left origin.
    pub crop: Option<[u32; 4]>,
    /// How samples become pixels.
    pub filter: FilterDescription,
    /// Multiplies radiance on its way into the image (pbrt's sensor).
    pub scale: f32,
}

impl Default for FilmDescription {
    fn default() -> Self {
        Self {
            span: Span::default(),
            width: 768,
            height: 576,
            crop: None,
            filter: FilterDescription::default(),
            scale: 1.0,
        }
    }
}

/// A reconstruction filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterDescription {
    /// Its form.
    pub kind: FilterKind,
    /// Half its extent in pixels, in x and in y.
    pub radius: [f32; 2],
}

impl FilterDescription {
    /// A filter of the same radius in x and y.
    pub const fn new(kind: FilterKind, radius: f32) -> Self {
        Self { kind, radius: [radius, radius] }
    }

    /// The box over one pixel.
    pub const BOX: Self = Self::new(FilterKind::Box, 0.5);
}

impl Default for FilterDescription {
    /// A Gaussian with a standard deviation of half a pixel, as in Mitsuba.
    fn default() -> Self {
        Self::new(FilterKind::Gaussian { standard_deviation: 0.5 }, 2.0)
    }
}

/// The form of a filter, a product of one-dimensional ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterKind {
    /// Constant.
    Box,
    /// Linear down to zero.
    Tent,
    /// A Gaussian, shifted to reach zero at the radius.
    Gaussian {
        /// In pixels.
        standard_deviation: f32,
    },
    /// The cubic of Mitchell and Netravali 1988; support 2 when the radius is 2.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
    /// Catmull and Rom: Mitchell with B = 0, C = 1/2.
    CatmullRom,
    /// A sinc windowed by the main lobe of another (Lanczos).
    Lanczos {
        /// Zero crossings of the inner sinc lie one pixel over this apart: Mitsuba's has 1 (radius = lobes); pbrt's `sinc`
        /// windows with `tau` = lobes.
        lobes: f32,
    },
}
