//! Beam and field angle.

use super::{PhotometricType, Web};

/// The share of the plane's maximum at which a beam ends (beam angle).
pub const BEAM_SHARE: f64 = 0.5;
/// The share of the plane's maximum at which the field ends (field angle).
pub const FIELD_SHARE: f64 = 0.1;

/// Full angle in degrees of the lobe that holds the maximum of the principal plane, between the two directions where
/// the intensity has fallen to `share` of that maximum, linear between the table's angles. `None` for a dark plane.
///
/// The principal plane is C0-C180 (type C) or V = 0 (types A and B). The lobe is followed from the maximum to both
/// sides until it has fallen to the share, on a plateau to its beginning: a batwing whose middle falls below half counts
/// one wing. Where the
/// table ends above the share the lobe ends there; one that never falls is 360 degrees wide.
pub fn lobe_angle_deg(web: &Web, share: f64) -> Option<f64> {
    Profile::principal(web).lobe_deg(share)
}

/// The same in the plane across: C90-C270 (type C) or H = 0 (types A and B).
pub fn lobe_angle_across_deg(web: &Web, share: f64) -> Option<f64> {
    Profile::across(web).lobe_deg(share)
}

/// The same in the plane through the largest intensity ([`Web::max_intensity`]): its C and C + 180 (type C), its H (type
/// A), its V (type B), which are planes through the luminaire in each type.
pub fn lobe_angle_at_max_deg(web: &Web, share: f64) -> Option<f64> {
    Profile::through_max(web).lobe_deg(share)
}

/// Full angles along H and along V through the largest intensity, type B: what floodlights are classed by.
pub fn flood_angles_deg(web: &Web, share: f64) -> [Option<f64>; 2] {
    let max = web.max_intensity();
    let across = Profile::flat(&web.horizontal_deg, |h| web.intensity_cd(max.vertical_deg, h));
    let upright = Profile::flat(&web.vertical_deg, |v| web.intensity_cd(v, max.horizontal_deg));
    [across.lobe_deg(share), upright.lobe_deg(share)]
}

/// Intensities along one plane.
struct Profile {
    angle_deg: Vec<f64>,
    intensity_cd: Vec<f64>,
    /// Whether the last angle is the first one, a turn further.
    closed: bool,
}

impl Profile {
    fn principal(web: &Web) -> Self {
        match web.photometric_type {
            PhotometricType::C => Self::through_axis(web, 0.0),
            _ => Self::flat(&web.horizontal_deg, |h| web.intensity_cd(0.0, h)),
        }
    }

    fn across(web: &Web) -> Self {
        match web.photometric_type {
            PhotometricType::C => Self::through_axis(web, 90.0),
            _ => Self::flat(&web.vertical_deg, |v| web.intensity_cd(v, 0.0)),
        }
    }

    fn through_max(web: &Web) -> Self {
        let max = web.max_intensity();
        match web.photometric_type {
            PhotometricType::C => Self::through_axis(web, max.horizontal_deg),
            PhotometricType::A => Self::flat(&web.vertical_deg, |v| web.intensity_cd(v, max.horizontal_deg)),
            PhotometricType::B => Self::flat(&web.horizontal_deg, |h| web.intensity_cd(max.vertical_deg, h)),
        }
    }

    fn lobe_deg(&self, share: f64) -> Option<f64> {
        let peak = self.peak()?;
        let level = share * self.intensity_cd[peak];
        match (self.walk(peak, level, -1), self.walk(peak, level, 1)) {
            (Some(before), Some(after)) => Some((before + after).min(360.0)),
            _ => Some(360.0),
        }
    }

    /// V along the plane H counts positive, along the one opposite negative.
    fn through_axis(web: &Web, h: f64) -> Self {
        let v = &web.vertical_deg;
        let opposite = v.iter().rev().filter(|&&v| v > 0.0).map(|&v| (-v, web.intensity_cd(v, h + 180.0)));
        let plane = v.iter().map(|&v| (v, web.intensity_cd(v, h)));
        // A table that ends before the nadir is dark in between: the lobe must not leap across.
        let edge = v.first().copied().filter(|&v| v > 0.0);
        let dark = edge.into_iter().flat_map(|v| [(-v, 0.0), (v, 0.0)]);
        let (angle_deg, intensity_cd) = opposite.chain(dark).chain(plane).unzip();
        Self { angle_deg, intensity_cd, closed: v.last() == Some(&180.0) }
    }

    /// Along one axis of types A and B.
    fn flat(axis: &[f64], at: impl Fn(f64) -> f64) -> Self {
        let mirrored = axis.first() == Some(&0.0) && axis.len() > 1;
        let mut angle_deg: Vec<f64> = if axis.len() == 1 { vec![-90.0, 90.0] } else { axis.to_vec() };
        if mirrored {
            let below: Vec<f64> = axis.iter().skip(1).rev().map(|a| -a).collect();
            angle_deg.splice(0..0, below);
        }
        let intensity_cd = angle_deg.iter().map(|&a| at(a)).collect();
        Self { angle_deg, intensity_cd, closed: false }
    }

