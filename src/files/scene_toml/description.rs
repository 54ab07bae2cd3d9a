//! A scene as its file states it: plain data, nothing built yet.
//!
//! Lengths are in metres, angles in degrees, flux in lumens. What can be checked without opening another file
//! has been checked: every number is finite and in its range, every name is unique, every reference leads
//! somewhere. Each part keeps its place in the file, so that later checks (a mesh with open edges, an emitter
//! inside glass) can point there. docs/SCENE.md describes the format.

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::scene_toml::source::{BUILT_IN_NAME, BUILT_IN_TEXT, Base, Source};
use crate::scene::camera::CameraSpec;
use crate::surface::Material;
use crate::surface::tabulated::{Energy, Sides};

/// A place in a scene file, both counted from 1; columns count characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// A value and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Where it stands in the scene file.
    pub place: Place,
}

/// A reference by name to a material or a surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// The name as written.
    pub name: String,
    /// Index into [`Description::materials`] or [`Description::surfaces`].
    pub index: usize,
    /// Where the reference stands.
    pub place: Place,
}

/// Everything a scene file says.
#[derive(Debug, Clone)]
pub struct Description {
    /// The text and where it comes from.
    pub source: Source,
    /// In the order of the file; at least one.
    pub emitters: Vec<EmitterDescription>,
    /// In the order of the file.
    pub materials: Vec<MaterialDescription>,
    /// In the order of the file.
    pub surfaces: Vec<SurfaceDescription>,
    /// In the order of the file.
    pub receivers: Vec<ReceiverDescription>,
    /// `[camera]`, where there is one.
    pub camera: Option<CameraDescription>,
    /// `[compare]`, where there is one.
    pub compare: Option<CompareDescription>,
    /// Defaults for the command line.
    pub run: RunDescription,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Diagnostic>,
}

impl Description {
    /// The scene inside the program, `scenes/wavy_glass.toml`.
    ///
    /// # Errors
    /// None, as the tests show; they are those of [`crate::files::scene_toml::parse`].
    pub fn built_in() -> std::result::Result<Self, Vec<Diagnostic>> {
        crate::files::scene_toml::parse(BUILT_IN_TEXT, BUILT_IN_NAME, Base::BuiltIn)
    }

    /// A diagnostic that points into this scene's file.
    pub fn diagnostic(
        &self,
        place: Place,
        kind: Kind,
        found: impl Into<String>,
        required: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::new(kind, found, required).at(place.line, place.column).in_file(&self.source.name)
    }

    /// The bytes of a file this scene names; errors point to where it is named.
    ///
    /// # Errors
    /// As [`Source::load`].
    pub fn load(&self, file: &Placed<String>) -> Result<Vec<u8>> {
        self.source.load(&file.value).map_err(|e| self.pointed_at(file.place, e))
    }

    /// One diagnostic for every file that this scene names and that [`Description::load`] could not open.
    pub fn missing_files(&self) -> Vec<Diagnostic> {
        let missing = |file: &Placed<String>| {
            self.source.probe(&file.value).err().map(|e| self.pointed_at(file.place, e))
        };
        self.files().filter_map(missing).collect()
    }

    /// The files this scene names, in the order emitters, materials, surfaces.
    pub fn files(&self) -> impl Iterator<Item = &Placed<String>> {
        let emitters = self.emitters.iter().filter_map(|e| match &e.shape {
            EmitterShape::Photometric { file, .. } => Some(file),
            EmitterShape::Isotropic | EmitterShape::Collimated { .. } | EmitterShape::Panel { .. } => None,
        });
        let materials = self.materials.iter().filter_map(|m| match &m.kind {
            MaterialKind::Tabulated(tabulated) => Some(&tabulated.file),
            _ => None,
        });
        let surfaces = self.surfaces.iter().filter_map(|s| match &s.shape {
            ShapeDescription::Mesh { file, .. } => Some(file),
            ShapeDescription::Heightfield(field) => match &field.relief {
                ReliefDescription::Image { file, .. } => Some(file),
                ReliefDescription::Waves { .. } | ReliefDescription::Noise { .. } => None,
            },
            _ => None,
        });
        emitters.chain(materials).chain(surfaces)
    }

    fn pointed_at(&self, place: Place, error: Diagnostic) -> Diagnostic {
        let pointed = error.at(place.line, place.column).in_file(&self.source.name);
        match pointed.advice() {
            Some(_) => pointed,
            None => pointed.hint("paths are relative to the folder of the scene file"),
        }
    }
}

/// An `[[emitter]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitterDescription {
    /// Unique; `emitter 1`, `emitter 2`, ... where the file gives none.
    pub name: String,
    /// The photometric centre, or the centre of a beam's cross-section or of a panel, in metres.
    pub position: Placed<DVec3>,
    /// Frame; `aim` -z and `up` y for isotropic emitters, where it means nothing.
    pub frame: Frame,
    /// Flux in lumens; `None` (photometric emitters only): the file's candela as they stand.
    pub flux_lm: Option<f64>,
    /// Colour of its light; `None`: white.
    pub colour: Option<Placed<ColourDescription>>,
    /// What it is.
    pub shape: EmitterShape,
    /// The header `[[emitter]]`.
    pub place: Place,
}

