//! The sums of an outcome as bytes, to go on from.

use std::io::{self, Read, Write};

use crate::math::varint::{expect, put, take, take_up_to};
use crate::scene::Scene;
use crate::tally::Moments;
use crate::tally::spot::SpotCount;
use crate::transport::parallel::Traced;

use super::outcome::{Outcome, ReplicateTotals};

impl Outcome {
    /// Writes the sums over finished replicates.
    ///
    /// # Errors
    /// Those of the writer.
    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.photons, u64::from(self.replicates)])?;
        let (ledger, census) = (self.ledger.clone(), self.census.clone());
        Traced { ledger, census, complete: true }.write(out)?;
        self.moments().try_for_each(|moments| moments.write(out))?;
        for ReplicateTotals { receivers, accounts } in &self.by_replicate {
            put(out, receivers.iter().chain(accounts).copied())?;
        }
        put(out, self.turned_away.iter().chain(&self.other_events).copied())?;
        for counts in &self.spots {
            put(out, [counts.len() as u64])?;
            counts.iter().try_for_each(|count| count.write(out))?;
        }
        self.far_fields.iter().try_for_each(|sums| sums.write(out))
    }

    /// Takes sums that were written, of the same scene and plan.
    ///
    /// # Errors
    /// Those of the reader; sums of another run.
    pub(super) fn read(&mut self, scene: &Scene, from: &mut dyn Read) -> io::Result<()> {
        let most = self.plan.replicates();
        self.stand_for(take(from)?);
        self.replicates = take_up_to(from, most.into(), "replicates")? as u32;
        let mut traced = Traced::new(scene);
        traced.add_from(from)?;
        (self.ledger, self.census) = (traced.ledger, traced.census);
        self.moments_mut().try_for_each(|moments| moments.read(from))?;
        let [receivers, accounts] = [self.totals.sum.len(), self.accounts.sum.len()];
        let list =
            |from: &mut dyn Read, n: usize| (0..n).map(|_| take(from)).collect::<io::Result<Vec<u64>>>();
        self.by_replicate.clear();
        for _ in 0..self.replicates {
            let (receivers, accounts) = (list(from, receivers)?, list(from, accounts)?);
            self.by_replicate.push(ReplicateTotals { receivers, accounts });
        }
        for sum in self.turned_away.iter_mut().chain(&mut self.other_events) {
            *sum = take(from)?;
        }
        for (counts, receiver) in self.spots.iter_mut().zip(&scene.receivers) {
            let number = receiver.spot.map_or(0, |_| self.replicates);
            expect(from, number.into(), "replicates of a spot")?;
            let spots = receiver.spot.into_iter().flat_map(|spot| (0..number).map(move |_| spot));
            *counts = spots.map(|spot| SpotCount::read(spot, from)).collect::<io::Result<_>>()?;
        }
        for (sums, field) in self.far_fields.iter_mut().zip(&scene.far_fields) {
            sums.read(from, most, field.nodes.count())?;
        }
        Ok(())
    }

    fn moments(&self) -> impl Iterator<Item = &Moments> {
        [&self.accounts, &self.totals, &self.grid_totals].into_iter().chain(&self.cells).chain(&self.grids)
    }

    fn moments_mut(&mut self) -> impl Iterator<Item = &mut Moments> {
        let Self { accounts, totals, grid_totals, cells, grids, .. } = self;
        [accounts, totals, grid_totals].into_iter().chain(cells).chain(grids)
    }
}
