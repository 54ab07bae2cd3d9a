//! The camera as a scene asks for it: [`CameraSpec`] is plain data, [`Camera`] is one that has been checked.

use std::ops::Deref;

use glam::DVec3;

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::geometry::{COORDINATE, LENGTH};

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
    /// Every photon is joined to the pinhole: no density bias, but what is scattered last is not seen by
    /// mirror or through glass.
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

/// Most pixels of a picture: 2^26, 8192 x 8192.
pub const MOST_PIXELS: u64 = 1 << 26;
/// Most eye paths a pixel.
pub const MOST_SAMPLES: u32 = 1 << 16;
/// Most neighbours of a density estimate.
pub const MOST_NEAREST: u32 = 1 << 20;
/// Angles across a picture, degrees.
pub const FOV: Interval = Interval { low: 1e-3, high: 179.0, words: "an angle from 0.001 to 179 degrees" };
/// Radii of a lens, m.
pub const LENS: Interval = Interval { low: 0.0, high: 1e9, words: "a radius from 0 (a pinhole) to 1e9 m" };
/// Luminances of a background, cd/m2.
pub const LUMINANCE: Interval = Interval { low: 0.0, high: 1e15, words: "a luminance from 0 to 1e15 cd/m2" };
/// Luminances that become white, cd/m2.
pub const WHITE: Interval =
    Interval { low: 1e-9, high: 1e15, words: "\"auto\", or the luminance of white, 1e-9 to 1e15 cd/m2" };
/// What pixels must be, in words.
pub const PIXELS_REQUIRED: &str = "[columns, rows], each at least 1, at most 2^26 in all";
/// What a number of neighbours must be, in words.
pub const NEAREST_REQUIRED: &str = "a whole number of photons from 2 to 2^20";

/// Photons that the automatic bandwidth takes at least.
pub const FEWEST_NEIGHBOURS: u32 = 64;

/// Which photons a density is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Bandwidth {
    /// All within a radius that is chosen once from the photons, but [`FEWEST_NEIGHBOURS`] at least
    /// (docs/PICTURE.md).
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

/// What a camera is asked to be; [`Camera::new`] checks it.
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
    /// A pinhole camera with the defaults of docs/SCENE.md. Directions of a point looked at that is
    /// `position`, or of an `up` along the view, are no numbers; [`Camera::new`] refuses them.
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

/// A camera that can be put into a scene: a [`CameraSpec`], which it gives to read, that makes sense.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera(CameraSpec);

impl Camera {
    /// A camera of these numbers.
    ///
    /// # Errors
    /// [`Invalid`], with the key of `[camera]` in a scene file, for what is no number or out of the ranges of
    /// docs/SCENE.md; a point looked at that is the position; an `up` along the view; splatting through a
    /// lens.
    pub fn new(spec: CameraSpec) -> Result<Self, Invalid> {
        let content = |what, found: String, required: &str| {
            Err(Invalid::Content { what, found, required: required.to_string() })
        };
        COORDINATE.vector("position", spec.position)?;
        let is_unit = |v: DVec3| (v.length() - 1.0).abs() <= 1e-9;
        if !is_unit(spec.forward) {
            return Err(Invalid::NoDirection { what: "look_at", value: spec.forward });
        }
        if !(is_unit(spec.up) && spec.up.dot(spec.forward).abs() <= 1e-9) {
            return Err(Invalid::Parallel { what: "up", to: "the view" });
        }
        FOV.check("fov_deg", spec.fov_deg)?;
        let [columns, rows] = spec.pixels;
        if !(1..=MOST_PIXELS).contains(&(u64::from(columns) * u64::from(rows))) {
            return content("pixels", format!("pixels = [{columns}, {rows}]"), PIXELS_REQUIRED);
        }
        if !(1..=MOST_SAMPLES).contains(&spec.samples) {
            let value = u64::from(spec.samples);
            return Err(Invalid::Count {
                what: "samples",
                value,
                required: "from 1 to 65536 eye paths a pixel",
            });
        }
        LENS.check("lens_radius", spec.lens_radius_m)?;
        if spec.lens_radius_m > 0.0 {
            LENGTH.check("focus", spec.focus_m)?;
            if spec.method == Method::Splat {
                let found = format!("method \"splat\" and lens_radius = {}", spec.lens_radius_m);
                return content(
                    "lens_radius",
                    found,
                    "0 with method = \"splat\": photons are joined to one point",
                );
            }
        }
        match spec.bandwidth {
            Bandwidth::Automatic => {}
            Bandwidth::Radius(r) | Bandwidth::AtLeast { radius_m: r, .. } => _ = LENGTH.check("radius", r)?,
            Bandwidth::Progressive(r) => _ = LENGTH.check("progressive_radius", r)?,
            Bandwidth::Nearest(k) if (2..=MOST_NEAREST).contains(&k) => {}
            Bandwidth::Nearest(k) => {
                let (what, value) = ("nearest", u64::from(k));
                return Err(Invalid::Count { what, value, required: NEAREST_REQUIRED });
            }
        }
        for luminance in spec.background_cd_m2 {
            LUMINANCE.check("background", luminance)?;
        }
        if let Exposure::White(luminance) = spec.exposure {
            WHITE.check("exposure", luminance)?;
        }
        Ok(Self(spec))
    }
}

