//! Which light to connect to, and which one a walk begins at.

use lichtweg_montecarlo::distribution::AliasTable;

use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Wide, WordLanes};

use super::few::FewTable;
use super::tree::{LightBounds, LightTree, Receiver};
use crate::lanes::{BELOW_ONE, lanes_of};
use crate::scene::description::LightChoiceKind;

/// Chooses lights.
///
/// A few are chosen by power, mixed with the uniform choice: power says nothing of distance and occlusion, and a light that
/// matters near by must not be starved by a strong one far away. Where there are many, those at a finite place are chosen by a
/// [`LightTree`], down to the triangle, and count as one among those infinitely far.
#[derive(Debug)]
pub struct LightSelection {
    table: Option<Table>,
    /// Those of the table's entries. The entry behind them, if there is one, stands for the lights at finite places.
    choices: Vec<LightChoice>,
    /// By light: the probability of the table's choice of it.
    of_light: Vec<f32>,
    places: Option<Places>,
    /// By power alone: where walks from the lights begin.
    by_power: Option<AliasTable>,
}

/// A light as the choice sees it.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Emitted power, of any unit.
    pub power: f32,
    /// What can be chosen of it, each with its share of the light's area: its triangles, or the light itself. Nothing if it is
    /// infinitely far.
    pub parts: Vec<(LightBounds, f32)>,
    /// Whether the parts are triangles.
    pub in_triangles: bool,
}

/// A choice for a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChoice {
    /// The light.
    pub light: u32,
    /// The triangle of it that points are to be chosen on; `None` is all of it.
    pub triangle: Option<u32>,
    /// The probability of the light. Of a triangle, its own probability over its share of the light's area: times a density that
    /// is even over the light, this is the density of points on the triangle.
    pub probability: f32,
}

/// Chooses entries.
#[derive(Debug)]
enum Table {
    Few(FewTable),
    Many(AliasTable),
}

/// Lights at finite places.
#[derive(Debug)]
struct Places {
    tree: LightTree,
    /// Over the parts by their power.
    by_power: AliasTable,
    parts: Vec<Part>,
    /// By light: the number of its first part.
    first: Vec<Option<u32>>,
    /// Probability that they are asked.
    probability: f32,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    light: u32,
    triangle: Option<u32>,
    /// One over its share of the light's area.
    inverse_share: f32,
    /// Its share of the power of all.
    power_share: f32,
}

/// Share of the uniform choice.
const UNIFORM_SHARE: f64 = 0.5;

/// Share of the choice by power where there is a tree, which knows nothing of occlusion.
const POWER_SHARE: f32 = 0.1;

/// A light of so many triangles is chosen with its triangle at once.
const FEW_TRIANGLES: usize = 16;

/// Lights at finite places that are worth a tree, however few their parts: from the third on, what the choice by place costs (a tenth
/// to a fifth of a path) is less than what it gains.
const MANY_LIGHTS: usize = 3;

/// Parts at finite places that are worth a tree, even of a single light.
const MANY_PARTS: usize = 16;

impl LightSelection {
    /// Over lights by their number; those without power are never chosen.
    pub fn new(lights: &[Candidate], kind: LightChoiceKind) -> Self {
        let powers: Vec<f32> = lights.iter().map(|l| l.power).collect();
        let by_power = AliasTable::new(&powers).ok();
        let uniform = match kind {
            LightChoiceKind::Uniform => 1.0,
            LightChoiceKind::Power => 0.0,
            LightChoiceKind::Auto | LightChoiceKind::Tree => UNIFORM_SHARE,
        };
        let placed = || lights.iter().filter(|l| l.power > 0.0 && !l.parts.is_empty());
        let parts: usize = placed().map(|l| l.parts.len()).sum();
        let by_place = match kind {
            LightChoiceKind::Auto => placed().count() >= MANY_LIGHTS || parts >= MANY_PARTS,
            LightChoiceKind::Tree => parts > 0,
            LightChoiceKind::Uniform | LightChoiceKind::Power => false,
        };
        let mut shares = powers;
        let mut places = None;
        if by_place {
            let power_of_placed: f32 = placed().map(|l| l.power).sum();
            for (share, light) in shares.iter_mut().zip(lights) {
                *share = if light.parts.is_empty() { *share } else { 0.0 };
            }
            shares.push(power_of_placed);
            mix(&mut shares, uniform);
            places = shares.pop().and_then(|probability| Places::new(lights, probability));
        } else {
            mix(&mut shares, uniform);
        }
        let (choices, mut weights) = entries(lights, &shares);
        weights.extend(places.as_ref().map(|places| places.probability));
        let table = AliasTable::new(&weights).ok().map(Table::new);
        Self { table, choices, of_light: shares, places, by_power }
    }

    /// A light for a receiver, and the probability of its choice; `None` where there is none that can shine on it.
    #[inline]
    pub fn sample(&self, to: &Receiver, u: f32) -> Option<LightChoice> {
        let (entry, rest) = self.table.as_ref()?.sample(u);
        match self.choices.get(entry as usize) {
            Some(choice) => Some(*choice),
            None => self.places.as_ref()?.sample(to, rest),
        }
    }

