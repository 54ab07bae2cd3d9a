//! Cells to try solvers of the cell equation on, the residual of a root by quadrature, and methods to compare with:
//! unguarded ones and those of the `roots` crate. Shared by tests/samplers/solvers.rs and benches/solvers.rs.
#![allow(dead_code, missing_docs)]

use std::cell::Cell as Counter;
use std::f64::consts::PI;

use caustix::math::solve::Solver;
use caustix::photometry::Web;
use caustix::sample::angles::Row;
use caustix::sample::cell::Cell;
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;
use roots::{
    SimpleConvergency, find_root_brent, find_root_newton_raphson, find_root_regula_falsi, find_root_secant,
};

/// Largest |F(s)/F(dt) - u| that counts as solved (METHOD 3).
pub const SOLVED: f64 = 1e-12;
/// Tolerance of the methods compared with: that of the project's solvers.
const TOLERANCE: f64 = 1.0 / (1u64 << 46) as f64;
const MOST_ITERATIONS: usize = 100;

/// The part of pi that an f64 leaves out.
const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;

/// A cell and what the quadrature says about it.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub row: Row,
    pub cell: Cell,
    /// Edge sums at both polar angles.
    edges: (f64, f64),
    whole: f64,
}

impl Case {
    /// `None` where the cell has no flux.
    pub fn new(theta1: f64, theta2: f64, corners: [f64; 4]) -> Option<Self> {
        let row = Row::new(theta1, theta2);
        let cell = Cell::new(&row, corners)?;
        let edges = (corners[0] + corners[1], corners[2] + corners[3]);
        let mut case = Self { row, cell, edges, whole: 1.0 };
        case.whole = case.mass_by_quadrature(row.width);
        Some(case)
    }

    /// |F(s)/F(dt) - u| by quadrature of the density: shares no formula with any solver.
    pub fn residual(&self, s: f64, u: f64) -> f64 {
        (self.mass_by_quadrature(s) / self.whole - u).abs()
    }

    /// Whether s is in the cell and solves the equation.
    pub fn is_solved(&self, s: f64, u: f64) -> bool {
        (0.0..=self.row.width).contains(&s) && self.residual(s, u) <= SOLVED
    }

    /// F(s) by Gauss-Legendre quadrature. The sine near the south pole is taken from pi - theta in two parts, so it is
    /// right to full relative precision there.
    fn mass_by_quadrature(&self, s: f64) -> f64 {
        const X: [f64; 4] = [
            0.183_434_642_495_649_8,
            0.525_532_409_916_329,
            0.796_666_477_413_626_7,
            0.960_289_856_497_536_3,
        ];
        const W: [f64; 4] = [
            0.362_683_783_378_362,
            0.313_706_645_877_887_3,
            0.222_381_034_453_374_48,
            0.101_228_536_290_376_26,
        ];
        let (theta1, dt) = (self.row.theta, self.row.width);
        let (sin, cos) = theta1.sin_cos();
        let density = |x: f64| {
            let sine = if theta1 + x > 2.0 {
                ((PI - theta1) - x + PI_LOW).sin()
            } else {
                sin * x.cos() + cos * x.sin()
            };
            (self.edges.0 * (1.0 - x / dt) + self.edges.1 * (x / dt)) * sine
        };
        let panels = 24;
        let h = s / f64::from(panels) / 2.0;
        let mut sum = 0.0;
        for p in 0..panels {
            let middle = h * f64::from(2 * p + 1);
            for k in 0..4 {
                sum += h * W[k] * (density(middle - h * X[k]) + density(middle + h * X[k]));
            }
        }
        sum
    }

