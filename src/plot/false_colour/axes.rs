//! What the axes of a map show: metres on a rectangle, angles on what goes round.

use crate::report::colour::scale::linear_ticks;

use super::super::canvas::{Anchor, Canvas, TextStyle};
use super::super::drawing::ink;
use super::super::font;
use super::{MARGIN, TEXT_SIZE, TICK_LENGTH, TICK_SIZE, crisp};

/// The axes of a map over a surface's (u, v), v up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axes {
    /// A picture: none.
    None,
    /// Sides along u and v, m.
    Metres([f64; 2]),
    /// A sphere: azimuth, and latitude by Lambert's cylindrical map.
    Sphere,
    /// A surface of revolution: azimuth, and the share of the area.
    Round,
}

/// The marks of one axis: place from 0 to 1 and label; and what the numbers are.
pub(super) struct Marks {
    pub(super) marks: Vec<(f64, String)>,
    name: &'static str,
}

impl Axes {
    /// Sides in metres, where they are lengths.
    pub(super) fn size_m(self) -> Option<[f64; 2]> {
        let Self::Metres(size) = self else { return None };
        let is_valid = size.iter().all(|s| s.is_finite() && *s > 0.0) && (size[0] / size[1]).is_normal();
        is_valid.then_some(size)
    }

    /// Marks along u and v on so many pixels.
    pub(super) fn marks(self, display: [usize; 2]) -> [Marks; 2] {
        let count = |pixels: usize, room: usize| (pixels / room).clamp(1, 8);
        let [along, up] = [count(display[0], 90), count(display[1], 70)];
        match (self, self.size_m()) {
            (Self::None, _) => [Marks::none(), Marks::none()],
            (_, Some([u, v])) => [Marks::linear(u, along, "u [m]"), Marks::linear(v, up, "v [m]")],
            (Self::Sphere, _) => [Marks::azimuth(), Marks::latitude()],
            (Self::Round, _) => [Marks::azimuth(), Marks::linear(1.0, up, "share of the area")],
            (Self::Metres(_), None) => [Marks::linear(1.0, along, "u"), Marks::linear(1.0, up, "v")],
        }
    }

    /// Draws ticks, numbers and names around a map at x, y of this width and height.
    pub(super) fn draw(self, canvas: &mut Canvas, map: [usize; 4]) {
        if self == Self::None {
            return;
        }
        let [along, up] = self.marks([map[2], map[3]]);
        let [x, y, width, height] = map.map(|p| p as f64);
        let style = TextStyle::new(TICK_SIZE, ink());
        let mut free_from = f64::NEG_INFINITY;
        for (place, label) in &along.marks {
            let at = crisp(x + place * width);
            canvas.line([at, y + height + 1.0], [at, y + height + TICK_LENGTH], 1.0, ink());
            let half = 0.5 * font::width_px(label, TICK_SIZE, true);
            // On a narrow map the numbers would run into each other.
            if at - half > free_from {
                let place = [at, y + height + TICK_LENGTH + 14.0];
                canvas.text(place, label, &style.anchored(Anchor::Middle));
                free_from = at + half + 6.0;
            }
        }
        let mut free_below = f64::INFINITY;
        for (place, label) in &up.marks {
            let at = crisp(y + height - place * height);
            canvas.line([x - 1.0, at], [x - TICK_LENGTH, at], 1.0, ink());
            if at < free_below {
                canvas.text([x - TICK_LENGTH - 5.0, at + 4.0], label, &style.anchored(Anchor::End));
                free_below = at - TICK_SIZE;
            }
        }
        let name = TextStyle::new(TEXT_SIZE, ink()).anchored(Anchor::Middle);
        canvas.text([x + 0.5 * width, y + height + TICK_LENGTH + 33.0], along.name, &name);
        let beside = [MARGIN as f64 + 10.0, y + 0.5 * height];
        canvas.text_rotated(beside, -std::f64::consts::FRAC_PI_2, up.name, &name, 0.0);
    }
}

impl Marks {
    fn none() -> Self {
        Self { marks: Vec::new(), name: "" }
    }

    fn linear(end: f64, count: usize, name: &'static str) -> Self {
        let marks = linear_ticks(0.0, end, count).into_iter().map(|t| (t.value / end, t.label));
        Self { marks: marks.collect(), name }
    }

    fn azimuth() -> Self {
        let quarter = |i: u32| (0.25 * f64::from(i), (90 * i).to_string());
        Self { marks: (0..=4).map(quarter).collect(), name: "azimuth [deg]" }
    }

    /// v = (1 + sin(latitude)) / 2.
    fn latitude() -> Self {
        let mark = |degrees: i32| {
            let sine = libm::sin(f64::from(degrees).to_radians());
            (0.5 * (1.0 + sine), degrees.to_string())
        };
        Self { marks: [-90, -60, -30, 0, 30, 60, 90].map(mark).into(), name: "latitude [deg]" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_has_latitudes_where_their_bands_have_equal_areas() {
        let [along, up] = Axes::Sphere.marks([700, 350]);
        let at = |marks: &Marks, label: &str| marks.marks.iter().find(|(_, l)| l == label).unwrap().0;
        // A cap above latitude 30 degrees is a quarter of the sphere.
        for (label, place) in [("-90", 0.0), ("0", 0.5), ("30", 0.75), ("-30", 0.25), ("90", 1.0)] {
            assert!((at(&up, label) - place).abs() < 1e-15, "{label}");
        }
        assert_eq!((at(&along, "90"), at(&along, "360")), (0.25, 1.0));
    }

    #[test]
    fn sides_that_are_no_lengths_have_parts_of_one() {
        let [along, up] = Axes::Metres([0.0, f64::NAN]).marks([700, 700]);
        assert_eq!((along.name, up.name), ("u", "v"));
        assert_eq!(along.marks.last().unwrap(), &(1.0, "1.0".to_owned()));
        let [along, _] = Axes::Metres([4.0, 2.0]).marks([700, 350]);
        assert_eq!((along.name, along.marks[1].0), ("u [m]", 0.25));
        assert_eq!(along.marks[1].1, "1");
    }
}
