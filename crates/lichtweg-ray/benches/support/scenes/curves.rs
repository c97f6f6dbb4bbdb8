//! Hairs as curves.

use lichtweg_ray::math::Vec3;
use lichtweg_ray::{CurveBasis, CurvePoint, CurveStyle, Curves};

use crate::support::random::Random;

/// Control points of each hair.
pub const POINTS: usize = 12;

/// The control points of curled hairs around the unit sphere, thinner towards their ends.
pub fn hair_ball(hairs: usize) -> Vec<CurvePoint> {
    let mut random = Random(7);
    let mut points = Vec::with_capacity(hairs * POINTS);
    for _ in 0..hairs {
        let mut p = random.direction();
        let mut d = p;
        for i in 0..POINTS {
            let along = i as f32 / (POINTS - 1) as f32;
            points.push(CurvePoint { position: p, radius: 0.003 * (1.0 - 0.8 * along) });
            d = (d + random.direction() * 0.4).normalized();
            p += d * (0.8 / (POINTS - 1) as f32);
        }
    }
    points
}

/// Round curves through these points.
pub fn curves(basis: CurveBasis, points: Vec<CurvePoint>) -> Curves {
    let counts = vec![POINTS; points.len() / POINTS];
    Curves::new(CurveStyle::Round, basis, points, &counts, &[]).expect("whole curves")
}

/// Where to look at the ball from, and the middle of a light.
pub const EYE: Vec3 = Vec3 { x: 0.0, y: 0.5, z: 5.0 };
pub const LIGHT: Vec3 = Vec3 { x: 4.0, y: 6.0, z: 3.0 };