    /// The node of the maximum; of equal ones the nearest to the axis.
    fn peak(&self) -> Option<usize> {
        let is_better = |i: usize, best: usize| {
            let nearer = self.angle_deg[i].abs() < self.angle_deg[best].abs();
            let (one, most) = (self.intensity_cd[i], self.intensity_cd[best]);
            one > most || (one == most && nearer)
        };
        let lit = (0..self.intensity_cd.len()).filter(|&i| self.intensity_cd[i] > 0.0);
        lit.reduce(|best, i| if is_better(i, best) { i } else { best })
    }

    /// Degrees from node `start` to where the intensity falls to `level`; `None` if it never does.
    fn walk(&self, start: usize, level: f64, step: isize) -> Option<f64> {
        let n = self.angle_deg.len();
        let (mut at, mut gone) = (start, 0.0);
        for _ in 0..n {
            let next = match at.checked_add_signed(step).filter(|&i| i < n) {
                Some(next) => next,
                // The node at -180 is the node at 180: go on from there, at no distance.
                None if self.closed => {
                    at = if step > 0 { 0 } else { n - 1 };
                    continue;
                }
                None => return Some(gone),
            };
            let width = (self.angle_deg[next] - self.angle_deg[at]).abs();
            let (here, there) = (self.intensity_cd[at], self.intensity_cd[next]);
            // A table that states just the share has fallen to it there, but for the rounding of both products.
            if there <= level * (1.0 + 4.0 * f64::EPSILON) {
                let part = (here - level) / (here - there);
                return Some(gone + width * part.min(1.0));
            }
            gone += width;
            at = next;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use PhotometricType::{B, C};

    fn web(v: &[f64], h: &[f64], candela: &[f64]) -> Web {
        Web::new(C, v.to_vec(), h.to_vec(), candela.to_vec()).unwrap()
    }

    #[test]
    fn full_angles_of_known_lobes() {
        let beam = |w: &Web| lobe_angle_deg(w, BEAM_SHARE);
        // 100 at 0, 0 at 40: half at 20, a tenth at 36.
        let cone = web(&[0.0, 40.0, 90.0], &[0.0], &[100.0, 0.0, 0.0]);
        assert_eq!((beam(&cone), lobe_angle_deg(&cone, FIELD_SHARE)), (Some(40.0), Some(72.0)));
        // The same, upwards: the lobe is around 180.
        let up = web(&[90.0, 140.0, 180.0], &[0.0], &[0.0, 0.0, 100.0]);
        assert_eq!(beam(&up), Some(40.0));
        // One-sided: peak at V = 30 in C0 only, half at 25 and 40.
        let side = web(
            &[0.0, 20.0, 30.0, 50.0, 90.0],
            &[0.0, 90.0, 180.0, 270.0, 360.0],
            &[[0.0, 0.0, 100.0, 0.0, 0.0], [0.0; 5], [0.0; 5], [0.0; 5], [0.0, 0.0, 100.0, 0.0, 0.0]]
                .concat(),
        );
        assert_eq!(beam(&side), Some(15.0));
        // Cut off at the table's end, everywhere above half, dark.
        assert_eq!(beam(&web(&[0.0, 70.0], &[0.0], &[100.0, 90.0])), Some(140.0));
        assert_eq!(beam(&web(&[0.0, 180.0], &[0.0], &[100.0, 90.0])), Some(360.0));
        assert_eq!(beam(&web(&[0.0, 90.0], &[0.0], &[0.0, 0.0])), None);
        // Zero below V = 30: the two sides are apart.
        assert_eq!(beam(&web(&[30.0, 50.0], &[0.0], &[100.0, 0.0])), Some(10.0));
        let flood =
            Web::new(B, vec![-10.0, 0.0, 10.0], vec![0.0, 40.0], vec![0.0, 100.0, 0.0, 0.0, 0.0, 0.0])
                .unwrap();
        assert_eq!(beam(&flood), Some(40.0));
        assert_eq!(lobe_angle_across_deg(&flood, BEAM_SHARE), Some(10.0));
    }

    #[test]
    fn the_plane_through_the_maximum_holds_it() {
        // 10 cd everywhere but a beam in C40: 100 cd at V = 30, 10 at 20 and 50: half at 24.44 and 41.11.
        let mut candela = vec![10.0; 5 * 5];
        candela[2 * 5 + 2] = 100.0;
        let skew = web(&[0.0, 20.0, 30.0, 50.0, 90.0], &[0.0, 20.0, 40.0, 60.0, 360.0], &candela);
        assert_eq!(lobe_angle_deg(&skew, BEAM_SHARE), Some(180.0));
        let expected = 30.0 * (5.0 / 9.0);
        let got = lobe_angle_at_max_deg(&skew, BEAM_SHARE).unwrap();
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        // Maximum at V = 20, H = 10: 100 falling to 0 in 10 degrees of V and 30 of H; in another H something else.
        let v = vec![10.0, 20.0, 30.0];
        let flood =
            Web::new(B, v, vec![-20.0, 10.0, 40.0], vec![0.0, 0.0, 90.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0]);
        let flood = flood.unwrap();
        assert_eq!(flood_angles_deg(&flood, BEAM_SHARE), [Some(30.0), Some(10.0)]);
        assert_eq!(lobe_angle_at_max_deg(&flood, BEAM_SHARE), Some(30.0));
        let lamp = Web { photometric_type: PhotometricType::A, ..flood };
        assert_eq!(lobe_angle_at_max_deg(&lamp, BEAM_SHARE), Some(10.0));
    }
}
