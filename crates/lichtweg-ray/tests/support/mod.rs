//! What tests of queries share: a scene that can be asked primitive by primitive.
#![allow(dead_code)]

use std::sync::Arc;

use lichtweg_ray::math::{Bounds3, Vec3};
use lichtweg_ray::{
    Accel, BuildOptions, Geometry, Hit, Instance, MovingMesh, Placement, Quadric, Ray, TriangleMesh, UserHit,
    UserPrimitives,
};

pub fn build(geometries: Vec<Geometry>) -> Accel {
    Accel::build(geometries, BuildOptions::default()).expect("a sound scene")
}

/// A geometry that can be built, and taken apart.
#[derive(Clone, Debug)]
pub enum Source {
    Mesh(TriangleMesh),
    Quadric(Quadric),
    Moving(MovingMesh),
    User(Arc<Balls>),
    Group(Vec<Source>, Placement),
}

impl Source {
    pub fn geometry(&self) -> Geometry {
        match self {
            Self::Mesh(mesh) => mesh.clone().into(),
            Self::Quadric(quadric) => (*quadric).into(),
            Self::Moving(mesh) => mesh.clone().into(),
            Self::User(balls) => Geometry::User(balls.clone()),
            Self::Group(inner, placement) => {
                let accel = Arc::new(build(inner.iter().map(Self::geometry).collect()));
                Instance { accel, to_world: placement.clone() }.into()
            }
        }
    }
}

/// Balls of the caller's own, intersected in `f64`.
#[derive(Debug)]
pub struct Balls(pub Vec<(Vec3, f32)>);

impl UserPrimitives for Balls {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, primitive: u32) -> Bounds3 {
        let (center, radius) = self.0[primitive as usize];
        let size = center.abs().max_element() + radius;
        Bounds3 { min: center, max: center }.widened(radius + size * 1e-5)
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit> {
        let (center, radius) = self.0[primitive as usize];
        let wide = |v: Vec3| v.to_array().map(f64::from);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (o, d, center, radius) = (wide(ray.origin), wide(ray.direction), wide(center), f64::from(radius));
        let o = [0, 1, 2].map(|i| o[i] - center[i]);
        let (a, b, c) = (dot(d, d), dot(o, d), dot(o, o) - radius * radius);
        let root = (b * b - a * c).sqrt();
        let t = [(-b - root) / a, (-b + root) / a].map(|t| t as f32);
        t.into_iter().find(|t| *t > ray.tnear && *t <= ray.tfar).map(|t| UserHit { t, u: 0.25, v: 0.75 })
    }

    fn normal(&self, primitive: u32, ray: &Ray, hit: &UserHit) -> Vec3 {
        ray.at(hit.t) - self.0[primitive as usize].0
    }
}

/// Every primitive in turn: what the nearest of all their hits is.
pub enum OneByOne {
    /// A primitive in a structure of its own; a moving triangle is built for the ray's time.
    Single(u32, u32, Accel),
    MovingTriangle(u32, u32, MovingMesh),
    UserPrimitive(u32, u32, Arc<Balls>),
    Group(u32, Vec<OneByOne>, Placement),
}

impl OneByOne {
    pub fn all(sources: &[Source]) -> Vec<Self> {
        let mut all = Vec::new();
        for (g, source) in (0..).zip(sources) {
            match source {
                Source::Mesh(mesh) => all.extend((0..mesh.indices.len() as u32).map(|p| {
                    let single = TriangleMesh::new(mesh.corners(p).to_vec(), vec![[0, 1, 2]]);
                    Self::Single(g, p, build(vec![single.into()]))
                })),
                Source::Quadric(quadric) => all.push(Self::Single(g, 0, build(vec![(*quadric).into()]))),
                Source::Moving(mesh) => all
                    .extend((0..mesh.indices.len() as u32).map(|p| Self::MovingTriangle(g, p, mesh.clone()))),
                Source::User(balls) => {
                    all.extend((0..balls.0.len() as u32).map(|p| Self::UserPrimitive(g, p, balls.clone())));
                }
                Source::Group(inner, placement) => {
                    all.push(Self::Group(g, Self::all(inner), placement.clone()));
                }
            }
        }
        all
    }

    /// The nearest hit of all that `accept` lets count, of the lowest place among equals.
    pub fn closest(all: &[Self], ray: &Ray, accept: &dyn Fn(&Hit) -> bool) -> Option<Hit> {
        let hits = all.iter().filter_map(|one| one.nearest(ray, accept));
        hits.reduce(|a, b| if b.t < a.t { b } else { a })
    }

    fn nearest(&self, ray: &Ray, accept: &dyn Fn(&Hit) -> bool) -> Option<Hit> {
        if let Self::Group(g, inner, placement) = self {
            let map = placement.at(ray.time.clamp(0.0, 1.0)).inverse()?;
            let local = Ray { origin: map.point(ray.origin), direction: map.vector(ray.direction), ..*ray };
            let inside = |h: &Hit| Hit { instances: [*g, h.instances[0]], ..*h };
            return Self::closest(inner, &local, &|h| accept(&inside(h))).map(|h| inside(&h));
        }
        let mut from = ray.tnear;
        loop {
            let hit = self.first(&ray.between(from, ray.tfar))?;
            if accept(&hit) {
                return Some(hit);
            }
            from = hit.t;
        }
    }

    fn first(&self, ray: &Ray) -> Option<Hit> {
        let named = |g: u32, p: u32, hit: Hit| Hit { geometry: g, primitive: p, ..hit };
        match self {
            Self::Single(g, p, accel) => accel.closest(ray).map(|hit| named(*g, *p, hit)),
            Self::MovingTriangle(g, p, mesh) => {
                let corners = mesh.corners(*p, ray.time).to_vec();
                let still = build(vec![TriangleMesh::new(corners, vec![[0, 1, 2]]).into()]);
                still.closest(ray).map(|hit| named(*g, *p, hit))
            }
            Self::UserPrimitive(g, p, balls) => balls.intersect(*p, ray).map(|h| Hit {
                t: h.t,
                u: h.u,
                v: h.v,
                geometry: *g,
                primitive: *p,
                instances: [Hit::NO_INSTANCE; Hit::MAX_INSTANCES],
            }),
            Self::Group(..) => None,
        }
    }
}
