//! A surface z = z0 + h(x, y) over a rectangle, as a grid of triangles with the formula's own normals.

use glam::{DVec2, DVec3};

use super::height_image::HEIGHT;
use super::{ANGLE, COORDINATE, HeightImage, LENGTH, Mesh, MeshParts, Noise, Smoothing};
use crate::error::Invalid;

/// Most cells of one heightfield: 2^22, eight million triangles.
pub const MOST_CELLS: u64 = 1 << 22;
/// What cells must be, in words.
pub const CELLS_REQUIRED: &str = "[cells along x, cells along y], each at least 1, at most 2^22 in all";

/// A plane wave `a sin(2 pi / l (x cos d + y sin d) + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Amplitude a (m).
    pub amplitude_m: f64,
    /// Wavelength l (m).
    pub wavelength_m: f64,
    /// Direction d it runs in, from x towards y (degrees).
    pub direction_deg: f64,
    /// Phase (degrees).
    pub phase_deg: f64,
}

/// Where the height comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// A sum of plane waves; none for a flat surface.
    Waves(Vec<Wave>),
    /// Seeded gradient noise.
    Noise(Noise),
    /// Samples spread over the rectangle, bilinear between them.
    Image(HeightImage),
}

impl Formula {
    /// Waves or octaves that are summed up at each vertex; none of an image.
    pub fn terms(&self) -> u64 {
        match self {
            Self::Waves(waves) => waves.len() as u64,
            Self::Noise(noise) => noise.octaves() as u64,
            Self::Image(_) => 0,
        }
    }
}

/// Which way the outward normal points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Facing {
    /// +z.
    #[default]
    Up,
    /// -z.
    Down,
}

/// A heightfield: `cells[0] x cells[1] x 2` triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Heightfield {
    min: DVec2,
    max: DVec2,
    /// Height of the reference plane (m).
    z_m: f64,
    cells: [u32; 2],
    formula: Formula,
    facing: Facing,
    smooth: bool,
}

impl Heightfield {
    /// A heightfield over the rectangle of this corner of least x and y (m) and this size (m), smooth and facing up. Heights count
    /// from the corner's z.
    ///
    /// # Errors
    /// Numbers out of range, no cells or more than `MOST_CELLS`, wavelengths too short for f64 over this rectangle.
    pub fn new(origin: DVec3, size: DVec2, cells: [u32; 2], formula: Formula) -> Result<Self, Invalid> {
        COORDINATE.vector("origin", origin)?;
        LENGTH.check("size", size.x)?;
        LENGTH.check("size", size.y)?;
        let number = cells.into_iter().map(u64::from).product();
        if !(1..=MOST_CELLS).contains(&number) {
            return Err(Invalid::Count { what: "cells", value: number, required: CELLS_REQUIRED });
        }
        let shortest = match &formula {
            Formula::Waves(waves) => {
                waves.iter().try_for_each(Wave::check)?;
                waves.iter().fold(f64::INFINITY, |m, w| m.min(w.wavelength_m))
            }
            Formula::Noise(noise) => noise.shortest_wavelength_m(),
            Formula::Image(_) => f64::INFINITY,
        };
        let min = origin.truncate();
        let max = min + size;
        let reach = min.abs().max_element().max(max.abs().max_element());
        if !(reach / shortest <= 1e12) {
            let found = format!("a wavelength of {shortest} m at {reach} m from the origin");
            return Err(Invalid::Shape { what: "wavelength", found, required: "at most 1e12 wavelengths" });
        }
        Ok(Self { min, max, z_m: origin.z, cells, formula, facing: Facing::Up, smooth: true })
    }

    /// The same with its outward normal this way.
    #[must_use]
    pub fn facing(self, facing: Facing) -> Self {
        Self { facing, ..self }
    }

    /// The same with smooth normals (the formula's, or finite differences for an image) or without.
    #[must_use]
    pub fn smooth(self, smooth: bool) -> Self {
        Self { smooth, ..self }
    }

