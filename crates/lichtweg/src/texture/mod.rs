//! Textures: functions of the surface coordinates (u, v), compiled for fast look-up.

mod bitmap;

use std::sync::Arc;

use lichtweg_ray::math::Vec2;

use crate::color::{Role, Spectrum, luminance, rgb_spectrum};
use crate::scene::description::{
    Diagnostic, Diagnostics, Image, Span, SpectrumDescription, TextureDescription, TextureInput, TextureKind,
    UvTransform,
};

use bitmap::Bitmap;

/// A value that is constant or looked up in a [`TextureArena`].
#[derive(Clone, Copy, Debug)]
pub enum Input {
    /// The same everywhere.
    Constant(Spectrum),
    /// Index of a texture.
    Texture(u32),
}

impl Input {
    /// One everywhere.
    pub const ONE: Self = Self::Constant(Spectrum::ONE);

    /// Whether this is the constant zero.
    pub fn is_zero(&self) -> bool {
        matches!(self, Self::Constant(c) if c.is_zero())
    }
}

/// All textures of a scene.
#[derive(Debug, Default)]
pub struct TextureArena {
    textures: Vec<Texture>,
    /// Of each texture: how many textures one look-up evaluates, itself included.
    costs: Vec<u32>,
}

/// Textures that one look-up may evaluate. A texture that uses an earlier one twice, which uses an earlier one twice, and so on,
/// doubles its cost each time; a chain grows the stack by each link.
const MAX_COST: u32 = 1000;

#[derive(Debug)]
enum Texture {
    Constant(Spectrum),
    Bitmap(Bitmap),
    Checkerboard { even: Input, odd: Input, to_uv: UvTransform },
    Scale { texture: Input, by: Input },
    Mix { a: Input, b: Input, amount: Input },
}

impl TextureArena {
    /// Compiles descriptions. A texture may refer to earlier ones only, so that no look-up can run in a circle; one that
    /// does not is reported.
    pub fn compile(descriptions: &[TextureDescription], diagnostics: &mut Diagnostics) -> Self {
        let mut arena = Self::default();
        for description in descriptions {
            let mut texture =
                arena.texture(description, diagnostics).unwrap_or(Texture::Constant(Spectrum::splat(0.5)));
            let mut cost = arena.cost(&texture);
            if cost > MAX_COST {
                let message = format!("one look-up of a texture evaluates more than {MAX_COST} others");
                diagnostics.push(
                    Diagnostic::error("deep-texture", message)
                        .at(description.span, "with this one")
                        .help("use fewer nested textures, or bake them into an image"),
                );
                (texture, cost) = (Texture::Constant(Spectrum::splat(0.5)), 1);
            }
            arena.textures.push(texture);
            arena.costs.push(cost);
        }
        arena
    }

    /// How many textures a look-up evaluates.
    fn cost(&self, texture: &Texture) -> u32 {
        let sum = |inputs: &[Input]| {
            inputs.iter().fold(1, |sum: u32, input| match input {
                Input::Constant(_) => sum,
                Input::Texture(id) => sum.saturating_add(self.costs[*id as usize]),
            })
        };
        match texture {
            Texture::Constant(_) | Texture::Bitmap(_) => 1,
            Texture::Checkerboard { even, odd, .. } => sum(&[*even, *odd]),
            Texture::Scale { texture, by } => sum(&[*texture, *by]),
            Texture::Mix { a, b, amount } => sum(&[*a, *b, *amount]),
        }
    }

    fn texture(&self, description: &TextureDescription, diagnostics: &mut Diagnostics) -> Option<Texture> {
        let span = description.span;
        let mut input = |i: &TextureInput| self.input(i, Role::Property, span, diagnostics);
        Some(match &description.kind {
            TextureKind::Constant(c) => Texture::Constant(constant(c, Role::Property, span, diagnostics)?),
            TextureKind::Bitmap { image, to_uv, wrap, filter, raw, scale, invert } => {
                check_image(image, span, diagnostics)?;
                Texture::Bitmap(Bitmap::new(image, *to_uv, *wrap, *filter, !*raw, *scale, *invert))
            }
            TextureKind::Checkerboard { even, odd, to_uv } => {
                Texture::Checkerboard { even: input(even)?, odd: input(odd)?, to_uv: *to_uv }
            }
            TextureKind::Scale { texture, by } => Texture::Scale { texture: input(texture)?, by: input(by)? },
            TextureKind::Mix { a, b, amount } => {
                Texture::Mix { a: input(a)?, b: input(b)?, amount: input(amount)? }
            }
        })
    }

