//! The binding to Embree 4 by hand, the only unsafe code of the benchmark. Structures and constants are those of Embree's
//! `rtcore_*.h`, as release builds have them: one level of instances.
#![allow(unsafe_code)]

use std::error::Error;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::mem::offset_of;
use std::path::Path;
use std::ptr::{NonNull, null, null_mut};

use raywood::{Ray, TriangleMesh};

/// How many rays a packet holds.
pub(crate) const LANES: usize = 16;

const GEOMETRY_TYPE_TRIANGLE: c_int = 0;
const BUFFER_TYPE_INDEX: c_int = 0;
const BUFFER_TYPE_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const BUILD_QUALITY_HIGH: c_int = 2;
const SCENE_FLAG_ROBUST: c_int = 1 << 2;
const RAY_QUERY_FLAG_COHERENT: c_int = 1 << 16;
const FEATURE_FLAG_ALL: c_uint = u32::MAX;
const DEVICE_PROPERTY_VERSION: c_int = 0;
const INVALID_GEOMETRY: u32 = u32::MAX;

/// Something that Embree owns.
type Handle = *mut c_void;

/// Embree's functions.
struct Functions {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    release_device: unsafe extern "C" fn(Handle),
    device_error: unsafe extern "C" fn(Handle) -> c_int,
    device_property: unsafe extern "C" fn(Handle, c_int) -> isize,
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    release_scene: unsafe extern "C" fn(Handle),
    set_scene_flags: unsafe extern "C" fn(Handle, c_int),
    set_scene_build_quality: unsafe extern "C" fn(Handle, c_int),
    commit_scene: unsafe extern "C" fn(Handle),
    new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle,
    release_geometry: unsafe extern "C" fn(Handle),
    set_new_geometry_buffer:
        unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void,
    commit_geometry: unsafe extern "C" fn(Handle),
    attach_geometry: unsafe extern "C" fn(Handle, Handle) -> c_uint,
    intersect1: unsafe extern "C" fn(Handle, *mut Single, *mut Arguments),
    occluded1: unsafe extern "C" fn(Handle, *mut Single, *mut Arguments),
    intersect16: unsafe extern "C" fn(*const [c_int; LANES], Handle, *mut Lanes, *mut Arguments),
    occluded16: unsafe extern "C" fn(*const [c_int; LANES], Handle, *mut Lanes, *mut Arguments),
}

/// Embree and a device of it.
pub(crate) struct Library {
    device: NonNull<c_void>,
    functions: Functions,
    name: String,
    /// Last, so that the functions are there until all else is gone.
    _code: libloading::Library,
}

// SAFETY: Embree's manual: devices and scenes may be used from several threads at a time; what changes them takes `&mut` or happens before
// they are shared.
unsafe impl Sync for Library {}

impl Library {
    /// Loads the shared library and makes a device with the given configuration, which may be empty: see `rtcNewDevice`.
    ///
    /// # Errors
    ///
    /// There is no such library, it is not Embree 4, or it refuses the configuration.
    pub(crate) fn load(path: &Path, config: &str) -> Result<Self, String> {
        let complain = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let config = CString::new(config).map_err(|error| complain(&error))?;
        // SAFETY: the user named the library as Embree's, whose initialisers have no preconditions.
        let code = unsafe { libloading::Library::new(path) }.map_err(|error| {
            // What the system says comes second.
            match error.source() {
                Some(cause) => complain(cause),
                None => complain(&error),
            }
        })?;
        macro_rules! function {
            ($name:literal) => {
                // SAFETY: the type is that of the function of this name in Embree 4's headers.
                *unsafe { code.get(concat!($name, "\0").as_bytes()) }
                    .map_err(|error| complain(&error))?
            };
        }
        let functions = Functions {
            new_device: function!("rtcNewDevice"),
            release_device: function!("rtcReleaseDevice"),
            device_error: function!("rtcGetDeviceError"),
            device_property: function!("rtcGetDeviceProperty"),
            new_scene: function!("rtcNewScene"),
            release_scene: function!("rtcReleaseScene"),
            set_scene_flags: function!("rtcSetSceneFlags"),
            set_scene_build_quality: function!("rtcSetSceneBuildQuality"),
            commit_scene: function!("rtcCommitScene"),
            new_geometry: function!("rtcNewGeometry"),
            release_geometry: function!("rtcReleaseGeometry"),
            set_new_geometry_buffer: function!("rtcSetNewGeometryBuffer"),
            commit_geometry: function!("rtcCommitGeometry"),
            attach_geometry: function!("rtcAttachGeometry"),
            intersect1: function!("rtcIntersect1"),
            occluded1: function!("rtcOccluded1"),
            intersect16: function!("rtcIntersect16"),
            occluded16: function!("rtcOccluded16"),
        };
        let device = new_device(&functions, &config).map_err(|error| complain(&error))?;
        // SAFETY: the device lives.
        let version =
            unsafe { (functions.device_property)(device.as_ptr(), DEVICE_PROPERTY_VERSION) };
        let name = format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100);
        let library = Self { device, functions, name, _code: code };
        // Version 3 has the same names for functions that take other arguments.
        if version / 10_000 != 4 {
            return Err(complain(&format_args!("is Embree {}, expected 4", library.name)));
        }
        Ok(library)
    }

    /// Its version, as in `4.4.0`.
    pub(crate) fn version(&self) -> &str {
        &self.name
    }

    /// The first error since it was last asked for.
    fn check(&self) -> Result<(), String> {
        // SAFETY: the device lives as long as `self`.
        match unsafe { (self.functions.device_error)(self.device.as_ptr()) } {
            0 => Ok(()),
            code => Err(format!("Embree reports error {code}")),
        }
    }
}

