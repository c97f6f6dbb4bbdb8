//! How a ray goes through the hierarchy: depth first, near children before far ones.

use std::mem::MaybeUninit;

use super::layout::{Block, Bvh, ChildRef, Node};
use super::slab::{Slab, prepare};
use crate::accel::Accel;
use crate::counts;
use crate::kind::{self, Probe};
use crate::ray::{Accept, Hit, Ray};
use crate::simd::{Lanes, WIDTH};
use crate::triangle::{BlockHits, TriangleHit, WideShear};

/// Levels of the tree, at most; the builder sees to it.
pub(crate) const MAX_DEPTH: usize = 72;
const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1 + WIDTH;

/// Children put off until later, as (entry t, child) packed so that integers order like distances.
///
/// The entries live elsewhere, so that the top can live in a register.
struct Stack {
    top: *mut u64,
    base: *mut u64,
}

type Entries = [MaybeUninit<u64>; STACK];

#[inline(always)]
fn pack(enter: f32, child: ChildRef) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child.0)
}

impl Stack {
    #[inline(always)]
    fn push(&mut self, entry: u64) {
        // SAFETY: the builder bounds the depth; each level leaves at most WIDTH - 1 entries behind.
        unsafe {
            debug_assert!(self.top < self.base.add(STACK));
            self.top.write(entry);
            self.top = self.top.add(1);
        }
    }

    /// The top entry that begins at `tfar` or before.
    #[inline(always)]
    fn pop(&mut self, tfar: f32) -> Option<ChildRef> {
        while self.top != self.base {
            // SAFETY: entries below the top were written.
            let entry = unsafe {
                self.top = self.top.sub(1);
                self.top.read()
            };
            if (entry >> 32) as u32 <= tfar.to_bits() {
                return Some(ChildRef(entry as u32));
            }
        }
        None
    }

    /// Puts the top `count` entries in order, nearest on top.
    #[inline(always)]
    fn sort_top(&mut self, count: usize) {
        // SAFETY: the top `count` entries were written.
        let top = unsafe { std::slice::from_raw_parts_mut(self.top.sub(count), count) };
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

/// The nearest hit so far.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    /// Running number of the primitive.
    pub id: u32,
}

impl Best {
    pub(crate) const NOTHING: u32 = u32::MAX;

    fn none(tfar: f32) -> Self {
        Self { t: tfar, u: 0.0, v: 0.0, id: Self::NOTHING }
    }

    /// Takes a hit with `t <= self.t`, if it is the better one: of equally near ones the lowest number wins, then
    /// the lowest u, and nothing has the highest number.
    #[inline(always)]
    pub(crate) fn consider(&mut self, hit: TriangleHit, id: u32) -> bool {
        let better = hit.t < self.t || id < self.id || (id == self.id && hit.u < self.u);
        if better {
            *self = Self { t: hit.t, u: hit.u, v: hit.v, id };
        }
        better
    }
}

/// The nearest hit so far of what is no triangle of a block.
#[derive(Clone, Copy)]
pub(crate) struct Other {
    hit: Hit,
    id: u32,
}

impl Other {
    pub(crate) const NONE: Self = Self { hit: Hit::NONE, id: Best::NOTHING };

    /// Takes a hit that its kind has not completed yet, and its running number.
    #[inline(always)]
    pub(crate) fn set(&mut self, hit: Hit, id: u32) {
        (self.hit, self.id) = (hit, id);
    }

