//! The binding to Embree 4 by hand; beside it only `memory.rs` has unsafe code. Structures and constants are those of Embree's
//! `rtcore_*.h`, as release builds have them: one level of instances.
#![allow(unsafe_code)]

use std::error::Error;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::mem::offset_of;
use std::path::Path;
use std::ptr::{NonNull, null, null_mut};
use std::sync::atomic::{AtomicIsize, Ordering};

use raywood::{Ray, TriangleMesh, Vec3};

use crate::memory::Memory;

const GEOMETRY_TYPE_TRIANGLE: c_int = 0;
const BUFFER_TYPE_INDEX: c_int = 0;
const BUFFER_TYPE_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
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
    set_shared_geometry_buffer:
        unsafe extern "C" fn(Handle, c_int, c_uint, c_int, *const c_void, usize, usize, usize),
    set_geometry_build_quality: unsafe extern "C" fn(Handle, c_int),
    set_memory_monitor: unsafe extern "C" fn(Handle, Monitor, *const Held),
    intersect1: unsafe extern "C" fn(Handle, *mut Single, *mut Arguments),
    occluded1: unsafe extern "C" fn(Handle, *mut Single, *mut Arguments),
    packets_of_8: PacketFunctions<8>,
    packets_of_16: PacketFunctions<16>,
}

/// The functions that trace packets of `N` rays.
struct PacketFunctions<const N: usize> {
    intersect: PacketFunction<N>,
    occluded: PacketFunction<N>,
}

type PacketFunction<const N: usize> =
    unsafe extern "C" fn(*const [c_int; N], Handle, *mut Lanes<N>, *mut Arguments);

/// That there are packets of `N` rays.
trait TracesPackets<const N: usize> {
    fn packets(&self) -> &PacketFunctions<N>;
}

impl TracesPackets<8> for Functions {
    fn packets(&self) -> &PacketFunctions<8> {
        &self.packets_of_8
    }
}

impl TracesPackets<16> for Functions {
    fn packets(&self) -> &PacketFunctions<16> {
        &self.packets_of_16
    }
}

/// Called before or after memory is taken or given back, from any thread; refuses it by returning false.
type Monitor = unsafe extern "C" fn(*const Held, isize, bool) -> bool;

/// The memory that a device holds, in bytes.
#[derive(Default)]
struct Held {
    now: AtomicIsize,
    most: AtomicIsize,
}

unsafe extern "C" fn count(held: *const Held, bytes: isize, _after: bool) -> bool {
    // SAFETY: it is the `Held` of the library that owns the device, which it outlives.
    let held = unsafe { &*held };
    let now = held.now.fetch_add(bytes, Ordering::Relaxed) + bytes;
    held.most.fetch_max(now, Ordering::Relaxed);
    true
}

/// Embree and a device of it.
pub(crate) struct Library {
    device: NonNull<c_void>,
    functions: Functions,
    name: String,
    held: Box<Held>,
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
            set_shared_geometry_buffer: function!("rtcSetSharedGeometryBuffer"),
            set_geometry_build_quality: function!("rtcSetGeometryBuildQuality"),
            set_memory_monitor: function!("rtcSetDeviceMemoryMonitorFunction"),
            intersect1: function!("rtcIntersect1"),
            occluded1: function!("rtcOccluded1"),
            packets_of_8: PacketFunctions {
                intersect: function!("rtcIntersect8"),
                occluded: function!("rtcOccluded8"),
            },
            packets_of_16: PacketFunctions {
                intersect: function!("rtcIntersect16"),
                occluded: function!("rtcOccluded16"),
            },
        };
        let device = new_device(&functions, &config).map_err(|error| complain(&error))?;
        // SAFETY: the device lives.
        let version =
            unsafe { (functions.device_property)(device.as_ptr(), DEVICE_PROPERTY_VERSION) };
        let name = format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100);
        let held = Box::<Held>::default();
        // SAFETY: the device lives; what it is given lives in a box of its own until after the device.
        unsafe { (functions.set_memory_monitor)(device.as_ptr(), count, &raw const *held) };
        // Its code stays for good: threads of its own end some time after the device is released, and would find nothing there.
        std::mem::forget(code);
        let library = Self { device, functions, name, held };
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

    /// The memory that the device takes while `f` runs, as it tells its monitor, and the result. No other thread may use the device meanwhile.
    pub(crate) fn watch<T>(&self, f: impl FnOnce() -> T) -> (Memory, T) {
        let before = self.held.now.load(Ordering::Relaxed);
        self.held.most.store(before, Ordering::Relaxed);
        let result = f();
        let since = |bytes: &AtomicIsize| bytes.load(Ordering::Relaxed) - before;
        let [bytes, peak_bytes] =
            [&self.held.now, &self.held.most].map(|b| usize::try_from(since(b)).unwrap_or(0));
        (Memory { bytes, peak_bytes }, result)
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

/// How much work goes into a tree, for a scene and its geometry alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// By Morton codes.
    Low = 0,
    /// By binned SAH.
    Medium = 1,
    /// By binned SAH with spatial splits.
    High = 2,
}

