//! Light that meets a plane straight or by way of a plane mirror, against the integral of I cos / d^2 in every cell.
//!
//! The intensity is that of the file's own table ([`Lamp`]); nothing of the sampler is used.

use caustix::sequence::Sequence;
use glam::DVec3;

use crate::support::judge::{assert_cells, assert_total};
use crate::support::lamp::Lamp;
use crate::support::quadrature::cell_means;
use crate::support::scenes::{run, scene};

const AIM: DVec3 = DVec3::new(0.25, 0.15, -1.0);
const UP: DVec3 = DVec3::new(0.3, 1.0, 0.2);
const POSITION: DVec3 = DVec3::new(0.11, -0.07, 1.5);
const CELLS: usize = 24;
/// For the little light that comes by way of the mirror.
const COARSE: usize = 8;

fn emitter(file: &str) -> String {
    format!(
        r#"
[[emitter]]
type = "photometric"
file = "../ies/{file}"
position = {:?}
aim = {:?}
up = {:?}
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.5, -1.5, 0.0]
edge_u = [3.0, 0.0, 0.0]
edge_v = [0.0, 3.0, 0.0]
[[receiver]]
surface = "plate"
cells = [{CELLS}, {CELLS}]
"#,
        POSITION.to_array(),
        AIM.to_array(),
        UP.to_array()
    )
}

fn on_plate(u: f64, v: f64) -> DVec3 {
    DVec3::new(3.0 * u - 1.5, 3.0 * v - 1.5, 0.0)
}

#[test]
fn files_of_every_type_light_a_bare_plane_as_the_integral_says() {
    // The panels resolve the table's cells: 0.5 degrees in the headlamp's, 2.5 to 15 in the others.
    for (file, panels) in
        [("headlamp_a.ies", 24), ("floodlight_b.ies", 6), ("wavy_glass.ies", 10), ("pool_lamp.ies", 4)]
    {
        let lamp = Lamp::new(file, POSITION, AIM, UP);
        let exact = cell_means(CELLS, CELLS, panels, |u, v| lamp.illuminance_lx(on_plate(u, v), DVec3::Z));
        let scene = scene(&emitter(file));
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 16, 16, 1);
        assert_cells(file, &scene, &outcome, 0, &exact);
        let area = 9.0 / (CELLS * CELLS) as f64;
        assert_total(file, &outcome, outcome.receiver_flux_lm(0), exact.iter().sum::<f64>() * area);
        assert_eq!(outcome.census.dimension_max, 2, "emission alone takes two coordinates");
    }
}

#[test]
fn a_plane_mirror_is_an_image_source() {
    let reflectance = 0.8;
    let (plane, lamp) = (1.75, Lamp::new("floodlight_b.ies", POSITION, AIM, UP));
    // The mirror reaches far enough that every point of the plate sees the image of the lamp in it. The light comes
    // upon it once from the front and once, turned round, from the back.
    for (corner_y, edge_y) in [(-4.0, 8.0), (4.0, -8.0)] {
        let text = emitter("floodlight_b.ies")
            + &format!(
                r#"
events = "direct"
[[receiver]]
name = "by way of the mirror"
surface = "plate"
cells = [{COARSE}, {COARSE}]
events = "indirect"
[[receiver]]
name = "both"
surface = "plate"
cells = [{CELLS}, {CELLS}]
[material.silver]
type = "mirror"
reflectance = {reflectance}
[[surface]]
name = "mirror"
type = "rectangle"
material = "silver"
corner = [{plane}, {corner_y:?}, -0.5]
edge_u = [0.0, {edge_y:?}, 0.0]
edge_v = [0.0, 0.0, 3.0]
"#
            );
        let scene = scene(&text);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 15, 16, 2);
        let direct = |u, v| lamp.illuminance_lx(on_plate(u, v), DVec3::Z);
        let image = |u, v| reflectance * lamp.mirrored_illuminance_lx(plane, on_plate(u, v), DVec3::Z);
        let maps = [
            ("direct", cell_means(CELLS, CELLS, 5, direct)),
            ("image source", cell_means(COARSE, COARSE, 10, image)),
            ("direct + image", cell_means(CELLS, CELLS, 5, |u, v| direct(u, v) + image(u, v))),
        ];
        for (i, (label, exact)) in maps.into_iter().enumerate() {
            assert_cells(label, &scene, &outcome, i, &exact);
            let area = 9.0 / exact.len() as f64;
            assert_total(label, &outcome, outcome.receiver_flux_lm(i), exact.iter().sum::<f64>() * area);
        }
    }
}
