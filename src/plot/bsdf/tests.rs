//! Diagrams of tables whose curves are known.

use super::slices::WANTED_DEG;
use super::*;
use crate::files::bsdf::text::parse;

/// A table in the surface frame, of one slice a list of f at 0, 45 and 90 degrees.
fn table(lobes: &str) -> ScatterTable {
    parse(format!("caustix-scattering 1\n{lobes}").as_bytes(), "test").unwrap()
}

/// A lobe 4 degrees wide about the mirrored or straight-through direction of light from 40 degrees.
fn narrow(quantity: &str) -> ScatterTable {
    table(&format!(
        "frame specular\nsymmetry rotational\nchannels 1\ntheta_i 40\npolar 0 2\nlobe {quantity} both\n\
         incidence 40\n9 0\n"
    ))
}

fn largest(slice: &Slice) -> (f64, f64) {
    slice.points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

#[test]
fn lobes_point_forwards_and_to_their_side() {
    for (quantity, up) in [("reflection", true), ("transmission", false)] {
        let plot = BsdfPlot::new(&narrow(quantity), "t", None);
        let (angle, intensity) = largest(&plot.slices[0]);
        assert!((angle - 40.0).abs() < 1e-9, "{quantity}: {angle}");
        assert!((intensity - 9.0 * 40f64.to_radians().cos()).abs() < 1e-6, "{quantity}: {intensity}");
        let disc = plot.disc();
        let [x, y] = disc.place(up, angle, disc.radius(intensity));
        assert!(x > disc.centre[0] && (y < disc.centre[1]) == up, "{quantity}");
        assert_eq!(disc.full, !up);
    }
}

#[test]
fn a_diffuser_draws_a_circle() {
    let polar: Vec<String> = (0..=90).map(|a| a.to_string()).collect();
    let values = "0.25 ".repeat(91);
    let plot = BsdfPlot::new(
        &table(&format!(
            "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0 50\npolar {}\nlobe reflection both\n\
             incidence 0\n{values}\nincidence 50\n{values}\n",
            polar.join(" ")
        )),
        "t",
        None,
    );
    let disc = plot.disc();
    assert!(matches!(disc.scale, Scale::Linear(outer) if outer == 0.25));
    for slice in &plot.slices {
        for (angle, intensity) in &slice.points {
            let [x, y] = disc.place(true, *angle, disc.radius(*intensity));
            let from_middle = (x - disc.centre[0]).hypot(y - disc.centre[1] + 0.5 * RADIUS);
            // The table's chords, a degree wide, lie inside the circle.
            assert!((from_middle - 0.5 * RADIUS).abs() < 0.01, "{angle}: {from_middle}");
        }
    }
}

#[test]
fn grooves_show_in_both_planes_even_at_normal_incidence() {
    let slices = [3.0, 1.0, 3.0, 1.0, 3.0].iter().zip([0, 90, 180, 270, 360]);
    let blocks: String = slices.map(|(f, phi)| format!("incidence 0 {phi}\n{f} {f}\n")).collect();
    let head = "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\nphi_i 0 90 180 270 360\npolar 0 90\n\
                lobe reflection both\n";
    let plot = BsdfPlot::new(&table(&(head.to_owned() + &blocks)), "t", None);
    let drawn: Vec<_> = plot.slices.iter().map(|s| (s.phi_i_deg, largest(s).1)).collect();
    assert_eq!(drawn, [(Some(0.0), 3.0), (Some(90.0), 1.0)]);
    let pens = plot.drawing().shapes.into_iter().filter_map(|s| match s {
        Shape::Polyline { points, pen } if points.len() > 100 => Some(pen),
        _ => None,
    });
    let pens: Vec<Pen> = pens.collect();
    assert_eq!((pens.len(), pens[0].dash_px, pens[1].dash_px.is_some()), (2, None, true));
    assert_eq!(pens[0].colour, pens[1].colour, "one colour for one polar angle");
}

#[test]
fn four_incidences_at_most_and_a_logarithm_where_they_differ_much() {
    let blocks: String = (0..=8).map(|i| format!("incidence {}\n{f} {f}\n", 10 * i, f = 1 << i)).collect();
    let angles: Vec<String> = (0..=8).map(|i| (10 * i).to_string()).collect();
    let head = format!(
        "frame surface\nsymmetry rotational\nchannels 1\ntheta_i {}\npolar 0 90\nlobe reflection both\n",
        angles.join(" ")
    );
    let plot = BsdfPlot::new(&table(&(head + &blocks)), "t", None);
    assert_eq!(plot.slices.iter().map(|s| s.theta_i_deg).collect::<Vec<_>>(), WANTED_DEG);
    let disc = plot.disc();
    assert_eq!(disc.scale, Scale::Logarithmic(1000.0));
    assert!((disc.radius(1000.0) - RADIUS).abs() < 1e-9 && (disc.radius(10.0) - 0.6 * RADIUS).abs() < 1e-9);
    assert_eq!((disc.radius(1e-3), disc.radius(0.0)), (0.0, 0.0));
    assert_eq!(disc.rings.len(), 5);
}

#[test]
fn dark_and_grazing_tables_draw_without_a_broken_number() {
    for lobes in [
        "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\npolar 0 90\nlobe reflection back\nincidence 0\n0 0\n",
        "frame specular\nsymmetry rotational\nchannels 1\ntheta_i 90\npolar 0 180\nlobe transmission both\n\
         incidence 90\n1e-38 1e-38\n",
    ] {
        let svg = BsdfPlot::new(&table(lobes), "<a & b>", Some("x".into())).drawing().to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(svg.contains("&lt;a &amp; b&gt;"));
    }
}
