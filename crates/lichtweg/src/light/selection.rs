//! Which light to connect to, and which one a walk begins at.

use lichtweg_montecarlo::distribution::AliasTable;

use super::tree::{LightBounds, LightTree, Receiver};
use crate::scene::description::LightChoiceKind;

/// Chooses lights.
///
/// A few are chosen by power, mixed with the uniform choice: power says nothing of distance and occlusion, and a light that
/// matters near by must not be starved by a strong one far away. Where there are many, those at a finite place are chosen by a
/// [`LightTree`], down to the triangle, and count as one among those infinitely far.
#[derive(Debug)]
pub struct LightSelection {
    table: Option<AliasTable>,
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

/// Lights at finite places.
#[derive(Debug)]
struct Places {
    tree: LightTree,
    /// Over the parts by their power.
    by_power: AliasTable,
    parts: Vec<Part>,
    /// By light: the number of its first part.
    first: Vec<Option<u32>>,
    /// The number that stands for them in the table, after those of all lights.
    entry: u32,
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
const POWER_SHARE: f64 = 0.1;

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
        if !by_place {
            return Self { table: mixed(&powers, uniform), places: None, by_power };
        }
        let power_of_placed: f32 = placed().map(|l| l.power).sum();
        let outside = lights.iter().map(|l| if l.parts.is_empty() { l.power } else { 0.0 });
        let table = mixed(&outside.chain([power_of_placed]).collect::<Vec<_>>(), uniform);
        let places = table.as_ref().and_then(|table| Places::new(lights, table.pmf(lights.len())));
        Self { table, places, by_power }
    }

    /// A light for a receiver, and the probability of its choice; `None` where there is none that can shine on it.
    #[inline]
    pub fn sample(&self, to: &Receiver, u: f32) -> Option<LightChoice> {
        let pick = self.table.as_ref()?.sample(u);
        match &self.places {
            Some(places) if pick.index as u32 == places.entry => places.sample(to, pick.remapped),
            _ => Some(LightChoice { light: pick.index as u32, triangle: None, probability: pick.pmf }),
        }
    }

    /// The same for some receivers at a time, those that have a number.
    #[inline(always)]
    pub fn sample_many<const N: usize>(
        &self,
        to: &[Receiver; N],
        u: &[Option<f32>; N],
    ) -> [Option<LightChoice>; N] {
        let Some(table) = &self.table else { return [None; N] };
        let mut choices = [None; N];
        let mut asking = [None; N];
        for ((choice, asks), u) in choices.iter_mut().zip(&mut asking).zip(u) {
            let Some(u) = *u else { continue };
            let pick = table.sample(u);
            match &self.places {
                Some(places) if pick.index as u32 == places.entry => *asks = Some(pick.remapped),
                _ => {
                    *choice =
                        Some(LightChoice { light: pick.index as u32, triangle: None, probability: pick.pmf })
                }
            }
        }
        if let Some(places) = &self.places {
            places.sample_many(to, &asking, &mut choices);
        }
        choices
    }

    /// [`LightChoice::probability`] of a point on a light: on a triangle, if the light is made of such.
    #[inline]
    pub fn probability(&self, to: &Receiver, light: u32, triangle: u32) -> f32 {
        match &self.places {
            Some(places) if places.first[light as usize].is_some() => places.probability(to, light, triangle),
            _ => self.table.as_ref().map_or(0.0, |t| t.pmf(light as usize)),
        }
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
        Some(Self {
            tree: LightTree::new(&bounds),
            by_power,
            parts,
            first,
            entry: lights.len() as u32,
            probability,
        })
    }

    #[inline]
    fn sample(&self, to: &Receiver, u: f32) -> Option<LightChoice> {
        match Ask::new(u) {
            Ask::Power(u) => Some(self.sample_by_power(to, u)),
            Ask::Tree(u) => self.tree.sample(to, u).map(|end| self.choice(end)),
        }
    }

    #[inline(always)]
    fn sample_many<const N: usize>(
        &self,
        to: &[Receiver; N],
        u: &[Option<f32>; N],
        choices: &mut [Option<LightChoice>; N],
    ) {
        let mut asking = [None; N];
        for (((choice, asks), to), u) in choices.iter_mut().zip(&mut asking).zip(to).zip(u) {
            match u.map(Ask::new) {
                Some(Ask::Power(u)) => *choice = Some(self.sample_by_power(to, u)),
                Some(Ask::Tree(u)) => *asks = Some(u),
                None => {}
            }
        }
        let ends = self.tree.sample_many(to, &asking);
        for (choice, end) in choices.iter_mut().zip(ends) {
            if let Some(end) = end {
                *choice = Some(self.choice(end));
            }
        }
    }

    #[inline(never)]
    fn sample_by_power(&self, to: &Receiver, u: f64) -> LightChoice {
        let part = self.by_power.sample_f64(u).index as u32;
        self.choice((part, self.tree.probability(to, part)))
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
        const SHARE: f32 = POWER_SHARE as f32;
        self.probability * (SHARE * part.power_share + (1.0 - SHARE) * by_tree) * part.inverse_share
    }
}

/// How a part is chosen, and what is left of the random number.
enum Ask {
    Power(f64),
    Tree(f64),
}

impl Ask {
    #[inline]
    fn new(u: f32) -> Self {
        let u = f64::from(u);
        match u < POWER_SHARE {
            true => Self::Power(u / POWER_SHARE),
            false => Self::Tree((u - POWER_SHARE) / (1.0 - POWER_SHARE)),
        }
    }
}

/// By power and uniformly, with this share of the latter.
fn mixed(powers: &[f32], uniform: f64) -> Option<AliasTable> {
    let total: f64 = powers.iter().map(|&p| f64::from(p)).sum();
    let lit = powers.iter().filter(|&&p| p > 0.0).count() as f64;
    let weight = |p: f32| match p > 0.0 {
        true => (1.0 - uniform) * f64::from(p) / total + uniform / lit,
        false => 0.0,
    };
    let weights: Vec<f64> = powers.iter().map(|&p| weight(p)).collect();
    AliasTable::new(&weights).ok()
}
