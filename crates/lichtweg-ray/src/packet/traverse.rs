//! How a packet goes through the hierarchy: depth first, children in the order in which the first ray enters them.

use std::marker::PhantomData;
use std::mem::MaybeUninit;

use super::ray::{Aligned, Mixed, Prepared, Triangle, settle};
use super::{HitPacket, RayPacket};
use crate::accel::Accel;
use crate::bvh::{Best, Block, ChildRef, MAX_DEPTH, Other, descend, take};
use crate::kind::{Item, Kind, Probe};
use crate::ray::Hit;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Lanes as NarrowLanes, Portable, WIDTH};
use crate::triangle::WideShear;
use crate::wide::{self, Float, FloatLanes, LANES, Mask, Wide, Word, WordLanes};

/// Where this many rays or fewer want a child, each goes on by itself.
const FEW: u32 = 4;

const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1 + WIDTH;

/// A child put off until later, the rays that want it, and where they enter it.
#[derive(Clone, Copy)]
struct Entry<W: Wide> {
    enter: W::F32,
    child: ChildRef,
    mask: u32,
    /// Where the first ray enters it.
    first: f32,
}

/// The nearest hits so far, and what is found next.
struct Bests<W: Wide> {
    t: W::F32,
    u: W::F32,
    v: W::F32,
    id: W::U32,
}

impl<W: Wide> Bests<W> {
    #[inline(always)]
    fn get(&self, lane: usize) -> Best {
        Best { t: self.t.lane(lane), u: self.u.lane(lane), v: self.v.lane(lane), id: self.id.lane(lane) }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, best: &Best) {
        let only = W::Mask::from_bits(1 << lane);
        self.t = W::F32::splat(best.t).select(only, self.t);
        self.u = W::F32::splat(best.u).select(only, self.u);
        self.v = W::F32::splat(best.v).select(only, self.v);
        self.id = W::U32::splat(best.id).select(only, self.id);
    }
}

/// Whether the triangles of a block are to be tested for one ray at a time, eight lanes of triangles, instead of for all rays, sixteen
/// lanes of rays: a test of a triangle takes some 0.7 times as long as one of a ray.
#[inline(always)]
fn one_by_one<W: Wide>(rays: u32, block: &Block) -> bool {
    !W::REGISTERS || 10 * rays.count_ones() < 7 * block.len()
}

/// A walk of a packet through the hierarchy.
struct Walk<'a, W: Wide, V: NarrowLanes> {
    accel: &'a Accel,
    rays: &'a RayPacket,
    prepared: Prepared<W>,
    bests: Bests<W>,
    /// Nearest hits of what is no triangle, of the rays that were asked for.
    others: [MaybeUninit<Other>; LANES],
    asked: u32,
    /// Rays that look for any hit and have found one.
    found: u32,
    narrow: PhantomData<V>,
}

impl<'a, W: Wide, V: NarrowLanes> Walk<'a, W, V> {
    #[inline(always)]
    fn new(accel: &'a Accel, rays: &'a RayPacket, active: u32) -> Self {
        let prepared = Prepared::new(rays, active, accel.bvh.reach);
        let nothing = W::U32::splat(Best::NOTHING);
        let zero = W::F32::splat(0.0);
        let bests = Bests { t: prepared.tfar, u: zero, v: zero, id: nothing };
        Self {
            accel,
            rays,
            prepared,
            bests,
            others: [const { MaybeUninit::uninit() }; LANES],
            asked: 0,
            found: 0,
            narrow: PhantomData,
        }
    }