/// The colour of light, as a scene names it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColourDescription {
    /// Linear sRGB in any one unit: no channel is negative, one is positive.
    Rgb([f64; 3]),
    /// That of a black body of this temperature, K.
    Cct(f64),
}

/// The directions of an emitter: orthogonal unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Unit vector of the direction (V, H) = (0, 0), for types A, B and C alike.
    pub aim: DVec3,
    /// Unit vector orthogonal to `aim`. Type C: towards which H = 0 tilts; types A and B: towards which V
    /// grows.
    pub up: DVec3,
}

/// What an emitter is.
#[derive(Debug, Clone, PartialEq)]
pub enum EmitterShape {
    /// A point with the intensity table of an LM-63 file.
    Photometric {
        /// The file, as named.
        file: Placed<String>,
    },
    /// A point of equal intensity in all directions.
    Isotropic,
    /// Parallel light of constant illuminance across its cross-section.
    Collimated {
        /// The cross-section, orthogonal to the aim.
        section: BeamSection,
    },
    /// A rectangle of equal luminance in all directions on the side of its aim.
    Panel {
        /// Extent along aim x up, in metres.
        width: f64,
        /// Extent along up, in metres.
        height: f64,
    },
}

/// Cross-section of a collimated beam, about the emitter's position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BeamSection {
    /// A disc.
    Disc {
        /// Radius in metres.
        radius: f64,
    },
    /// A rectangle.
    Rectangle {
        /// Extent along aim x up, in metres.
        width: f64,
        /// Extent along up, in metres.
        height: f64,
    },
}

/// A `[material.NAME]`.
#[derive(Debug, Clone)]
pub struct MaterialDescription {
    /// NAME.
    pub name: String,
    /// What it does with light.
    pub kind: MaterialKind,
    /// The name in the header.
    pub place: Place,
}

/// What a material does with light.
#[derive(Debug, Clone)]
pub enum MaterialKind {
    /// What the scene file says is all of it.
    Plain(Material),
    /// Scatters as a table says.
    Tabulated(TabulatedDescription),
}

impl From<Material> for MaterialKind {
    fn from(material: Material) -> Self {
        Self::Plain(material)
    }
}

/// A scattering table on a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedDescription {
    /// The file, as named.
    pub file: Placed<String>,
    /// Which side of the surface is the table's front.
    pub sides: Sides,
    /// Turn of the table against the surface's reference direction, in degrees, counter-clockwise seen from the tip of the
    /// outward normal.
    pub rotation_deg: f64,
    /// Unit vector whose part along the surface is the reference direction; `None`: the shape's own.
    pub reference: Option<DVec3>,
    /// What happens where the table scatters more than arrives.
    pub energy: Energy,
    /// Whether what the table leaves goes on straight through (mirrored, where the table only reflects) instead of being
    /// absorbed.
    pub specular_remainder: bool,
}

/// A `[[surface]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceDescription {
    /// Unique.
    pub name: String,
    /// Its material.
    pub material: Reference,
    /// Its shape, before the transform.
    pub shape: ShapeDescription,
    /// Applied to the shape: scaled, then rotated, then translated.
    pub transform: TransformDescription,
    /// The header `[[surface]]`.
    pub place: Place,
}

/// The shape of a surface. Which side is the front (outward) is said at each.
#[derive(Debug, Clone, PartialEq)]
pub enum ShapeDescription {
    /// Triangles of an OBJ file; front: the side from which a face's vertices run counter-clockwise.
    Mesh {
        /// The file, as named.
        file: Placed<String>,
        /// `Some(true)`: open edges are an error.
        closed: Option<bool>,
        /// `Some(true)`: compute smooth normals; `Some(false)`: facet normals; `None`: the file's, if it has
        /// any.
        smooth: Option<bool>,
    },
    /// The points corner + u edge_u + v edge_v, u and v in [0, 1]; front: the side of edge_u x edge_v.
    Rectangle {
        /// The corner u = v = 0, in metres.
        corner: DVec3,
        /// Edge along u, in metres; at right angles to `edge_v`.
        edge_u: DVec3,
        /// Edge along v, in metres.
        edge_v: DVec3,
    },
    /// Six faces along the axes; front: outside.
    Box {
        /// Least corner, in metres.
        min: DVec3,
        /// Greatest corner, in metres.
        max: DVec3,
    },
    /// A sphere; front: outside.
    Sphere {
        /// Centre, in metres.
        center: DVec3,
        /// Radius, in metres.
        radius: f64,
    },
    /// A paraboloid of revolution cut off at a radius; front: the side of the focus.
    Paraboloid {
        /// Vertex, in metres.
        vertex: DVec3,
        /// Unit vector from the vertex to the focus.
        axis: DVec3,
        /// Distance of the focus from the vertex, in metres.
        focal_length: f64,
        /// Radius of the rim, in metres.
        radius: f64,
    },
    /// A relief over a rectangle in the xy plane.
    Heightfield(HeightfieldDescription),
}