    /// Number of cells.
    pub fn cell_count(&self) -> u64 {
        self.cells.into_iter().map(u64::from).product()
    }

    /// The triangles. Cell (i, j) holds triangles `2 (j cells_x + i)` and the next.
    ///
    /// # Errors
    /// Those of [`Mesh::new`].
    pub fn mesh(&self) -> Result<Mesh, Invalid> {
        let [nx, ny] = self.cells;
        let columns = u64::from(nx) + 1;
        let mut parts = MeshParts::default();
        for j in 0..=ny {
            for i in 0..=nx {
                let at = self.node(i, j);
                let (h, slope) = self.height_and_slope(at);
                parts.vertices.push(DVec3::new(at.x, at.y, self.z_m + h));
                if self.smooth {
                    let up = DVec3::new(-slope.x, -slope.y, 1.0);
                    parts.normals.push(if self.facing == Facing::Up { up } else { -up });
                }
            }
        }
        for j in 0..u64::from(ny) {
            for i in 0..u64::from(nx) {
                let v = |di: u64, dj: u64| ((j + dj) * columns + i + di) as u32;
                let (a, b, c, d) = (v(0, 0), v(1, 0), v(1, 1), v(0, 1));
                match self.facing {
                    Facing::Up => parts.triangles.extend([[a, b, c], [a, c, d]]),
                    Facing::Down => parts.triangles.extend([[a, c, b], [a, d, c]]),
                }
            }
        }
        if self.smooth {
            parts.normal_indices = parts.triangles.clone();
        }
        Ok(Mesh::new(parts, Smoothing::Given, false)?.0)
    }

    /// Height over the reference plane (m) and its slope at (x, y) (m).
    pub fn height_and_slope(&self, at: DVec2) -> (f64, DVec2) {
        match &self.formula {
            Formula::Waves(waves) => waves.iter().fold((0.0, DVec2::ZERO), |(h, s), w| {
                let (dh, ds) = w.height_and_slope(at);
                (h + dh, s + ds)
            }),
            Formula::Noise(noise) => noise.height_and_slope(at),
            Formula::Image(image) => {
                let size = self.max - self.min;
                let height = |p: DVec2| image.height_m((p - self.min) / size);
                // Central differences over a cell of the grid, one-sided at the border.
                let step = size / DVec2::new(f64::from(self.cells[0]), f64::from(self.cells[1]));
                let along = |e: DVec2| {
                    let (lo, hi) = ((at - e).max(self.min), (at + e).min(self.max));
                    (height(hi) - height(lo)) / (hi - lo).element_sum()
                };
                let slope = DVec2::new(along(DVec2::new(step.x, 0.0)), along(DVec2::new(0.0, step.y)));
                (height(at), slope)
            }
        }
    }

    /// Grid node (i, j); the last ones lie exactly on the far edges.
    fn node(&self, i: u32, j: u32) -> DVec2 {
        let along = |lo: f64, hi: f64, i: u32, n: u32| {
            if i == n { hi } else { lo + (hi - lo) * (f64::from(i) / f64::from(n)) }
        };
        DVec2::new(
            along(self.min.x, self.max.x, i, self.cells[0]),
            along(self.min.y, self.max.y, j, self.cells[1]),
        )
    }
}

impl Wave {
    fn height_and_slope(&self, at: DVec2) -> (f64, DVec2) {
        let direction = self.direction_deg.to_radians();
        let k = DVec2::new(libm::cos(direction), libm::sin(direction))
            * (std::f64::consts::TAU / self.wavelength_m);
        let phase = k.dot(at) + self.phase_deg.to_radians();
        (self.amplitude_m * libm::sin(phase), k * (self.amplitude_m * libm::cos(phase)))
    }

