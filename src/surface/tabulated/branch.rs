//! Which slice of which lobe scatters a photon, and where to.
//!
//! With renormalisation the slice is one of the photon's discrete events, on the coordinate that all of these share, and the
//! direction has two coordinates to itself: one for row and polar angle, one for column and azimuth. So the direction goes
//! steadily with both and hardly changes with the slice, and points that fill the unit cube evenly fill the lobe evenly, even
//! where their number allows only a few strata in each of many dimensions (docs/STUDY.md). Without, each choice has its own coordinate.

use glam::{DMat3, DVec3};

use crate::math::solve::Solver;
use crate::sample::choose::{Reusable, Share, TWO_TO_64};
use crate::sample::compact::{CompactGrids, Located};
use crate::sample::coordinates::{Chooser, Purpose};
use crate::sample::grid::GridPoint;
use crate::sample::method::{Rejection, Sampling};
use crate::scattering::Quantity;
use crate::surface::tabulated::arrival::Arrival;
use crate::surface::tabulated::layer::{Layer, Mix};

/// The lobes of a face for one incidence: the one that reflects, the one that transmits.
pub(crate) struct Lobes<'a> {
    pub arrival: &'a Arrival,
    pub lobes: [Option<(&'a Layer, Mix)>; 2],
}

/// What can scatter a photon: a slice, for one channel where there is colour.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Branch {
    weight: f64,
    pub slice: u32,
    pub lobe: u32,
}

/// Four slices for each of two lobes.
const MOST_GREY: usize = 8;
/// The same for each of three channels.
const MOST_COLOURED: usize = 24;

/// Every branch of positive weight, at most `MOST`, in a fixed order.
pub(crate) struct Branches<const MOST: usize> {
    list: [Branch; MOST],
    length: usize,
    total: f64,
}

impl Branches<MOST_GREY> {
    /// Adds those of layers that are all grey: the albedo of their mixture.
    #[inline(always)]
    pub fn add_grey(&mut self, layers: [Option<&Layer>; 2], theta: f64, phi: f64) -> f64 {
        let mut albedo = 0.0;
        for (lobe, layer) in layers.into_iter().enumerate() {
            let Some(layer) = layer else { continue };
            let mut sum = 0.0;
            layer.each_part(theta, phi, |slice, part| {
                if part > 0.0 {
                    let weight = part * layer.grids.integral(slice);
                    self.add(lobe, slice, weight);
                    sum += weight;
                }
            });
            albedo += sum;
        }
        albedo
    }
}

impl<const MOST: usize> Branches<MOST> {
    #[inline(always)]
    pub fn none() -> Self {
        Self { list: [Branch::default(); MOST], length: 0, total: 0.0 }
    }

    /// One of them; `None` where there is none.
    #[inline(always)]
    pub fn decide<C: Chooser>(&self, chooser: &mut C) -> Option<Branch> {
        match self.as_slice() {
            [] => None,
            [only] => Some(*only),
            _ => chooser.decide(Purpose::Scatter, |u| self.choose(u)),
        }
    }

    #[inline(always)]
    fn as_slice(&self) -> &[Branch] {
        &self.list[..self.length]
    }

    #[inline(always)]
    fn add(&mut self, lobe: usize, slice: usize, weight: f64) {
        if weight > 0.0 {
            self.list[self.length] = Branch { weight, slice: slice as u32, lobe: lobe as u32 };
            self.length += 1;
            self.total += weight;
        }
    }

    /// The branches of a lobe for one channel.
    #[inline(always)]
    fn add_channel(&mut self, lobe: usize, (layer, mix): &(&Layer, Mix), channel: usize, share: f64) {
        for (incidence, part) in mix.parts() {
            let slice = layer.slice(channel, incidence);
            self.add(lobe, slice, share * part * layer.grids.integral(slice));
        }
    }

    /// The fractions of each branch in turn, until one satisfies: (branch, its share). The last one owns what is left.
    #[inline(always)]
    fn find(&self, mut is_it: impl FnMut(Branch, Share) -> bool) -> Option<(Branch, Share)> {
        let (last, others) = self.as_slice().split_last()?;
        let scale = TWO_TO_64 / self.total;
        let (mut sum, mut low) = (0.0, 0);
        for branch in others {
            sum += branch.weight;
            // One too rare for its own fraction has none.
            let high = (sum * scale) as u64;
            let share = Share { low, width: high - low };
            if high > low && is_it(*branch, share) {
                return Some((*branch, share));
            }
            low = high;
        }
        let share = Share { low, width: low.wrapping_neg() };
        is_it(*last, share).then_some((*last, share))
    }

    /// One branch by weight, as one event on `u`.
    #[inline(always)]
    fn choose(&self, u: &mut Reusable) -> Option<Branch> {
        let bits = u.bits();
        let (branch, share) = self.find(|_, share| share.width == 0 || bits - share.low < share.width)?;
        u.take(share);
        Some(branch)
    }
}

