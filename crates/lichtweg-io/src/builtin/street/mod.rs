//! `builtin:street`: a street of houses, with trees, cars and lamps, in the light of a low sun.
//!
//! After the street scene in P. Hanrahan's lecture on path tracing (Stanford CS348B, 2010, lecture 14), rendered with M.
//! Fajardo's Arnold: 1536 x 654 pixels, 16 paths for each, 2 bounces, 250,000 faces, in 18 minutes on two processors of
//! 800 MHz. That picture has models of its own; this one has twice its faces, and is as hard on a ray engine: small things
//! beside large ones, leaves, thin wires, and light that is mostly diffuse.
//!
//! Everything is generated, a function of a level of detail and a seed: the same on any machine whose sines are. Lengths are
//! metres, y points up. [`plan`] says what stands where.

mod builder;
mod car;
mod door;
mod fence;
mod foliage;
mod furniture;
mod ground;
mod house;
mod lamp;
mod palette;
mod plan;
mod random;
mod roof;
mod setting;
mod solids;
#[cfg(test)]
mod tests;
mod tower;
mod tree;
mod window;
mod wires;

use std::sync::Arc;

use lichtweg::scene::description::{Description, Diagnostic, GeometryDescription, ShapeDescription, Span};
use lichtweg_ray::math::{Affine, Vec3};

use builder::Builder;
use random::Random;

/// Levels of detail that make sense: from a sketch to some ten million faces.
pub const DETAIL: std::ops::RangeInclusive<f32> = 0.05..=32.0;

/// What a street is a function of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Factor on the number of leaves, stones and tiles, in [`DETAIL`]; at 1 there are 500,000 faces and more.
    pub detail: f32,
    /// Of houses, trees, cars and their places.
    pub seed: u64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self { detail: 1.0, seed: 4 }
    }
}

impl Parameters {
    /// Sets one by its name, from what stands behind `-D NAME=`.
    ///
    /// # Errors
    /// There is no parameter of that name, or the value is none of its.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), Diagnostic> {
        let bad = |expected: String| {
            Diagnostic::error("bad-value", format!("-D {name}={value}: {expected} expected"))
        };
        match name {
            "detail" => {
                let range = format!("a number from {} to {}", DETAIL.start(), DETAIL.end());
                let detail = value.parse().ok().filter(|detail| DETAIL.contains(detail));
                self.detail = detail.ok_or_else(|| bad(range))?;
            }
            "seed" => self.seed = value.parse().map_err(|_| bad("a whole number, at least 0,".to_owned()))?,
            _ => {
                let message = format!("-D {name}={value}: the scene has no such parameter");
                return Err(Diagnostic::error("unused-define", message).help("it has: detail, seed"));
            }
        }
        Ok(())
    }
}

/// The scene.
pub fn describe(parameters: Parameters) -> Description {
    let mut description = setting::describe();
    for (material, shading, mesh) in build(parameters).finish() {
        let shape = ShapeDescription {
            name: Some(format!("{material:?} {shading:?}").to_lowercase()),
            span: Span::default(),
            geometry: GeometryDescription::Mesh(Arc::new(mesh)),
            to_world: Affine::IDENTITY,
            flip_normals: false,
            material: material.describe(&mut description),
            emission: None,
            group: None,
        };
        description.shapes.push(shape);
    }
    description
}

/// All triangles of the scene as one mesh, for measuring ray engines: positions, and three of their indices a triangle.
pub fn triangles(parameters: Parameters) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (_, _, mesh) in build(parameters).finish() {
        let first = positions.len() as u32;
        positions.extend(mesh.positions);
        triangles.extend(mesh.triangles.into_iter().map(|t| t.map(|i| i + first)));
    }
    (positions, triangles)
}

fn build(Parameters { detail, seed }: Parameters) -> Builder {
    let mut builder = Builder::new(detail.clamp(*DETAIL.start(), *DETAIL.end()));
    plan::street(&mut builder, &mut Random::new(seed));
    builder
}
