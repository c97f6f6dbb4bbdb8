//! How a ray goes through the hierarchy: depth first, near children before far ones.

use std::mem::MaybeUninit;

use super::layout::{Bvh, ChildRef, Node, TriangleId};
use super::slab::Slab;
use crate::quadric::PlacedQuadric;
use crate::ray::{Hit, Ray};
use crate::simd::{Lanes, WIDTH};
use crate::triangle::{BlockHits, Shear, WideShear};

/// Levels of the tree, at most; the builder sees to it.
pub(crate) const MAX_DEPTH: usize = 72;
const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1 + WIDTH;

/// Children put off until later, as (entry t, child) packed so that integers order like distances.
struct Stack {
    entries: [MaybeUninit<u64>; STACK],
    len: usize,
}

#[inline(always)]
fn pack(enter: f32, child: ChildRef) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child.0)
}

impl Stack {
    #[inline(always)]
    fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; STACK], len: 0 }
    }

    #[inline(always)]
    fn push(&mut self, entry: u64) {
        debug_assert!(self.len < STACK);
        // SAFETY: the builder bounds the depth; each level leaves at most WIDTH - 1 entries behind.
        unsafe { self.entries.get_unchecked_mut(self.len).write(entry) };
        self.len += 1;
    }

    /// The top entry that begins at `tfar` or before.
    #[inline(always)]
    fn pop(&mut self, tfar: f32) -> Option<ChildRef> {
        while self.len > 0 {
            self.len -= 1;
            // SAFETY: entries below `len` were written.
            let entry = unsafe { self.entries.get_unchecked(self.len).assume_init() };
            if (entry >> 32) as u32 <= tfar.to_bits() {
                return Some(ChildRef(entry as u32));
            }
        }
        None
    }

    /// Puts the top `count` entries in order, nearest on top.
    #[inline(always)]
    fn sort_top(&mut self, count: usize) {
        let base = self.len - count;
        // SAFETY: the top `count` entries were written.
        let top = unsafe {
            std::slice::from_raw_parts_mut(self.entries.as_mut_ptr().add(base).cast::<u64>(), count)
        };
        for i in 1..count {
            let x = top[i];
            let mut j = i;
            while j > 0 && top[j - 1] < x {
                top[j] = top[j - 1];
                j -= 1;
            }
            top[j] = x;
        }
    }
}

/// The primitives that are no triangles.
pub(crate) struct Others<'a> {
    pub quadrics: &'a [PlacedQuadric],
}

/// The nearest hit so far.
struct Best {
    t: f32,
    u: f32,
    v: f32,
    place: Place,
}

#[derive(Clone, Copy)]
enum Place {
    Nothing,
    Triangle { block: usize, lane: usize },
    Quadric(usize),
}

impl Place {
    fn id(self, bvh: &Bvh, others: &Others) -> Option<TriangleId> {
        match self {
            Self::Nothing => None,
            Self::Triangle { block, lane } => Some(bvh.ids[block][lane]),
            Self::Quadric(i) => {
                Some(TriangleId { geometry: others.quadrics[i].geometry, primitive: 0 })
            }
        }
    }
}

impl Best {
    /// Takes a candidate with `t <= self.t`; of equally near ones the lowest id wins.
    #[inline(always)]
    fn consider(&mut self, t: f32, u: f32, v: f32, place: Place, bvh: &Bvh, others: &Others) {
        if t < self.t || self.loses_tie(place, bvh, others) {
            *self = Self { t, u, v, place };
        }
    }

    #[cold]
    #[inline(never)]
    fn loses_tie(&self, place: Place, bvh: &Bvh, others: &Others) -> bool {
        let held = self.place.id(bvh, others);
        held.is_none_or(|held| place.id(bvh, others).is_some_and(|new| new < held))
    }
}

/// A ray that can hit something: finite, with a direction and a range.
#[inline(always)]
fn range(ray: &Ray) -> Option<(f32, f32)> {
    let tnear = if ray.tnear > 0.0 { ray.tnear } else { 0.0 };
    let tfar = if ray.tfar < f32::MAX { ray.tfar } else { f32::MAX };
    let sound = tnear < tfar
        && !ray.tnear.is_nan()
        && !ray.tfar.is_nan()
        && ray.origin.is_finite()
        && ray.direction.is_finite()
        && ray.direction.abs().max_element() >= f32::MIN_POSITIVE;
    sound.then_some((tnear, tfar))
}