    #[inline(always)]
    fn run<const ANY: bool>(&mut self) {
        let mut stack: [MaybeUninit<Entry<W>>; STACK] = [const { MaybeUninit::uninit() }; STACK];
        let mut top = 0;
        let mut current = self.accel.bvh.root;
        let mut mask = self.prepared.active.bits();
        if mask == 0 {
            return;
        }
        loop {
            if current.is_leaf() {
                self.leaf::<ANY>(current, mask);
            } else if !W::REGISTERS || mask.count_ones() <= FEW {
                self.singles::<ANY>(current, mask);
            } else {
                // SAFETY: inner references of the builder are indices of nodes.
                let node = unsafe { self.accel.bvh.nodes.get_unchecked(current.node()) };
                let rays = W::Mask::from_bits(mask);
                let bottom = top;
                for slot in 0..WIDTH {
                    let child = node.children[slot];
                    if child == ChildRef::NOTHING {
                        continue;
                    }
                    let p = &node.planes;
                    let planes = [p[0][slot], p[1][slot], p[2][slot], p[3][slot], p[4][slot], p[5][slot]];
                    let (met, enter) = self.prepared.meet(planes, self.bests.t);
                    let met = met & rays;
                    if met.any() {
                        let first = match ANY {
                            // Large boxes come first in a node: they are the likeliest to stop a ray.
                            true => slot as f32,
                            false => enter.select(met, W::F32::splat(f32::INFINITY)).smallest(),
                        };
                        let entry = Entry { enter, child, mask: met.bits(), first };
                        // The farthest lies deepest.
                        let mut at = top;
                        // SAFETY: the builder bounds the depth, and each level leaves at most WIDTH - 1
                        // entries behind; entries below the top were written.
                        unsafe {
                            debug_assert!(top < STACK);
                            while at > bottom && stack[at - 1].assume_init_ref().first < first {
                                stack[at] = stack[at - 1];
                                at -= 1;
                            }
                        }
                        stack[at].write(entry);
                        top += 1;
                    }
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                // SAFETY: entries below the top were written.
                let entry = unsafe { stack[top].assume_init_ref() };
                mask = entry.mask & if ANY { !self.found } else { entry.enter.le(self.bests.t).bits() };
                if mask != 0 {
                    current = entry.child;
                    break;
                }
            }
        }
    }

    #[inline(always)]
    fn leaf<const ANY: bool>(&mut self, leaf: ChildRef, mask: u32) {
        let (begin, count) = leaf.leaf();
        if leaf.is_other() {
            self.others_leaf::<ANY>(leaf, mask & !self.found);
            return;
        }
        for index in begin..begin + count {
            // SAFETY: leaf references of the builder are ranges of blocks.
            let block = unsafe { self.accel.bvh.blocks.get_unchecked(index) };
            let rays = mask & !self.found;
            if rays == 0 {
                return;
            }
            match self.prepared.axes {
                _ if one_by_one::<W>(rays, block) => self.block_alone::<ANY>(block, rays),
                Some(axes) => self.block::<ANY, _>(block, rays, |lane| Aligned { block, lane, axes }),
                None => self.block::<ANY, _>(block, rays, |lane| Mixed { block, lane }),
            }
        }
    }

    /// The triangles of a block for each ray by itself.
    #[inline(always)]
    fn block_alone<const ANY: bool>(&mut self, block: &Block, mut lanes: u32) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let shear = WideShear::<V>::new(&self.prepared.shear(lane));
            let mut best = self.bests.get(lane);
            let hits = shear.intersect(block, &shear.end(best.t));
            if hits.mask == 0 {
                continue;
            }
            if hits.doubt {
                for triangle in 0..WIDTH {
                    self.doubtful::<ANY>(block, triangle, 1 << lane);
                }
            } else if ANY {
                self.found |= 1 << lane;
            } else {
                take(&mut best, &hits, block);
                self.bests.set(lane, &best);
            }
        }
    }

    /// Two passes: the first has no branch that depends on a triangle, and leaves few triangles to the second.
    #[inline(always)]
    fn block<const ANY: bool, T: Triangle<W>>(
        &mut self,
        block: &Block,
        rays: u32,
        triangle: impl Fn(usize) -> T,
    ) {
        let mut near = [0; WIDTH];
        let mut candidates = 0_u32;
        for (lane, near) in near.iter_mut().enumerate() {
            if block.ids[lane] == Block::NO_ID {
                break;
            }
            *near = self.prepared.near(&triangle(lane), self.bests.t).bits() & rays;
            candidates |= u32::from(*near != 0) << lane;
        }
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            let id = block.ids[lane];
            let rays = W::Mask::from_bits(near[lane] & !self.found);
            let hits = self.prepared.intersect(&triangle(lane), rays, self.bests.t);
            let sure = hits.mask.and_not(hits.doubtful);
            if ANY {
                self.found |= sure.bits();
            } else {
                let nearer = sure & (hits.t.lt(self.bests.t) | W::U32::splat(id).lt(self.bests.id));
                self.bests.t = hits.t.select(nearer, self.bests.t);
                self.bests.u = hits.u.select(nearer, self.bests.u);
                self.bests.v = hits.v.select(nearer, self.bests.v);
                self.bests.id = W::U32::splat(id).select(nearer, self.bests.id);
            }
            if hits.doubtful.any() {
                self.doubtful::<ANY>(block, lane, hits.doubtful.bits());
            }
        }
    }

    /// The slow test of a triangle of a block for some rays.
    #[inline(never)]
    fn doubtful<const ANY: bool>(&mut self, block: &Block, triangle: usize, mut lanes: u32) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let mut best = self.bests.get(lane);
            if let Some(hit) = settle(&self.prepared.shear(lane), block.triangle(triangle), best.t) {
                self.found |= u32::from(ANY) << lane;
                best.consider(hit, block.ids[triangle]);
                self.bests.set(lane, &best);
            }
        }
    }

    #[inline(always)]
    fn other(&mut self, lane: usize) -> &mut Other {
        if self.asked >> lane & 1 == 0 {
            self.asked |= 1 << lane;
            self.others[lane].write(Other::NONE);
        }
        // SAFETY: written before its bit was set.
        unsafe { self.others[lane].assume_init_mut() }
    }

    /// A leaf of primitives that are no triangles.
    #[inline(always)]
    fn others_leaf<const ANY: bool>(&mut self, leaf: ChildRef, mut lanes: u32) {
        if lanes.count_ones() > FEW && self.spheres_leaf::<ANY>(leaf, lanes) {
            return;
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let mut best = self.bests.get(lane);
            let ray = self.rays.get(lane);
            let probe = Probe { ray: &ray, isa: V::ISA, shear: self.prepared.shear(lane) };
            if best.meet::<ANY, false>(self.accel, leaf, &probe, None, self.other(lane)) {
                self.found |= u32::from(ANY) << lane;
                self.bests.set(lane, &best);
            }
        }
    }

    /// A leaf of whole spheres; `false`, and nothing done, where it is none.
    #[inline(always)]
    fn spheres_leaf<const ANY: bool>(&mut self, leaf: ChildRef, lanes: u32) -> bool {
        let (begin, count) = leaf.leaf();
        let items = &self.accel.items[begin..begin + count];
        let sphere = |geometry: u32| match &self.accel.kinds[geometry as usize] {
            Kind::Quadric(quadric) if quadric.is_whole_sphere() => Some(quadric),
            _ => None,
        };
        if items.iter().any(|item| sphere(item.geometry).is_none()) {
            return false;
        }
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.rays.origin, &self.rays.direction);
        let origin = [W::F32::load(ox), W::F32::load(oy), W::F32::load(oz)];
        let direction = [W::F32::load(dx), W::F32::load(dy), W::F32::load(dz)];
        for &Item { geometry, .. } in items {
            let Some(sphere) = sphere(geometry) else { continue };
            let (t, hit) = sphere.intersect_sphere(origin, direction, self.prepared.tnear, self.bests.t);
            let hit = hit & W::Mask::from_bits(lanes);
            if ANY {
                self.found |= hit.bits();
                continue;
            }
            let id = self.accel.bvh.numbering.number(geometry, 0);
            let number = W::U32::splat(id);
            let nearer = hit & (t.lt(self.bests.t) | number.lt(self.bests.id));
            self.bests.t = t.select(nearer, self.bests.t);
            self.bests.id = number.select(nearer, self.bests.id);
            let (zero, t) = (W::F32::splat(0.0), t.to_lanes());
            self.bests.u = zero.select(nearer, self.bests.u);
            self.bests.v = zero.select(nearer, self.bests.v);
            let mut nearer = nearer.bits();
            while nearer != 0 {
                let lane = nearer.trailing_zeros() as usize;
                nearer &= nearer - 1;
                self.other(lane).set(Hit::plain(t.0[lane], 0.0, 0.0, geometry, 0), id);
            }
        }
        true
    }

    /// Some rays one by one.
    #[inline(always)]
    fn singles<const ANY: bool>(&mut self, child: ChildRef, mask: u32) {
        let mut lanes = mask & !self.found;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let ray = self.rays.get(lane);
            let alone = (self.prepared.slab::<V>(lane), WideShear::new(&self.prepared.shear(lane)));
            let mut best = self.bests.get(lane);
            let (accel, other) = (self.accel, self.other(lane));
            if descend::<V, ANY, false>(accel, &ray, &alone, None, &mut best, other, child) {
                self.found |= 1 << lane;
            } else if !ANY {
                self.bests.set(lane, &best);
            }
        }
    }

    /// Names what was hit.
    #[inline(always)]
    fn finish(&self) -> HitPacket {
        let mut out = HitPacket {
            t: self.bests.t.to_lanes(),
            u: self.bests.u.to_lanes(),
            v: self.bests.v.to_lanes(),
            ..HitPacket::default()
        };
        let id = self.bests.id;
        let nothing = W::U32::splat(Best::NOTHING);
        let missed = id.equal(nothing);
        if missed.bits() == (1 << LANES) - 1 {
            return out;
        }
        let (geometry, primitive) = self.accel.bvh.numbering.locate_all::<W>(id);
        out.geometry = W::U32::splat(HitPacket::NOTHING).select(missed, geometry).to_lanes();
        out.primitive = W::U32::splat(0).select(missed, primitive).to_lanes();
        let mut asked = self.asked & !missed.bits();
        let ids = id.to_lanes();
        while asked != 0 {
            let lane = asked.trailing_zeros() as usize;
            asked &= asked - 1;
            // SAFETY: written before its bit was set.
            let other = unsafe { self.others[lane].assume_init_ref() };
            if ids.0[lane] == other.id() {
                self.finish_other(lane, other, &mut out);
            }
        }
        out
    }

    #[inline(never)]
    fn finish_other(&self, lane: usize, other: &Other, out: &mut HitPacket) {
        if let Some(hit) = self.bests.get(lane).hit(self.accel, &self.rays.get(lane), other) {
            out.set(lane, &hit);
        }
    }
}