    /// F(x dt) / F(dt) in closed form for any x, inside the cell or not: eq. (8) about the cell's edge.
    fn distribution(&self, x: f64) -> f64 {
        let s = x * self.row.width;
        let (sin, cos) = self.row.theta.sin_cos();
        let versine = 2.0 * (0.5 * s).sin().powi(2);
        let moment_cos = s * s.sin() - versine;
        let moment_sin = if s.abs() < 0.5 {
            let mut term = s * s * s / 3.0;
            (1..9).fold(0.0, |sum, k| {
                let now = sum + term;
                let k = f64::from(k);
                term *= -s * s * (k + 1.0) / k / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
                now
            })
        } else {
            s.sin() - s * s.cos()
        };
        let (a, b) = self.edges;
        let rise = (b - a) / self.row.width;
        (a * (sin * s.sin() + cos * versine) + rise * (sin * moment_cos + cos * moment_sin)) / self.whole
    }

    /// Derivative of [`Self::distribution`].
    fn density(&self, x: f64) -> f64 {
        let (sin, cos) = self.row.theta.sin_cos();
        let s = x * self.row.width;
        let edge = self.edges.0 + (self.edges.1 - self.edges.0) * x;
        edge * (sin * s.cos() + cos * s.sin()) * self.row.width / self.whole
    }

    /// F(theta) / F(theta2) by eq. (8) as the paper prints it, in absolute angles.
    fn as_printed(&self, theta: f64) -> f64 {
        let (a, b) = self.edges;
        let (t1, t2) = (self.row.theta, self.row.theta + self.row.width);
        let f = |t: f64| {
            (b - a) * (t.sin() - t * t.cos() - t1.sin() + t1 * t1.cos())
                - (t1.cos() - t.cos()) * (t1 * b - t2 * a)
        };
        f(theta) / f(t2)
    }
}

/// Cells with a trait in common.
#[derive(Debug, Clone)]
pub struct Family {
    pub name: &'static str,
    pub cases: Vec<Case>,
}

