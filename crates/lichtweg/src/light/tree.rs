//! A tree of lights: chooses one of many by what it may give to a point (Conty Estevez and Kulla 2018, "Importance Sampling of
//! Many Lights with Adaptive Tree Splitting", without the splitting; compare Pharr, Jakob and Humphreys 2023, section 12.6.3).
//!
//! Every node bounds the places of its lights by a sphere, and the directions in which they shine by a cone. A walk goes down from
//! the root, and takes each child in proportion to a bound on what it gives:
//!
//! importance = power cos(t) / max(d^2, r^2),
//!
//! with d the distance to the sphere's centre, r its radius, and t the smallest angle between a normal of the lights and a direction
//! from one of their places to the point. A light whose importance is zero cannot shine on the point.
//!
//! Limits: the bound knows nothing of occlusion, nor of the surface that the point lies on.

use std::f32::consts::{FRAC_PI_2, PI};

use lichtweg_ray::math::{Bounds3, Vec3};

/// What a tree needs to know of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// Around its places.
    pub bounds: Bounds3,
    /// Unit axis of the cone of its normals.
    pub axis: Vec3,
    /// Half-angle of that cone in radians; pi is every direction. Light leaves at less than pi / 2 from a normal.
    pub spread: f32,
    /// Its power, of any unit.
    pub power: f32,
}

/// Lights, by their number.
#[derive(Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// The leaf of each light; none where it is not in the tree.
    leaves: Vec<Option<u32>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: Vec3,
    radius_squared: f32,
    axis: Vec3,
    sin_spread: f32,
    cos_spread: f32,
    power: f32,
    parent: u32,
    /// The second child; the first one comes next after the node.
    second: u32,
    /// The light of a leaf.
    light: Option<u32>,
}

/// Bins along an axis to choose a split from.
const BINS: usize = 12;

impl LightBounds {
    /// Those of two sets of lights together.
    fn union(&self, other: &Self) -> Self {
        let (axis, spread) = cone_union((self.axis, self.spread), (other.axis, other.spread));
        Self { bounds: self.bounds.union(other.bounds), axis, spread, power: self.power + other.power }
    }

    /// The orientation and surface area heuristic (Conty Estevez and Kulla 2018, section 4.4), as a measure of how badly the
    /// importance of a node can judge its lights.
    fn cost(&self) -> f32 {
        let (o, w) = (self.spread, (self.spread + FRAC_PI_2).min(PI));
        let orientation = 2.0 * PI * (1.0 - o.cos())
            + FRAC_PI_2 * (2.0 * w * o.sin() - (o - 2.0 * w).cos() - 2.0 * o * o.sin() + o.cos());
        let extent = self.bounds.extent().length_squared();
        self.power * orientation * extent
    }
}

/// The smallest cone (axis, half-angle) about two.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = a.0.dot(b.0).clamp(-1.0, 1.0).acos();
    if (between + b.1).min(PI) <= a.1 {
        return a;
    }
    let spread = 0.5 * (a.1 + between + b.1);
    // Turn the wider one's axis towards the other's, by what its cone grows.
    match (b.0 - a.0 * a.0.dot(b.0)).try_normalized() {
        Some(side) if spread < PI => {
            let (sin, cos) = (spread - a.1).sin_cos();
            ((a.0 * cos + side * sin).normalized(), spread)
        }
        _ => (a.0, PI),
    }
}

