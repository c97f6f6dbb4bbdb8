//! From a description to an image.

use lichtweg::render::{Job, LayerSelection, Progress, RenderedImage};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{
    CameraDescription, Description, Diagnostics, EstimatorKind, FieldOfView, FilmDescription,
    FilterDescription, FovAxis, Heuristic, LightStrategy,
};
use lichtweg_ray::math::Affine;

/// The compiled scene; every finding, even a warning, is a failure.
pub fn compile_scene(description: &Description) -> Scene {
    let mut diagnostics = Diagnostics::default();
    let scene = Scene::compile(description, &mut diagnostics);
    assert!(diagnostics.list.is_empty(), "{:#?}", diagnostics.list);
    scene.expect("compiles without findings")
}

/// The job, without limit of time.
pub fn compile_job(description: &Description) -> Job {
    let mut diagnostics = Diagnostics::default();
    let job = Job::compile(description, LayerSelection::default(), None, &mut diagnostics);
    assert!(diagnostics.list.is_empty(), "{:#?}", diagnostics.list);
    job.expect("compiles without findings")
}

/// Renders; a sample that had to be dropped is a failure.
pub fn render(description: &Description) -> RenderedImage {
    render_scene(&compile_scene(description), description)
}

/// Renders a scene that is compiled already.
pub fn render_scene(scene: &Scene, description: &Description) -> RenderedImage {
    let rendering = compile_job(description).render(scene, &Progress::default()).expect("not stopped");
    let statistics = rendering.statistics;
    assert_eq!(statistics.dropped, 0, "first dropped: {:?}", statistics.first_dropped);
    rendering.image
}

/// A film of so many pixels with the box filter.
pub fn film(width: u32, height: u32) -> FilmDescription {
    FilmDescription { width, height, filter: FilterDescription::BOX, ..Default::default() }
}

/// A pinhole at `origin` that looks at `target`, with +y (or +z, where it looks along y) up.
pub fn camera(origin: [f64; 3], target: [f64; 3], degrees: f32) -> CameraDescription {
    let along_y = origin[0] == target[0] && origin[2] == target[2];
    let up = if along_y { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    CameraDescription {
        to_world: Affine::look_at(origin, target, up).expect("spans a frame"),
        field_of_view: FieldOfView::Angle { degrees, axis: FovAxis::X },
        ..Default::default()
    }
}

/// A way to carry light to the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    Naive,
    Nee,
    MisBalance,
    MisPower,
    Light,
    BidirectionalBalance,
    BidirectionalPower,
}

impl Estimator {
    pub const ALL: [Self; 4] = [Self::Naive, Self::Nee, Self::MisBalance, Self::MisPower];
    /// Walks from the lights, and from both ends.
    pub const ADJOINT: [Self; 3] = [Self::Light, Self::BidirectionalBalance, Self::BidirectionalPower];
    /// Those that find delta lights.
    pub const CONNECTING: [Self; 3] = [Self::Nee, Self::MisBalance, Self::MisPower];

    /// Asks for it.
    pub fn choose(self, description: &mut Description) {
        let integrator = &mut description.integrator;
        (integrator.estimator, integrator.light, integrator.heuristic) = match self {
            Self::Naive => (EstimatorKind::Path, LightStrategy::Naive, Heuristic::Power),
            Self::Nee => (EstimatorKind::Path, LightStrategy::Nee, Heuristic::Power),
            Self::MisBalance => (EstimatorKind::Path, LightStrategy::Mis, Heuristic::Balance),
            Self::MisPower => (EstimatorKind::Path, LightStrategy::Mis, Heuristic::Power),
            Self::Light => (EstimatorKind::Light, LightStrategy::Mis, Heuristic::Power),
            Self::BidirectionalBalance => {
                (EstimatorKind::Bidirectional, LightStrategy::Mis, Heuristic::Balance)
            }
            Self::BidirectionalPower => (EstimatorKind::Bidirectional, LightStrategy::Mis, Heuristic::Power),
        };
    }
}
