//! Far fields: the luminous intensity, by direction, of light that leaves the scene or comes out of a surface.
//!
//! Their nodes are values of a table that is bilinear in gamma and C, not means of cells (METHOD 8).

use glam::{DMat3, DVec3};

use crate::emitter::{AimFrame, grid_axes};
use crate::error::invalid::Invalid;
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, SurfaceId};
use crate::photometry::PhotometricType;
pub use crate::photometry::web::Symmetry;
use crate::units::RADIANS_PER_DEGREE;

use super::nodes::{Nodes, Weights};
use super::receiver::check_name;

/// Most nodes that one far field counts, half steps included: a table of 0.25 degrees in both angles.
pub const MOST_NODES: usize = 1 << 22;

/// What `gamma_deg` must be, in words.
pub const GAMMA_REQUIRED: &str = "a step from 0.01 that divides 90 degrees, or angles that increase by 0.01 or more, begin at 0 or 90 and end at 90 or 180";
/// What `c_deg` must be, in words.
pub const C_REQUIRED: &str = "a step from 0.01 that divides 360 degrees, or angles that increase by 0.01 or more, begin at 0 and go round the circle: \
     no 180 degrees without a plane (the planes that a `symmetry` makes are written, too)";
const SYMMETRY_REQUIRED: &str =
    "planes C that the symmetry takes to planes C (0, 90, 180 and 270 among them, where it names them)";

/// The nodes of an angle that was not given: of half the finest step, from which wider ones are made by doubling. The widest
/// step divides 90 degrees, so that planes at which symmetries begin are there.
const FINEST_GAMMA: (f64, u32) = (0.125, 5);
const FINEST_C: (f64, u32) = (1.875, 4);
/// Of a far field that is the same in all planes these show how far it is not.
const ROTATIONAL_C: (f64, u32) = (2.5, 1);

/// A far field as it is asked for.
#[derive(Debug, Clone)]
pub struct FarFieldSpec {
    name: String,
    frame: AimFrame,
    gamma_deg: Option<Vec<f64>>,
    c_deg: Option<Vec<f64>>,
    surface: Option<String>,
    symmetry: Symmetry,
}

impl FarFieldSpec {
    /// The far field of this name, which becomes that of its files; gamma = 0 is along `aim`, C = 0 towards `up`.
    ///
    /// # Errors
    /// A name that cannot be a file's on every common system.
    pub fn new(name: impl Into<String>, frame: AimFrame) -> Result<Self, Invalid> {
        let name = check_name("far field", name.into())?;
        Ok(Self { name, frame, gamma_deg: None, c_deg: None, surface: None, symmetry: Symmetry::None })
    }

    /// With nodes at these gamma (degrees): one number is a step. Without, the widest of 4, 2, 1, 0.5 and 0.25 degrees is
    /// taken that follows the light as well as its noise lets see.
    ///
    /// # Errors
    /// Anything but `GAMMA_REQUIRED`.
    pub fn with_gamma_deg(mut self, gamma_deg: &[f64]) -> Result<Self, Invalid> {
        let angles = match gamma_deg {
            [step] => steps(*step, 180.0, 90.0).filter(|angles| angles.len() >= 3),
            list => Some(list.to_vec()),
        };
        let is_good = |a: &[f64]| {
            rises(a) && [0.0, 90.0].contains(&a[0]) && [90.0, 180.0].contains(&a[a.len() - 1]) && a.len() >= 2
        };
        self.gamma_deg = Some(required("gamma_deg", gamma_deg, angles, is_good, GAMMA_REQUIRED)?);
        Ok(self)
    }

    /// With nodes at these C (degrees): one number is a step. Without, the widest of 30, 15, 7.5 and 3.75 degrees is taken,
    /// as for gamma.
    ///
    /// # Errors
    /// Anything but `C_REQUIRED`.
    pub fn with_c_deg(mut self, c_deg: &[f64]) -> Result<Self, Invalid> {
        let angles = match c_deg {
            [step] if *step != 0.0 => steps(*step, 360.0, 360.0),
            list => Some(list.to_vec()),
        };
        let goes_round = |a: &[f64]| {
            let gaps = a.windows(2).map(|pair| pair[1] - pair[0]).chain([360.0 - a[a.len() - 1]]);
            a.len() < 3 || gaps.into_iter().all(|gap| gap < 180.0)
        };
        let is_good = |a: &[f64]| rises(a) && a[0] == 0.0 && a[a.len() - 1] <= 360.0 && goes_round(a);
        let mut angles = required("c_deg", c_deg, angles, is_good, C_REQUIRED)?;
        angles.retain(|c| *c < 360.0);
        self.c_deg = Some(angles);
        Ok(self)
    }

    /// Of the light alone that comes out of the front of this surface.
    #[must_use]
    pub fn of_surface(self, surface: impl Into<String>) -> Self {
        Self { surface: Some(surface.into()), ..self }
    }

    /// Averaged to this symmetry of type C.
    #[must_use]
    pub fn with_symmetry(self, symmetry: Symmetry) -> Self {
        Self { symmetry, ..self }
    }