/// The nearest hit, or with `ANY` an arbitrary one, of which only the existence means something.
#[inline(always)]
pub(crate) fn traverse<V: Lanes, const ANY: bool>(
    bvh: &Bvh,
    others: &Others,
    ray: &Ray,
) -> Option<Hit> {
    let (tnear, tfar) = range(ray)?;
    let slab = Slab::<V>::new(ray, tnear, bvh.reach);
    let shear = WideShear::<V>::new(&Shear::new(ray), tnear);
    let mut best = Best { t: tfar, u: 0.0, v: 0.0, place: Place::Nothing };
    let mut wide_tfar = V::splat(tfar);
    let mut stack = Stack::new();
    let mut current = bvh.root;
    loop {
        while !current.is_leaf() {
            // SAFETY: inner references of the builder are indices of nodes.
            let node = unsafe { bvh.nodes.get_unchecked(current.node()) };
            // SAFETY: the planes are the node's six aligned rows.
            let (mut mask, enter) = unsafe { slab.meet((&raw const node.planes).cast(), wide_tfar) };
            if mask == 0 {
                match stack.pop(best.t) {
                    Some(next) => {
                        current = next;
                        continue;
                    }
                    None => return finish(bvh, others, ray, &best),
                }
            }
            let first = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            if mask == 0 {
                current = child(node, first);
                continue;
            }
            let enter = enter.to_array().0;
            let entry = |i: usize| {
                // SAFETY: bits of a mask of eight lanes are below eight.
                pack(unsafe { *enter.get_unchecked(i) }, child(node, i))
            };
            let second = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let (a, b) = (entry(first), entry(second));
            if mask == 0 {
                let (near, far) = if a <= b { (a, b) } else { (b, a) };
                stack.push(far);
                current = ChildRef(near as u32);
                continue;
            }
            stack.push(a);
            stack.push(b);
            let mut count = 2;
            while mask != 0 {
                stack.push(entry(mask.trailing_zeros() as usize));
                mask &= mask - 1;
                count += 1;
            }
            stack.sort_top(count);
            stack.len -= 1;
            // SAFETY: just written.
            current = ChildRef(unsafe { stack.entries.get_unchecked(stack.len).assume_init() } as u32);
        }

        let (begin, count) = current.leaf();
        if !current.is_other() {
            for block in begin..begin + count {
                // SAFETY: leaf references of the builder are ranges of blocks.
                let hits = shear.intersect(unsafe { bvh.blocks.get_unchecked(block) }, wide_tfar);
                if hits.mask != 0 {
                    if ANY {
                        return Some(HIT_SOMETHING);
                    }
                    take(&mut best, &hits, block, bvh, others);
                    wide_tfar = V::splat(best.t);
                }
            }
        } else {
            for &quadric in &bvh.others[begin..begin + count] {
                let quadric = quadric as usize;
                let hit = others.quadrics[quadric].intersect(ray, tnear, best.t);
                if let Some(t) = hit {
                    if ANY {
                        return Some(HIT_SOMETHING);
                    }
                    best.consider(t, 0.0, 0.0, Place::Quadric(quadric), bvh, others);
                    wide_tfar = V::splat(best.t);
                }
            }
        }
        match stack.pop(best.t) {
            Some(next) => current = next,
            None => return finish(bvh, others, ray, &best),
        }
    }
}

const HIT_SOMETHING: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, geometry: 0, primitive: 0 };

#[inline(always)]
fn child(node: &Node, slot: usize) -> ChildRef {
    // SAFETY: slots come from masks of eight lanes.
    unsafe { *node.children.get_unchecked(slot) }
}

#[inline(always)]
fn take<V: Lanes>(best: &mut Best, hits: &BlockHits<V>, block: usize, bvh: &Bvh, others: &Others) {
    let t = hits.t();
    let mut mask = hits.mask;
    let mut nearest = mask.trailing_zeros() as usize;
    mask &= mask - 1;
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        // Lanes are in order of id: the first of equals stays.
        if t[lane & 7] < t[nearest & 7] {
            nearest = lane;
        }
    }
    let hit = hits.lane(nearest & 7);
    best.consider(hit.t, hit.u, hit.v, Place::Triangle { block, lane: nearest & 7 }, bvh, others);
}

/// Names what was hit.
#[inline(always)]
fn finish(bvh: &Bvh, others: &Others, ray: &Ray, best: &Best) -> Option<Hit> {
    let (t, u, v) = (best.t, best.u, best.v);
    match best.place {
        Place::Nothing => None,
        Place::Triangle { block, lane } => {
            let id = bvh.ids[block][lane];
            Some(Hit { t, u, v, geometry: id.geometry, primitive: id.primitive })
        }
        Place::Quadric(i) => {
            let quadric = &others.quadrics[i];
            let (u, v) = quadric.parameters(ray, t);
            Some(Hit { t, u, v, geometry: quadric.geometry, primitive: 0 })
        }
    }
}