/// Polar edges of inner cells, narrow ones, wide ones and those at either pole.
fn positions() -> [(&'static str, Vec<(f64, f64)>); 5] {
    let at = |widths: &[f64], starts: &[f64]| -> Vec<(f64, f64)> {
        let all = widths.iter().flat_map(|w| starts.iter().map(move |t| (*t, *t + *w)));
        all.filter(|(_, end)| *end < PI).collect()
    };
    let narrow = [1e-12, 1e-9, 1e-6, 1e-3];
    let wide = [0.3, 0.49, 0.51, 1.2, PI / 2.0];
    let inner = [1.0, 2.5, 5.0, 10.0].map(f64::to_radians);
    let polar: Vec<f64> = narrow.iter().chain(&inner).chain(&wide).copied().collect();
    let mut wide_cells = at(&wide, &[1e-9, 0.1, 1.0, PI / 2.0, 2.5]);
    wide_cells.push((0.0, PI));
    [
        ("inner, 1 to 10 degrees", at(&inner, &[0.02, 0.1, 0.5, 1.0, PI / 2.0, 2.0, 2.5, 2.9])),
        ("narrow, 1e-12 to 1e-3 rad", at(&narrow, &[1e-9, 0.1, 1.0, PI / 2.0, 2.5, 3.1])),
        ("wide, 0.3 rad to the sphere", wide_cells),
        ("north pole", polar.iter().map(|w| (0.0, *w)).collect()),
        ("south pole", polar.iter().map(|w| (PI - *w, PI)).collect()),
    ]
}

/// The families of METHOD 3 and 8: ordinary corners at every kind of place, and hard corners at all of them.
pub fn families() -> Vec<Family> {
    let ordinary = [[1.0, 1.0, 1.0, 1.0], [0.3, 0.7, 0.31, 0.69], [1.0, 1.2, 0.3, 0.1], [0.2, 0.1, 1.0, 1.3]];
    let zero_edge = [[0.0, 0.0, 1.0, 2.0], [3.0, 1.0, 0.0, 0.0]];
    let one_corner = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let extreme = [
        [1.0, 1.0, 1e-12, 1e-12],
        [1e-12, 1e-12, 1.0, 1.0],
        [1.0, 1e-12, 1e12, 1.0],
        [1e12, 1.0, 1e-12, 1.0],
        [1e-200, 2e-200, 5e-201, 0.0],
        [1e200, 0.0, 3e200, 1e190],
        [1.0, 1.0, 1e-300, 0.0],
    ];
    let cases = |places: &[(f64, f64)], corners: &[[f64; 4]]| -> Vec<Case> {
        let all = places.iter().flat_map(|p| corners.iter().map(move |c| (*p, *c)));
        all.map(|((from, to), c)| Case::new(from, to, c).unwrap()).collect()
    };
    let positions = positions();
    let everywhere: Vec<(f64, f64)> = positions.iter().flat_map(|(_, places)| places.clone()).collect();
    let mut all: Vec<Family> = positions
        .into_iter()
        .map(|(name, places)| Family { name, cases: cases(&places, &ordinary) })
        .collect();
    all.push(Family { name: "a zero edge, everywhere", cases: cases(&everywhere, &zero_edge) });
    all.push(Family { name: "one corner not zero, everywhere", cases: cases(&everywhere, &one_corner) });
    all.push(Family { name: "ratios of 1e12 and more, everywhere", cases: cases(&everywhere, &extreme) });
    all
}

/// The cells of a table that have flux, and that flux in any unit.
pub fn of_table(web: &Web) -> Vec<(Case, f64)> {
    let grid = web.full_grid();
    let stride = grid.azimuth_rad.len();
    let mut all = Vec::new();
    for (i, edge) in grid.polar_rad.windows(2).enumerate() {
        for (j, lune) in grid.azimuth_rad.windows(2).enumerate() {
            let at = i * stride + j;
            let corners = [at, at + 1, at + stride, at + stride + 1].map(|k| grid.intensity_cd[k]);
            let case = Case::new(edge[0], edge[1], corners);
            all.extend(case.map(|c| (c, c.whole * (lune[1] - lune[0]))));
        }
    }
    all
}

/// Values of u for case `k`: both ends and close to them, a ladder, and some that no ladder meets.
pub fn uniforms(k: u64) -> Vec<f64> {
    let mut all = vec![0.0, 1e-300, 1e-18, 1e-9, 1e-4, 1.0 - 1e-9, 1.0 - f64::EPSILON / 2.0];
    all.extend((0..25).map(|i| f64::from(i) / 25.0 + 0.003));
    all.extend((0..16).map(|i| to_unit_f64(mix64(k << 8 | i))));
    all
}

/// A way to solve the cell equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// One of the project's.
    Own(Solver),
    /// The secant method from both ends of the cell, nothing else.
    UnguardedSecant,
    /// Newton's method from u dt, nothing else.
    UnguardedNewton,
    /// The secant method on eq. (8) as printed, in absolute angles.
    AsPrinted,
    RootsBrent,
    RootsSecant,
    RootsNewton,
    RootsRegulaFalsi,
}