    /// Name of the output.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Finer steps make tables that nobody reads.
const FINEST_DEG: f64 = 0.01;

/// The multiples of a step from 0 to `end`, which is one of them, as `divided` is.
fn steps(step: f64, end: f64, divided: f64) -> Option<Vec<f64>> {
    /// A step such as 0.1 is no dyadic number.
    const WHOLE: f64 = 1e-9;
    let (count, parts) = ((end / step).round(), divided / step);
    let divides = step >= FINEST_DEG && (parts - parts.round()).abs() <= WHOLE * parts && parts >= 0.5;
    divides.then(|| (0..=count as usize).map(|i| end * i as f64 / count).collect())
}

fn rises(angles: &[f64]) -> bool {
    let is_step = |pair: &[f64]| pair[1] - pair[0] >= FINEST_DEG * (1.0 - 1e-9);
    !angles.is_empty() && angles.windows(2).all(is_step)
}

fn required(
    what: &'static str,
    given: &[f64],
    angles: Option<Vec<f64>>,
    is_good: impl Fn(&[f64]) -> bool,
    required: &str,
) -> Result<Vec<f64>, Invalid> {
    let found = || match given {
        [step] => format!("{what} = {step}"),
        list => format!("{what} with {} angles from {:?} to {:?}", list.len(), list.first(), list.last()),
    };
    let found = || found().replace("Some(", "").replace(')', "").replace("None", "none");
    let refused = || Invalid::Content { what, found: found(), required: required.into() };
    angles.filter(|angles| is_good(angles)).ok_or_else(refused)
}

/// A far field of a scene.
#[derive(Debug, Clone)]
pub struct FarField {
    /// Name of the output.
    pub name: String,
    /// What is counted; those of the table are some of them.
    pub nodes: Nodes,
    /// How often every other gamma and C of the nodes may be left out: at least once, so that the table's step is known
    /// to be fine enough, and once alone where the scene gives its angles.
    pub doublings: [u32; 2],
    /// The surface out of whose front the light comes; all that leaves the scene without.
    pub surface: Option<SurfaceId>,
    /// What it is averaged to.
    pub symmetry: Symmetry,
    /// Rows: C = 0, C = 90 degrees, gamma = 0.
    axes: DMat3,
}

impl FarField {
    /// A far field in this geometry.
    ///
    /// # Errors
    /// An unknown surface, too many nodes, planes that have not the symmetry asked for.
    pub fn new(spec: &FarFieldSpec, geometry: &Geometry) -> Result<Self> {
        let surface = match &spec.surface {
            None => None,
            Some(name) => Some(geometry.surface_named(name).ok_or_else(|| {
                let found = format!("far field \"{}\" of surface \"{name}\"", spec.name);
                Diagnostic::new(Kind::Unknown, found, "a surface of the scene")
            })?),
        };
        let is_rotational = spec.symmetry == Symmetry::Rotational;
        let (gamma, c) = (FINEST_GAMMA, if is_rotational { ROTATIONAL_C } else { FINEST_C });
        let finest = |(step, _): (f64, u32), end: f64| steps(step, end, end).unwrap_or_default();
        let given = [&spec.gamma_deg, &spec.c_deg].map(Option::is_some);
        // Angles that the scene gives, with half steps; else the finest of all.
        let nodes = Nodes {
            gamma_deg: spec.gamma_deg.clone().unwrap_or_else(|| finest(gamma, 180.0)),
            c_deg: spec.c_deg.clone().unwrap_or_else(|| {
                let mut all = finest(c, 360.0);
                all.pop();
                all
            }),
        };
        let fine = nodes.halved();
        let nodes = Nodes {
            gamma_deg: if given[0] { fine.gamma_deg } else { nodes.gamma_deg },
            c_deg: if given[1] { fine.c_deg } else { nodes.c_deg },
        };
        if nodes.count() > MOST_NODES {
            let (rows, planes) = (nodes.gamma_deg.len(), nodes.planes());
            let found =
                format!("far field \"{}\" of {rows} x {planes} nodes, half steps included", spec.name);
            return Err(Diagnostic::new(Kind::Limit, found, "at most 2^22: wider steps"));
        }
        let doublings =
            [(given[0], gamma.1), (given[1], c.1)].map(|(given, most)| if given { 1 } else { most });
        let table = nodes.thinned(doublings.map(|d| 1 << d));
        if (0..table.planes()).any(|plane| table.equal_planes(plane, spec.symmetry).is_none())
            || !has_seams(&table, spec.symmetry)
        {
            let found = format!("symmetry = \"{}\" with these `c_deg`", spec.symmetry.name());
            return Err(Diagnostic::new(Kind::Range, found, SYMMETRY_REQUIRED));
        }
        let axes = grid_axes(PhotometricType::C, spec.frame)?.transpose();
        Ok(Self { name: spec.name.clone(), nodes, doublings, surface, symmetry: spec.symmetry, axes })
    }

