//! What holds of every tree: choices come as often as said, probabilities sum to one, and what shines is not left out.

use std::f32::consts::{FRAC_PI_2, PI};

use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::math::{Bounds3, Vec3, Vector};
use lichtweg_ray::wide::{self, Kernel, LANES, Lanes, Wide};

use super::*;

fn numbers(stream: u64, index: u32) -> impl FnMut() -> f32 {
    let mut sampler = Sampler::new(SamplerKind::Independent, 1, stream, index);
    move || sampler.next_1d() * 2.0 - 1.0
}

fn leaves(count: u32) -> Vec<LightBounds> {
    (0..count)
        .map(|i| {
            let mut next = numbers(2, i);
            let at = Vec3::new(next(), next(), next());
            let axis = Vec3::new(next(), next(), next()).normalized();
            let size = 0.05 * (1.0 + next());
            let spread = if i % 7 == 0 { PI } else { 0.5 * (1.0 + next()) };
            let intensity = if i % 11 == 5 { 0.0 } else { 1.5 + next() };
            let bounds = Bounds3::of([at, at + Vec3::splat(size)]);
            LightBounds { bounds, axis, spread, two_sided: i % 5 == 0, intensity }
        })
        .collect()
}

/// Open and on a surface, amid the lights and far from them.
fn receivers() -> impl Iterator<Item = Receiver> {
    let places = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.0, 40.0, 0.0)];
    let normals = [Vec3::ZERO, Vec3::new(0.0, 0.6, -0.8), Vec3::new(0.0, -1.0, 0.0)];
    places.into_iter().flat_map(move |position| normals.map(|normal| Receiver { position, normal }))
}

/// By numbers that are even, what is chosen differs from what is said by rounding alone.
#[test]
fn samples_follow_their_probabilities() {
    const SAMPLES: u32 = 1 << 16;
    for count in [1, 2, 8, 9, 50, 700] {
        let tree = LightTree::new(&leaves(count));
        for to in receivers() {
            let mut seen = vec![0_u32; count as usize];
            for i in 0..SAMPLES {
                let u = (i as f32 + 0.5) / SAMPLES as f32;
                let Some((leaf, probability)) = tree.sample(&to, u) else { continue };
                seen[leaf as usize] += 1;
                let said = tree.probability(&to, leaf);
                assert!((probability / said - 1.0).abs() < 1e-5, "{probability} {said}");
            }
            let said: Vec<f32> = (0..count).map(|leaf| tree.probability(&to, leaf)).collect();
            for (leaf, (&seen, &said)) in seen.iter().zip(&said).enumerate() {
                let expected = said * SAMPLES as f32;
                assert!((seen as f32 - expected).abs() < 2.0 + 1e-4 * expected, "{leaf}: {seen}, {expected}");
            }
            // What goes down to a node of which nothing shines on the receiver is lost.
            let total: f32 = said.iter().sum();
            let lost = 1.0 - seen.iter().sum::<u32>() as f32 / SAMPLES as f32;
            assert!((total + lost - 1.0).abs() < 1e-3, "{count} {to:?}: {total} {lost}");
        }
    }
}

/// Where lights shine everywhere, nothing is lost.
#[test]
fn probabilities_sum_to_one() {
    for count in [1, 3, 64, 3000] {
        let everywhere = |b: LightBounds| LightBounds { spread: PI, intensity: b.intensity + 0.1, ..b };
        let tree = LightTree::new(&leaves(count).into_iter().map(everywhere).collect::<Vec<_>>());
        for to in receivers().filter(|to| to.normal == Vec3::ZERO) {
            let total: f64 = (0..count).map(|leaf| f64::from(tree.probability(&to, leaf))).sum();
            assert!((total - 1.0).abs() < 1e-5, "{count} {to:?}: {total}");
        }
    }
}

/// What can shine on a receiver is chosen with some probability, however it was rounded and joined.
#[test]
fn bounds_hold() {
    let leaves = leaves(300);
    let tree = LightTree::new(&leaves);
    let mut checked = 0;
    for i in 0..300 {
        let mut next = numbers(3, i);
        let position = Vec3::new(next(), next(), next()) * 3.0;
        let normal = Vec3::new(next(), next(), next()).normalized();
        let to = Receiver { position, normal: if i % 2 == 0 { normal } else { Vec3::ZERO } };
        for (leaf, light) in leaves.iter().enumerate() {
            for corner in light.bounds.corners() {
                let direction = (position - corner).normalized();
                let angle = light.axis.dot(direction).acos();
                let angle = if light.two_sided { angle.min(PI - angle) } else { angle };
                let arrives = i % 2 != 0 || normal.dot(-direction) > 0.0;
                if arrives && angle < light.spread + FRAC_PI_2 && light.intensity > 0.0 {
                    checked += 1;
                    assert!(tree.probability(&to, leaf as u32) > 0.0, "{leaf} {to:?}");
                }
            }
        }
    }
    assert!(checked > 100_000);
}

