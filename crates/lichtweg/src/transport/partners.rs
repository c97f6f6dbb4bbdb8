//! Which vertices of walks from the lights each walk from the eye is joined with, in blocks of sixteen that scatter alike.

use lichtweg_montecarlo::{SamplerState, hash};
use lichtweg_ray::wide::{self, FloatLanes, Kernel, LANES, Lanes, Row, Wide};

use super::bidirectional::Pair;
use super::counting_sort::CountingSort;
use super::joint::{Joints, Kind};
use super::packets::rows_of;
use super::vertex::Trail;

/// Sixteen vertices, a column a quantity.
#[derive(Clone, Debug)]
pub struct Block {
    /// The columns of their rows.
    pub columns: [Lanes<f32>; LANES],
    /// See [`Label::number`](super::joint::Label); what is behind the last is infinite.
    pub numbers: Lanes<f32>,
    /// Which they are among all.
    pub joints: [u32; LANES],
    pub kind: BlockKind,
}

/// How the vertices of a block scatter.
#[derive(Clone, Copy, Debug)]
pub enum BlockKind {
    /// Diffusely.
    Reflectors,
    /// By single lobes, whose columns have this number.
    Lobes(u32),
    /// Each in its own way.
    General,
}

/// The vertices of walks from the lights, for each group of pairs.
#[derive(Debug, Default)]
pub struct Partners {
    by_walk: CountingSort,
    /// Those of one group, by kind.
    kinds: [Vec<u32>; 3],
    blocks: Vec<Block>,
    lobes: Vec<[[Lanes<f32>; LANES]; 2]>,
    /// Where those of each group begin in `blocks`.
    groups: Vec<u32>,
    /// The group of each pair.
    group: Vec<u32>,
}

impl Partners {
    /// From the vertices of the walks of some pairs, in rows, groups of `partners` of which share theirs.
    pub fn gather(&mut self, light: &Joints, pairs: &[Pair], row: usize, partners: usize) {
        let walks = light.labels.iter().map(|label| label.walk as usize);
        self.by_walk.sort(pairs.len(), walks);
        let groups_a_row = row.div_ceil(partners);
        self.group.clear();
        for (number, row) in pairs.chunks(row).enumerate() {
            self.deal(row, (number * groups_a_row) as u32, groups_a_row as u32);
        }
        self.blocks.clear();
        self.lobes.clear();
        self.groups.clear();
        for first in (0..pairs.len()).step_by(row) {
            for group in 0..groups_a_row {
                self.groups.push(self.blocks.len() as u32);
                self.kinds.iter_mut().for_each(Vec::clear);
                for partner in 0..partners {
                    let walk = first + (group + partner * groups_a_row) % row;
                    for &joint in self.by_walk.of(walk) {
                        let kind = match light.labels[joint as usize].kind {
                            Kind::Reflector => 0,
                            Kind::Lobe(..) => 1,
                            Kind::General => 2,
                        };
                        self.kinds[kind].push(joint);
                    }
                }
                self.push_blocks(light);
            }
        }
        self.groups.push(self.blocks.len() as u32);
    }

    /// The groups of a row's pairs. They are dealt by chance: pairs of a group err alike, and if they lay regularly their errors would
    /// be a pattern in the image. A pair that shares nothing keeps its own walk.
    fn deal(&mut self, row: &[Pair], first: u32, groups: u32) {
        let start = self.group.len();
        self.group.extend((0..row.len() as u32).map(|i| first + i % groups));
        if groups as usize >= row.len() {
            return;
        }
        let SamplerState { key, index, .. } = row[0].light.state();
        let seed = hash::combine(key, u64::from(index));
        for i in (1..row.len()).rev() {
            let u = hash::combine(seed, i as u64) >> 32;
            let other = (u * (i as u64 + 1)) >> 32;
            self.group.swap(start + i, start + other as usize);
        }
    }

