//! Just enough of Embree 4's C interface, opened at run time, to measure against.

use std::ffi::{c_char, c_void};
use std::ptr::null;
use std::sync::atomic::{AtomicI64, Ordering};

use libloading::Library;
use lichtweg_ray::{CurveBasis, CurvePoint, Curves, Ray};

use super::scenes::Scene;
use super::scenes::curves::POINTS;

/// RTCRayHit (with room to spare).
#[derive(Clone, Copy, Default)]
#[repr(C, align(16))]
pub struct RayHit {
    origin: [f32; 3],
    tnear: f32,
    direction: [f32; 3],
    time: f32,
    pub tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub primitive: u32,
    pub geometry: u32,
    instance: [u32; 8],
}

impl RayHit {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            tnear: ray.tnear,
            direction: ray.direction.to_array(),
            tfar: ray.tfar,
            mask: u32::MAX,
            primitive: u32::MAX,
            geometry: u32::MAX,
            instance: [u32::MAX; 8],
            ..Self::default()
        }
    }
}

type Handle = *mut c_void;
type Query = unsafe extern "C" fn(Handle, *mut RayHit, *const c_void);

/// How to build a scene.
#[derive(Clone, Copy, PartialEq)]
pub enum Mode {
    Medium,
    High,
    /// With the watertight triangle test; Embree then builds with medium quality, whatever is asked for.
    Robust,
}

/// The arrays of a geometry, vertices with the padding that Embree demands.
struct Source {
    /// RTCGeometryType.
    geometry: i32,
    vertices: Vec<f32>,
    /// Values a vertex.
    vertex_width: usize,
    indices: Vec<u32>,
    /// Values a primitive.
    index_width: usize,
}

impl Source {
    fn triangles(scene: &Scene) -> Self {
        let mut vertices: Vec<f32> = scene.positions.iter().flat_map(|p| p.to_array()).collect();
        vertices.push(0.0);
        Self { geometry: 0, vertices, vertex_width: 3, indices: scene.indices.concat(), index_width: 3 }
    }

    /// All curves of the same number of points.
    fn round_curves(curves: &Curves) -> Self {
        let point = |p: &CurvePoint| [p.position.x, p.position.y, p.position.z, p.radius];
        let (order, step) = (curves.basis().order(), curves.basis().step());
        let geometry = match curves.basis() {
            CurveBasis::Linear => 16,
            CurveBasis::Bezier => 24,
            CurveBasis::BSpline => 32,
        };
        let firsts = (0..curves.points().len() as u32).step_by(POINTS);
        let of_curve = |first: u32| (first..=first + (POINTS - order) as u32).step_by(step);
        Self {
            geometry,
            vertices: curves.points().iter().flat_map(point).collect(),
            vertex_width: 4,
            indices: firsts.flat_map(of_curve).collect(),
            index_width: 1,
        }
    }
}

/// A committed scene.
pub struct Embree {
    scene: Handle,
    device: Handle,
    release_scene: extern "C" fn(Handle),
    release_device: extern "C" fn(Handle),
    intersect: Query,
    occluded: Query,
    pub build_seconds: f64,
    /// What the library holds after the build, the shared arrays not among it.
    pub bytes: i64,
    // Shared with the scene.
    _source: Source,
    // The library counts into it until the device is gone.
    _held: Box<AtomicI64>,
    _library: &'static Library,
}

