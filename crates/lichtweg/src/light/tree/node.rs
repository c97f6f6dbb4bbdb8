//! A node of eight children in three cache lines, and what each of them may give to a receiver.
//!
//! Children are bounded by spheres, on a grid of 16 bits over the node's box, and by cones of normals; all roundings are outward.
//! A child is an inner node or a leaf. For one receiver, what is computed is computed for all eight side by side, without a branch,
//! so that the compiler makes vectors of it; for sixteen receivers, child by child. The bits are the same.

use std::f32::consts::PI;

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, LANES};

use super::bounds::LightBounds;
use crate::lanes::{lanes_of_vector, spread, vec3};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Where light is to arrive: one place, or one a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver<F = f32> {
    /// Where.
    pub position: Vector<F>,
    /// Unit normal of the side that light must come from; zero where it may come from both.
    pub normal: Vector<F>,
}

impl Receiver {
    /// A place that light may come to from everywhere.
    pub fn open(position: Vec3) -> Self {
        Self { position, normal: Vec3::ZERO }
    }
}

impl<F: FloatLanes> Receiver<F> {
    /// Of each lane.
    #[inline(always)]
    pub(crate) fn to_singles(self) -> [Receiver; LANES] {
        let (p, n) = (lanes_of_vector(self.position), lanes_of_vector(self.normal));
        std::array::from_fn(|i| Receiver { position: vec3(&p, i), normal: vec3(&n, i) })
    }
}

/// What is below a node: the number of a node, or of a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    pub fn leaf(leaf: u32) -> Self {
        Self(leaf | Self::LEAF)
    }

    pub fn node(node: u32) -> Self {
        Self(node)
    }

    /// The leaf (`Ok`) or the node (`Err`).
    #[inline(always)]
    pub fn resolve(self) -> Result<u32, u32> {
        if self.0 & Self::LEAF != 0 { Ok(self.0 & !Self::LEAF) } else { Err(self.0) }
    }
}

/// Eight children.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Corner and step of the grid.
    corner: Vec3,
    step: f32,
    centers: [[u16; WIDTH]; 3],
    /// In steps.
    radii: [u16; WIDTH],
    /// Cosine of the cone's half-angle, times [`COSINE`].
    spreads: [i16; WIDTH],
    /// Upper half of an f32; negative where light leaves both sides.
    intensities: [u16; WIDTH],
    /// Times [`AXIS`].
    axes: [[i8; WIDTH]; 3],
    children: [Child; WIDTH],
    /// Where this node is: see [`Node::place`].
    pub parent: u32,
}

/// One, in a cosine of 16 bits.
const COSINE: f32 = 32767.0;
/// One, in an axis of 8 bits.
const AXIS: f32 = 127.0;
/// More than what rounding an axis adds to its product with a unit vector.
const AXIS_ERROR: f32 = 0.007;
/// Least square of a distance.
const NEAREST: f32 = 1e-24;
/// Largest place on the grid; a little is left for rounding.
const GRID: f32 = 65_000.0;

const _: () = assert!(size_of::<Node>() == 192);

impl Node {
    /// The place of the root, and of what is in no tree.
    pub const NO_PLACE: u32 = u32::MAX;

    /// Node and slot in one number.
    pub fn place(node: u32, slot: usize) -> u32 {
        node * WIDTH as u32 + slot as u32
    }

    /// A node over children, at most eight and of intensities up to 1, which is itself at `place`. What is below the children is not known yet.
    pub fn new(children: &[LightBounds], place: u32) -> Self {
        let all = children[1..].iter().fold(children[0].bounds, |all, c| all.union(c.bounds));
        // Coordinates of the box, and so distances, round by some 1e-7 of their size.
        let size = all.min.abs().max(all.max.abs()).max_element();
        let step = (all.extent().max_element() / GRID).max(size * 1e-7).max(f32::MIN_POSITIVE);
        let mut node = Self {
            corner: all.min,
            step,
            centers: [[0; WIDTH]; 3],
            radii: [0; WIDTH],
            spreads: [0; WIDTH],
            intensities: [0; WIDTH],
            axes: [[0; WIDTH]; 3],
            children: [Child(0); WIDTH],
            parent: place,
        };
        for (slot, child) in children.iter().enumerate() {
            debug_assert!(child.intensity <= 1.0 + 1e-3);
            let center = (child.bounds.center() - all.min) * (1.0 / step);
            // The grid moves the centre by less than one step, and rounding by less than another.
            let radius = 0.5 * child.bounds.extent().length() / step + 2.0;
            node.radii[slot] = radius.ceil() as u16;
            let cos_spread = if child.spread < PI { child.spread.cos() } else { -1.0 };
            node.spreads[slot] = (cos_spread * COSINE).floor().max(-COSINE) as i16;
            // Rounded up, and never zero: that is for what is not there.
            let bits = (child.intensity.to_bits() >> 16) as u16 + 1;
            node.intensities[slot] = bits | if child.two_sided { 1 << 15 } else { 0 };
            for (axis, (c, a)) in center.to_array().into_iter().zip(child.axis.to_array()).enumerate() {
                node.centers[axis][slot] = c.round() as u16;
                node.axes[axis][slot] = (a * AXIS).round() as i8;
            }
        }
        node
    }

    pub fn set_child(&mut self, slot: usize, child: Child) {
        self.children[slot] = child;
    }

    #[inline(always)]
    pub fn child(&self, slot: usize) -> Child {
        self.children[slot]
    }