fn new_device(functions: &Functions, config: &CStr) -> Result<NonNull<c_void>, String> {
    // SAFETY: the string ends in zero; the device is released in `drop`.
    NonNull::new(unsafe { (functions.new_device)(config.as_ptr()) }).ok_or_else(|| {
        // SAFETY: without a device it tells why the last one was not made.
        let code = unsafe { (functions.device_error)(null_mut()) };
        format!("Embree makes no device (error {code}); is the configuration right?")
    })
}

impl Drop for Library {
    fn drop(&mut self) {
        // SAFETY: the device lives, and no scene outlives the library it borrows.
        unsafe { (self.functions.release_device)(self.device.as_ptr()) };
    }
}

/// Whether a scene has the flag ROBUST.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Robustness {
    Default,
    Robust,
}

/// Whether rays are traced with the flag COHERENT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coherence {
    Coherent,
    Incoherent,
}

/// A mesh with Embree's tree over it.
pub(crate) struct Scene<'a> {
    library: &'a Library,
    robustness: Robustness,
    handle: NonNull<c_void>,
}

// SAFETY: Embree's manual: any number of threads may trace in a committed scene, and nothing changes it after `build`.
unsafe impl Sync for Scene<'_> {}

impl<'a> Scene<'a> {
    /// Builds a tree of quality HIGH, on all cores.
    ///
    /// # Errors
    ///
    /// Embree reports one.
    pub(crate) fn build(
        library: &'a Library,
        mesh: &TriangleMesh,
        robustness: Robustness,
    ) -> Result<Self, String> {
        let f = &library.functions;
        let device = library.device.as_ptr();
        let made = |handle: Handle| {
            NonNull::new(handle).ok_or_else(|| "Embree is out of memory".to_owned())
        };

        // SAFETY: the device lives; the scene is released in `drop`.
        let handle = made(unsafe { (f.new_scene)(device) })?;
        let scene = Self { library, robustness, handle };
        // SAFETY: the device lives; the geometry is released below, or leaks when memory is out.
        let geometry = made(unsafe { (f.new_geometry)(device, GEOMETRY_TYPE_TRIANGLE) })?.as_ptr();
        let buffer = |kind, format, items: usize| {
            // SAFETY: the geometry lives; items of three four-byte numbers are 12 bytes apart.
            made(unsafe { (f.set_new_geometry_buffer)(geometry, kind, 0, format, 12, items) })
        };
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let vertices = buffer(BUFFER_TYPE_VERTEX, FORMAT_FLOAT3, positions.len())?;
        let indices = buffer(BUFFER_TYPE_INDEX, FORMAT_UINT3, triangles.len())?;
        // SAFETY: Embree's buffers are as many items of 12 bytes long as the slices, are aligned for numbers of four bytes and overlap nothing;
        // `Vec3` is three consecutive `f32`.
        unsafe {
            positions.as_ptr().copy_to_nonoverlapping(vertices.as_ptr().cast(), positions.len());
            triangles.as_ptr().copy_to_nonoverlapping(indices.as_ptr().cast(), triangles.len());
        }
        const { assert!(size_of::<raywood::Vec3>() == 12) };
        // SAFETY: geometry and scene live, and the scene keeps the geometry.
        unsafe {
            (f.commit_geometry)(geometry);
            (f.attach_geometry)(scene.handle.as_ptr(), geometry);
            (f.release_geometry)(geometry);
            let flags = if robustness == Robustness::Robust { SCENE_FLAG_ROBUST } else { 0 };
            (f.set_scene_flags)(scene.handle.as_ptr(), flags);
            (f.set_scene_build_quality)(scene.handle.as_ptr(), BUILD_QUALITY_HIGH);
            (f.commit_scene)(scene.handle.as_ptr());
        }
        library.check()?;
        Ok(scene)
    }

