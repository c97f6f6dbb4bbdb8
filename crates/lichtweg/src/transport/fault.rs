//! Mistakes that the crate's own tests can make on purpose, to see that the comparisons of estimators notice. Outside of these
//! tests nothing of this is compiled.

/// A mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Connections from the side of the light without the cosine at the surface.
    Cosine,
    /// Importance that refraction scales like radiance.
    EtaSquared,
    /// No correction of the adjoint for shading normals.
    ShadingNormal,
    /// Weights that leave out one strategy: hits of lights by walks from the eye.
    Weights,
    /// Distant lights with densities per solid angle where those per area are asked for.
    DistantDensity,
    /// Camera importance that is even over solid angle rather than over the film.
    Importance,
    /// Weights that take lights to be chosen for connections as they are for walks.
    LightChoice,
}

/// Whether the running test makes the mistake.
#[cfg(not(test))]
#[inline(always)]
pub const fn is_seeded(_: Fault) -> bool {
    false
}

/// Whether the running test makes any mistake.
#[cfg(not(test))]
#[inline(always)]
pub const fn is_any_seeded() -> bool {
    false
}

#[cfg(test)]
pub use seed::{is_any_seeded, is_seeded, with_fault};

#[cfg(test)]
mod seed {
    use std::cell::Cell;

    use super::Fault;

    thread_local! {
        static SEEDED: Cell<Option<Fault>> = const { Cell::new(None) };
    }

    pub fn is_seeded(fault: Fault) -> bool {
        SEEDED.get() == Some(fault)
    }

    pub fn is_any_seeded() -> bool {
        SEEDED.get().is_some()
    }

    /// Does something with a fault, on one thread.
    pub fn with_fault<R: Send>(fault: Option<Fault>, action: impl FnOnce() -> R + Send) -> R {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
        pool.install(|| {
            SEEDED.set(fault);
            action()
        })
    }
}