    /// Reads something of each of its cache lines, so that they are on their way.
    #[inline(always)]
    pub fn touch(&self) -> u32 {
        u32::from(self.centers[0][0]) ^ u32::from(self.radii[0]) ^ self.parent
    }

    /// What the children may give to a receiver, relative to each other; zero of what certainly cannot.
    #[inline(always)]
    pub fn importances(&self, to: &Receiver) -> [f32; WIDTH] {
        let to = Relative::new(to, self.corner);
        let mut importances = [0.0; WIDTH];
        for (slot, importance) in importances.iter_mut().enumerate() {
            *importance = self.bounds(slot).importance(&to);
        }
        importances
    }

    /// [`Node::importances`] to any number of receivers, by child.
    #[inline(always)]
    pub fn importances_each<F: Float>(&self, to: &Receiver<F>) -> [F; WIDTH] {
        let to = Relative::new(to, self.corner);
        let mut importances = [F::splat(0.0); WIDTH];
        for (slot, importance) in importances.iter_mut().enumerate() {
            if self.intensities[slot] != 0 {
                *importance = self.bounds(slot).importance(&to);
            }
        }
        importances
    }

    #[inline(always)]
    fn bounds(&self, slot: usize) -> Bounds {
        let center = |axis: usize| f32::from(self.centers[axis][slot]) * self.step;
        let axis = |axis: usize| f32::from(self.axes[axis][slot]) * (1.0 / AXIS);
        let intensity = self.intensities[slot];
        Bounds {
            center: Vec3::new(center(0), center(1), center(2)),
            radius: f32::from(self.radii[slot]) * self.step,
            axis: Vec3::new(axis(0), axis(1), axis(2)),
            cos_spread: f32::from(self.spreads[slot]) * (1.0 / COSINE),
            intensity: f32::from_bits(u32::from(intensity & 0x7fff) << 16),
            two_sided: intensity >> 15 != 0,
        }
    }
}

/// A receiver as seen from a node's corner.
struct Relative<F> {
    at: Vector<F>,
    normal: Vector<F>,
    /// 1 where light may come from both sides, else 0.
    open: F,
}

impl<F: Float> Relative<F> {
    #[inline(always)]
    fn new(to: &Receiver<F>, corner: Vec3) -> Self {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let Vector { x, y, z } = to.normal;
        let open = x.equal(zero) & y.equal(zero) & z.equal(zero);
        Self { at: to.position - spread(corner), normal: to.normal, open: one.select(open, zero) }
    }
}

/// What a node knows of a child, relative to its corner.
struct Bounds {
    center: Vec3,
    radius: f32,
    axis: Vec3,
    cos_spread: f32,
    intensity: f32,
    two_sided: bool,
}

impl Bounds {
    /// intensity cos(t) cos(t') / max(d^2, r^2), with t the smallest angle at which light can leave the sphere towards the receiver,
    /// and t' the smallest to the receiver's normal at which it can arrive.
    #[inline(always)]
    fn importance<F: Float>(&self, to: &Relative<F>) -> F {
        let splat = F::splat;
        let (zero, one, nearest) = (splat(0.0), splat(1.0), splat(NEAREST));
        let (x, y, z) =
            (to.at.x - splat(self.center.x), to.at.y - splat(self.center.y), to.at.z - splat(self.center.z));
        let radius = splat(self.radius);
        let radius_squared = splat(self.radius * self.radius);
        let distance_squared = x * x + y * y + z * z;
        let inverse = one / distance_squared.max(nearest).sqrt();
        let leaving = (splat(self.axis.x) * x + splat(self.axis.y) * y + splat(self.axis.z) * z) * inverse;
        let leaving = if self.two_sided { leaving.abs() } else { leaving };
        let leaving = (leaving + splat(AXIS_ERROR)).max(splat(-1.0)).min(one);
        let arriving = -(to.normal.x * x + to.normal.y * y + to.normal.z * z) * inverse;
        // The angle under which the sphere is seen, and that of the cone.
        let sin_size = (radius * inverse).min(one);
        let cos_size = sine(sin_size);
        let cos_spread = splat(self.cos_spread);
        let (sin, cos) = angle_less(sine(leaving), leaving, splat(sine(self.cos_spread)), cos_spread);
        let (_, leaving) = angle_less(sin, cos, sin_size, cos_size);
        let (_, arriving) = angle_less(sine(arriving), arriving, sin_size, cos_size);
        let factor = leaving.max(zero) * arriving.max(to.open);
        let factor = one.select(distance_squared.le(radius_squared), factor);
        splat(self.intensity) * factor / distance_squared.max(radius_squared).max(nearest)
    }
}

/// sqrt(1 - x^2).
#[inline(always)]
fn sine<F: Float>(cosine: F) -> F {
    (F::splat(1.0) - cosine * cosine).max(F::splat(0.0)).sqrt()
}

/// Sine and cosine of a - b, or of 0 where b is larger, of angles in [0, pi] given by theirs.
#[inline(always)]
fn angle_less<F: Float>(sin_a: F, cos_a: F, sin_b: F, cos_b: F) -> (F, F) {
    let less = cos_b.le(cos_a);
    let sin = sin_a * cos_b - cos_a * sin_b;
    let cos = cos_a * cos_b + sin_a * sin_b;
    (F::splat(0.0).select(less, sin), F::splat(1.0).select(less, cos))
}