impl Embree {
    /// Opens the library at `path`.
    pub fn open(path: &str) -> Option<&'static Library> {
        // SAFETY: the user names a libembree4.
        match unsafe { Library::new(path) } {
            Ok(library) => Some(Box::leak(Box::new(library))),
            Err(e) => {
                eprintln!("cannot open {path}: {e}");
                None
            }
        }
    }

    /// Builds a scene of triangles. `EMBREE_CONFIG` is handed on to the device.
    pub fn build(library: &'static Library, scene: &Scene, mode: Mode) -> Self {
        Self::commit(library, Source::triangles(scene), mode)
    }

    /// Builds a scene of round curves.
    pub fn build_curves(library: &'static Library, curves: &Curves) -> Self {
        Self::commit(library, Source::round_curves(curves), Mode::High)
    }

    fn commit(library: &'static Library, source: Source, mode: Mode) -> Self {
        let quality = if mode == Mode::High { 2 } else { 1 };
        let flags = if mode == Mode::Robust { 4 } else { 0 };
        let config = std::env::var("EMBREE_CONFIG").unwrap_or_default() + "\0";
        // SAFETY: names and signatures are those of rtcore.h; buffers live in the returned value.
        unsafe {
            let new_device: extern "C" fn(*const c_char) -> Handle = symbol(library, "rtcNewDevice");
            let new_scene: extern "C" fn(Handle) -> Handle = symbol(library, "rtcNewScene");
            let new_geometry: extern "C" fn(Handle, i32) -> Handle = symbol(library, "rtcNewGeometry");
            #[allow(clippy::type_complexity)]
            let set_buffer: extern "C" fn(
                Handle,
                i32,
                u32,
                i32,
                *const c_void,
                usize,
                usize,
                usize,
            ) = symbol(library, "rtcSetSharedGeometryBuffer");
            let commit_geometry: extern "C" fn(Handle) = symbol(library, "rtcCommitGeometry");
            let attach: extern "C" fn(Handle, Handle) -> u32 = symbol(library, "rtcAttachGeometry");
            let set_quality: extern "C" fn(Handle, i32) = symbol(library, "rtcSetSceneBuildQuality");
            let set_flags: extern "C" fn(Handle, i32) = symbol(library, "rtcSetSceneFlags");
            let commit: extern "C" fn(Handle) = symbol(library, "rtcCommitScene");

            let set_monitor: extern "C" fn(Handle, Monitor, *const c_void) =
                symbol(library, "rtcSetDeviceMemoryMonitorFunction");
            let release_geometry: extern "C" fn(Handle) = symbol(library, "rtcReleaseGeometry");

            let device = new_device(config.as_ptr().cast());
            assert!(!device.is_null());
            let held = Box::new(AtomicI64::new(0));
            set_monitor(device, count_bytes, (&raw const *held).cast());
            let s = new_scene(device);
            set_quality(s, quality);
            set_flags(s, flags);
            let g = new_geometry(device, source.geometry);
            let Source { vertices, vertex_width, indices, index_width, .. } = &source;
            let count = vertices.len() / vertex_width;
            let format = 0x9000 + *vertex_width as i32;
            set_buffer(g, 1, 0, format, vertices.as_ptr().cast(), 0, 4 * vertex_width, count);
            let count = indices.len() / index_width;
            let format = 0x5000 + *index_width as i32;
            set_buffer(g, 0, 0, format, indices.as_ptr().cast(), 0, 4 * index_width, count);
            commit_geometry(g);
            attach(s, g);
            release_geometry(g);
            let start = std::time::Instant::now();
            commit(s);
            let build_seconds = start.elapsed().as_secs_f64();
            Self {
                scene: s,
                device,
                release_scene: symbol(library, "rtcReleaseScene"),
                release_device: symbol(library, "rtcReleaseDevice"),
                bytes: held.load(Ordering::Relaxed),
                _held: held,
                intersect: symbol(library, "rtcIntersect1"),
                occluded: symbol(library, "rtcOccluded1"),
                build_seconds,
                _source: source,
                _library: library,
            }
        }
    }

    /// Closest hit; a miss has `geometry == u32::MAX`.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> RayHit {
        let mut query = RayHit::new(ray);
        // SAFETY: the scene is committed and the record is large and aligned enough.
        unsafe { (self.intersect)(self.scene, &mut query, null()) };
        query
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut query = RayHit::new(ray);
        // SAFETY: as above; RTCRay is the head of the record.
        unsafe { (self.occluded)(self.scene, &mut query, null()) };
        query.tfar < 0.0
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        (self.release_scene)(self.scene);
        (self.release_device)(self.device);
    }
}

type Monitor = extern "C" fn(*const c_void, isize, bool) -> bool;

/// Told of every allocation and release.
extern "C" fn count_bytes(held: *const c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: the pointer is that of the counter given with this function.
    unsafe { &*held.cast::<AtomicI64>() }.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

// SAFETY: queries of a committed scene may run on any thread.
unsafe impl Sync for Embree {}

unsafe fn symbol<T: Copy>(library: &'static Library, name: &str) -> T {
    // SAFETY: the caller states the right type.
    unsafe { *library.get::<T>(name.as_bytes()).expect("a symbol of Embree 4") }
}