impl LightTree {
    /// Over lights with their numbers, of which there are `count` in all.
    pub fn new(lights: Vec<(u32, LightBounds)>, count: usize) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * lights.len()), leaves: vec![None; count] };
        let mut lights = lights;
        if !lights.is_empty() {
            tree.build(&mut lights, u32::MAX);
        }
        tree
    }

    fn build(&mut self, lights: &mut [(u32, LightBounds)], parent: u32) -> LightBounds {
        let index = self.nodes.len() as u32;
        let all = lights[1..].iter().fold(lights[0].1, |all, (_, bounds)| all.union(bounds));
        let radius = 0.5 * all.bounds.extent().length();
        // A little wider than rounding asks for: what shines must not be lost.
        let spread = (all.spread + 1e-3).min(PI);
        self.nodes.push(Node {
            center: all.bounds.center(),
            radius_squared: radius * radius * (1.0 + 1e-4),
            axis: all.axis,
            sin_spread: spread.sin(),
            cos_spread: if spread >= PI { -1.0 } else { spread.cos() },
            power: all.power,
            parent,
            second: 0,
            light: None,
        });
        if let [(light, _)] = lights {
            self.nodes[index as usize].light = Some(*light);
            self.leaves[*light as usize] = Some(index);
            return all;
        }
        let middle = split(lights);
        let (first, second) = lights.split_at_mut(middle);
        self.build(first, index);
        self.nodes[index as usize].second = self.nodes.len() as u32;
        self.build(second, index);
        all
    }

    /// A light for a point, and the probability of its choice; `None` where none can shine on it.
    #[inline]
    pub fn sample(&self, from: Vec3, u: f32) -> Option<(u32, f32)> {
        let mut u = f64::from(u);
        let (mut index, mut probability) = (0_usize, 1.0_f32);
        loop {
            let node = self.nodes.get(index)?;
            if let Some(light) = node.light {
                return (node.importance(from) > 0.0).then_some((light, probability));
            }
            let first = self.first_share(index, from)?;
            let share = f64::from(first);
            if u < share {
                u /= share;
                probability *= first;
                index += 1;
            } else {
                u = (u - share) / (1.0 - share);
                probability *= 1.0 - first;
                index = node.second as usize;
            }
        }
    }

    /// Probability that [`LightTree::sample`] chooses a light.
    pub fn probability(&self, from: Vec3, light: u32) -> f32 {
        let Some(leaf) = self.leaves.get(light as usize).copied().flatten() else { return 0.0 };
        let mut index = leaf;
        if self.nodes[index as usize].importance(from) <= 0.0 {
            return 0.0;
        }
        let mut probability = 1.0;
        while self.nodes[index as usize].parent != u32::MAX {
            let parent = self.nodes[index as usize].parent;
            let Some(first) = self.first_share(parent as usize, from) else { return 0.0 };
            probability *= if index == parent + 1 { first } else { 1.0 - first };
            index = parent;
        }
        probability
    }

    /// Probability of the first child of a node; `None` where neither can give anything.
    #[inline]
    fn first_share(&self, node: usize, from: Vec3) -> Option<f32> {
        let first = self.nodes[node + 1].importance(from);
        let second = self.nodes[self.nodes[node].second as usize].importance(from);
        let sum = first + second;
        (sum > 0.0).then(|| first / sum)
    }
}

impl Node {
    #[inline]
    fn importance(&self, from: Vec3) -> f32 {
        let along = from - self.center;
        let distance_squared = along.length_squared();
        let strength = self.power / distance_squared.max(self.radius_squared).max(f32::MIN_POSITIVE);
        if self.cos_spread <= -1.0 || distance_squared <= self.radius_squared {
            return strength;
        }
        // From the angle between axis and direction, take the spread, then the angle under which the sphere is seen.
        let cos = (self.axis.dot(along) / distance_squared.sqrt()).clamp(-1.0, 1.0);
        let (sin, cos) = angle_less((1.0 - cos * cos).sqrt(), cos, self.sin_spread, self.cos_spread);
        let sin_size = (self.radius_squared / distance_squared).sqrt();
        let (_, cos) = angle_less(sin, cos, sin_size, (1.0 - sin_size * sin_size).max(0.0).sqrt());
        strength * cos.max(0.0)
    }
}

