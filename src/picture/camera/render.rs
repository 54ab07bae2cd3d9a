//! Passes of the camera over its pixels, tile by tile over threads; the same bits for any number of them.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::SurfaceId;
use crate::math::varint::{put, take, take_up_to};
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sequence::hash::stream_key;
use crate::sequence::owen::OwenPoints;
use crate::surface::luminance_of;

use super::eye::{EyePath, Pass};
use super::film::{Sums, TILE, TILE_PIXELS};
use super::filter;
use super::pixel::{PixelSums, SETS};
use super::view::View;

/// What a pass did beside its pixels.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Rendered {
    /// Pixels that an interrupt left unseen: black, of unknown error.
    pub unseen: u64,
    /// Eye paths that were ended because they did not end by themselves.
    pub killed: u64,
    /// Eye paths that were followed.
    pub paths: u64,
    /// Those of them that reached a surface in another medium than the scene says is there.
    pub contradicted: BTreeMap<SurfaceId, u64>,
}

impl Rendered {
    /// Adds what other tiles did.
    pub fn merge(&mut self, other: Self) {
        self.unseen += other.unseen;
        self.killed += other.killed;
        self.paths += other.paths;
        for (surface, count) in other.contradicted {
            *self.contradicted.entry(surface).or_default() += count;
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { unseen, killed, paths, contradicted } = self;
        put(out, [*unseen, *killed, *paths, contradicted.len() as u64])?;
        put(out, contradicted.iter().flat_map(|(surface, count)| [u64::from(surface.0), *count]))
    }

    /// Reads what was written.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn read(from: &mut dyn Read) -> io::Result<Self> {
        let (unseen, killed, paths) = (take(from)?, take(from)?, take(from)?);
        let mut read = Self { unseen, killed, paths, ..Self::default() };
        for _ in 0..take(from)? {
            let surface = take_up_to(from, u32::MAX.into(), "surfaces")? as u32;
            read.contradicted.insert(SurfaceId(surface), take(from)?);
        }
        Ok(read)
    }
}

/// Coordinates of a pixel's samples that come from a net; those beyond are independent.
const NET_COORDINATES: u32 = 12;
/// Salt of the pixels' seeds.
const SALT: u64 = 0xca;

/// Adds a pass to the sums. `progress` is told the number of pixels after each tile.
///
/// # Errors
/// One channel for a scene in colour; sums of another picture.
pub fn render<const C: usize>(
    view: &View<'_>,
    pass: &Pass<'_, C>,
    sums: &mut Sums<C>,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Rendered> {
    let all = 0..sums.tile_count();
    render_tiles(view, pass, sums, all, interrupt, progress)
}

/// The same of some tiles alone; the pass is over with the last of them.
///
/// # Errors
/// As [`render`].
pub fn render_tiles<const C: usize>(
    view: &View<'_>,
    pass: &Pass<'_, C>,
    sums: &mut Sums<C>,
    tiles: Range<usize>,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Rendered> {
    if !(C == 3 || (C == 1 && !view.scene.is_coloured())) || sums.pixels != view.camera.pixels {
        return Err(Diagnostic::new(
            Kind::Range,
            format!("a picture of {C} channels and {:?} pixels", sums.pixels),
            format!("3 channels for a scene in colour, else 1 or 3; {:?} pixels", view.camera.pixels),
        ));
    }
    let pixels = view.camera.pixels;
    let all = Mutex::new(Rendered::default());
    let sets = SETS.min(view.camera.samples);
    let (first, is_last) = (tiles.start, tiles.end == sums.tile_count());
    let some = &mut sums.tiles[tiles.start * TILE_PIXELS..tiles.end * TILE_PIXELS];
    some.par_chunks_mut(TILE_PIXELS).enumerate().for_each(|(tile, sums)| {
        let tile = first + tile;
        let mut brush = Brush::new(view, pass, sets);
        let corner = Sums::<C>::corner(pixels, tile);
        let (mut done, mut left) = (0, 0);
        for (k, sums) in sums.iter_mut().enumerate() {
            let [column, row] = [corner[0] + k as u32 % TILE, corner[1] + k as u32 / TILE];
            if column >= pixels[0] || row >= pixels[1] {
                continue;
            }
            if interrupt.load(Ordering::Relaxed) {
                *sums = PixelSums::UNSEEN;
                left += 1;
            } else {
                brush.paint([column, row], sums);
                done += 1;
            }
        }
        let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
        all.killed += brush.path.killed;
        all.unseen += left;
        all.paths += brush.path.paths;
        for (surface, (count, _)) in &brush.path.contradicted {
            *all.contradicted.entry(*surface).or_default() += count;
        }
        drop(all);
        progress(done);
    });
    if pass.finishes && is_last {
        sums.replicates += pass.replicates.len() as u32;
    }
    sums.sets = sets;
    Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Renders pixels one after another.
struct Brush<'a, const C: usize> {
    path: EyePath<'a, C>,
    sets: u32,
    samples_per_set: u32,
}

impl<'a, const C: usize> Brush<'a, C> {
    fn new(view: &'a View<'a>, pass: &'a Pass<'a, C>, sets: u32) -> Self {
        Self { path: EyePath::new(view, pass), sets, samples_per_set: view.camera.samples.div_ceil(sets) }
    }

    fn paint(&mut self, [column, row]: [u32; 2], sums: &mut PixelSums<C>) {
        let seed = stream_key(self.path.view.seed, row, column, SALT);
        let of_sample = 1.0 / (f64::from(self.sets) * f64::from(self.samples_per_set));
        self.path.gathered.clear();
        let mut before = [0.0; C];
        for set in 0..self.sets {
            let points = OwenPoints::with_coordinates(seed, set, NET_COORDINATES);
            let mut found = [0.0; C];
            for k in 0..self.samples_per_set {
                let light = self.sample(&points, k, [column, row]);
                (0..C).for_each(|c| found[c] += light[c]);
            }
            let gathered = self.path.gathered.value;
            for c in 0..C {
                found[c] += gathered[c] - before[c];
                sums.value[c] += found[c] * of_sample;
            }
            before = gathered;
            sums.by_set[set as usize] += (luminance_of(&found) / f64::from(self.samples_per_set)) as f32;
        }
        let pass = self.path.pass;
        sums.error.add(&self.path.gathered, of_sample, pass.replicates.clone(), pass.finishes);
    }

    fn sample(&mut self, points: &OwenPoints, k: u32, [column, row]: [u32; 2]) -> [f64; 3] {
        let mut chooser = Coordinates::new(points, u64::from(k), true);
        let view = self.path.view;
        let mut pair = || [(); 2].map(|()| chooser.uniform(Purpose::BeamPosition));
        let [dx, dy] = filter::offset(view.camera.filter, pair());
        let place = DVec2::new(f64::from(column) + 0.5 + dx, f64::from(row) + 0.5 + dy);
        let pinhole = &view.pinhole;
        let ray = if pinhole.has_lens() { pinhole.ray_by_lens(place, pair()) } else { pinhole.ray(place) };
        self.path.look(ray, &mut chooser)
    }
}
