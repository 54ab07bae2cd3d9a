//! The camera as a scene asks for it: plain data, checked.

use glam::DVec3;

/// How a pixel weighs the image around its centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The pixel's own square, evenly.
    Box,
    /// A tent of two pixels' width.
    #[default]
    Tent,
    /// A Gaussian of standard deviation half a pixel, cut at two pixels.
    Gaussian,
}

impl Filter {
    /// The word of the scene file for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Tent => "tent",
            Self::Gaussian => "gaussian",
        }
    }
}

/// How light that photons bring reaches the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Eye paths to a scattering surface, density estimation there.
    #[default]
    Map,
    /// Every photon is joined to the pinhole: no density bias, but what is scattered last is not seen by mirror or through
    /// glass.
    Splat,
}

impl Method {
    /// The word of the scene file for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Map => "map",
            Self::Splat => "splat",
        }
    }
}

/// Photons that the automatic bandwidth takes at least.
pub const FEWEST_NEIGHBOURS: u32 = 64;

/// Which photons a density is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Bandwidth {
    /// All within a radius that is chosen once from the photons, but [`FEWEST_NEIGHBOURS`] at least (docs/PICTURE.md).
    #[default]
    Automatic,
    /// All within a radius, and where these are fewer than so many, that many nearest.
    AtLeast {
        /// The radius, m.
        radius_m: f64,
        /// The number.
        neighbours: u32,
    },
    /// All within this radius, m.
    Radius(f64),
    /// This many nearest, (k - 1) / (pi r_k^2).
    Nearest(u32),
    /// All within this radius, m, in the first replicate, and within less in each one after it.
    Progressive(f64),
}

/// The kernel that weighs photons by distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// The same for all.
    Flat,
    /// 2 / (pi r^2) (1 - d^2 / r^2).
    #[default]
    Epanechnikov,
}

impl Kernel {
    /// The word of the scene file for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Epanechnikov => "epanechnikov",
        }
    }
}

/// Which luminance becomes white in the PNG.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Exposure {
    /// By the stated rule of `image::tone`.
    #[default]
    Auto,
    /// This luminance, cd/m2.
    White(f64),
}

/// A camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSpec {
    /// Pinhole or middle of the lens, m.
    pub position: DVec3,
    /// Unit vector to the middle of the picture.
    pub forward: DVec3,
    /// Unit vector, orthogonal to `forward`, that is up in the picture.
    pub up: DVec3,
    /// Angle across the width of the picture, degrees.
    pub fov_deg: f64,
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Eye paths a pixel.
    pub samples: u32,
    /// Radius of the lens, m; 0 is a pinhole.
    pub lens_radius_m: f64,
    /// Distance from the lens, along `forward`, of the plane in focus, m.
    pub focus_m: f64,
    /// Pixel filter.
    pub filter: Filter,
    /// How photons reach the picture.
    pub method: Method,
    /// Bandwidth of the density estimate.
    pub bandwidth: Bandwidth,
    /// Kernel of the density estimate.
    pub kernel: Kernel,
    /// Luminance where nothing is seen, cd/m2, by channel of linear sRGB.
    pub background_cd_m2: [f64; 3],
    /// Exposure of the PNG.
    pub exposure: Exposure,
    /// Whether highlights roll off (filmic shoulder) instead of being cut.
    pub filmic: bool,
    /// Whether a false-colour picture of luminance is written too.
    pub false_colour: bool,
    /// Most bytes of stored photons at a time; more photons take several passes.
    pub photon_memory_bytes: u64,
}

impl CameraSpec {
    /// A pinhole camera with the defaults of docs/SCENE.md.
    pub fn pinhole(position: DVec3, look_at: DVec3, up: DVec3, fov_deg: f64, pixels: [u32; 2]) -> Self {
        let forward = (look_at - position).normalize();
        Self {
            position,
            forward,
            up: (up - forward * up.dot(forward)).normalize(),
            fov_deg,
            pixels,
            samples: 16,
            lens_radius_m: 0.0,
            focus_m: (look_at - position).length(),
            filter: Filter::default(),
            method: Method::default(),
            bandwidth: Bandwidth::default(),
            kernel: Kernel::default(),
            background_cd_m2: [0.0; 3],
            exposure: Exposure::default(),
            filmic: false,
            false_colour: false,
            photon_memory_bytes: 2 << 30,
        }
    }
}
