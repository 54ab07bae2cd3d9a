//! Where arriving flux is counted.

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, Shape, SurfaceId};

use crate::files::scene_toml::description::{ReceiverEvents, ReceiverSide};

/// A receiver as it is asked for.
#[derive(Debug, Clone)]
pub struct ReceiverSpec {
    /// Name of the output.
    pub name: String,
    /// Name of the surface it lies on.
    pub surface: String,
    /// Cells along u and v; `None`: one value a face.
    pub cells: Option<[u32; 2]>,
    /// Sides on which arrivals count.
    pub side: ReceiverSide,
    /// Histories that count.
    pub events: ReceiverEvents,
}

/// How a receiver's surface is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cells {
    /// nu x nv cells of equal area in the surface's (u, v).
    Grid {
        /// Cells along u.
        nu: u32,
        /// Cells along v.
        nv: u32,
    },
    /// One cell a face.
    Faces {
        /// Number of faces.
        count: usize,
    },
}

impl Cells {
    /// Number of cells.
    pub fn len(self) -> usize {
        match self {
            Self::Grid { nu, nv } => nu as usize * nv as usize,
            Self::Faces { count } => count,
        }
    }

    /// Whether there are none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

/// A receiver of a scene.
#[derive(Debug, Clone)]
pub struct Receiver {
    /// Name of the output.
    pub name: String,
    /// The surface it lies on.
    pub surface: SurfaceId,
    /// How that is divided.
    pub cells: Cells,
    /// Sides on which arrivals count.
    pub side: ReceiverSide,
    /// Histories that count.
    pub events: ReceiverEvents,
    /// Area of each cell in m2: one number for all, or one a face.
    areas_m2: Vec<f64>,
    /// Width and height in metres of a flat rectangle.
    pub size_m: Option<[f64; 2]>,
}

/// Cells of receivers without a number of their own.
pub const DEFAULT_CELLS: [u32; 2] = [256, 256];

impl Receiver {
    /// A receiver on a surface of this geometry.
    ///
    /// # Errors
    /// An unknown surface, a grid of cells on a mesh or none at all, no area.
    pub fn new(spec: &ReceiverSpec, geometry: &Geometry) -> Result<Self> {
        let surface = geometry.surface_named(&spec.surface).ok_or_else(|| {
            Diagnostic::new(
                Kind::Unknown,
                format!("receiver \"{}\" on surface \"{}\"", spec.name, spec.surface),
                "a surface of the scene",
            )
        })?;
        let shape = &geometry.surfaces()[surface.0 as usize].shape;
        let is_mesh = matches!(shape, Shape::Mesh(_));
        let cells = match (is_mesh, spec.cells) {
            (true, None) => Cells::Faces { count: shape.face_count() },
            (true, Some(_)) => {
                return Err(Diagnostic::new(
                    Kind::Range,
                    format!("cells for receiver \"{}\" on a mesh", spec.name),
                    "no cells: a mesh gets one value a triangle",
                ));
            }
            (false, cells) => {
                let [nu, nv] = cells.unwrap_or(DEFAULT_CELLS);
                Cells::Grid { nu, nv }
            }
        };
        let areas_m2 = match cells {
            Cells::Grid { .. } => vec![shape.area() / cells.len() as f64],
            Cells::Faces { .. } => shape.face_areas(),
        };
        if cells.is_empty() || !areas_m2.iter().all(|a| *a > 0.0 && a.is_finite()) {
            return Err(Diagnostic::new(
                Kind::Range,
                format!(
                    "receiver \"{}\" of {} cells with an area of {} m2",
                    spec.name,
                    cells.len(),
                    shape.area()
                ),
                "at least one cell, and a positive area for each",
            ));
        }
        let size_m = match shape {
            Shape::Rectangle(r) => Some([r.edge_u().length(), r.edge_v().length()]),
            _ => None,
        };
        let (name, side, events) = (spec.name.clone(), spec.side, spec.events);
        Ok(Self { name, surface, cells, side, events, areas_m2, size_m })
    }

    /// Area of a cell, m2.
    #[inline]
    pub fn area_m2(&self, cell: usize) -> f64 {
        self.areas_m2[if self.areas_m2.len() == 1 { 0 } else { cell }]
    }

    /// Area of all cells, m2.
    pub fn total_area_m2(&self) -> f64 {
        match self.cells {
            Cells::Grid { .. } => self.areas_m2[0] * self.cells.len() as f64,
            Cells::Faces { .. } => self.areas_m2.iter().sum(),
        }
    }
}