    fn check(&self) -> Result<(), Invalid> {
        HEIGHT.check("amplitude", self.amplitude_m)?;
        LENGTH.check("wavelength", self.wavelength_m)?;
        ANGLE.check("direction_deg", self.direction_deg)?;
        ANGLE.check("phase_deg", self.phase_deg)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(formula: Formula, facing: Facing) -> Heightfield {
        let origin = DVec3::new(-1.0, 0.0, 0.5);
        Heightfield::new(origin, DVec2::new(2.0, 3.0), [40, 60], formula).unwrap().facing(facing)
    }

    fn wave() -> Wave {
        Wave { amplitude_m: 0.1, wavelength_m: 0.8, direction_deg: 30.0, phase_deg: 20.0 }
    }

    #[test]
    fn waves_follow_their_formula_and_normals_their_slope() {
        let f = field(Formula::Waves(vec![wave()]), Facing::Up);
        let (x, y) = (0.37, 1.1);
        let (h, slope) = f.height_and_slope(DVec2::new(x, y));
        let phase = std::f64::consts::TAU / 0.8 * (x * 0.75f64.sqrt() + y * 0.5) + std::f64::consts::PI / 9.0;
        assert!((h - 0.1 * phase.sin()).abs() < 1e-15);
        let d = 1e-6;
        let dh = (f.height_and_slope(DVec2::new(x, y + d)).0 - f.height_and_slope(DVec2::new(x, y - d)).0)
            / (2.0 * d);
        assert!((dh - slope.y).abs() < 1e-9);
        let mesh = f.mesh().unwrap();
        assert_eq!(mesh.triangles().len(), 40 * 60 * 2);
        assert_eq!(mesh.topology().open_edges, 2 * (40 + 60));
        assert_eq!(mesh.topology().inconsistent_edges, 0);
        // Normals within a facet turn by at most the curvature a k^2 = 6.17 / m times half its diagonal.
        let least = (6.17 * 0.0354f64).cos();
        for face in 0..mesh.triangles().len() {
            let [a, b, c] = mesh.triangle(face);
            let facet = (b - a).cross(c - a).normalize();
            let smooth = mesh.shading_normal(face, [1.0 / 3.0; 2], facet);
            assert!(facet.z > 0.0 && facet.dot(smooth) > least, "{face}");
        }
    }

    #[test]
    fn facing_down_turns_facets_and_normals() {
        let mesh = field(Formula::Waves(vec![wave()]), Facing::Down).mesh().unwrap();
        let [a, b, c] = mesh.triangle(17);
        let facet = (b - a).cross(c - a).normalize();
        assert!(facet.z < 0.0 && mesh.shading_normal(17, [0.2; 2], facet).dot(facet) > 0.99);
    }

    #[test]
    fn nonsense_is_refused() {
        let make = |z, size, cells, waves| {
            Heightfield::new(DVec3::new(-1.0, 0.0, z), DVec2::new(2.0, size), cells, Formula::Waves(waves))
        };
        assert!(make(0.5, 3.0, [40, 60], vec![]).is_ok());
        for (z, size, cells, waves) in [
            (0.5, 0.0, [4, 4], vec![]),
            (0.5, 3.0, [0, 3], vec![]),
            (0.5, 3.0, [u32::MAX, u32::MAX], vec![]),
            (f64::NAN, 3.0, [4, 4], vec![]),
            (0.5, 3.0, [4, 4], vec![Wave { wavelength_m: 0.0, ..wave() }]),
            (0.5, 3.0, [4, 4], vec![Wave { wavelength_m: 1e-15, ..wave() }]),
            (0.5, 3.0, [4, 4], vec![Wave { phase_deg: f64::INFINITY, ..wave() }]),
        ] {
            assert!(make(z, size, cells, waves.clone()).is_err(), "{z} {size} {cells:?} {waves:?}");
        }
        // A thousandth of a nanometre wide at a thousand kilometres: sine and cosine would be noise.
        let far = DVec3::new(1e6, 0.0, 0.0);
        let short = Formula::Waves(vec![Wave { wavelength_m: 1e-9, ..wave() }]);
        assert!(Heightfield::new(far, DVec2::ONE, [4, 4], short).is_err());
    }
}
