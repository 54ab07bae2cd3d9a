//! Tables of type C turned about their axis, and folded again where they are mirrored.

use super::web::Symmetry;
use super::{PhotometricType, Web};

impl Web {
    /// The table with what was at H at H + `by_deg`, type C; others and rotational ones as they are. Planes
    /// are joined at 0, where one is interpolated if there is none, which leaves the bilinear function as it
    /// was.
    pub fn turned(&self, by_deg: f64) -> Self {
        if self.photometric_type != PhotometricType::C || self.symmetry() == Symmetry::Rotational {
            return self.clone();
        }
        let circle = self.over_circle();
        let n_v = circle.vertical_deg.len();
        let rows = circle.horizontal_deg.iter().zip(circle.candela.chunks_exact(n_v.max(1)));
        let mut planes: Vec<(f64, Vec<f64>)> =
            rows.map(|(h, row)| (settled(h + by_deg), row.to_vec())).collect();
        // The last is the first, a turn further.
        planes.pop();
        planes.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let (Some((first, low)), Some((last, high))) = (planes.first(), planes.last())
            && *first != 0.0
        {
            let weight = (360.0 - last) / (first + 360.0 - last);
            let seam = high.iter().zip(low).map(|(a, b)| (1.0 - weight) * a + weight * b).collect();
            planes.insert(0, (0.0, seam));
        }
        planes.extend(planes.first().map(|(_, row)| (360.0, row.clone())));
        let (horizontal_deg, rows): (Vec<f64>, Vec<Vec<f64>>) = planes.into_iter().unzip();
        Self { horizontal_deg, candela: rows.concat(), ..circle }.folded()
    }

    /// A table over 0..360 by the least part of it that stands for the whole, where its planes are mirrored
    /// to the last bit.
    fn folded(self) -> Self {
        let n_v = self.vertical_deg.len().max(1);
        let row = |i: usize| &self.candela[i * n_v..(i + 1) * n_v];
        let place = |h: f64| self.horizontal_deg.iter().position(|&stored| stored == h);
        let mirrored = |image: fn(f64) -> f64| {
            let twin = |(i, &h): (usize, &f64)| place(image(h)).is_some_and(|j| row(i) == row(j));
            self.horizontal_deg.iter().enumerate().all(twin)
        };
        let at_0 = mirrored(|h| 360.0 - h);
        let at_90 = mirrored(|h| if h <= 180.0 { 180.0 - h } else { 540.0 - h });
        let part = match (at_0, at_90) {
            (true, true) => place(0.0).zip(place(90.0)),
            (true, false) => place(0.0).zip(place(180.0)),
            (false, true) => place(90.0).zip(place(270.0)),
            (false, false) => None,
        };
        match part {
            Some((from, to)) => Self {
                photometric_type: self.photometric_type,
                horizontal_deg: self.horizontal_deg[from..=to].to_vec(),
                candela: self.candela[from * n_v..(to + 1) * n_v].to_vec(),
                vertical_deg: self.vertical_deg,
            },
            None => self,
        }
    }
}

/// An angle within 0..360, without the noise of a sum in its last digits.
fn settled(degrees: f64) -> f64 {
    let rounded = (degrees.rem_euclid(360.0) * 1e9).round() / 1e9;
    if rounded >= 360.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(h: &[f64]) -> Web {
        let candela = h.iter().flat_map(|h| [100.0 + h, 50.0 + 0.5 * h, 0.25 * h]).collect();
        Web::new(PhotometricType::C, vec![0.0, 45.0, 90.0], h.to_vec(), candela).unwrap()
    }

    #[test]
    fn symmetries_turn_into_one_another() {
        let bilateral = table(&[0.0, 20.0, 90.0, 150.0, 180.0]);
        let quarter = bilateral.turned(90.0);
        assert_eq!((quarter.symmetry(), quarter.horizontal_deg[1]), (Symmetry::Bilateral90To270, 110.0));
        assert_eq!(quarter.candela, bilateral.candela);
        assert_eq!(quarter.turned(-90.0), bilateral);
        // By a half: the same planes backwards.
        let half = bilateral.turned(180.0);
        assert_eq!(half.horizontal_deg, [0.0, 30.0, 90.0, 160.0, 180.0]);
        assert_eq!(half.intensity_cd(45.0, 30.0), bilateral.intensity_cd(45.0, 150.0));
        let quadrants = table(&[0.0, 20.0, 90.0]);
        assert_eq!(quadrants.turned(180.0), quadrants);
        assert_eq!(quadrants.turned(270.0).horizontal_deg, [0.0, 70.0, 90.0]);
        let askew = quadrants.turned(7.0);
        assert_eq!((askew.symmetry(), askew.horizontal_deg.len()), (Symmetry::None, 10));
        assert_eq!(table(&[0.0]).turned(33.0), table(&[0.0]));
    }
}
