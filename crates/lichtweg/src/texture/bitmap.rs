//! Image maps.
//!
//! 8-bit images keep their size in memory, with the sRGB curve undone by table at each look-up; everything else is held as
//! linear `f32`. Texel centres lie at half-integers; v = 0 is the bottom row.

use std::sync::LazyLock;

use lichtweg_ray::math::Vec2;

use crate::color::Spectrum;
use crate::scene::description::{Image, Pixels, TextureFilter, UvTransform, WrapMode};

/// A compiled image map.
#[derive(Debug)]
pub struct Bitmap {
    width: u32,
    height: u32,
    texels: Texels,
    to_uv: UvTransform,
    wrap: WrapMode,
    filter: TextureFilter,
    /// The looked-up value x becomes `scale * x + offset`.
    scale: f32,
    offset: f32,
}

#[derive(Debug)]
enum Texels {
    /// sRGB-encoded, or linear through the identity table.
    U8 { data: Vec<[u8; 3]>, decode: &'static [f32; 256] },
    /// Linear.
    F32(Vec<[f32; 3]>),
}

impl Pixels {
    /// Number of channel values.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Image {
    /// The colour of every pixel as linear sRGB, undoing the transfer curve if the image says it has one and `decode` is set.
    pub fn to_linear_rgb(&self, decode: bool) -> Vec<[f32; 3]> {
        let curve = |v: f32| if self.srgb && decode { srgb_to_linear(v) } else { v };
        match &self.pixels {
            Pixels::U8(v) => colors(v, self.channels, |x| curve(f32::from(x) / 255.0)),
            Pixels::U16(v) => colors(v, self.channels, |x| curve(f32::from(x) / 65535.0)),
            Pixels::F32(v) => colors(v, self.channels, curve),
        }
    }
}

/// The colour channels of interleaved pixels, grey repeated, alpha left out.
fn colors<T: Copy, U>(values: &[T], channels: u32, convert: impl Fn(T) -> U) -> Vec<[U; 3]> {
    let pick = if channels >= 3 { [0, 1, 2] } else { [0, 0, 0] };
    values.chunks_exact(channels as usize).map(|p| pick.map(|i| convert(p[i]))).collect()
}

/// The sRGB transfer curve undone (IEC 61966-2-1).
fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

static SRGB_TABLE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb_to_linear(i as f32 / 255.0)));
static LINEAR_TABLE: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| i as f32 / 255.0));

impl Bitmap {
    /// Compiles an image that holds as many values as it says.
    pub fn new(
        image: &Image,
        to_uv: UvTransform,
        wrap: WrapMode,
        filter: TextureFilter,
        decode: bool,
        scale: f32,
        invert: bool,
    ) -> Self {
        let texels = match &image.pixels {
            Pixels::U8(v) => Texels::U8 {
                data: colors(v, image.channels, |x| x),
                decode: if image.srgb && decode { &SRGB_TABLE } else { &LINEAR_TABLE },
            },
            _ => Texels::F32(image.to_linear_rgb(decode)),
        };
        let (scale, offset) = if invert { (-scale, scale) } else { (scale, 0.0) };
        Self { width: image.width, height: image.height, texels, to_uv, wrap, filter, scale, offset }
    }

    /// The value at (u, v).
    pub fn eval(&self, uv: Vec2) -> Spectrum {
        let mut p = self.to_uv.apply(uv);
        if self.wrap == WrapMode::Repeat {
            // Leaves at most the texels along the border to `wrap`.
            p = Vec2::new(p.x - floor(p.x), p.y - floor(p.y));
        }
        let (x, y) = (p.x * self.width as f32, (1.0 - p.y) * self.height as f32);
        let value = match self.filter {
            TextureFilter::Nearest => self.texel_at(floor(x), floor(y)),
            TextureFilter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (x0, y0) = (floor(x), floor(y));
                let (s, t) = (x - x0, y - y0);
                let [[a, b], [c, d]] = self.four(x0, y0);
                (a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t
            }
        };
        value * self.scale + Spectrum::splat(self.offset)
    }

    /// Size of a texel in (u, v), neglecting a shear of the look-up.
    pub fn texel(&self) -> Vec2 {
        let [a, b] = self.to_uv.rows;
        let stretch = |x: f32, y: f32| x.abs().max(y.abs()).max(1e-6);
        Vec2::new(
            1.0 / (self.width as f32 * stretch(a[0], a[1])),
            1.0 / (self.height as f32 * stretch(b[0], b[1])),
        )
    }

    /// The texels from an integer coordinate on, by row.
    #[inline]
    fn four(&self, x: f32, y: f32) -> [[Spectrum; 2]; 2] {
        let (right, below) = (self.width as i32 - 1, self.height as i32 - 1);
        // Conversions saturate, and take NaN to zero.
        let (column, row) = (x as i32, y as i32);
        if x >= 0.0 && y >= 0.0 && column < right && row < below {
            let width = self.width as usize;
            let first = row as usize * width + column as usize;
            return [first, first + width].map(|i| [self.texel_of(i), self.texel_of(i + 1)]);
        }
        [y, y + 1.0].map(|y| [self.texel_at(x, y), self.texel_at(x + 1.0, y)])
    }

