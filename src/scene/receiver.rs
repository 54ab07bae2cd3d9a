//! Where arriving flux is counted.

use crate::error::invalid::Invalid;
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, LENGTH, Shape, SurfaceId};

use super::evaluation::{GRID_REQUIRED, Grid, GridKind, MOST_GRID_CELLS};
use super::spot::Spot;

/// The side of its surface on which a receiver counts arriving flux.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReceiverSide {
    /// The side the outward normal points to.
    #[default]
    Front,
    /// The other side.
    Back,
    /// Both, in one sum.
    Both,
}

/// Which arrivals a receiver counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReceiverEvents {
    /// Every arrival.
    #[default]
    All,
    /// Straight from the emitter: no event before.
    Direct,
    /// After at least one event.
    Indirect,
}

/// Most cells of one receiver, and of all with cells of their own together: 2^26, two gigabytes of sums.
pub const MOST_CELLS: u64 = 1 << 26;

/// What cells must be, in words.
pub const CELLS_REQUIRED: &str = "[cells along u, cells along v], each at least 1, at most 2^26 in all";

/// Longest name in bytes: file systems take 255, of which endings and temporary names need some.
const LONGEST_NAME_BYTES: usize = 200;

/// Base names of files that a run writes besides the receivers', and names Windows does not let a file have.
const RESERVED: [&str; 6] = ["camera", "report", "con", "prn", "aux", "nul"];

/// A receiver as it is asked for: by default all that arrives on the front of its surface.
#[derive(Debug, Clone)]
pub struct ReceiverSpec {
    name: String,
    surface: String,
    cells: Option<[u32; 2]>,
    side: ReceiverSide,
    events: ReceiverEvents,
    grid: Option<GridKind>,
    border_m: f64,
    /// Whether its spot is measured, and the point of the sections.
    spot: Option<Option<[f64; 2]>>,
}

impl ReceiverSpec {
    /// A receiver of this name, which becomes that of its files, on the surface of that name.
    ///
    /// # Errors
    /// A name that cannot be a file's on every common system.
    pub fn new(name: impl Into<String>, surface: impl Into<String>) -> Result<Self, Invalid> {
        let name = check_name("receiver", name.into())?;
        let (side, events) = (ReceiverSide::default(), ReceiverEvents::default());
        Ok(Self {
            name,
            surface: surface.into(),
            cells: None,
            side,
            events,
            grid: None,
            border_m: 0.0,
            spot: None,
        })
    }

    /// The same with so many cells along u and v, those that a pilot chooses (`choose_cells`) without; not on a mesh, which has one value a face.
    ///
    /// # Errors
    /// No cells, or more than `MOST_CELLS`.
    pub fn with_cells(mut self, cells: [u32; 2]) -> Result<Self, Invalid> {
        let number = cells.into_iter().map(u64::from).product();
        if !(1..=MOST_CELLS).contains(&number) {
            return Err(Invalid::Count { what: "cells", value: number, required: CELLS_REQUIRED });
        }
        self.cells = Some(cells);
        Ok(self)
    }

    /// The same for arrivals on another side.
    #[must_use]
    pub fn on_side(self, side: ReceiverSide) -> Self {
        Self { side, ..self }
    }

    /// The same for arrivals of some histories alone.
    #[must_use]
    pub fn of_events(self, events: ReceiverEvents) -> Self {
        Self { events, ..self }
    }

    /// The same with an evaluation grid beside the map: of so many cells along u and v, or, without, as EN 12464-1 divides a
    /// rectangle. A border of this width is left out on each side.
    ///
    /// # Errors
    /// No cells, or too many; a border that is no length.
    pub fn with_grid(mut self, counts: Option<[u32; 2]>, border_m: f64) -> Result<Self, Invalid> {
        if let Some(counts) = counts {
            let number = counts.into_iter().map(u64::from).product();
            if !(1..=MOST_GRID_CELLS).contains(&number) {
                return Err(Invalid::Count { what: "grid", value: number, required: GRID_REQUIRED });
            }
        }
        self.border_m = if border_m == 0.0 { 0.0 } else { LENGTH.check("border_m", border_m)? };
        self.grid = Some(counts.map_or(GridKind::En12464, GridKind::Counts));
        Ok(self)
    }

    /// The same with the figures of the spot that the light makes on a rectangle, and sections through this point, in metres
    /// from the corner along u and v; through the peak without.
    #[must_use]
    pub fn with_spot(self, at_m: Option<[f64; 2]>) -> Self {
        Self { spot: Some(at_m), ..self }
    }

