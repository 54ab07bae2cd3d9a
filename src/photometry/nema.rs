//! NEMA types of floodlights (ANSI/NEMA FA 1; IES LM-35): classes of the field angle, at 10 % of the largest
//! intensity.

use super::beam::{FIELD_SHARE, flood_angles_deg, lobe_angle_across_deg, lobe_angle_deg};
use super::{PhotometricType, Web};
use serde::Serialize;

/// Field angles at which types 1 to 7 begin, degrees.
const BEGINS_DEG: [f64; 7] = [10.0, 18.0, 29.0, 46.0, 70.0, 100.0, 130.0];

/// The class of a floodlight in two planes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NemaType {
    /// Names of the planes: along H and along V through the maximum (type B), C0-C180 and C90-C270 (type C).
    pub planes: [&'static str; 2],
    /// Field angles in them, degrees.
    pub field_angles_deg: [f64; 2],
    /// Types, 1 to 7.
    pub types: [u32; 2],
}

impl NemaType {
    /// Of a table, or why it has none. Both planes must go through the largest intensity: in type C it must
    /// be on the axis.
    pub fn new(web: &Web) -> Result<Self, &'static str> {
        let max = web.max_intensity();
        let (planes, angles) = match web.photometric_type {
            PhotometricType::A => return Err("floodlights are classed by tables of type B or C"),
            PhotometricType::B => (["H", "V"], flood_angles_deg(web, FIELD_SHARE)),
            PhotometricType::C if max.vertical_deg % 180.0 != 0.0 => {
                return Err(
                    "the largest intensity is off the axis: planes C0-C180 and C90-C270 do not hold it",
                );
            }
            PhotometricType::C => (
                ["C0-C180", "C90-C270"],
                [lobe_angle_deg(web, FIELD_SHARE), lobe_angle_across_deg(web, FIELD_SHARE)],
            ),
        };
        let [Some(first), Some(second)] = angles else { return Err("a flux of 0") };
        match [class(first), class(second)] {
            [Some(a), Some(b)] => Ok(Self { planes, field_angles_deg: [first, second], types: [a, b] }),
            _ => Err("a field angle below 10 degrees, where type 1 begins"),
        }
    }
}

/// The type of a field angle; `None` below 10 degrees.
fn class(field_angle_deg: f64) -> Option<u32> {
    let begun = BEGINS_DEG.iter().filter(|&&begin| field_angle_deg >= begin).count() as u32;
    (begun > 0).then_some(begun)
}

#[cfg(test)]
mod tests {
    use super::*;
    use PhotometricType::{A, B, C};

    #[test]
    fn classes_begin_where_they_say() {
        for (angle, expected) in [
            (9.9, None),
            (10.0, Some(1)),
            (17.9, Some(1)),
            (18.0, Some(2)),
            (29.0, Some(3)),
            (46.0, Some(4)),
            (70.0, Some(5)),
            (99.9, Some(5)),
            (100.0, Some(6)),
            (130.0, Some(7)),
            (180.0, Some(7)),
        ] {
            assert_eq!(class(angle), expected, "{angle}");
        }
    }

    #[test]
    fn planes_go_through_the_maximum() {
        // Linear from 100 cd at (10, 0) to 0 in 20 degrees of V and 60 of H: a tenth at 18 and 54 degrees to
        // both sides.
        let candela = vec![0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0];
        let flood = Web::new(B, vec![-10.0, 10.0, 30.0], vec![-60.0, 0.0, 60.0], candela).unwrap();
        let nema = NemaType::new(&flood).unwrap();
        assert_eq!((nema.types, nema.planes), ([6, 3], ["H", "V"]));
        assert!((nema.field_angles_deg[0] - 108.0).abs() < 1e-9);
        assert!(NemaType::new(&Web { photometric_type: A, ..flood }).is_err());
        let cone = Web::new(C, vec![0.0, 40.0, 90.0], vec![0.0], vec![100.0, 0.0, 0.0]).unwrap();
        assert_eq!(NemaType::new(&cone).unwrap().types, [5, 5]);
        let batwing = Web::new(C, vec![0.0, 40.0, 90.0], vec![0.0], vec![50.0, 100.0, 0.0]).unwrap();
        assert!(NemaType::new(&batwing).unwrap_err().contains("off the axis"));
        let pencil = Web::new(C, vec![0.0, 2.0, 90.0], vec![0.0], vec![50.0, 0.0, 0.0]).unwrap();
        assert!(NemaType::new(&pencil).unwrap_err().contains("below 10"));
    }
}