/// Triangles as Embree can read them where they lie: their vertices followed by room to read 16 bytes at any of them.
pub(crate) struct SharedMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl SharedMesh {
    /// Copies a mesh.
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        let mut positions = Vec::with_capacity(mesh.positions().len() + 1);
        positions.extend_from_slice(mesh.positions());
        positions.push(Vec3::ZERO);
        Self { positions, triangles: mesh.triangles().to_vec() }
    }
}

/// Whether rays are traced with the flag COHERENT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coherence {
    Coherent,
    Incoherent,
}

/// What Embree made, if it did.
fn made(handle: Handle) -> Result<NonNull<c_void>, String> {
    NonNull::new(handle).ok_or_else(|| "Embree is out of memory".to_owned())
}

/// A mesh with Embree's tree over it.
pub(crate) struct Scene<'a> {
    library: &'a Library,
    robustness: Robustness,
    handle: NonNull<c_void>,
}

// SAFETY: Embree's manual: any number of threads may trace in a committed scene, and nothing changes it after `build` or `commit`.
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
        let scene = Self::empty(library, robustness, Quality::High)?;
        scene.add_geometry(None, |geometry| {
            let buffer = |kind, format, items: usize| {
                // SAFETY: the geometry lives; items of three four-byte numbers are 12 bytes apart.
                made(unsafe { (f.set_new_geometry_buffer)(geometry, kind, 0, format, 12, items) })
            };
            let (positions, triangles) = (mesh.positions(), mesh.triangles());
            let vertices = buffer(BUFFER_TYPE_VERTEX, FORMAT_FLOAT3, positions.len())?.cast();
            let indices = buffer(BUFFER_TYPE_INDEX, FORMAT_UINT3, triangles.len())?.cast();
            // SAFETY: Embree's buffers are as many items of 12 bytes long as the slices, are aligned for numbers of four bytes and overlap nothing;
            // `Vec3` is three consecutive `f32`.
            unsafe {
                positions.as_ptr().copy_to_nonoverlapping(vertices.as_ptr(), positions.len());
                triangles.as_ptr().copy_to_nonoverlapping(indices.as_ptr(), triangles.len());
            }
            Ok(())
        })?;
        scene.commit()?;
        Ok(scene)
    }

    /// A scene that shares a mesh with the caller and has no tree yet: it is not to be traced before [`commit`](Self::commit).
    ///
    /// # Errors
    ///
    /// Embree reports one.
    pub(crate) fn prepare(
        library: &'a Library,
        mesh: &'a SharedMesh,
        quality: Quality,
    ) -> Result<Self, String> {
        let f = &library.functions;
        let scene = Self::empty(library, Robustness::Default, quality)?;
        scene.add_geometry(Some(quality), |geometry| {
            let share = |kind, format, data: *const c_void, items: usize| {
                // SAFETY: the geometry lives; the data have so many items, 12 bytes apart, outlive the scene and are not written to. Beyond the
                // last vertex there is another, so that 16 bytes can be read of each.
                unsafe {
                    (f.set_shared_geometry_buffer)(geometry, kind, 0, format, data, 0, 12, items);
                }
            };
            let SharedMesh { positions, triangles } = mesh;
            let vertices = positions.len() - 1;
            share(BUFFER_TYPE_VERTEX, FORMAT_FLOAT3, positions.as_ptr().cast(), vertices);
            share(BUFFER_TYPE_INDEX, FORMAT_UINT3, triangles.as_ptr().cast(), triangles.len());
            Ok(())
        })?;
        library.check()?;
        Ok(scene)
    }

    /// Builds its tree: after that it may be traced.
    ///
    /// # Errors
    ///
    /// Embree reports one.
    pub(crate) fn commit(&self) -> Result<(), String> {
        // SAFETY: the scene lives, and nothing traces it yet.
        unsafe { (self.library.functions.commit_scene)(self.handle.as_ptr()) };
        self.library.check()
    }

    /// A scene without geometry.
    fn empty(
        library: &'a Library,
        robustness: Robustness,
        quality: Quality,
    ) -> Result<Self, String> {
        let f = &library.functions;
        // SAFETY: the device lives; the scene is released in `drop`.
        let handle = made(unsafe { (f.new_scene)(library.device.as_ptr()) })?;
        let flags = if robustness == Robustness::Robust { SCENE_FLAG_ROBUST } else { 0 };
        // SAFETY: the scene lives.
        unsafe {
            (f.set_scene_flags)(handle.as_ptr(), flags);
            (f.set_scene_build_quality)(handle.as_ptr(), quality as c_int);
        }
        Ok(Self { library, robustness, handle })
    }

    /// Adds a mesh that `fill` gives its buffers, with a build quality of its own or the default one.
    fn add_geometry(
        &self,
        quality: Option<Quality>,
        fill: impl FnOnce(Handle) -> Result<(), String>,
    ) -> Result<(), String> {
        let f = &self.library.functions;
        let device = self.library.device.as_ptr();
        // SAFETY: the device lives; the geometry is released below.
        let geometry = made(unsafe { (f.new_geometry)(device, GEOMETRY_TYPE_TRIANGLE) })?.as_ptr();
        let filled = fill(geometry);
        // SAFETY: geometry and scene live, and the scene keeps the geometry. One without buffers is not attached.
        unsafe {
            if filled.is_ok() {
                if let Some(quality) = quality {
                    (f.set_geometry_build_quality)(geometry, quality as c_int);
                }
                (f.commit_geometry)(geometry);
                (f.attach_geometry)(self.handle.as_ptr(), geometry);
            }
            (f.release_geometry)(geometry);
        }
        filled
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

/// `RTCRayHit8` or `RTCRayHit16`; it starts with its `RTCRay8` or `RTCRay16`. Those of 8 need no more than multiples of 32 bytes.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Lanes<const N: usize> {
    origin: [[f32; N]; 3],
    tnear: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    tfar: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
    /// Only in releases from 4.3 on; others leave it alone.
    instance_primitive: [u32; N],
}