    /// The same for some of sixteen receivers.
    #[inline(always)]
    pub fn sample_lanes<W: Wide>(
        &self,
        to: &Receiver<W::F32>,
        u: W::F32,
        lanes: u32,
    ) -> [Option<LightChoice>; LANES] {
        let mut choices = [None; LANES];
        let Some(table) = &self.table else { return choices };
        let (entry, rest) = table.sample_lanes::<W>(u);
        let entry = entry.to_lanes();
        let mut asking = 0;
        for lane in lanes_of(lanes) {
            choices[lane] = self.choices.get(entry.0[lane] as usize).copied();
            asking |= u32::from(choices[lane].is_none()) << lane;
        }
        if asking != 0
            && let Some(places) = &self.places
        {
            places.sample_lanes::<W>(to, rest, asking, &mut choices);
        }
        choices
    }

    /// [`LightChoice::probability`] of a point on a light: on a triangle, if the light is made of such.
    #[inline]
    pub fn probability(&self, to: &Receiver, light: u32, triangle: u32) -> f32 {
        match &self.places {
            Some(places) if places.first[light as usize].is_some() => places.probability(to, light, triangle),
            _ => self.of_light[light as usize],
        }
    }

    /// [`LightChoice::probability`] of a light that is around the scene, for every receiver.
    #[inline]
    pub fn probability_around(&self, light: u32) -> f32 {
        self.of_light[light as usize]
    }

    /// [`LightSelection::probability`] for some of sixteen receivers and the lights there; of no meaning for others.
    #[inline(always)]
    pub fn probability_lanes<W: Wide>(
        &self,
        to: &Receiver<W::F32>,
        lights: &Lanes<u32>,
        triangles: &Lanes<u32>,
        lanes: u32,
    ) -> W::F32 {
        let mut probability = Lanes::splat(0.0);
        let (mut parts, mut placed) = (Lanes::splat(0), 0);
        for lane in lanes_of(lanes) {
            let light = lights.0[lane] as usize;
            match self.places.as_ref().and_then(|places| places.first[light]) {
                Some(first) => {
                    placed |= 1 << lane;
                    parts.0[lane] = first + triangles.0[lane];
                }
                None => probability.0[lane] = self.of_light[light],
            }
        }
        if placed != 0
            && let Some(places) = &self.places
        {
            let root = places.tree.root_importances::<W>(to);
            let by_tree = places.tree.probability_lanes::<W>(&root, to, &parts, placed).to_lanes();
            for lane in lanes_of(placed) {
                let part = &places.parts[parts.0[lane] as usize];
                probability.0[lane] = places.probability_of(part, by_tree.0[lane]);
            }
        }
        W::F32::load(&probability)
    }

    /// Whether it makes a difference where a receiver is, and how it is turned.
    #[inline]
    pub fn is_by_place(&self) -> bool {
        self.places.is_some()
    }

    /// A light for a walk to begin at, chosen by power, and the probability of its choice.
    #[inline]
    pub fn sample_emitter(&self, u: f64) -> Option<(u32, f32)> {
        let pick = self.by_power.as_ref()?.sample_f64(u);
        Some((pick.index as u32, pick.pmf))
    }

    /// Probability that [`LightSelection::sample_emitter`] chooses a light.
    #[inline]
    pub fn emitter_probability(&self, light: u32) -> f32 {
        self.by_power.as_ref().map_or(0.0, |t| t.pmf(light as usize))
    }
}

impl Places {
    /// `None` where nothing at a finite place shines.
    fn new(lights: &[Candidate], probability: f32) -> Option<Self> {
        let mut first = Vec::with_capacity(lights.len());
        let (mut parts, mut bounds, mut powers) = (Vec::new(), Vec::new(), Vec::new());
        for (number, light) in (0..).zip(lights) {
            first.push((!light.parts.is_empty()).then_some(parts.len() as u32));
            for (i, (part, share)) in (0..).zip(&light.parts) {
                let triangle = light.in_triangles.then_some(i);
                parts.push(Part {
                    light: number,
                    triangle,
                    power_share: 0.0,
                    inverse_share: if *share > 0.0 { 1.0 / share } else { 0.0 },
                });
                bounds.push(*part);
                powers.push(light.power * share);
            }
        }
        let by_power = AliasTable::new(&powers).ok()?;
        parts.iter_mut().enumerate().for_each(|(i, part)| part.power_share = by_power.pmf(i));
        Some(Self { tree: LightTree::new(&bounds), by_power, parts, first, probability })
    }

    #[inline]
    fn sample(&self, to: &Receiver, u: f32) -> Option<LightChoice> {
        match u < POWER_SHARE {
            true => {
                let part = self.part_by_power(u);
                Some(self.choice((part, self.tree.probability(to, part))))
            }
            false => self.tree.sample(to, of_tree(u)).map(|end| self.choice(end)),
        }
    }

