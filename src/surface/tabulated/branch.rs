//! Which slice of which lobe scatters a photon, and where to.
//!
//! With renormalisation the slice is one of the photon's discrete events, on the coordinate that all of these
//! share, and the direction has two coordinates to itself: one for row and polar angle, one for column and
//! azimuth. So the direction goes steadily with both and hardly changes with the slice, and points that fill
//! the unit cube evenly fill the lobe evenly, even where their number allows only a few strata in each of
//! many dimensions (docs/STUDY.md). Without, each choice has its own coordinate.

use glam::{DMat3, DVec3};

use crate::sample::angles::Located;
use crate::sample::cell::GridPoint;
use crate::sample::choose::{Reusable, Share, TWO_TO_64};
use crate::sample::coordinates::{Chooser, Purpose};
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

    /// One branch by weight, as one event on `u`. The last one owns what the others leave.
    #[inline(always)]
    fn choose(&self, u: &mut Reusable) -> Option<Branch> {
        let (last, others) = self.as_slice().split_last()?;
        let scale = TWO_TO_64 / self.total;
        let (mut sum, mut low) = (0.0, 0);
        for branch in others {
            sum += branch.weight;
            // One too rare for a fraction of its own has none.
            let high = (sum * scale) as u64;
            if u.bits() < high {
                u.take(Share { low, width: high - low });
                return Some(*branch);
            }
            low = high;
        }
        u.take(Share { low, width: low.wrapping_neg() });
        Some(*last)
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

    /// g of a lobe by channel.
    pub fn projected(&self, quantity: Quantity, wo: DVec3) -> [f64; 3] {
        let Some((layer, mix)) = &self.lobes[quantity as usize] else { return [0.0; 3] };
        let (theta, phi) = angles(&self.axes(layer), wo);
        let Some(at) = layer.grids.locate(theta, phi) else { return [0.0; 3] };
        layer.values_at(mix, &at)
    }

    #[inline]
    fn axes(&self, layer: &Layer) -> DMat3 {
        self.arrival.axes(layer.frame, layer.quantity)
    }

    /// Every branch, the channels in these shares. A grey lobe is the same for all channels: one branch with
    /// all shares.
    #[inline(always)]
    fn branches(&self, shares: [f64; 3]) -> Branches<MOST_COLOURED> {
        let mut all = Branches::none();
        for (lobe, found) in self.lobes.iter().enumerate() {
            match found {
                None => {}
                Some(found) if found.0.channels == 1 => {
                    all.add_channel(lobe, found, 0, shares[0] + shares[1] + shares[2]);
                }
                Some(found) => (0..3).for_each(|k| all.add_channel(lobe, found, k, shares[k])),
            }
        }
        all
    }

    /// A direction of light that is scattered, with the values of its channels there; `None` where nothing
    /// is.
    #[inline(always)]
    pub fn sample<C: Chooser>(&self, shares: [f64; 3], chooser: &mut C) -> Option<Left> {
        let branch = self.branches(shares).decide(chooser)?;
        let (layer, mix) = self.lobes[branch.lobe as usize].as_ref()?;
        let (mut left, point, at) = leave(self.arrival, layer, branch.slice as usize, chooser);
        let at = at.or_else(|| layer.grids.locate(point.theta, point.phi));
        left.values = at.map_or([0.0; 3], |at| layer.values_at(mix, &at));
        Some(left)
    }

    /// Proposals of white light, times the chance of being scattered: (inside cells, against a slice's
    /// largest).
    pub fn proposals(&self, shares: [f64; 3]) -> (f64, f64) {
        let (mut cells, mut table) = (0.0, 0.0);
        for branch in self.branches(shares).as_slice() {
            if let Some((layer, _)) = &self.lobes[branch.lobe as usize] {
                let (in_cell, in_table) = layer.grids.proposals(branch.slice as usize);
                cells += branch.weight * in_cell;
                table += branch.weight * in_table;
            }
        }
        (cells, table)
    }
}

/// A direction from a slice, the point of its grid, and where in the grid that lies if that is known. The
/// values are still to be told.
#[inline(always)]
pub(crate) fn leave<C: Chooser>(
    arrival: &Arrival,
    layer: &Layer,
    slice: usize,
    chooser: &mut C,
) -> (Left, GridPoint, Option<Located>) {
    let (point, at) = layer.grids.draw(slice, chooser);
    let wo = arrival.axes(layer.frame, layer.quantity) * point.direction;
    let below_horizon = wo.dot(arrival.outgoing_normal(layer.quantity)) <= 0.0;
    (Left { wo, quantity: layer.quantity, below_horizon, values: [1.0; 3] }, point, at)
}

/// (theta, phi) of a direction in a frame.
fn angles(axes: &DMat3, wo: DVec3) -> (f64, f64) {
    let d = DVec3::new(wo.dot(axes.x_axis), wo.dot(axes.y_axis), wo.dot(axes.z_axis));
    (libm::atan2(libm::hypot(d.x, d.y), d.z), libm::atan2(d.y, d.x))
}
