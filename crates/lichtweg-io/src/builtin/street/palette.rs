//! What the street is made of: matte, muted colours as of an architect's model, and a few things that shine.

use lichtweg::scene::description::{
    Description, MaterialDescription, MaterialId, MaterialKind, Span, TextureInput,
};

/// A material; the numbers choose one of its tones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Material {
    /// A rendered facade.
    Plaster(u8),
    /// Sills, steps, kerbs and copings.
    Stone,
    /// Window frames and other painted wood.
    Trim,
    /// Doors and shutters.
    Paint(u8),
    /// Roof tiles.
    Tile(u8),
    /// Chimneys and garden walls.
    Brick,
    /// The pots on the chimneys.
    Clay,
    /// The stones of the roadway.
    Cobble(u8),
    /// Slabs of the pavement.
    Slab(u8),
    /// Between and beyond the stones.
    Soil,
    /// Lawns.
    Grass(u8),
    /// Trunks and branches.
    Bark,
    /// Leaves, seen from both sides.
    Leaf(u8),
    /// Petals.
    Flower(u8),
    /// Benches and poles.
    Wood,
    /// Lamps, railings and wires.
    Iron,
    /// Gutters and bumpers.
    Zinc,
    /// Panes, by what is behind them.
    Glass(u8),
    /// The globes of the lamps.
    Opal,
    /// Cars.
    Lacquer(u8),
    /// Tyres and what is in the dark under a car.
    Rubber,
    /// The lamps at the back of a car.
    Tail,
}

/// Tones of [`Material::Plaster`].
pub const PLASTERS: u8 = 8;
/// Tones of [`Material::Paint`].
pub const PAINTS: u8 = 5;
/// Tones of [`Material::Lacquer`].
pub const LACQUERS: u8 = 6;

impl Material {
    /// Its albedo, linear sRGB.
    fn albedo(self) -> [f32; 3] {
        match self {
            Self::Plaster(tone) => [
                [0.68, 0.63, 0.54],
                [0.72, 0.70, 0.66],
                [0.63, 0.50, 0.35],
                [0.60, 0.44, 0.38],
                [0.48, 0.54, 0.57],
                [0.54, 0.57, 0.47],
                [0.66, 0.56, 0.45],
                [0.50, 0.48, 0.46],
            ][usize::from(tone)],
            Self::Stone => [0.52, 0.50, 0.46],
            Self::Trim => [0.76, 0.75, 0.72],
            Self::Paint(tone) => [
                [0.10, 0.20, 0.16],
                [0.12, 0.20, 0.30],
                [0.34, 0.10, 0.08],
                [0.30, 0.33, 0.34],
                [0.26, 0.16, 0.09],
            ][usize::from(tone)],
            Self::Tile(tone) => [
                [0.40, 0.19, 0.12],
                [0.33, 0.15, 0.10],
                [0.46, 0.24, 0.15],
                [0.25, 0.26, 0.28],
                [0.20, 0.21, 0.23],
                [0.30, 0.30, 0.31],
            ][usize::from(tone)],
            Self::Brick => [0.40, 0.22, 0.16],
            Self::Clay => [0.50, 0.27, 0.18],
            Self::Cobble(tone) => {
                [[0.26, 0.255, 0.25], [0.32, 0.31, 0.30], [0.22, 0.22, 0.225]][usize::from(tone)]
            }
            Self::Slab(tone) => [[0.47, 0.45, 0.42], [0.42, 0.41, 0.385]][usize::from(tone)],
            Self::Soil => [0.20, 0.18, 0.155],
            Self::Grass(tone) => [[0.17, 0.24, 0.08], [0.22, 0.28, 0.10]][usize::from(tone)],
            Self::Bark => [0.22, 0.18, 0.14],
            Self::Leaf(tone) => {
                [[0.20, 0.31, 0.09], [0.28, 0.38, 0.12], [0.15, 0.25, 0.09]][usize::from(tone)]
            }
            Self::Flower(tone) => [[0.62, 0.10, 0.10], [0.70, 0.42, 0.50]][usize::from(tone)],
            Self::Wood => [0.34, 0.24, 0.16],
            Self::Iron => [0.07, 0.075, 0.075],
            Self::Zinc => [0.44, 0.45, 0.46],
            Self::Glass(tone) => {
                [[0.03, 0.035, 0.04], [0.09, 0.09, 0.09], [0.30, 0.29, 0.26]][usize::from(tone)]
            }
            Self::Opal => [0.80, 0.78, 0.72],
            Self::Lacquer(tone) => [
                [0.42, 0.07, 0.06],
                [0.62, 0.58, 0.48],
                [0.07, 0.20, 0.23],
                [0.12, 0.125, 0.13],
                [0.66, 0.67, 0.68],
                [0.22, 0.34, 0.44],
            ][usize::from(tone)],
            Self::Rubber => [0.035, 0.035, 0.035],
            Self::Tail => [0.45, 0.03, 0.03],
        }
    }

    /// Adds it to a description.
    pub fn describe(self, description: &mut Description) -> MaterialId {
        let albedo = TextureInput::rgb(self.albedo());
        let kind = match self {
            Self::Glass(_) | Self::Lacquer(_) | Self::Opal | Self::Tail => MaterialKind::Plastic {
                eta: 1.5,
                diffuse_reflectance: albedo,
                specular_reflectance: TextureInput::number(1.0),
                roughness: None,
                nonlinear: false,
            },
            _ => MaterialKind::Diffuse { reflectance: albedo },
        };
        let mut add = |kind| {
            let name = Some(format!("{self:?}"));
            description.add_material(MaterialDescription { name, span: Span::default(), kind })
        };
        let front = add(kind);
        match self {
            Self::Leaf(_) | Self::Flower(_) | Self::Grass(_) => {
                add(MaterialKind::TwoSided { front, back: front })
            }
            _ => front,
        }
    }
}