    #[inline(always)]
    fn sample_lanes<W: Wide>(
        &self,
        to: &Receiver<W::F32>,
        u: W::F32,
        lanes: u32,
        choices: &mut [Option<LightChoice>; LANES],
    ) {
        let by_power = u.lt(W::F32::splat(POWER_SHARE)).bits() & lanes;
        let root = self.tree.root_importances::<W>(to);
        let ends = self.tree.sample_lanes::<W>(&root, to, of_tree(u), lanes & !by_power);
        for (choice, end) in choices.iter_mut().zip(ends) {
            if let Some(end) = end {
                *choice = Some(self.choice(end));
            }
        }
        if by_power != 0 {
            let (u, mut parts) = (u.to_lanes(), Lanes::splat(0));
            lanes_of(by_power).for_each(|lane| parts.0[lane] = self.part_by_power(u.0[lane]));
            let by_tree = self.tree.probability_lanes::<W>(&root, to, &parts, by_power).to_lanes();
            for lane in lanes_of(by_power) {
                choices[lane] = Some(self.choice((parts.0[lane], by_tree.0[lane])));
            }
        }
    }

    /// A part by a number below the share of the choice by power.
    #[inline(never)]
    fn part_by_power(&self, u: f32) -> u32 {
        self.by_power.sample_f64(f64::from(u) / f64::from(POWER_SHARE)).index as u32
    }

    /// A part with its probability in the tree.
    #[inline]
    fn choice(&self, (part, by_tree): (u32, f32)) -> LightChoice {
        let part = &self.parts[part as usize];
        let probability = self.probability_of(part, by_tree);
        LightChoice { light: part.light, triangle: part.triangle, probability }
    }

    #[inline]
    fn probability(&self, to: &Receiver, light: u32, triangle: u32) -> f32 {
        let Some(part) = self.first[light as usize].map(|first| first + triangle) else { return 0.0 };
        self.probability_of(&self.parts[part as usize], self.tree.probability(to, part))
    }

    #[inline]
    fn probability_of(&self, part: &Part, by_tree: f32) -> f32 {
        self.probability
            * (POWER_SHARE * part.power_share + (1.0 - POWER_SHARE) * by_tree)
            * part.inverse_share
    }
}

/// What is left, for the tree, of a number that is not below the share of the choice by power.
#[inline(always)]
fn of_tree<F: Float>(u: F) -> F {
    ((u - F::splat(POWER_SHARE)) / F::splat(1.0 - POWER_SHARE)).min(F::splat(BELOW_ONE))
}

impl Table {
    fn new(table: AliasTable) -> Self {
        match table.len() <= FewTable::MOST {
            true => Self::Few(FewTable::new(&table)),
            false => Self::Many(table),
        }
    }

    /// An entry, and what is left of the number.
    #[inline]
    fn sample(&self, u: f32) -> (u32, f32) {
        match self {
            Self::Few(table) => table.sample(u),
            Self::Many(table) => {
                let pick = table.sample(u);
                (pick.index as u32, pick.remapped)
            }
        }
    }

    #[inline(always)]
    fn sample_lanes<W: Wide>(&self, u: W::F32) -> (W::U32, W::F32) {
        if let Self::Few(table) = self {
            return table.sample_lanes::<W>(u);
        }
        let (mut entries, mut rests) = (Lanes::splat(0), u.to_lanes());
        for (entry, rest) in entries.0.iter_mut().zip(&mut rests.0) {
            (*entry, *rest) = self.sample(*rest);
        }
        (W::U32::load(&entries), W::F32::load(&rests))
    }
}

/// What is chosen at once: lights, or triangles of those that have few. With the weight of each.
fn entries(lights: &[Candidate], shares: &[f32]) -> (Vec<LightChoice>, Vec<f32>) {
    let mut entries = Vec::with_capacity(lights.len());
    for ((number, light), &probability) in (0..).zip(lights).zip(shares) {
        let choice = LightChoice { light: number, triangle: None, probability };
        if probability == 0.0 {
            continue;
        }
        if light.in_triangles && light.parts.len() <= FEW_TRIANGLES {
            let triangles = (0..).zip(&light.parts).map(|(triangle, (_, share))| {
                (LightChoice { triangle: Some(triangle), ..choice }, probability * share)
            });
            entries.extend(triangles.filter(|(_, weight)| *weight > 0.0));
        } else {
            entries.push((choice, probability));
        }
    }
    entries.into_iter().unzip()
}

/// Turns powers into probabilities: by power, mixed with the uniform choice by its share.
fn mix(powers: &mut [f32], uniform: f64) {
    let total: f64 = powers.iter().map(|&p| f64::from(p)).sum();
    let lit = powers.iter().filter(|&&p| p > 0.0).count() as f64;
    for p in powers.iter_mut().filter(|p| **p > 0.0) {
        *p = ((1.0 - uniform) * f64::from(*p) / total + uniform / lit) as f32;
    }
}