    /// Compiles a parameter; `None`, and a diagnostic at `span`, where it names what does not exist.
    pub fn input(
        &self,
        input: &TextureInput,
        role: Role,
        span: Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<Input> {
        match input {
            TextureInput::Constant(c) => constant(c, role, span, diagnostics).map(Input::Constant),
            TextureInput::Texture(id) if (id.0 as usize) < self.textures.len() => {
                Some(match &self.textures[id.0 as usize] {
                    Texture::Constant(c) => Input::Constant(*c),
                    _ => Input::Texture(id.0),
                })
            }
            TextureInput::Texture(_) => {
                diagnostics.push(
                    Diagnostic::error(
                        "texture-order",
                        "a texture refers to one that is not stated before it",
                    )
                    .at(span, "refers to a later texture, or to itself"),
                );
                None
            }
        }
    }

    /// The value at (u, v).
    #[inline]
    pub fn eval(&self, input: Input, uv: Vec2) -> Spectrum {
        match input {
            Input::Constant(c) => c,
            Input::Texture(id) => self.look_up(id, uv),
        }
    }

    /// The value at (u, v) as one number: the luminance.
    #[inline]
    pub fn eval_number(&self, input: Input, uv: Vec2) -> f32 {
        match input {
            Input::Constant(c) => c.0[0],
            Input::Texture(id) => luminance(self.look_up(id, uv).to_rgb()),
        }
    }

    fn look_up(&self, id: u32, uv: Vec2) -> Spectrum {
        match &self.textures[id as usize] {
            Texture::Constant(c) => *c,
            Texture::Bitmap(b) => b.eval(uv),
            Texture::Checkerboard { even, odd, to_uv } => {
                let p = to_uv.apply(uv);
                let upper = |x: f32| x - bitmap::floor(x) >= 0.5;
                self.eval(if upper(p.x) == upper(p.y) { *even } else { *odd }, uv)
            }
            Texture::Scale { texture, by } => self.eval(*texture, uv) * self.eval(*by, uv),
            Texture::Mix { a, b, amount } => {
                let t = self.eval(*amount, uv);
                self.eval(*a, uv) * (Spectrum::ONE - t) + self.eval(*b, uv) * t
            }
        }
    }

    /// Derivatives of the number at (u, v) with respect to u and v, by central differences over one texel.
    pub fn gradient(&self, input: Input, uv: Vec2) -> Vec2 {
        let Input::Texture(id) = input else { return Vec2::ZERO };
        let step = match &self.textures[id as usize] {
            Texture::Bitmap(b) => b.texel(),
            _ => Vec2::new(1e-3, 1e-3),
        };
        let (du, dv) = (Vec2::new(0.5 * step.x, 0.0), Vec2::new(0.0, 0.5 * step.y));
        let slope = |d: Vec2, h: f32| (self.eval_number(input, uv + d) - self.eval_number(input, uv - d)) / h;
        Vec2::new(slope(du, step.x), slope(dv, step.y))
    }

    /// Mean over (u, v) in the unit square, by a regular grid: an estimate, for light selection.
    pub fn mean(&self, input: Input) -> Spectrum {
        const GRID: u32 = 64;
        if let Input::Constant(c) = input {
            return c;
        }
        let mut sum = Spectrum::ZERO;
        for i in 0..GRID * GRID {
            let uv = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
            sum += self.eval(input, uv);
        }
        sum / (GRID * GRID) as f32
    }
}

fn constant(
    description: &SpectrumDescription,
    role: Role,
    span: Span,
    diagnostics: &mut Diagnostics,
) -> Option<Spectrum> {
    match rgb_spectrum(description, role) {
        Some(s) if s.0.iter().all(|v| v.is_finite()) => Some(s),
        Some(_) => {
            diagnostics.push(
                Diagnostic::error("not-finite", "a colour is not finite")
                    .at(span, "has a NaN or infinite colour"),
            );
            None
        }
        None => {
            diagnostics.push(
                Diagnostic::error("unknown-preset", format!("{description:?} names no known material"))
                    .at(span, "unknown preset"),
            );
            None
        }
    }
}

fn check_image(image: &Arc<Image>, span: Span, diagnostics: &mut Diagnostics) -> Option<()> {
    let values = image.width as usize * image.height as usize * image.channels as usize;
    let sound = values > 0 && values == image.pixels.len();
    if !sound {
        diagnostics.push(
            Diagnostic::error("empty-image", "an image has no pixels, or not as many as it says")
                .at(span, "this image"),
        );
    }
    sound.then_some(())
}

impl UvTransform {
    /// The image of (u, v).
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        let [a, b] = self.rows;
        Vec2::new(a[0] * uv.x + a[1] * uv.y + a[2], b[0] * uv.x + b[1] * uv.y + b[2])
    }
}