    fn texel_at(&self, x: f32, y: f32) -> Spectrum {
        let (Some(x), Some(y)) = (wrap(self.wrap, x, self.width), wrap(self.wrap, y, self.height)) else {
            return Spectrum::ZERO;
        };
        self.texel_of(y as usize * self.width as usize + x as usize)
    }

    #[inline]
    fn texel_of(&self, index: usize) -> Spectrum {
        Spectrum::rgb(match &self.texels {
            Texels::U8 { data, decode } => data[index].map(|v| decode[usize::from(v)]),
            Texels::F32(data) => data[index],
        })
    }
}

/// Largest integer that is not above `x`. Without SSE4.1, which a portable build must not assume, `f32::floor` is a call.
#[inline]
pub(super) fn floor(x: f32) -> f32 {
    /// From here on all numbers are integers.
    const INTEGERS: f32 = (1 << 23) as f32;
    if x.abs() < INTEGERS {
        let truncated = x as i32 as f32;
        if truncated > x { truncated - 1.0 } else { truncated }
    } else {
        x
    }
}

/// The texel that an integer coordinate of any size falls on; `None` is black. Coordinates that are not finite fall on
/// the first.
fn wrap(mode: WrapMode, x: f32, size: u32) -> Option<u32> {
    // The conversion saturates, and NaN becomes zero.
    let (x, n) = (x as i64, i64::from(size));
    if (0..n).contains(&x) {
        return Some(x as u32);
    }
    let inside = match mode {
        WrapMode::Repeat => x.rem_euclid(n),
        WrapMode::Clamp => x.clamp(0, n - 1),
        WrapMode::Mirror => {
            let m = x.rem_euclid(2 * n);
            m.min(2 * n - 1 - m)
        }
        WrapMode::Black => return None,
    };
    Some(inside as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Image {
        Image { width: 2, height: 2, channels: 1, pixels: Pixels::F32(vec![1.0, 2.0, 3.0, 4.0]), srgb: false }
    }

    fn bitmap(wrap: WrapMode, filter: TextureFilter) -> Bitmap {
        Bitmap::new(&image(), UvTransform::default(), wrap, filter, true, 1.0, false)
    }

    #[test]
    fn the_first_row_is_at_the_top() {
        let b = bitmap(WrapMode::Repeat, TextureFilter::Nearest);
        assert_eq!(b.eval(Vec2::new(0.25, 0.75)).0[0], 1.0);
        assert_eq!(b.eval(Vec2::new(0.75, 0.25)).0[0], 4.0);
    }

    #[test]
    fn bilinear_passes_through_centres_and_means() {
        let b = bitmap(WrapMode::Clamp, TextureFilter::Bilinear);
        assert_eq!(b.eval(Vec2::new(0.25, 0.75)).0[0], 1.0);
        assert_eq!(b.eval(Vec2::new(0.5, 0.5)).0[0], 2.5);
        assert_eq!(b.eval(Vec2::new(0.0, 1.0)).0[0], 1.0);
    }

    #[test]
    fn wrapping() {
        assert_eq!(wrap(WrapMode::Repeat, -1.0, 4), Some(3));
        assert_eq!(wrap(WrapMode::Mirror, -1.0, 4), Some(0));
        assert_eq!(wrap(WrapMode::Mirror, 4.0, 4), Some(3));
        assert_eq!(wrap(WrapMode::Clamp, 1e30, 4), Some(3));
        assert_eq!(wrap(WrapMode::Black, 4.0, 4), None);
        assert_eq!(wrap(WrapMode::Repeat, f32::NAN, 4), Some(0));
    }

    #[test]
    fn floors_are_floors() {
        for x in
            [-2.0, -1.5, -0.0, 0.0, 0.25, 1.0, 3.999, -1e-20, 8_388_607.5, -8_388_607.5, 1e30, f32::INFINITY]
        {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
        assert!(floor(f32::NAN).is_nan());
    }

    #[test]
    fn srgb_is_undone_and_inversion_comes_before_scaling() {
        let image = Image { width: 1, height: 1, channels: 3, pixels: Pixels::U8(vec![188; 3]), srgb: true };
        let make = |decode, scale, invert| {
            let (uv, w) = (UvTransform::default(), WrapMode::Repeat);
            Bitmap::new(&image, uv, w, TextureFilter::Nearest, decode, scale, invert).eval(Vec2::ZERO).0[0]
        };
        assert!((make(true, 1.0, false) - 0.5029).abs() < 1e-3);
        assert!((make(false, 1.0, false) - 188.0 / 255.0).abs() < 1e-6);
        assert!((make(false, 2.0, true) - 2.0 * (1.0 - 188.0 / 255.0)).abs() < 1e-6);
    }
}