    /// Running number of the primitive, or [`Best::NOTHING`].
    #[inline(always)]
    pub(crate) fn id(&self) -> u32 {
        self.id
    }
}

/// The nearest hit, or with `ANY` an arbitrary one, of which only the existence means something. With `FILTERED`
/// hits count only where masks and `accept` let them; without, neither is looked at.
#[inline(always)]
pub(crate) fn traverse<V: Lanes, const ANY: bool, const FILTERED: bool>(
    accel: &Accel,
    ray: &Ray,
    accept: Option<Accept>,
) -> Option<Hit> {
    let (slab, shear, tfar) = prepare::<V>(ray, accel.bvh.reach)?;
    let prepared = (slab, WideShear::<V>::new(&shear));
    let mut best = Best::none(tfar);
    let mut other = Other::NONE;
    let root = accel.bvh.root;
    if descend::<V, ANY, FILTERED>(accel, ray, &prepared, accept, &mut best, &mut other, root) {
        return Some(Hit::NONE);
    }
    best.hit(accel, ray, &other)
}

impl Best {
    /// Names what was hit.
    #[inline(always)]
    pub(crate) fn hit(&self, accel: &Accel, ray: &Ray, other: &Other) -> Option<Hit> {
        if self.id == Self::NOTHING {
            return None;
        }
        if self.id == other.id && other.hit.is_instanced() {
            return Some(other.hit);
        }
        if self.id == other.id {
            return Some(accel.kinds[other.hit.geometry as usize].completed(ray, other.hit));
        }
        let (geometry, primitive) = accel.bvh.numbering.locate(self.id);
        Some(Hit::plain(self.t, self.u, self.v, geometry, primitive))
    }
}

/// Looks for something nearer than `best` in and below a child; with `ANY`, whether there is anything.
#[inline(always)]
pub(crate) fn descend<V: Lanes, const ANY: bool, const FILTERED: bool>(
    accel: &Accel,
    ray: &Ray,
    (slab, shear): &(Slab<V>, WideShear<V>),
    accept: Option<Accept>,
    best: &mut Best,
    other: &mut Other,
    mut current: ChildRef,
) -> bool {
    let bvh = &accel.bvh;
    let mut entries: Entries = [const { MaybeUninit::uninit() }; STACK];
    let base = entries.as_mut_ptr().cast();
    let mut stack = Stack { top: base, base };
    loop {
        match go::<V, ANY, FILTERED>(bvh, slab, shear, best, &mut stack, current) {
            Event::Done => return false,
            Event::Found => return true,
            Event::Block(index) => {
                let block = &bvh.blocks[index];
                for lane in 0..WIDTH {
                    let Some(h) = shear.settle(block, lane, best.t) else { continue };
                    if FILTERED && !accel.accepts(ray, h, block.ids[lane], accept) {
                        continue;
                    }
                    if ANY {
                        return true;
                    }
                    best.consider(h, block.ids[lane]);
                }
            }
            Event::Others(leaf) => {
                let probe = Probe { ray, isa: V::ISA, shear: shear.scalar() };
                if best.meet::<ANY, FILTERED>(accel, leaf, &probe, accept, other) && ANY {
                    return true;
                }
            }
        }
        match stack.pop(best.t) {
            Some(next) => current = next,
            None => return false,
        }
    }
}

impl Best {
    /// Takes the nearest hit in a leaf of other primitives, if it is the better one; whether there is any.
    #[inline(always)]
    pub(crate) fn meet<const ANY: bool, const FILTERED: bool>(
        &mut self,
        accel: &Accel,
        leaf: ChildRef,
        probe: &Probe,
        accept: Option<Accept>,
        other: &mut Other,
    ) -> bool {
        let nearest = kind::nearest::<ANY, FILTERED>(accel, leaf, probe, self.t, accept);
        let Some((hit, id)) = nearest else { return false };
        if self.consider(TriangleHit { t: hit.t, u: hit.u, v: hit.v }, id) {
            other.set(hit, id);
        }
        true
    }
}

/// Why the fast loop stops.
enum Event {
    /// Nothing is left to visit.
    Done,
    /// Any hit was wanted and one was found.
    Found,
    /// A block has triangles that need the slow test, or hits that need to be accepted.
    Block(usize),
    /// A leaf of other primitives.
    Others(ChildRef),
}

/// The fast loop. It calls no function, so that its constants stay in registers.
#[inline(always)]
fn go<V: Lanes, const ANY: bool, const FILTERED: bool>(
    bvh: &Bvh,
    slab: &Slab<V>,
    shear: &WideShear<V>,
    best: &mut Best,
    stack: &mut Stack,
    mut current: ChildRef,
) -> Event {
    let mut end = shear.end(best.t);
    loop {
        while !current.is_leaf() {
            counts::node();
            // SAFETY: inner references of the builder are indices of nodes.
            let node = unsafe { bvh.nodes.get_unchecked(current.node()) };
            // SAFETY: the planes are the node's six aligned rows.
            let (mut mask, enter) = unsafe { slab.meet((&raw const node.planes).cast(), end.t) };
            if mask == 0 {
                match stack.pop(best.t) {
                    Some(next) => {
                        current = next;
                        continue;
                    }
                    None => return Event::Done,
                }
            }
            let first = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            if mask == 0 {
                current = child(node, first);
                continue;
            }
            if ANY {
                // Lower slots are larger boxes, more likely to be hit: they come first.
                loop {
                    let slot = 31 - mask.leading_zeros();
                    let next = child(node, slot as usize & 7);
                    mask ^= 1 << slot;
                    fetch(bvh, next);
                    stack.push(pack(0.0, next));
                    if mask == 0 {
                        break;
                    }
                }
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
                let (near, far) = in_order(a, b);
                fetch(bvh, ChildRef(far as u32));
                stack.push(far);
                current = ChildRef(near as u32);
                continue;
            }
            let third = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let c = entry(third);
            fetch(bvh, ChildRef(a as u32));
            fetch(bvh, ChildRef(b as u32));
            fetch(bvh, ChildRef(c as u32));
            let (a, b) = in_order(a, b);
            let (b, c) = in_order(b, c);
            let (a, b) = in_order(a, b);
            stack.push(c);
            stack.push(b);
            if mask == 0 {
                current = ChildRef(a as u32);
                continue;
            }
            stack.push(a);
            let mut count = 3;
            while mask != 0 {
                let e = entry(mask.trailing_zeros() as usize);
                fetch(bvh, ChildRef(e as u32));
                stack.push(e);
                mask &= mask - 1;
                count += 1;
            }
            stack.sort_top(count);
            // SAFETY: just written.
            current = ChildRef(unsafe {
                stack.top = stack.top.sub(1);
                stack.top.read()
            } as u32);
        }

        let (begin, count) = current.leaf();
        if current.is_other() {
            return Event::Others(current);
        }
        for index in begin..begin + count {
            counts::block();
            // SAFETY: leaf references of the builder are ranges of blocks.
            let block = unsafe { bvh.blocks.get_unchecked(index) };
            let hits = shear.intersect(block, &end);
            if hits.mask != 0 {
                if FILTERED || hits.doubt {
                    let rest = begin + count - index - 1;
                    if rest != 0 {
                        stack.push(pack(0.0, ChildRef::triangles(index + 1, rest)));
                    }
                    return Event::Block(index);
                }
                if ANY {
                    return Event::Found;
                }
                take(best, &hits, block);
                end = shear.end(best.t);
            }
        }
        match stack.pop(best.t) {
            Some(next) => current = next,
            None => return Event::Done,
        }
    }
}

/// Asks for the memory of a child that will be visited later.
#[inline(always)]
fn fetch(bvh: &Bvh, c: ChildRef) {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    {
        use std::arch::x86_64::*;
        let leaf = c.is_leaf();
        let start = if leaf { bvh.blocks.as_ptr().cast::<i8>() } else { bvh.nodes.as_ptr().cast() };
        let index = (c.0 & 0x7ff_ffff) as usize;
        let extra = if leaf { usize::MAX } else { 0 };
        let start = start.wrapping_add(index * 256).wrapping_add(index << 6 & extra);
        for line in [0, 64, 128, 192, 192 + (64 & extra)] {
            // SAFETY: a prefetch may name any address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line)) };
        }
    }
}

/// The smaller and the larger of two.
#[inline(always)]
fn in_order(a: u64, b: u64) -> (u64, u64) {
    (a.min(b), a.max(b))
}

#[inline(always)]
fn child(node: &Node, slot: usize) -> ChildRef {
    // SAFETY: slots come from masks of eight lanes.
    unsafe { *node.children.get_unchecked(slot) }
}

#[inline(always)]
pub(crate) fn take<V: Lanes>(best: &mut Best, hits: &BlockHits<V>, block: &Block) {
    let t = hits.t();
    let mut mask = hits.mask;
    let mut nearest = mask.trailing_zeros() as usize & 7;
    mask &= mask - 1;
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize & 7;
        mask &= mask - 1;
        // Lanes are in order of number: the first of equals stays.
        if t[lane] < t[nearest] {
            nearest = lane;
        }
    }
    best.consider(hits.lane(nearest), block.ids[nearest]);
}
