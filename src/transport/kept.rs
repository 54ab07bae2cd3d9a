//! Ledger and census as bytes, to be kept or sent and added up.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};

use crate::geometry::SurfaceId;
use crate::math::varint::{damaged, expect, put, take};

use super::census::{Census, Exceptions};
use super::ledger::Ledger;
use super::parallel::Traced;

/// Most photons of a run.
const MOST_PHOTONS: u64 = 1 << 48;

impl Traced {
    /// Writes what there is.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { ledger: Ledger { emitted, absorbed, escaped, killed, trapped }, census, .. } = self;
        let Census { dimension_histogram, dimension_max, drawn_for, exceptions, missed } = census;
        for list in [&emitted[..], &absorbed[..], &dimension_histogram[..], &drawn_for[..]] {
            put(out, [list.len() as u64])?;
            put(out, list.iter().copied())?;
        }
        let Exceptions {
            skipped_crossings,
            corrected_directions,
            below_horizon,
            contradicted,
            lost,
            events,
            met,
        } = exceptions;
        put(out, [*escaped, *killed, u64::from(*dimension_max)])?;
        put(out, [*skipped_crossings, *below_horizon, *events, *met])?;
        for map in [trapped, corrected_directions, contradicted, lost] {
            put(out, [map.len() as u64])?;
            put(out, map.iter().flat_map(|(surface, count)| [u64::from(surface.0), *count]))?;
        }
        put(out, [missed.len() as u64])?;
        put(out, missed.iter().flat_map(|(emitter, count)| [*emitter as u64, *count]))
    }

    /// Adds what was written, of the same scene.
    ///
    /// # Errors
    /// Those of the reader; accounts of another scene, and such as do not balance.
    pub fn add_from(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let (emitters, surfaces) = (self.ledger.emitted.len(), self.ledger.absorbed.len());
        let mut more =
            Self { ledger: Ledger::new(emitters, surfaces), census: Census::default(), complete: true };
        let Self { ledger, census, .. } = &mut more;
        let lists: [(&mut [u64], &str); 3] = [
            (&mut ledger.emitted, "emitters"),
            (&mut ledger.absorbed, "surfaces"),
            (&mut census.dimension_histogram, "dimensions"),
        ];
        for (list, what) in lists {
            expect(from, list.len() as u64, what)?;
            list.iter_mut().try_for_each(|number| photons(from).map(|n| *number = n))?;
        }
        expect(from, census.drawn_for.len() as u64, "purposes")?;
        census.drawn_for.iter_mut().try_for_each(|number| take(from).map(|n| *number = n))?;
        let e = &mut census.exceptions;
        (ledger.escaped, ledger.killed) = (photons(from)?, photons(from)?);
        census.dimension_max = u32::try_from(take(from)?).map_err(|_| damaged("too many coordinates"))?;
        (e.skipped_crossings, e.below_horizon, e.events, e.met) =
            (take(from)?, take(from)?, take(from)?, take(from)?);
        for map in [&mut ledger.trapped, &mut e.corrected_directions, &mut e.contradicted, &mut e.lost] {
            *map = map_of(from, surfaces, |i| SurfaceId(i as u32))?;
        }
        census.missed = map_of(from, emitters, |i| i)?;
        let counted = more.census.photons();
        if more.ledger.total_ended() != counted || more.ledger.total_emitted() != counted {
            return Err(damaged("accounts that do not balance"));
        }
        self.merge(&more);
        Ok(())
    }
}

/// A number of photons: of more than 2^48 there is no run, and fewer can be added up without a look.
fn photons(from: &mut dyn Read) -> io::Result<u64> {
    Some(take(from)?).filter(|n| *n <= MOST_PHOTONS).ok_or_else(|| damaged("more photons than a run has"))
}

/// Counts of at most so many things.
fn map_of<K: Ord>(
    from: &mut dyn Read,
    most: usize,
    key: impl Fn(usize) -> K,
) -> io::Result<BTreeMap<K, u64>> {
    let number = take(from)?;
    if number > most as u64 {
        return Err(damaged(&format!("{number} accounts of {most} things")));
    }
    let mut map = BTreeMap::new();
    for _ in 0..number {
        let (of, count) = (take(from)?, photons(from)?);
        let of = usize::try_from(of).ok().filter(|of| *of < most);
        map.insert(key(of.ok_or_else(|| damaged("an account of nothing"))?), count);
    }
    Ok(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::walk::End;

    fn some() -> Traced {
        let mut traced = Traced { ledger: Ledger::new(2, 3), census: Census::default(), complete: true };
        for (emitter, end) in
            [(0, End::Absorbed(SurfaceId(2))), (1, End::Escaped), (1, End::Trapped(SurfaceId(1)))]
        {
            traced.ledger.begin(emitter);
            traced.ledger.end(end);
            traced.census.count(5, &[1, 1, 1, 1, 1, 0, 0]);
        }
        traced.census.missed.insert(1, 7);
        let e = &mut traced.census.exceptions;
        (e.events, e.met, e.skipped_crossings, e.below_horizon) = (9, 0b101, 3, 4);
        e.corrected_directions.insert(SurfaceId(0), 11);
        e.contradicted.insert(SurfaceId(1), 12);
        e.lost.insert(SurfaceId(2), 13);
        traced
    }

    #[test]
    fn what_is_written_is_added() {
        let traced = some();
        let mut bytes = Vec::new();
        traced.write(&mut bytes).unwrap();
        let mut sum = Traced { ledger: Ledger::new(2, 3), census: Census::default(), complete: true };
        sum.add_from(&mut &bytes[..]).unwrap();
        assert_eq!((&sum.ledger, &sum.census), (&traced.ledger, &traced.census));
        sum.add_from(&mut &bytes[..]).unwrap();
        let mut twice = traced.clone();
        twice.merge(&traced);
        assert_eq!((&sum.ledger, &sum.census), (&twice.ledger, &twice.census));
    }

    #[test]
    fn accounts_of_another_scene_cut_short_or_unbalanced_are_refused() {
        let mut bytes = Vec::new();
        some().write(&mut bytes).unwrap();
        let mut other = Traced { ledger: Ledger::new(2, 4), census: Census::default(), complete: true };
        assert!(other.add_from(&mut &bytes[..]).unwrap_err().to_string().contains("3 surfaces"));
        let mut same = some();
        assert!(same.add_from(&mut &bytes[..bytes.len() - 1]).is_err());
        let mut unbalanced = some();
        unbalanced.ledger.escaped += 1;
        bytes.clear();
        unbalanced.write(&mut bytes).unwrap();
        assert!(same.add_from(&mut &bytes[..]).unwrap_err().to_string().contains("balance"));
    }
}
