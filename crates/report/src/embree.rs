//! Embree (Wald, Woop, Benthin, Johnson, Ernst, "Embree: A Kernel Framework for Efficient CPU Ray Tracing", 2014),
//! where the machine has it: loaded at run time, not linked.
//!
//! The parts of version 4's C interface that are used are declared by hand.

#![allow(
    unsafe_code,
    reason = "calls into a C library that is loaded at run time"
)]

use libloading::Library;
use raycast_core::glam::Vec3;
use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr::{NonNull, null_mut};
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;

/// The environment variable that names the library.
pub const LIBRARY_VARIABLE: &str = "EMBREE_LIBRARY";

/// The number that Embree gives for a miss.
pub const NONE: u32 = u32::MAX;

/// Names to try where the variable names none.
const USUAL_NAMES: [&str; 2] = ["libembree4.so.4", "libembree4.so"];

// From `rtcore_common.h`, `rtcore_buffer.h`, `rtcore_geometry.h`, `rtcore_scene.h`, `rtcore_device.h`.
const GEOMETRY_TYPE_TRIANGLE: c_int = 0;
const BUFFER_TYPE_INDEX: c_int = 0;
const BUFFER_TYPE_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const SCENE_FLAG_ROBUST: c_int = 1 << 2;
const BUILD_QUALITY_MEDIUM: c_int = 1;
const RAY_QUERY_FLAG_COHERENT: c_int = 1 << 16;
const FEATURE_FLAG_ALL: c_uint = u32::MAX;
const DEVICE_PROPERTY_VERSION: c_int = 0;

/// Why Embree is not available.
#[derive(Debug, Error)]
pub enum EmbreeError {
    /// The library could not be loaded.
    #[error("{name}: cannot be loaded: {source}")]
    Load {
        /// The file, or the name that the system was asked for.
        name: String,
        /// What the loader says.
        source: libloading::Error,
    },
    /// The library is not Embree 4.
    #[error("{name}: expected Embree 4, found no {symbol}")]
    Symbol {
        /// The file, or the name that the system was asked for.
        name: String,
        /// The missing function.
        symbol: &'static str,
    },
    /// Embree did not start, or did not build a scene.
    #[error("Embree gave up: error {code}")]
    Refused {
        /// Its `RTCError`.
        code: c_int,
    },
}

/// `N` rays in structure-of-arrays order with their hits: `RTCRayHit` for one, `RTCRayHit8`, `RTCRayHit16`.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Packet<const N: usize> {
    /// Origins, a coordinate at a time.
    pub origin: [[f32; N]; 3],
    /// The start of each ray's range.
    pub t_near: [f32; N],
    /// Directions, of any length.
    pub direction: [[f32; N]; 3],
    time: [f32; N],
    /// The end of each ray's range; after a hit, its distance.
    pub t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    /// Normals of the triangles hit, as long as twice their area.
    pub normal: [[f32; N]; 3],
    /// Weights of the second corners.
    pub u: [f32; N],
    /// Weights of the third corners.
    pub v: [f32; N],
    /// Triangles hit.
    pub triangle: [u32; N],
    /// The geometry hit, or [`NONE`].
    pub geometry: [u32; N],
    instance: [u32; N],
    instance_triangle: [u32; N],
}

impl<const N: usize> Packet<N> {
    /// Rays to be filled in, with ranges from 0 to infinity.
    pub const NEW: Self = Self {
        origin: [[0.0; N]; 3],
        t_near: [0.0; N],
        direction: [[0.0; N]; 3],
        time: [0.0; N],
        t_far: [f32::INFINITY; N],
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
        normal: [[0.0; N]; 3],
        u: [0.0; N],
        v: [0.0; N],
        triangle: [NONE; N],
        geometry: [NONE; N],
        instance: [NONE; N],
        instance_triangle: [NONE; N],
    };

    /// Clears the hits for another cast.
    #[inline(always)]
    pub fn reset(&mut self) {
        self.t_far = [f32::INFINITY; N];
        self.geometry = [NONE; N];
        self.triangle = [NONE; N];
    }
}