    /// The weights of light in this direction (unit), summing to `one`; `None` where it is outside the table.
    #[inline]
    pub fn weights(&self, direction: DVec3, one: u64) -> Option<Weights> {
        let local = self.axes * direction;
        let gamma = libm::atan2(libm::hypot(local.x, local.y), local.z) / RADIANS_PER_DEGREE;
        let c = libm::atan2(local.y, local.x) / RADIANS_PER_DEGREE;
        self.nodes.weights(gamma.min(180.0), c, one)
    }
}

/// Whether the planes at which a file of this symmetry begins and ends are there.
fn has_seams(nodes: &Nodes, symmetry: Symmetry) -> bool {
    let seams: &[f64] = match symmetry {
        Symmetry::Bilateral0To180 => &[0.0, 180.0],
        Symmetry::Bilateral90To270 => &[90.0, 270.0],
        Symmetry::Quadrants => &[0.0, 90.0],
        _ => &[],
    };
    seams.iter().all(|seam| nodes.c_deg.contains(seam))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec() -> FarFieldSpec {
        FarFieldSpec::new("lens", AimFrame::new(DVec3::NEG_Z, Some(DVec3::Y)).unwrap()).unwrap()
    }

    fn built(spec: FarFieldSpec) -> Result<FarField> {
        FarField::new(&spec, &Geometry::build(Vec::new()).unwrap())
    }

    #[test]
    fn steps_and_lists_become_nodes_with_half_steps() {
        let field = built(spec().with_gamma_deg(&[0.1]).unwrap().with_c_deg(&[5.0]).unwrap()).unwrap();
        assert_eq!((field.nodes.gamma_deg.len(), field.nodes.planes(), field.doublings), (3601, 144, [1, 1]));
        assert_eq!((field.nodes.gamma_deg[1800], field.nodes.gamma_deg[3600]), (90.0, 180.0));
        let field = built(spec().with_gamma_deg(&[0.0, 10.0, 90.0]).unwrap()).unwrap();
        assert_eq!((field.nodes.gamma_deg, field.doublings), (vec![0.0, 5.0, 10.0, 50.0, 90.0], [1, 4]));
        let field = built(spec().with_c_deg(&[0.0]).unwrap()).unwrap();
        assert_eq!((field.nodes.gamma_deg.len(), field.nodes.c_deg), (1441, vec![0.0, 180.0]));
    }

    #[test]
    fn what_is_no_table_is_refused() {
        for gamma in [
            &[7.0][..],
            &[0.0],
            &[-1.0],
            &[f64::NAN],
            &[1e-9],
            &[0.0, 30.0],
            &[10.0, 90.0],
            &[0.0, 50.0, 40.0, 90.0],
            &[],
        ] {
            let refused = spec().with_gamma_deg(gamma).unwrap_err();
            assert_eq!(refused.required(), GAMMA_REQUIRED, "{gamma:?}");
        }
        for c in [&[7.0][..], &[-5.0], &[720.0], &[f64::INFINITY], &[5.0, 90.0], &[0.0, 365.0], &[0.0, 0.0]] {
            assert_eq!(spec().with_c_deg(c).unwrap_err().required(), C_REQUIRED, "{c:?}");
        }
        let quadrants = |c: &[f64]| built(spec().with_c_deg(c).unwrap().with_symmetry(Symmetry::Quadrants));
        assert!(
            quadrants(&[15.0]).is_ok()
                && quadrants(&[0.0, 30.0, 90.0, 150.0, 180.0, 210.0, 270.0, 330.0]).is_ok()
        );
        for c in [&[72.0][..], &[0.0, 30.0, 90.0, 180.0, 270.0], &[60.0]] {
            let refused = quadrants(c).unwrap_err();
            assert!(refused.to_string().contains("symmetry = \"quadrants\""), "{c:?}: {refused}");
        }
        let many = built(spec().with_gamma_deg(&[0.01]).unwrap().with_c_deg(&[0.5]).unwrap()).unwrap_err();
        assert!(many.to_string().contains("36001 x 1440 nodes"), "{many}");
        assert!(built(spec().of_surface("exit")).is_err());
    }

    /// Type C of docs/PHOTOMETRIC_FRAME.md: a lamp that looks down, C = 0 to the north, C = 90 to the ... of it.
    #[test]
    fn directions_have_the_angles_of_the_frame() {
        let field = built(spec().with_gamma_deg(&[45.0]).unwrap().with_c_deg(&[90.0]).unwrap()).unwrap();
        let frame = AimFrame::new(DVec3::NEG_Z, Some(DVec3::Y)).unwrap();
        let axes = grid_axes(PhotometricType::C, frame).unwrap();
        for (gamma, c, node) in
            [(0.0f64, 0.0f64, 0), (45.0, 0.0, 16), (90.0, 90.0, 34), (135.0, 225.0, 53), (180.0, 0.0, 64)]
        {
            let (g, c) = (gamma.to_radians(), c.to_radians());
            let direction = axes * DVec3::new(g.sin() * c.cos(), g.sin() * c.sin(), g.cos());
            let most = field.weights(direction, 1000).unwrap().into_iter().max_by_key(|w| w.1).unwrap();
            assert_eq!((most.0, most.1), (node, 1000), "{gamma}");
        }
    }
}