impl<const N: usize> Lanes<N> {
    /// No rays, and no answers.
    const EMPTY: Self = Self {
        origin: [[0.0; N]; 3],
        tnear: [0.0; N],
        direction: [[0.0; N]; 3],
        time: [0.0; N],
        tfar: [0.0; N],
        mask: [0; N],
        id: [0; N],
        flags: [0; N],
        normal: [[0.0; N]; 3],
        u: [0.0; N],
        v: [0.0; N],
        primitive: [0; N],
        geometry: [INVALID_GEOMETRY; N],
        instance: [INVALID_GEOMETRY; N],
        instance_primitive: [INVALID_GEOMETRY; N],
    };
}

/// A packet of 8 or 16 rays, and which of its lanes hold one.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Packet<const N: usize> {
    lanes: Lanes<N>,
    /// -1 where there is a ray, else 0.
    valid: [c_int; N],
}

impl<const N: usize> Default for Packet<N> {
    fn default() -> Self {
        Self { lanes: Lanes::EMPTY, valid: [0; N] }
    }
}

impl<const N: usize> Record for Packet<N>
where
    Functions: TracesPackets<N>,
{
    const RAYS: usize = N;

    fn pack(&mut self, rays: &[Ray]) {
        *self = Self::default();
        let lanes = &mut self.lanes;
        for (lane, ray) in rays.iter().take(N).enumerate() {
            for axis in 0..3 {
                lanes.origin[axis][lane] = ray.origin[axis];
                lanes.direction[axis][lane] = ray.direction[axis];
            }
            lanes.tnear[lane] = ray.t_min;
            lanes.tfar[lane] = ray.t_max;
            lanes.mask[lane] = u32::MAX;
            self.valid[lane] = -1;
        }
    }

    fn trace(scene: &Scene<'_>, records: &mut [Self], any_hit: bool, coherence: Coherence) {
        let f: &PacketFunctions<N> = scene.library.functions.packets();
        let function = if any_hit { f.occluded } else { f.intersect };
        let (scene, mut arguments) = (scene.handle.as_ptr(), Arguments::new(coherence));
        with_flushed_denormals(|| {
            for Self { lanes, valid } in records {
                // SAFETY: the scene is committed; the lanes have the layout and alignment of an `RTCRayHit` of `N`, which starts with its
                // `RTCRay`, are ours alone, and no filter or user geometry is called. The mask has `N` numbers, at a multiple of 64 bytes.
                unsafe { function(valid, scene, lanes, &raw mut arguments) };
            }
        });
    }

    fn lane(&self, lane: usize) -> Lane {
        Lane::new(self.lanes.tfar[lane], self.lanes.geometry[lane])
    }
}

// Where the headers put things.
const _: () = assert!(size_of::<Vec3>() == 12);
const _: () = assert!(size_of::<Single>() == 96 && size_of::<Lanes<16>>() == 21 * 64);
const _: () = assert!(offset_of!(Single, normal) == 48 && offset_of!(Single, geometry) == 72);
const _: () =
    assert!(offset_of!(Lanes<16>, tfar) == 8 * 64 && offset_of!(Lanes<16>, normal) == 12 * 64);
const _: () = assert!(
    offset_of!(Lanes<8>, geometry) == 18 * 32 && offset_of!(Lanes<16>, geometry) == 18 * 64
);
const _: () = assert!(offset_of!(Packet<8>, valid).is_multiple_of(64));
const _: () = assert!(offset_of!(Packet<16>, valid).is_multiple_of(64));

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
        let mut packet = Packet::<8>::default();
        packet.pack(&[ray(7.0); 8]);
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