    /// Whether it has the flag ROBUST.
    pub(crate) fn robustness(&self) -> Robustness {
        self.robustness
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene lives, and nothing uses it any more.
        unsafe { (self.library.functions.release_scene)(self.handle.as_ptr()) };
    }
}

/// `RTCIntersectArguments` and `RTCOccludedArguments`, which have the same layout.
#[repr(C)]
struct Arguments {
    flags: c_int,
    feature_mask: c_uint,
    context: *const c_void,
    filter: *const c_void,
    user_geometry: *const c_void,
    min_width_distance_factor: f32,
}

impl Arguments {
    fn new(coherence: Coherence) -> Self {
        Self {
            flags: if coherence == Coherence::Coherent { RAY_QUERY_FLAG_COHERENT } else { 0 },
            feature_mask: FEATURE_FLAG_ALL,
            context: null(),
            filter: null(),
            user_geometry: null(),
            min_width_distance_factor: 0.0,
        }
    }
}

/// Rays in Embree's format, with place for their answers.
pub(crate) trait Record: Default + Send {
    /// How many rays.
    const RAYS: usize;

    /// Writes the rays, at most [`RAYS`](Self::RAYS), and clears the answers.
    fn pack(&mut self, rays: &[Ray]);

    /// Traces all records on this thread.
    fn trace(scene: &Scene<'_>, records: &mut [Self], any_hit: bool, coherence: Coherence);

    /// The answer to one of the rays.
    fn lane(&self, lane: usize) -> Lane;
}

/// What one ray was answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lane {
    /// The distance of the closest hit, after a question for that.
    pub(crate) t: Option<f32>,
    /// Whether anything was hit, after a question for that.
    pub(crate) occluded: bool,
}

impl Lane {
    fn new(tfar: f32, geometry: u32) -> Self {
        Self { t: (geometry != INVALID_GEOMETRY).then_some(tfar), occluded: tfar < 0.0 }
    }
}

/// `RTCRayHit`; it starts with its `RTCRay`.
#[derive(Clone, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Single {
    origin: [f32; 3],
    tnear: f32,
    direction: [f32; 3],
    time: f32,
    tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
    /// Only in releases from 4.3 on; others leave it alone.
    instance_primitive: u32,
}

impl Record for Single {
    const RAYS: usize = 1;

    fn pack(&mut self, rays: &[Ray]) {
        let [ray] = rays else { return };
        *self = Self {
            origin: ray.origin.to_array(),
            tnear: ray.t_min,
            direction: ray.direction.to_array(),
            tfar: ray.t_max,
            mask: u32::MAX,
            geometry: INVALID_GEOMETRY,
            instance: INVALID_GEOMETRY,
            instance_primitive: INVALID_GEOMETRY,
            ..Self::default()
        };
    }

    fn trace(scene: &Scene<'_>, records: &mut [Self], any_hit: bool, coherence: Coherence) {
        let f = &scene.library.functions;
        let function = if any_hit { f.occluded1 } else { f.intersect1 };
        let (scene, mut arguments) = (scene.handle.as_ptr(), Arguments::new(coherence));
        with_flushed_denormals(|| {
            for record in records {
                // SAFETY: the scene is committed; the record has the layout and alignment of an `RTCRayHit`, which starts with an `RTCRay`, is
                // ours alone, and no filter or user geometry is called.
                unsafe { function(scene, record, &raw mut arguments) };
            }
        });
    }

    fn lane(&self, _: usize) -> Lane {
        Lane::new(self.tfar, self.geometry)
    }
}

/// `RTCRayHit16`; it starts with its `RTCRay16`.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Lanes {
    origin: [[f32; LANES]; 3],
    tnear: [f32; LANES],
    direction: [[f32; LANES]; 3],
    time: [f32; LANES],
    tfar: [f32; LANES],
    mask: [u32; LANES],
    id: [u32; LANES],
    flags: [u32; LANES],
    normal: [[f32; LANES]; 3],
    u: [f32; LANES],
    v: [f32; LANES],
    primitive: [u32; LANES],
    geometry: [u32; LANES],
    instance: [u32; LANES],
    /// Only in releases from 4.3 on; others leave it alone.
    instance_primitive: [u32; LANES],
}

/// A packet of rays, and which of its lanes hold one.
#[derive(Clone, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    lanes: Lanes,
    /// -1 where there is a ray, else 0.
    valid: [c_int; LANES],
}

impl Record for Packet {
    const RAYS: usize = LANES;