/// `RTCIntersectArguments`.
#[repr(C)]
struct Arguments {
    flags: c_int,
    feature_mask: c_uint,
    context: *mut c_void,
    filter: *mut c_void,
    intersect: *mut c_void,
    /// Only used if the library was built with it.
    min_width_distance_factor: f32,
}

type Device = *mut c_void;
type SceneHandle = *mut c_void;
type Geometry = *mut c_void;
type IntersectMany = unsafe extern "C" fn(*const c_int, SceneHandle, *mut c_void, *mut Arguments);

/// The functions, valid while the library is loaded.
struct Functions {
    new_device: unsafe extern "C" fn(*const c_char) -> Device,
    release_device: unsafe extern "C" fn(Device),
    device_error: unsafe extern "C" fn(Device) -> c_int,
    device_property: unsafe extern "C" fn(Device, c_int) -> isize,
    new_scene: unsafe extern "C" fn(Device) -> SceneHandle,
    release_scene: unsafe extern "C" fn(SceneHandle),
    set_scene_flags: unsafe extern "C" fn(SceneHandle, c_int),
    set_scene_build_quality: unsafe extern "C" fn(SceneHandle, c_int),
    commit_scene: unsafe extern "C" fn(SceneHandle),
    new_geometry: unsafe extern "C" fn(Device, c_int) -> Geometry,
    release_geometry: unsafe extern "C" fn(Geometry),
    commit_geometry: unsafe extern "C" fn(Geometry),
    attach_geometry: unsafe extern "C" fn(SceneHandle, Geometry) -> c_uint,
    set_new_geometry_buffer:
        unsafe extern "C" fn(Geometry, c_int, c_uint, c_int, usize, usize) -> *mut c_void,
    intersect_1: unsafe extern "C" fn(SceneHandle, *mut c_void, *mut Arguments),
    intersect_8: IntersectMany,
    intersect_16: IntersectMany,
}

/// The loaded library with a device.
pub struct Embree {
    functions: Functions,
    device: Device,
    // Never unloaded: its threads end some time after the device is released, in the library's code.
    _library: ManuallyDrop<Library>,
}

// SAFETY: "All Embree API calls are thread-safe" except building one scene from several threads, and a scene here is
// built before another thread has it.
unsafe impl Send for Embree {}
// SAFETY: as above.
unsafe impl Sync for Embree {}

/// Triangles with Embree's own tree.
pub struct EmbreeScene {
    embree: Arc<Embree>,
    scene: NonNull<c_void>,
    commit: Duration,
}

// SAFETY: a committed scene is only read, and Embree allows that from any thread.
unsafe impl Send for EmbreeScene {}
// SAFETY: as above.
unsafe impl Sync for EmbreeScene {}

impl Embree {
    /// Loads the library that [`LIBRARY_VARIABLE`] names, else one that the system knows, and starts it with
    /// `threads` threads for building.
    ///
    /// # Errors
    /// There is none, it is another version, or it does not start.
    pub fn load(threads: usize) -> Result<Arc<Self>, EmbreeError> {
        match std::env::var_os(LIBRARY_VARIABLE) {
            Some(path) => Self::load_from(Path::new(&path), threads),
            None => {
                let [first, second] = USUAL_NAMES;
                Self::load_from(Path::new(first), threads)
                    .or_else(|_| Self::load_from(Path::new(second), threads))
            }
        }
    }

    fn load_from(path: &Path, threads: usize) -> Result<Arc<Self>, EmbreeError> {
        let name = path.display().to_string();
        // SAFETY: Embree's initialisers do nothing that could break this program. A library of
        // another kind that the user names runs with the user's own rights, as any program would.
        let library = unsafe { Library::new(path) }.map_err(|source| EmbreeError::Load {
            name: name.clone(),
            source,
        })?;
        let functions = Functions::load(&library).map_err(|symbol| EmbreeError::Symbol {
            name: name.clone(),
            symbol,
        })?;
        let config = CString::new(format!("threads={threads},verbose=0")).unwrap_or_default();
        // SAFETY: a zero-terminated string, read before the call returns.
        let device = unsafe { (functions.new_device)(config.as_ptr()) };
        if device.is_null() {
            // SAFETY: null asks for the error of a device that could not be created.
            let code = unsafe { (functions.device_error)(null_mut()) };
            return Err(EmbreeError::Refused { code });
        }
        Ok(Arc::new(Self {
            functions,
            device,
            _library: ManuallyDrop::new(library),
        }))
    }