/// A photon on its way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Left {
    pub wo: DVec3,
    pub quantity: Quantity,
    pub below_horizon: bool,
    /// g by channel there, of a lobe in colour.
    pub values: [f64; 3],
}

impl<'a> Lobes<'a> {
    /// Parts that are scattered, by channel.
    #[inline]
    pub fn albedo(&self, coloured: bool) -> [f64; 3] {
        let of = |channel| {
            let mut sum = 0.0;
            for (layer, mix) in self.lobes.iter().flatten() {
                sum += layer.albedo(mix, channel);
            }
            sum
        };
        if coloured { [of(0), of(1), of(2)] } else { [of(0); 3] }
    }

    /// The same of one lobe.
    pub fn albedo_of(&self, quantity: Quantity) -> [f64; 3] {
        let lobe = self.lobes[quantity as usize].as_ref();
        lobe.map_or([0.0; 3], |(layer, mix)| [0, 1, 2].map(|channel| layer.albedo(mix, channel)))
    }

    /// g of a lobe by channel.
    pub fn eval_cos(&self, quantity: Quantity, wo: DVec3) -> [f64; 3] {
        let Some((layer, mix)) = &self.lobes[quantity as usize] else { return [0.0; 3] };
        let (theta, phi) = angles(&self.axes(layer), wo);
        let Some(at) = layer.grids.locate(theta, phi) else { return [0.0; 3] };
        layer.values_at(mix, &at)
    }

    #[inline]
    fn axes(&self, layer: &Layer) -> DMat3 {
        self.arrival.axes(layer.frame, layer.quantity)
    }

    /// Every branch. `shares` are those of the channels; `None` where all are grey.
    #[inline(always)]
    fn branches<const MOST: usize>(&self, shares: Option<[f64; 3]>) -> Branches<MOST> {
        let mut all = Branches::none();
        for (lobe, found) in self.lobes.iter().enumerate() {
            let Some(found) = found else { continue };
            match shares {
                None => all.add_channel(lobe, found, 0, 1.0),
                // A grey lobe beside a coloured one is the same for all channels: one branch with all shares.
                Some(shares) if found.0.channels == 1 => {
                    all.add_channel(lobe, found, 0, shares[0] + shares[1] + shares[2]);
                }
                Some(shares) => (0..3).for_each(|k| all.add_channel(lobe, found, k, shares[k])),
            }
        }
        all
    }

    /// A direction of light that is scattered; `None` where nothing is.
    #[inline(always)]
    pub fn sample<C: Chooser>(&self, shares: Option<[f64; 3]>, chooser: &mut C) -> Option<Left> {
        let branch = if shares.is_none() {
            self.branches::<MOST_GREY>(None).decide(chooser)?
        } else {
            self.branches::<MOST_COLOURED>(shares).decide(chooser)?
        };
        let (layer, mix) = self.lobes[branch.lobe as usize].as_ref()?;
        let (mut left, point, at) = leave(self.arrival, layer, branch.slice as usize, chooser);
        if shares.is_some() {
            let at = at.or_else(|| layer.grids.locate(point.theta, point.phi));
            left.values = at.map_or([0.0; 3], |at| layer.values_at(mix, &at));
        }
        Some(left)
    }

    /// The coordinates of every branch that gives wo.
    pub fn invert(&self, shares: Option<[f64; 3]>, quantity: Quantity, wo: DVec3) -> Vec<(u64, f64)> {
        let mut found = Vec::new();
        let _ = self.branches::<MOST_COLOURED>(shares).find(|branch, share| {
            if let Some((layer, _)) =
                self.lobes[branch.lobe as usize].as_ref().filter(|(l, _)| l.quantity == quantity)
            {
                let (theta, phi) = angles(&self.axes(layer), wo);
                let inside = layer.grids.invert_by_row(branch.slice as usize, theta, phi);
                found.extend(inside.map(|(remainder, u2)| (share.invert(remainder), u2)));
            }
            false // All of them.
        });
        found
    }

    /// Proposals of white light, times the chance of being scattered: (inside cells, against a slice's largest).
    pub fn proposals(&self, shares: Option<[f64; 3]>) -> (f64, f64) {
        let (mut cells, mut table) = (0.0, 0.0);
        for branch in self.branches::<MOST_COLOURED>(shares).as_slice() {
            if let Some((layer, _)) = &self.lobes[branch.lobe as usize] {
                let (in_cell, in_table) = layer.grids.proposals(branch.slice as usize);
                cells += branch.weight * in_cell;
                table += branch.weight * in_table;
            }
        }
        (cells, table)
    }
}