struct Together<'a> {
    tree: &'a LightTree,
    to: &'a [Receiver; LANES],
    u: Lanes<f32>,
}

impl Kernel for Together<'_> {
    type Output = ([Option<(u32, f32)>; LANES], Lanes<f32>);

    #[inline(always)]
    fn run<W: Wide>(self) -> Self::Output {
        let vector = |of: fn(&Receiver) -> Vec3| {
            let component =
                |axis: usize| W::F32::load(&Lanes(std::array::from_fn(|i| of(&self.to[i]).to_array()[axis])));
            Vector::new(component(0), component(1), component(2))
        };
        let to = Receiver { position: vector(|to| to.position), normal: vector(|to| to.normal) };
        let root = self.tree.root_importances::<W>(&to);
        let ends = self.tree.sample_lanes::<W>(&root, &to, W::F32::load(&self.u), 0xffff);
        let leaves = Lanes(ends.map(|end| end.map_or(0, |(leaf, _)| leaf)));
        (ends, self.tree.probability_lanes::<W>(&root, &to, &leaves, 0xffff).to_lanes())
    }
}

/// Sixteen receivers are given what each would be given alone, to the bit.
#[test]
fn lanes_are_single_receivers() {
    let mut deep = 0;
    for count in [1, 5, 8, 9, 700] {
        let tree = LightTree::new(&leaves(count));
        for i in 0..200 {
            let mut next = numbers(4, i);
            let to = std::array::from_fn(|lane| {
                let normal = Vec3::new(next(), next(), next()).normalized();
                Receiver {
                    position: Vec3::new(next(), next(), next()) * 2.0,
                    normal: if lane % 4 == 0 { Vec3::ZERO } else { normal },
                }
            });
            let u = Lanes(std::array::from_fn(|_| 0.5 * (1.0 + next())));
            let (ends, probabilities) = wide::dispatch(Together { tree: &tree, to: &to, u });
            for lane in 0..LANES {
                let alone = tree.sample(&to[lane], u.0[lane]);
                assert_eq!(ends[lane], alone);
                let leaf = alone.map_or(0, |(leaf, _)| leaf);
                assert_eq!(probabilities.0[lane], tree.probability(&to[lane], leaf));
                deep += u32::from(count > 8 && alone.is_some());
            }
        }
    }
    assert!(deep > 3000);
}

/// Lights in one place, on a line, without extent, and of very different brightness.
#[test]
fn degenerate_lights() {
    let point = |x: f32, intensity: f32| LightBounds {
        bounds: Bounds3::of([Vec3::new(x, 0.0, 0.0)]),
        axis: Vec3::Z,
        spread: PI,
        two_sided: false,
        intensity,
    };
    let together: Vec<_> = (0..100).map(|_| point(0.0, 1.0)).collect();
    let line: Vec<_> = (0..100).map(|i| point(1.5_f32.powi(i), 1e-30 + 1.3_f32.powi(i))).collect();
    let extreme: Vec<_> = (0..20).map(|i| point(i as f32, [1e30, 1e-30, f32::MAX][i % 3])).collect();
    for lights in [together, line, extreme] {
        let tree = LightTree::new(&lights);
        for x in [0.0, 1.0, -1e-20, 1e10] {
            let to = Receiver::open(Vec3::new(x, 0.0, 0.0));
            for i in 0..1000 {
                let Some((leaf, probability)) = tree.sample(&to, i as f32 / 1000.0) else { continue };
                assert!(probability > 0.0 && probability <= 1.0 + 1e-5, "{x}: {leaf} {probability}");
            }
        }
    }
    assert!(LightTree::new(&[]).sample(&Receiver::open(Vec3::ZERO), 0.5).is_none());
    assert!(LightTree::new(&[point(0.0, 0.0)]).sample(&Receiver::open(Vec3::ZERO), 0.5).is_none());
}