    /// Its version, as in "4.4.0".
    pub fn version(&self) -> String {
        // SAFETY: the device lives as long as `self`.
        let version =
            unsafe { (self.functions.device_property)(self.device, DEVICE_PROPERTY_VERSION) };
        let (major, minor, patch) = (version / 10_000, version / 100 % 100, version % 100);
        format!("{major}.{minor}.{patch}")
    }

    /// Builds a scene of triangles with these corners; a triangle's number is its index. `robust` asks for Embree's
    /// watertight tests and padded boxes.
    ///
    /// # Errors
    /// Embree refuses, usually for lack of memory.
    pub fn scene(
        self: &Arc<Self>,
        triangles: &[[Vec3; 3]],
        robust: bool,
    ) -> Result<EmbreeScene, EmbreeError> {
        let f = &self.functions;
        // SAFETY: handles are used between creation and release, and the buffers, which Embree pads itself, are
        // filled to the requested lengths.
        unsafe {
            let refused = || EmbreeError::Refused {
                code: (f.device_error)(self.device),
            };
            let mut scene = EmbreeScene {
                embree: Arc::clone(self),
                scene: NonNull::new((f.new_scene)(self.device)).ok_or_else(refused)?,
                commit: Duration::ZERO,
            };
            let handle = scene.scene.as_ptr();
            (f.set_scene_flags)(handle, if robust { SCENE_FLAG_ROBUST } else { 0 });
            (f.set_scene_build_quality)(handle, BUILD_QUALITY_MEDIUM);
            let geometry = (f.new_geometry)(self.device, GEOMETRY_TYPE_TRIANGLE);
            let buffer = |kind, format, items| {
                let buffer = (f.set_new_geometry_buffer)(geometry, kind, 0, format, 12, items);
                NonNull::new(buffer)
            };
            let vertices = buffer(BUFFER_TYPE_VERTEX, FORMAT_FLOAT3, triangles.len() * 3);
            let indices = buffer(BUFFER_TYPE_INDEX, FORMAT_UINT3, triangles.len());
            let (Some(vertices), Some(indices)) = (vertices, indices) else {
                (f.release_geometry)(geometry);
                return Err(refused());
            };
            let vertices = vertices.cast::<[[f32; 3]; 3]>();
            let indices = indices.cast::<[u32; 3]>();
            for (at, corners) in triangles.iter().enumerate() {
                vertices.add(at).write(corners.map(|c| c.to_array()));
                let first = 3 * at as u32;
                indices.add(at).write([first, first + 1, first + 2]);
            }
            let begin = Instant::now();
            (f.commit_geometry)(geometry);
            (f.attach_geometry)(handle, geometry);
            (f.release_geometry)(geometry);
            (f.commit_scene)(handle);
            scene.commit = begin.elapsed();
            match (f.device_error)(self.device) {
                0 => Ok(scene),
                code => Err(EmbreeError::Refused { code }),
            }
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: every scene holds a reference to the device, so none is left.
        unsafe { (self.functions.release_device)(self.device) };
    }
}

impl EmbreeScene {
    /// The time to build the tree, after its buffers were filled.
    pub fn commit_time(&self) -> Duration {
        self.commit
    }

    /// Casts one ray.
    #[inline]
    pub fn cast_1(&self, ray: &mut Packet<1>, coherent: bool) {
        // SAFETY: the packet is laid out as `RTCRayHit`, and aligned to more than its 16 bytes.
        unsafe {
            (self.embree.functions.intersect_1)(
                self.scene.as_ptr(),
                std::ptr::from_mut(ray).cast(),
                &mut Arguments::new(coherent),
            );
        }
    }

    /// Casts eight rays.
    #[inline]
    pub fn cast_8(&self, rays: &mut Packet<8>, coherent: bool) {
        self.cast_many(self.embree.functions.intersect_8, rays, coherent);
    }