/// A direction from a slice, the point of its grid, and where in the grid that lies if that is known. The values are still to be
/// told.
#[inline(always)]
pub(crate) fn leave<C: Chooser>(
    arrival: &Arrival,
    layer: &Layer,
    slice: usize,
    chooser: &mut C,
) -> (Left, GridPoint, Option<Located>) {
    let (point, at) = match chooser.sampling() {
        Sampling::Inverse(solver) => invert(&layer.grids, slice, solver, chooser),
        Sampling::Rejection(rejection) => (reject(&layer.grids, slice, rejection, chooser), None),
    };
    let wo = arrival.axes(layer.frame, layer.quantity) * point.direction;
    let below_horizon = wo.dot(arrival.outgoing_normal(layer.quantity)) <= 0.0;
    (Left { wo, quantity: layer.quantity, below_horizon, values: [1.0; 3] }, point, at)
}

/// By inverse functions. Where a coordinate goes on after a choice, one serves for the row and theta, the other for the column
/// and phi; else the cell has a coordinate of its own.
#[inline(always)]
fn invert<C: Chooser>(
    grids: &CompactGrids,
    slice: usize,
    solver: Solver,
    chooser: &mut C,
) -> (GridPoint, Option<Located>) {
    let mut u = chooser.reusable(Purpose::Scatter);
    if chooser.reuses() {
        let v = chooser.reusable(Purpose::Scatter);
        let (row, share) = grids.row_of(slice, u.bits());
        let u_theta = chooser.left(share.rest(u.bits()), share.probability(), Purpose::Scatter);
        let (column, probability, rest) = grids.column_of(slice, row, share, v.bits());
        let u_phi = chooser.left(rest, probability, Purpose::Scatter);
        let (point, at) = grids.place_at(slice, [row, column], [u_theta, u_phi], solver);
        return (point, Some(at));
    }
    let cell = choose_cell(grids, slice, &mut u, chooser);
    let u_theta = chooser.rest(u, Purpose::Scatter);
    let u_phi = chooser.uniform(Purpose::Scatter);
    (grids.place(slice, cell, u_theta, u_phi, solver), None)
}

#[inline]
fn choose_cell<C: Chooser>(grids: &CompactGrids, slice: usize, u: &mut Reusable, chooser: &mut C) -> usize {
    if grids.is_single(slice) {
        return grids.choose(slice, u);
    }
    chooser.choose_by(u, Purpose::Scatter, |u| grids.choose(slice, u))
}

/// By rejection. A photon on its way cannot go on with another point of the sequence, so of the two ways against the table's
/// maximum both take the photon's next coordinates.
#[inline(never)]
fn reject<C: Chooser>(
    grids: &CompactGrids,
    slice: usize,
    rejection: Rejection,
    chooser: &mut C,
) -> GridPoint {
    let mut u = chooser.reusable(Purpose::Scatter);
    let cell = match rejection {
        Rejection::Cell => Some(choose_cell(grids, slice, &mut u, chooser)),
        Rejection::Table | Rejection::NextPoint => None,
    };
    let mut u_theta = chooser.rest(u, Purpose::Scatter);
    loop {
        let u_phi = chooser.uniform(Purpose::Scatter);
        let (point, value) = match cell {
            Some(cell) => grids.propose_in_cell(slice, cell, u_theta, u_phi),
            None => grids.propose(slice, u_theta, u_phi),
        };
        if chooser.uniform(Purpose::Acceptance) < value {
            return point;
        }
        u_theta = chooser.uniform(Purpose::Scatter);
    }
}

/// (theta, phi) of a direction in a frame.
fn angles(axes: &DMat3, wo: DVec3) -> (f64, f64) {
    let d = DVec3::new(wo.dot(axes.x_axis), wo.dot(axes.y_axis), wo.dot(axes.z_axis));
    (libm::atan2(libm::hypot(d.x, d.y), d.z), libm::atan2(d.y, d.x))
}

/// Two given coordinates, the first of which chooses the slice too.
pub(crate) struct Given {
    u1: Option<Reusable>,
    u2: f64,
    solver: Solver,
}

impl Given {
    pub fn new(u1: u64, u2: f64, solver: Solver) -> Self {
        Self { u1: Some(Reusable::fresh(u1)), u2, solver }
    }
}

impl Chooser for Given {
    fn happens(&mut self, probability: f64) -> bool {
        probability >= 1.0
    }

    fn uniform(&mut self, _: Purpose) -> f64 {
        self.u2
    }

    fn reusable(&mut self, _: Purpose) -> Reusable {
        self.u1.take().unwrap_or(Reusable::fresh((self.u2 * TWO_TO_64) as u64))
    }

    fn decide<R>(&mut self, purpose: Purpose, choice: impl FnOnce(&mut Reusable) -> R) -> R {
        let mut u = self.reusable(purpose);
        let chosen = choice(&mut u);
        self.u1 = Some(u);
        chosen
    }

    /// However little is left: there is no other.
    fn left(&mut self, left: f64, _: f64, _: Purpose) -> f64 {
        left
    }

    fn sampling(&self) -> Sampling {
        Sampling::Inverse(self.solver)
    }
}