    /// Name of the output.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// The name of a result of this kind, if it can be that of a file.
///
/// # Errors
/// A name that cannot be a file's on every common system.
pub(super) fn check_name(what: &str, name: String) -> Result<String, Invalid> {
    if is_file_name(&name) {
        return Ok(name);
    }
    let shown: String = name.chars().take(40).collect();
    Err(Invalid::Content {
        what: "name",
        found: format!("the {what} name `{}`", shown.escape_debug()),
        required:
            "letters, digits, spaces, `_`, `-` and `.`, not beginning or ending with a dot or a space, \
                   at most 200 bytes of UTF-8 (it becomes a file name), and none of the words \
                   camera, report, con, prn, aux, nul"
                .into(),
    })
}

/// Whether this can be the base name of a file on every common system, and only that.
fn is_file_name(name: &str) -> bool {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '_' | '-' | '.');
    let edge = |c: char| matches!(c, ' ' | '.');
    (1..=LONGEST_NAME_BYTES).contains(&name.len())
        && name.chars().all(allowed)
        && !name.starts_with(edge)
        && !name.ends_with(edge)
        && !RESERVED.contains(&name.to_lowercase().as_str())
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

/// What divided a receiver into its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DividedBy {
    /// The scene, or the faces of a mesh.
    Scene,
    /// Nothing yet: `DEFAULT_CELLS`, until `run::choose_cells` is called.
    Default,
    /// A pilot run, for cells of about equal error whatever the number of photons.
    Pilot,
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
    /// What divided it.
    pub divided_by: DividedBy,
    /// Sides on which arrivals count.
    pub side: ReceiverSide,
    /// Histories that count.
    pub events: ReceiverEvents,
    /// Area of each cell in m2: one number for all, or one a face.
    areas_m2: Vec<f64>,
    /// Width and height in metres of a flat rectangle.
    pub size_m: Option<[f64; 2]>,
    /// The evaluation grid beside the map.
    pub grid: Option<Grid>,
    /// What is measured of its spot.
    pub spot: Option<Spot>,
}

/// Cells of receivers without a number of their own, until a pilot chooses them.
pub const DEFAULT_CELLS: [u32; 2] = [256, 256];

impl Receiver {
    /// A receiver on a surface of this geometry.
    ///
    /// # Errors
    /// An unknown surface, a grid of cells on a mesh, no area.
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
        let divided_by = match (cells, spec.cells) {
            (Cells::Grid { .. }, None) => DividedBy::Default,
            _ => DividedBy::Scene,
        };
        let areas_m2 = match cells {
            Cells::Grid { .. } => vec![shape.area() / cells.len() as f64],
            Cells::Faces { .. } => shape.face_areas(),
        };
        if !areas_m2.iter().all(|a| *a > 0.0 && a.is_finite()) {
            return Err(Diagnostic::new(
                Kind::Range,
                format!(
                    "receiver \"{}\" of {} cells with an area of {} m2",
                    spec.name,
                    cells.len(),
                    shape.area()
                ),
                "a positive area for each cell",
            ));
        }
        let size_m = match shape {
            Shape::Rectangle(r) => Some([r.edge_u().length(), r.edge_v().length()]),
            _ => None,
        };
        let grid = match (spec.grid, size_m) {
            (None, _) => None,
            (Some(kind), Some(size_m)) => Some(Grid::new(kind, size_m, spec.border_m)?),
            (Some(_), None) => {
                let found =
                    format!("an evaluation grid for receiver \"{}\", which is no rectangle", spec.name);
                return Err(Diagnostic::new(Kind::Range, found, "a grid on a rectangle alone"));
            }
        };
        let spot = match (spec.spot, shape) {
            (None, _) => None,
            (Some(at_m), Shape::Rectangle(rectangle)) => Some(Spot::new(*rectangle, at_m)?),
            (Some(_), _) => {
                let found = format!("`spot` for receiver \"{}\", which is no rectangle", spec.name);
                return Err(Diagnostic::new(Kind::Range, found, "spot figures of a rectangle alone"));
            }
        };
        let (name, side, events) = (spec.name.clone(), spec.side, spec.events);
        Ok(Self { name, surface, cells, divided_by, side, events, areas_m2, size_m, grid, spot })
    }

    /// The same receiver of nu x nv cells; one on faces stays as it is.
    pub fn divided(&self, [nu, nv]: [u32; 2], divided_by: DividedBy) -> Self {
        let Cells::Grid { .. } = self.cells else { return self.clone() };
        let cells = Cells::Grid { nu, nv };
        let areas_m2 = vec![self.total_area_m2() / cells.len() as f64];
        Self { cells, divided_by, areas_m2, ..self.clone() }
    }

    /// Cells along u and v, where a pilot run chose them.
    pub fn cells_by_pilot(&self) -> Option<[u32; 2]> {
        match (self.divided_by, self.cells) {
            (DividedBy::Pilot, Cells::Grid { nu, nv }) => Some([nu, nv]),
            _ => None,
        }
    }

    /// Takes cells that a pilot run chose, where a scene leaves them to it.
    pub fn take_cells_of_pilot(&mut self, cells: [u32; 2]) {
        if self.divided_by == DividedBy::Default {
            *self = self.divided(cells, DividedBy::Pilot);
        }
    }

    /// Area of a cell, m2.
    #[inline]
    pub fn area_m2(&self, cell: usize) -> f64 {
        self.areas_m2[if self.areas_m2.len() == 1 { 0 } else { cell }]
    }

    /// Area of each cell in m2: one number for all, or one a face.
    pub fn areas_m2(&self) -> &[f64] {
        &self.areas_m2
    }

    /// Area of all cells, m2.
    pub fn total_area_m2(&self) -> f64 {
        match self.cells {
            Cells::Grid { .. } => self.areas_m2[0] * self.cells.len() as f64,
            Cells::Faces { .. } => self.areas_m2.iter().sum(),
        }
    }
}