    /// Makes blocks of the vertices of a group.
    fn push_blocks(&mut self, light: &Joints) {
        for (kind, joints) in self.kinds.iter().enumerate() {
            for joints in joints.chunks(LANES) {
                let kind = match kind {
                    0 => BlockKind::Reflectors,
                    1 => {
                        let mut rows = [0; LANES];
                        for (row, &joint) in rows.iter_mut().zip(joints) {
                            if let Kind::Lobe(number) = light.labels[joint as usize].kind {
                                *row = number;
                            }
                        }
                        let rows = &rows[..joints.len()];
                        let column = |part: usize| columns(rows_of(rows, |i| &light.lobes[i][part]));
                        self.lobes.push([column(0), column(1)]);
                        BlockKind::Lobes(self.lobes.len() as u32 - 1)
                    }
                    _ => BlockKind::General,
                };
                let mut block = Block {
                    columns: columns(rows_of(joints, |i| &light.rows[i])),
                    numbers: Lanes::splat(f32::INFINITY),
                    joints: [Trail::NONE; LANES],
                    kind,
                };
                for (lane, &joint) in joints.iter().enumerate() {
                    block.numbers.0[lane] = light.labels[joint as usize].number as f32;
                    block.joints[lane] = joint;
                }
                self.blocks.push(block);
            }
        }
    }

    /// What a pair is joined with.
    #[inline(always)]
    pub fn of(&self, pair: u32) -> &[Block] {
        let group = self.group[pair as usize] as usize;
        &self.blocks[self.groups[group] as usize..self.groups[group + 1] as usize]
    }

    /// The columns of the lobes of a block: directions to the vertices before, and materials.
    #[inline(always)]
    pub fn lobes(&self, number: u32) -> &[[Lanes<f32>; LANES]; 2] {
        &self.lobes[number as usize]
    }
}

/// Rows as columns in memory.
fn columns(rows: [&Row; LANES]) -> [Lanes<f32>; LANES] {
    wide::dispatch(Transpose(rows))
}

struct Transpose<'r>([&'r Row; LANES]);

impl Kernel for Transpose<'_> {
    type Output = [Lanes<f32>; LANES];

    #[inline(always)]
    fn run<W: Wide>(self) -> [Lanes<f32>; LANES] {
        let columns = W::F32::columns(&self.0);
        let mut out = [Lanes::splat(0.0); LANES];
        for i in 0..LANES {
            out[i] = columns[i].to_lanes();
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::{Sampler, SamplerKind};
    use lichtweg_ray::Ray;
    use lichtweg_ray::math::Vec3;

    use super::*;

    /// Groups are even, and which pixels are of one is left to chance, anew in each row.
    #[test]
    fn groups_make_no_pattern() {
        const ROW: usize = 256;
        let pair = |i: u32| {
            let sampler = |sample| Sampler::new(SamplerKind::Sobol, 5, u64::from(i / ROW as u32), sample);
            Pair { ray: Ray::new(Vec3::ZERO, Vec3::Z), eye: sampler(0), light: sampler(i), expected: 0.0 }
        };
        let pairs: Vec<Pair> = (0..4 * ROW as u32).map(pair).collect();
        let mut partners = Partners::default();
        partners.gather(&Joints::default(), &pairs, ROW, 16);
        for group in 0..64 {
            let members = partners.group.iter().filter(|&&g| g == group).count();
            assert_eq!(members, 16, "group {group}");
        }
        let rows: Vec<&[u32]> = partners.group.chunks(ROW).collect();
        let again = |lag: usize| (lag..ROW).filter(|&i| rows[0][i] == rows[0][i - lag]).count();
        // A sixteenth on average.
        assert!((1..64).all(|lag| again(lag) < 40), "{:?}", (1..64).map(again).collect::<Vec<_>>());
        let kept = (0..ROW).filter(|&i| rows[0][i] + 16 == rows[1][i]).count();
        assert!(kept < 40, "{kept} of {ROW}");
        partners.gather(&Joints::default(), &pairs, ROW, 1);
        assert!(partners.group.iter().enumerate().all(|(i, &g)| g as usize == i), "each its own");
    }
}