    fn pack(&mut self, rays: &[Ray]) {
        *self = Self::default();
        let lanes = &mut self.lanes;
        for (lane, ray) in rays.iter().take(LANES).enumerate() {
            for axis in 0..3 {
                lanes.origin[axis][lane] = ray.origin[axis];
                lanes.direction[axis][lane] = ray.direction[axis];
            }
            lanes.tnear[lane] = ray.t_min;
            lanes.tfar[lane] = ray.t_max;
            lanes.mask[lane] = u32::MAX;
            self.valid[lane] = -1;
        }
        lanes.geometry = [INVALID_GEOMETRY; LANES];
        lanes.instance = [INVALID_GEOMETRY; LANES];
        lanes.instance_primitive = [INVALID_GEOMETRY; LANES];
    }

    fn trace(scene: &Scene<'_>, records: &mut [Self], any_hit: bool, coherence: Coherence) {
        let f = &scene.library.functions;
        let function = if any_hit { f.occluded16 } else { f.intersect16 };
        let (scene, mut arguments) = (scene.handle.as_ptr(), Arguments::new(coherence));
        with_flushed_denormals(|| {
            for Self { lanes, valid } in records {
                // SAFETY: the scene is committed; the lanes have the layout and alignment of an `RTCRayHit16`, which starts with an `RTCRay16`,
                // are ours alone, and no filter or user geometry is called. The mask has 16 numbers, at a multiple of 64 bytes.
                unsafe { function(valid, scene, lanes, &raw mut arguments) };
            }
        });
    }

    fn lane(&self, lane: usize) -> Lane {
        Lane::new(self.lanes.tfar[lane], self.lanes.geometry[lane])
    }
}

// Where the headers put things.
const _: () = assert!(size_of::<Single>() == 96 && size_of::<Lanes>() == 21 * 64);
const _: () = assert!(offset_of!(Single, normal) == 48 && offset_of!(Single, geometry) == 72);
const _: () = assert!(offset_of!(Lanes, tfar) == 8 * 64 && offset_of!(Lanes, normal) == 12 * 64);
const _: () = assert!(offset_of!(Lanes, geometry) == 18 * 64);
const _: () = assert!(offset_of!(Packet, valid).is_multiple_of(64));

/// Calls `f` with denormal numbers taken for zero and made zero, as Embree's manual asks of every thread that traces.
fn with_flushed_denormals(f: impl FnOnce()) {
    #[cfg(target_arch = "x86_64")]
    {
        /// Flush to zero, denormals are zero.
        const FLUSHED: u32 = 1 << 15 | 1 << 6;
        let mut before = 0u32;
        // SAFETY: the instruction writes four bytes, the control register of floating point arithmetic.
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack)) };
        let flushed = before | FLUSHED;
        // SAFETY: the instruction reads four bytes with the bits of a control register. Rust's own arithmetic may not run with them; until they
        // are taken back there is only the loop of Embree's calls, which has none and cannot unwind.
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const flushed, options(nostack)) };
        f();
        // SAFETY: as above.
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const before, options(nostack)) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    f();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_that_are_not_there_are_errors() {
        let said = Library::load(Path::new("no/such/libembree4.so"), "").err().expect("no library");
        assert!(said.starts_with("no/such/libembree4.so: "), "{said}");
    }

    #[test]
    fn packets_hold_rays_in_lanes() {
        let ray = |x: f32| Ray::new([x, 2.0, 3.0], [0.0, 1.0, x]).with_interval(0.5, 10.0 + x);
        let rays: Vec<_> = (0..5).map(|i| ray(i as f32)).collect();
        let mut packet = Packet::default();
        packet.pack(&[ray(7.0); LANES]);
        packet.pack(&rays);
        assert_eq!(packet.valid[3..7], [-1, -1, 0, 0]);
        let lanes = &packet.lanes;
        assert_eq!((lanes.origin[0][4], lanes.direction[2][4]), (4.0, 4.0));
        assert_eq!((lanes.tnear[4], lanes.tfar[4]), (0.5, 14.0));
        assert_eq!(packet.lane(4), Lane { t: None, occluded: false });
        packet.lanes.geometry[4] = 0;
        packet.lanes.tfar[3] = f32::NEG_INFINITY;
        assert_eq!(packet.lane(4), Lane { t: Some(14.0), occluded: false });
        assert_eq!(packet.lane(3), Lane { t: None, occluded: true });
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn denormals_are_back_afterwards() {
        let tiny = || std::hint::black_box(f32::MIN_POSITIVE) / std::hint::black_box(2.0);
        with_flushed_denormals(|| ());
        assert!(tiny() > 0.0);
    }
}