/// Sine and cosine of a - b, or of 0 where b is larger, of angles in [0, pi] given by theirs.
#[inline]
fn angle_less(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> (f32, f32) {
    if cos_a >= cos_b {
        return (0.0, 1.0);
    }
    (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b)
}

/// Parts lights in two; how many are in the first part.
fn split(lights: &mut [(u32, LightBounds)]) -> usize {
    let centers = Bounds3::of(lights.iter().map(|(_, l)| l.bounds.center()));
    let extent = centers.extent();
    let component = |v: Vec3, axis: usize| v.to_array()[axis];
    let mut best: Option<(f32, usize, usize)> = None;
    let bin_of = |l: &LightBounds, axis: usize| {
        let (low, length) = (component(centers.min, axis), component(extent, axis));
        let at = (component(l.bounds.center(), axis) - low) / length;
        ((at * BINS as f32) as usize).min(BINS - 1)
    };
    for axis in 0..3 {
        if component(extent, axis) <= 0.0 {
            continue;
        }
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for (_, light) in lights.iter() {
            let bin = &mut bins[bin_of(light, axis)];
            *bin = Some(bin.map_or(*light, |b| b.union(light)));
        }
        let join = |bins: &[Option<LightBounds>]| bins.iter().flatten().copied().reduce(|a, b| a.union(&b));
        // Thin boxes ask to be cut across.
        let stretch = extent.max_element() / component(extent, axis);
        for at in 1..BINS {
            let (Some(a), Some(b)) = (join(&bins[..at]), join(&bins[at..])) else { continue };
            let cost = stretch * (a.cost() + b.cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, at));
            }
        }
    }
    let Some((_, axis, at)) = best else { return lights.len() / 2 };
    let mut middle = 0;
    for i in 0..lights.len() {
        if bin_of(&lights[i].1, axis) < at {
            lights.swap(i, middle);
            middle += 1;
        }
    }
    middle.clamp(1, lights.len() - 1)
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::{Sampler, SamplerKind};

    use super::*;

    fn lights(count: u32) -> Vec<(u32, LightBounds)> {
        (0..count)
            .map(|i| {
                let mut s = Sampler::new(SamplerKind::Independent, 1, 2, i);
                let mut next = || s.next_1d() * 2.0 - 1.0;
                let at = Vec3::new(next(), next(), next());
                let axis = Vec3::new(next(), next(), next()).normalized();
                let size = 0.05 * (1.0 + next());
                let bounds = Bounds3::of([at, at + Vec3::splat(size)]);
                let spread = if i % 7 == 0 { PI } else { 0.5 * (1.0 + next()) };
                (i, LightBounds { bounds, axis, spread, power: 1.5 + next() })
            })
            .collect()
    }

    /// Choices come as often as said, and probabilities sum to one.
    #[test]
    fn samples_follow_their_probabilities() {
        for count in [1, 2, 50] {
            let tree = LightTree::new(lights(count), count as usize);
            for from in [Vec3::new(0.1, 0.2, 0.3), Vec3::new(3.0, -2.0, 1.0)] {
                const SAMPLES: u32 = 1 << 16;
                let mut seen = vec![0_u32; count as usize];
                for i in 0..SAMPLES {
                    let u = (i as f32 + 0.5) / SAMPLES as f32;
                    let Some((light, probability)) = tree.sample(from, u) else { continue };
                    seen[light as usize] += 1;
                    assert!((probability / tree.probability(from, light) - 1.0).abs() < 1e-4);
                }
                for (light, &seen) in seen.iter().enumerate() {
                    let expected = tree.probability(from, light as u32) * SAMPLES as f32;
                    assert!(
                        (seen as f32 - expected).abs() < 3.0 + 1e-3 * expected,
                        "{light}: {seen}, {expected}"
                    );
                }
            }
        }
    }

    /// What can shine on a point is chosen with some probability, however the cones of nodes are joined.
    #[test]
    fn bounds_hold() {
        let lights = lights(200);
        let tree = LightTree::new(lights.clone(), 200);
        for i in 0..200_u32 {
            let mut s = Sampler::new(SamplerKind::Independent, 3, 4, i);
            let mut next = || s.next_1d() * 6.0 - 3.0;
            let from = Vec3::new(next(), next(), next());
            for (light, bounds) in &lights {
                let angle = bounds.axis.dot((from - bounds.bounds.center()).normalized()).acos();
                let shines = angle < bounds.spread + FRAC_PI_2;
                assert!(!shines || tree.probability(from, *light) > 0.0, "{light} {from:?}");
            }
        }
    }
}