impl Method {
    pub fn all() -> Vec<Self> {
        let others = [
            Self::UnguardedSecant,
            Self::UnguardedNewton,
            Self::AsPrinted,
            Self::RootsBrent,
            Self::RootsSecant,
            Self::RootsNewton,
            Self::RootsRegulaFalsi,
        ];
        Solver::ALL.map(Self::Own).into_iter().chain(others).collect()
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Own(solver) => solver.name(),
            Self::UnguardedSecant => "unguarded secant",
            Self::UnguardedNewton => "unguarded newton",
            Self::AsPrinted => "unguarded secant, (8) as printed",
            Self::RootsBrent => "roots: brent",
            Self::RootsSecant => "roots: secant",
            Self::RootsNewton => "roots: newton-raphson",
            Self::RootsRegulaFalsi => "roots: regula falsi",
        }
    }

    /// The in-cell angle s (NaN where the method gives up) and the evaluations of F and its derivative.
    pub fn solve(self, case: &Case, u: f64) -> (f64, u32) {
        let width = case.row.width;
        let count = Counter::new(0);
        let f = |x: f64| {
            count.set(count.get() + 1);
            case.distribution(x) - u
        };
        // All in the fraction x of the width: `roots` knows absolute tolerances only.
        let mut rule = SimpleConvergency { eps: TOLERANCE, max_iter: MOST_ITERATIONS };
        let x = match self {
            Self::Own(solver) => {
                let polar = case.cell.sample_theta(&case.row, u, solver);
                return (polar.s, polar.evaluations);
            }
            Self::UnguardedSecant => secant(0.0, 1.0, f),
            Self::UnguardedNewton => newton(u, f, |x| case.density(x)),
            Self::AsPrinted => {
                let theta = |x: f64| case.row.theta + x * width;
                let theta = secant(theta(0.0), theta(1.0), |t| {
                    count.set(count.get() + 1);
                    case.as_printed(t) - u
                });
                return (theta - case.row.theta, count.get());
            }
            Self::RootsBrent => find_root_brent(0.0, 1.0, f, &mut rule).unwrap_or(f64::NAN),
            Self::RootsSecant => find_root_secant(0.0, 1.0, f, &mut rule).unwrap_or(f64::NAN),
            Self::RootsNewton => {
                find_root_newton_raphson(u, f, |x| case.density(x), &mut rule).unwrap_or(f64::NAN)
            }
            Self::RootsRegulaFalsi => find_root_regula_falsi(0.0, 1.0, f, &mut rule).unwrap_or(f64::NAN),
        };
        (x * width, count.get())
    }
}

/// The textbook's secant method.
fn secant(mut x0: f64, mut x1: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut f0, mut f1) = (f(x0), f(x1));
    for _ in 0..MOST_ITERATIONS {
        if f1.abs() <= TOLERANCE {
            break;
        }
        let x2 = x1 - f1 * (x1 - x0) / (f1 - f0);
        (x0, f0, x1, f1) = (x1, f1, x2, f(x2));
    }
    x1
}

/// The textbook's Newton method.
fn newton(mut x: f64, f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..MOST_ITERATIONS {
        let value = f(x);
        if value.abs() <= TOLERANCE {
            break;
        }
        x -= value / slope(x);
    }
    x
}

/// What a method did over some pairs of a case and a u.
#[derive(Debug, Clone, Copy, Default)]
pub struct Score {
    pub solves: u64,
    /// Roots outside of their cell, not found, or with a residual above [`SOLVED`].
    pub failures: u64,
    /// Largest residual among those that did not fail.
    pub worst: f64,
    pub evaluations: u64,
    pub most_evaluations: u32,
}

impl Score {
    pub fn add(&mut self, case: &Case, u: f64, (s, evaluations): (f64, u32)) {
        self.solves += 1;
        self.evaluations += u64::from(evaluations);
        self.most_evaluations = self.most_evaluations.max(evaluations);
        if case.is_solved(s, u) {
            self.worst = self.worst.max(case.residual(s, u));
        } else {
            self.failures += 1;
        }
    }

    pub fn join(&mut self, other: &Self) {
        self.solves += other.solves;
        self.failures += other.failures;
        self.worst = self.worst.max(other.worst);
        self.evaluations += other.evaluations;
        self.most_evaluations = self.most_evaluations.max(other.most_evaluations);
    }

    pub fn mean_evaluations(&self) -> f64 {
        self.evaluations as f64 / self.solves as f64
    }

    /// A method over all cases, each at its [`uniforms`].
    pub fn of(method: Method, cases: &[Case]) -> Self {
        let mut score = Self::default();
        for (k, case) in cases.iter().enumerate() {
            for u in uniforms(k as u64) {
                score.add(case, u, method.solve(case, u));
            }
        }
        score
    }
}
