//! The commonest material, as sixteen walks at once look it up.

use lichtweg_ray::wide::Row;

use crate::texture::Input;

/// A material that does nothing but reflect diffusely, on one side or on both.
#[derive(Clone, Debug)]
pub(crate) struct Diffuse {
    /// Of the front and of the back.
    pub reflectance: [Input; 2],
    /// The constant reflectances of the front (elements 0 to 3) and of the back (4 to 7); 1 where the back reflects (8).
    pub row: Row,
}

impl Diffuse {
    pub(super) fn new(reflectance: [Input; 2], two_sided: bool) -> Self {
        let mut row = Row::splat(0.0);
        for (side, input) in reflectance.iter().enumerate() {
            if let Input::Constant(c) = input {
                row.0[4 * side..4 * side + 4].copy_from_slice(&c.0);
            }
        }
        row.0[8] = if two_sided { 1.0 } else { 0.0 };
        Self { reflectance, row }
    }

    /// Whether the row does not say it all.
    #[inline(always)]
    pub fn is_textured(&self) -> bool {
        self.reflectance.iter().any(|input| matches!(input, Input::Texture(_)))
    }
}