    /// Casts sixteen rays.
    #[inline]
    pub fn cast_16(&self, rays: &mut Packet<16>, coherent: bool) {
        self.cast_many(self.embree.functions.intersect_16, rays, coherent);
    }

    #[inline(always)]
    fn cast_many<const N: usize>(
        &self,
        intersect: IntersectMany,
        rays: &mut Packet<N>,
        coherent: bool,
    ) {
        #[repr(align(64))]
        struct Valid<const N: usize>([c_int; N]);
        let valid = Valid([-1; N]);
        // SAFETY: the packet and the mask are laid out as `RTCRayHit8` or `RTCRayHit16` for the N
        // that `intersect` is for, and aligned to 64 bytes.
        unsafe {
            intersect(
                valid.0.as_ptr(),
                self.scene.as_ptr(),
                std::ptr::from_mut(rays).cast(),
                &mut Arguments::new(coherent),
            );
        }
    }
}

impl Drop for EmbreeScene {
    fn drop(&mut self) {
        // SAFETY: made in `Embree::scene`, released once.
        unsafe { (self.embree.functions.release_scene)(self.scene.as_ptr()) };
    }
}

impl Arguments {
    #[inline(always)]
    fn new(coherent: bool) -> Self {
        Self {
            flags: if coherent { RAY_QUERY_FLAG_COHERENT } else { 0 },
            feature_mask: FEATURE_FLAG_ALL,
            context: null_mut(),
            filter: null_mut(),
            intersect: null_mut(),
            min_width_distance_factor: 0.0,
        }
    }
}

impl Functions {
    /// Finds all of them; otherwise the name of the first that is missing.
    fn load(library: &Library) -> Result<Self, &'static str> {
        fn find<F: Copy>(library: &Library, name: &'static str) -> Result<F, &'static str> {
            // SAFETY: each field's type is the C declaration of the function it is named after.
            unsafe { library.get::<F>(name.as_bytes()) }
                .map(|symbol| *symbol)
                .map_err(|_| name)
        }
        Ok(Self {
            new_device: find(library, "rtcNewDevice")?,
            release_device: find(library, "rtcReleaseDevice")?,
            device_error: find(library, "rtcGetDeviceError")?,
            device_property: find(library, "rtcGetDeviceProperty")?,
            new_scene: find(library, "rtcNewScene")?,
            release_scene: find(library, "rtcReleaseScene")?,
            set_scene_flags: find(library, "rtcSetSceneFlags")?,
            set_scene_build_quality: find(library, "rtcSetSceneBuildQuality")?,
            commit_scene: find(library, "rtcCommitScene")?,
            new_geometry: find(library, "rtcNewGeometry")?,
            release_geometry: find(library, "rtcReleaseGeometry")?,
            commit_geometry: find(library, "rtcCommitGeometry")?,
            attach_geometry: find(library, "rtcAttachGeometry")?,
            set_new_geometry_buffer: find(library, "rtcSetNewGeometryBuffer")?,
            intersect_1: find(library, "rtcIntersect1")?,
            intersect_8: find(library, "rtcIntersect8")?,
            intersect_16: find(library, "rtcIntersect16")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{offset_of, size_of};

    /// As `sizeof` and `offsetof` give them for the structures of Embree 4.4.
    #[test]
    fn packets_are_laid_out_as_in_c() {
        assert_eq!(offset_of!(Packet<1>, normal), 48);
        assert_eq!(offset_of!(Packet<8>, normal), 12 * 32);
        assert_eq!(offset_of!(Packet<16>, normal), 12 * 64);
        assert_eq!(offset_of!(Packet<16>, geometry), 18 * 64);
        assert_eq!(size_of::<Packet<16>>(), 21 * 64);
    }

    #[test]
    fn a_missing_library_is_named() {
        let error = Embree::load_from(Path::new("/no/such/libembree4.so"), 1).err();
        let message = error.expect("an error").to_string();
        assert!(message.starts_with("/no/such/libembree4.so: "), "{message}");
    }
}
