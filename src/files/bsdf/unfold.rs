//! Azimuth lists of files, unfolded to one full turn with both ends.

use crate::scattering::Frame;

/// Angles a list of a file may have.
pub(crate) const MAX_ANGLES: usize = 100_000;

/// A full turn and, for each of its azimuths, the file's azimuth whose values it takes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Turn {
    pub azimuth_deg: Vec<f64>,
    pub source: Vec<usize>,
}

/// A table that does not depend on azimuth. About the specular direction the cosine of the horizon still does, so there the
/// turn has a node every 10 degrees.
pub(crate) fn rotational(frame: Frame) -> Turn {
    let sectors = match frame {
        Frame::Surface => 2,
        Frame::Specular => 36,
    };
    let azimuth_deg = (0..=sectors).map(|i| 360.0 * f64::from(i) / f64::from(sectors)).collect();
    Turn { azimuth_deg, source: vec![0; sectors as usize + 1] }
}

/// A table of one half, rising from 0 to 180, mirrored into the other; `None` where it does not span the half.
pub(crate) fn mirrored(half_deg: &[f64]) -> Option<Turn> {
    let spans = half_deg.len() >= 2 && half_deg.first() == Some(&0.0) && half_deg.last() == Some(&180.0);
    if !spans || !rises(half_deg) {
        return None;
    }
    let back = (0..half_deg.len() - 1).rev();
    Some(Turn {
        azimuth_deg: half_deg.iter().copied().chain(back.clone().map(|i| 360.0 - half_deg[i])).collect(),
        source: (0..half_deg.len()).chain(back).collect(),
    })
}

/// A table of the whole turn: as it is where both ends are listed, else closed with its first azimuth. `None` where the
/// azimuths do not rise, leave a turn, or are fewer than two.
pub(crate) fn closed(azimuth_deg: &[f64]) -> Option<Turn> {
    let (first, last) = (*azimuth_deg.first()?, *azimuth_deg.last()?);
    if azimuth_deg.len() < 2 || !rises(azimuth_deg) || last - first > 360.0 {
        return None;
    }
    let mut turn = Turn { azimuth_deg: azimuth_deg.to_vec(), source: (0..azimuth_deg.len()).collect() };
    if last - first < 360.0 {
        turn.azimuth_deg.push(first + 360.0);
        turn.source.push(0);
    }
    Some(turn)
}

/// Rising strictly; false also for what is not a number.
pub(crate) fn rises(angles: &[f64]) -> bool {
    angles.windows(2).all(|w| w[0] < w[1])
}

/// The values of an unfolded table, [channel][phi_i][theta_i][polar][azimuth]. `phi_i` has the file's azimuth of incidence that
/// each one takes, and whether its values are mirrored in azimuth; `block` gives, for a channel, an azimuth of incidence and a
/// theta_i of the file, its values [azimuth][polar].
pub(crate) fn unfold<'v>(
    counts: [usize; 5],
    phi_i: impl Iterator<Item = (usize, bool)> + Clone,
    turn: &Turn,
    block: impl Fn(usize, usize, usize) -> &'v [f32],
) -> Vec<f32> {
    let [channels, _, thetas, polars, _] = counts;
    let mut out = Vec::with_capacity(counts.iter().product());
    for channel in 0..channels {
        for (phi, mirrored) in phi_i.clone() {
            for theta in 0..thetas {
                let block = block(channel, phi, theta);
                for polar in 0..polars {
                    let values = turn.source.iter().map(|azimuth| block[azimuth * polars + polar]);
                    if mirrored { out.extend(values.rev()) } else { out.extend(values) }
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_mirrored_and_turns_closed() {
        let turn = mirrored(&[0.0, 60.0, 180.0]).unwrap();
        assert_eq!(turn.azimuth_deg, [0.0, 60.0, 180.0, 300.0, 360.0]);
        assert_eq!(turn.source, [0, 1, 2, 1, 0]);
        assert_eq!(mirrored(&[0.0, 90.0]), None);
        assert_eq!(mirrored(&[180.0]), None);
        let turn = closed(&[0.0, 90.0, 180.0, 270.0]).unwrap();
        assert_eq!((turn.azimuth_deg[4], turn.source[4]), (360.0, 0));
        assert_eq!(closed(&[-180.0, 0.0, 180.0]).unwrap().source, [0, 1, 2]);
        assert_eq!(closed(&[0.0, 90.0, 90.0]), None);
        assert_eq!(closed(&[0.0, 361.0]), None);
    }
}