impl ShapeDescription {
    /// The word of the scene file for it.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Mesh { .. } => "mesh",
            Self::Rectangle { .. } => "rectangle",
            Self::Box { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Paraboloid { .. } => "paraboloid",
            Self::Heightfield(_) => "heightfield",
        }
    }
}

/// A surface z = origin.z + h(x, y) over a rectangle, in triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightfieldDescription {
    /// Corner of least x and y, at height h = 0, in metres.
    pub origin: DVec3,
    /// Extent along x and y, in metres.
    pub size: [f64; 2],
    /// Which side is the front.
    pub facing: Facing,
    /// Smooth normals.
    pub smooth: bool,
    /// h(x, y).
    pub relief: ReliefDescription,
}

/// The side a heightfield's outward normal points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// +z is outside: with a dielectric, `ior` lies below.
    Up,
    /// -z is outside: with a dielectric, `ior` lies above.
    Down,
}

/// The heights of a heightfield.
#[derive(Debug, Clone, PartialEq)]
pub enum ReliefDescription {
    /// Sum of sines.
    Waves {
        /// Cells along x and y, two triangles each.
        cells: [u32; 2],
        /// At least one.
        waves: Vec<WaveDescription>,
    },
    /// Seeded gradient noise in octaves.
    Noise {
        /// Cells along x and y, two triangles each.
        cells: [u32; 2],
        /// The relief depends on it.
        seed: u64,
        /// Bound of |h| in metres: the octaves' amplitudes are scaled so that their sum is this.
        amplitude: f64,
        /// At least one.
        octaves: Vec<OctaveDescription>,
    },
    /// A grey image, spread over the rectangle with its first row at the greatest y.
    Image {
        /// Cells along x and y; `None`: one vertex a pixel.
        cells: Option<[u32; 2]>,
        /// The file, as named.
        file: Placed<String>,
        /// h of black and of white, in metres.
        height: [f64; 2],
    },
}

/// h(x, y) = amplitude sin(2 pi / wavelength (x cos(direction) + y sin(direction)) + phase), x and y counted
/// from the scene's origin (before the transform), not from the heightfield's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveDescription {
    /// In metres.
    pub amplitude: f64,
    /// In metres.
    pub wavelength: f64,
    /// Direction of propagation from +x towards +y, in degrees.
    pub direction_deg: f64,
    /// In degrees.
    pub phase_deg: f64,
}

/// One octave of noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctaveDescription {
    /// Relative to the other octaves.
    pub amplitude: f64,
    /// Distance of the noise's lattice points, in metres.
    pub wavelength: f64,
}

/// p -> R (S p) + T, with S the scale, T the translation and R = Rz Ry Rx: about x first, then y, then z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransformDescription {
    /// Factors along x, y and z, all positive.
    pub scale: DVec3,
    /// Angles about the x, y and z axes, in degrees, counter-clockwise seen from the tip of the axis.
    pub rotate_deg: DVec3,
    /// In metres.
    pub translate: DVec3,
}

impl TransformDescription {
    /// The transform that changes nothing.
    pub const IDENTITY: Self = Self { scale: DVec3::ONE, rotate_deg: DVec3::ZERO, translate: DVec3::ZERO };

    /// Whether it changes nothing.
    pub fn is_identity(&self) -> bool {
        *self == Self::IDENTITY
    }
}

/// A `[[receiver]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ReceiverDescription {
    /// Unique, also where upper and lower case are not told apart; usable as a file name.
    pub name: String,
    /// The surface it lies on.
    pub surface: Reference,
    /// Cells along u and v; `None` on meshes, boxes and heightfields: one value a triangle.
    pub cells: Option<[u32; 2]>,
    /// Which arrivals count, by side.
    pub side: ReceiverSide,
    /// Which arrivals count, by history.
    pub events: ReceiverEvents,
    /// The header `[[receiver]]`.
    pub place: Place,
}

/// The side of its surface on which a receiver counts arriving flux.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceiverSide {
    /// The side the outward normal points to.
    Front,
    /// The other side.
    Back,
    /// Both, in one sum.
    Both,
}

/// Which arrivals a receiver counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceiverEvents {
    /// Every arrival.
    All,
    /// Straight from the emitter: no event before.
    Direct,
    /// After at least one event.
    Indirect,
}

/// A `[camera]`.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraDescription {
    /// What it asks for, with the defaults filled in.
    pub spec: CameraSpec,
    /// The header `[camera]`.
    pub place: Place,
}

/// `[compare]`: what `caustix compare` does with the scene beside what every scene gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CompareDescription {
    /// Every photon is reflected this often, with weights and without roulette; 0 to 30.
    pub reflections: u32,
}

/// `[run]`: what the command line takes where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunDescription {
    /// Number of photons, 1 to 2^48.
    pub photons: Option<Placed<u64>>,
    /// Seed of the sequence.
    pub seed: Option<Placed<u64>>,
    /// Number of replicates, 1 to 65536.
    pub replicates: Option<Placed<u32>>,
}