#[inline(always)]
fn closest_kernel<W: Wide, V: NarrowLanes>(accel: &Accel, rays: &RayPacket, active: u32) -> HitPacket {
    let mut walk = Walk::<W, V>::new(accel, rays, active);
    walk.run::<false>();
    walk.finish()
}

#[inline(always)]
fn occluded_kernel<W: Wide, V: NarrowLanes>(accel: &Accel, rays: &RayPacket, active: u32) -> u32 {
    let mut walk = Walk::<W, V>::new(accel, rays, active);
    walk.run::<true>();
    walk.found
}

macro_rules! dispatch {
    ($name:ident $kernel:ident $avx2:ident $avx512:ident $doc:literal -> $output:ty) => {
        #[doc = $doc]
        #[inline]
        pub(crate) fn $name(isa: Isa, accel: &Accel, rays: &RayPacket, active: u32) -> $output {
            match isa {
                Isa::Portable => $kernel::<wide::Portable, Portable>(accel, rays, active),
                #[cfg(target_arch = "x86_64")]
                // SAFETY: values of `Isa` come from detection.
                Isa::Avx2 => unsafe { $avx2(accel, rays, active) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                Isa::Avx512 => unsafe { $avx512(accel, rays, active) },
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn $avx2(accel: &Accel, rays: &RayPacket, active: u32) -> $output {
            $kernel::<wide::Avx2, Avx2>(accel, rays, active)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq")]
        fn $avx512(accel: &Accel, rays: &RayPacket, active: u32) -> $output {
            $kernel::<wide::Avx512, Avx512>(accel, rays, active)
        }
    };
}
dispatch!(closest closest_kernel closest_avx2 closest_avx512 "The nearest hits of the active rays." -> HitPacket);
dispatch!(occluded occluded_kernel occluded_avx2 occluded_avx512 "The active rays that hit anything." -> u32);