impl Deref for Camera {
    type Target = CameraSpec;

    fn deref(&self) -> &CameraSpec {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec() -> CameraSpec {
        CameraSpec::pinhole(DVec3::new(1.0, -2.0, 3.0), DVec3::new(0.0, 0.5, 0.2), DVec3::Z, 50.0, [8, 6])
    }

    #[test]
    fn nonsense_is_refused_by_name() {
        let looks = |look_at, up| CameraSpec::pinhole(DVec3::ONE, look_at, up, 40.0, [8, 6]);
        let mut cases = vec![
            ("position", CameraSpec { position: DVec3::new(0.0, 1e300, 0.0), ..spec() }),
            ("look_at", looks(DVec3::ONE, DVec3::Z)),
            ("look_at", looks(DVec3::NAN, DVec3::Z)),
            ("look_at", looks(DVec3::INFINITY, DVec3::Z)),
            ("look_at", CameraSpec { forward: 2.0 * spec().forward, ..spec() }),
            ("up", looks(DVec3::ZERO, DVec3::ONE)),
            ("up", looks(DVec3::ZERO, DVec3::ZERO)),
            ("up", CameraSpec { up: spec().forward, ..spec() }),
            ("pixels", CameraSpec { pixels: [0, 6], ..spec() }),
            ("pixels", CameraSpec { pixels: [8193, 8192], ..spec() }),
            ("pixels", CameraSpec { pixels: [u32::MAX, u32::MAX], ..spec() }),
            ("samples", CameraSpec { samples: 0, ..spec() }),
            ("samples", CameraSpec { samples: 65537, ..spec() }),
            ("focus", CameraSpec { lens_radius_m: 1.0, focus_m: 0.0, ..spec() }),
            ("lens_radius", CameraSpec { lens_radius_m: 1.0, method: Method::Splat, ..spec() }),
            ("nearest", CameraSpec { bandwidth: Bandwidth::Nearest(1), ..spec() }),
            ("nearest", CameraSpec { bandwidth: Bandwidth::Nearest(1 + (1 << 20)), ..spec() }),
        ];
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300] {
            cases.extend([
                ("fov_deg", CameraSpec { fov_deg: bad, ..spec() }),
                ("lens_radius", CameraSpec { lens_radius_m: bad, ..spec() }),
                ("background", CameraSpec { background_cd_m2: [0.0, bad, 0.0], ..spec() }),
                ("exposure", CameraSpec { exposure: Exposure::White(bad), ..spec() }),
            ]);
        }
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300] {
            cases.extend([
                ("radius", CameraSpec { bandwidth: Bandwidth::Radius(bad), ..spec() }),
                ("progressive_radius", CameraSpec { bandwidth: Bandwidth::Progressive(bad), ..spec() }),
            ]);
        }
        for (what, spec) in cases {
            let refused = Camera::new(spec.clone()).expect_err(what);
            assert_eq!(refused.what(), what, "{refused} {spec:?}");
        }
        let lens = CameraSpec { lens_radius_m: 0.1, pixels: [8192, 8192], samples: 1, ..spec() };
        assert_eq!(*Camera::new(lens.clone()).unwrap(), lens);
    }
}
