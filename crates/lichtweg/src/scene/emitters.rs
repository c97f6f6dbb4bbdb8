//! The surfaces that emit, by themselves: for rays that matter only where they run into light.

use lichtweg_ray::{Accel, BuildError, BuildOptions, BuildReport, Hit, HitPacket, Ray, RayPacket};

use super::{RayCounts, Scene, Shape};

/// A hierarchy over the emitting surfaces.
#[derive(Debug)]
pub(super) struct Emitters(Accel);

/// Of all primitives, this part may emit, at most: a ray that asks for light asks twice.
const FEW: u64 = 4;

impl Emitters {
    /// Over those of the shapes that emit; `None` where they are so many that asking for them first is no gain.
    pub fn new(shapes: &[Shape], all: &BuildReport) -> Result<Option<Self>, BuildError> {
        let emitting = || shapes.iter().filter(|s| s.light.is_some());
        let primitives: u64 = emitting().map(|s| s.form.triangles().max(1)).sum();
        if FEW * primitives > (all.triangles + all.quadrics + all.curve_segments) as u64 {
            return Ok(None);
        }
        Accel::build(emitting().map(|s| s.form.geometry()).collect(), BuildOptions::default())
            .map(|accel| Some(Self(accel)))
    }

    /// What building it took.
    pub fn report(&self) -> &BuildReport {
        self.0.report()
    }
}

impl Scene {
    /// What those of a packet's rays hit that run into light, and which they are: some others may be among them, but none that leave a
    /// scene with nothing around it.
    pub(crate) fn light_packet(
        &self,
        rays: &RayPacket,
        active: u32,
        counts: &mut RayCounts,
    ) -> (HitPacket, u32) {
        let Some(Emitters(emitters)) = self.emitters.as_ref().filter(|_| !self.has_holes) else {
            counts.closest += u64::from(active.count_ones());
            return (self.accel.closest_packet(rays, active), active);
        };
        let mut on_lights = 0;
        if !emitters.bounds().is_empty() {
            counts.occlusion += u64::from(active.count_ones());
            on_lights = emitters.occluded_packet(rays, active);
        }
        let mut lit = on_lights;
        if !self.is_dark_outside() {
            let others = active & !on_lights;
            counts.occlusion += u64::from(others.count_ones());
            lit |= others & !self.accel.occluded_packet(rays, others);
        }
        counts.closest += u64::from(on_lights.count_ones());
        (self.accel.closest_packet(rays, on_lights), lit)
    }

    /// [`Scene::light_packet`] for a single ray.
    pub(crate) fn light_hit(&self, ray: &Ray, counts: &mut RayCounts) -> (Option<Hit>, bool) {
        let mut rays = RayPacket::default();
        rays.set(0, ray);
        let (hits, lit) = self.light_packet(&rays, 1, counts);
        (hits.get(0), lit != 0)
    }
}
