//! Which estimator, and where its random numbers come from.

use lichtweg_montecarlo::SamplerKind;

use super::Span;

/// The estimator a scene asks for.
#[derive(Clone, Debug)]
pub struct IntegratorDescription {
    /// Where it was stated.
    pub span: Span,
    /// Which one.
    pub estimator: EstimatorKind,
    /// Which paths of walks from the eye carry light.
    pub light: LightStrategy,
    /// How two strategies for one path are weighted.
    pub heuristic: Heuristic,
    /// How vertices choose the light that they are connected to.
    pub light_choice: LightChoiceKind,
    /// Largest number of path edges (1: emitters seen directly, 2: direct light); `None` is unlimited.
    pub max_depth: Option<u32>,
    /// When paths may end early.
    pub roulette: RouletteDescription,
    /// Do not show emitters that the camera sees directly.
    pub hide_emitters: bool,
}

impl Default for IntegratorDescription {
    fn default() -> Self {
        Self {
            span: Span::default(),
            estimator: EstimatorKind::Path,
            light: LightStrategy::Mis,
            heuristic: Heuristic::Power,
            light_choice: LightChoiceKind::Auto,
            max_depth: None,
            roulette: RouletteDescription::default(),
            hide_emitters: false,
        }
    }
}

/// From which end the walks start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EstimatorKind {
    /// The eye: path tracing.
    Path,
    /// The lights: light tracing.
    Light,
    /// Both: bidirectional path tracing.
    Bidirectional,
}

/// Which paths carry light to the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LightStrategy {
    /// Follow the BSDF and count the lights that are hit.
    Naive,
    /// Connect every vertex to a sampled light; count hits only where no connection could find them.
    Nee,
    /// Both, weighted by multiple importance sampling.
    Mis,
}

/// The weight of a strategy with density p_i among densities p_j (Veach 1997, section 9.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Heuristic {
    /// p_i / sum p_j.
    Balance,
    /// p_i^2 / sum p_j^2.
    Power,
}

/// How a vertex chooses the light that it is connected to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LightChoiceKind {
    /// Half by power and half uniformly where there are few; by place where there are many.
    Auto,
    /// All lights alike.
    Uniform,
    /// By emitted power.
    Power,
    /// By a tree that knows the places and directions of lights, and of their triangles.
    Tree,
}

/// Russian roulette by throughput.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RouletteDescription {
    /// The first depth (in path edges) at which a path may end; `None` never.
    pub start_depth: Option<u32>,
}

impl Default for RouletteDescription {
    /// From the fifth edge on, as in Mitsuba.
    fn default() -> Self {
        Self { start_depth: Some(5) }
    }
}

/// The random numbers a scene asks for.
#[derive(Clone, Debug)]
pub struct SamplerDescription {
    /// Where it was stated.
    pub span: Span,
    /// Which sequence.
    pub kind: SamplerKind,
    /// Samples a pixel.
    pub samples_per_pixel: u32,
    /// Seed.
    pub seed: u64,
}

impl Default for SamplerDescription {
    fn default() -> Self {
        Self { span: Span::default(), kind: SamplerKind::Independent, samples_per_pixel: 64, seed: 0 }
    }
}
