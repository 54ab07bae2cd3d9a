//! Bodies in contact, in one another, overlapping, and open surfaces, against closed forms.
//!
//! Light at normal incidence through a stack of interfaces that absorb nothing passes, unpolarised and incoherent,
//! T with (1 - T)/T = the sum of R/(1 - R) over them: odds of being sent back add up.

use caustix::error::Diagnostic;
use caustix::error::warning::Severity;
use caustix::geometry::{Mesh, MeshParts, Rectangle, Shape, Smoothing, box_mesh};
use caustix::run::{Estimate, Outcome, warnings};
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Sequence;
use caustix::surface::{Dielectric, Material};
use caustix::{AimFrame, Beam, BeamSection, Emitter};
use glam::DVec3;

use crate::support::judge::assert_total;
use crate::support::scenes::{run, scene, try_scene};

pub(crate) const LAMP: &str = "[[emitter]]\ntype = \"collimated\"\nposition = [0.0, 0.0, 2.0]\naim = [0.0, 0.0, -1.0]\nradius = 0.03\nflux_lm = 1000.0\n";
pub(crate) const GLASS: &str = "[material.glass]\ntype = \"dielectric\"\nior = 1.5\n";
pub(crate) const WATER: &str = "[material.water]\ntype = \"dielectric\"\nior = 1.333\n";
pub(crate) const BLACK: &str = "[material.black]\ntype = \"absorber\"\n";

/// What passes interfaces between media of these refractive indices, in their order.
fn passed(indices: &[f64]) -> f64 {
    let odds = indices.windows(2).map(|n| {
        let r = ((n[1] - n[0]) / (n[1] + n[0])).powi(2);
        r / (1.0 - r)
    });
    1.0 / (1.0 + odds.sum::<f64>())
}

pub(crate) fn cuboid(name: &str, material: &str, min: [f64; 3], max: [f64; 3], more: &str) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"box\"\nmaterial = \"{material}\"\nmin = {min:?}\nmax = {max:?}\n{more}\n"
    )
}

/// A box about the beam, between two heights.
fn slab(name: &str, material: &str, low: f64, high: f64, more: &str) -> String {
    cuboid(name, material, [-0.05, -0.05, low], [0.05, 0.05, high], more)
}

pub(crate) fn sphere(name: &str, material: &str, centre: [f64; 3], radius: f64, more: &str) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"sphere\"\nmaterial = \"{material}\"\ncenter = {centre:?}\nradius = {radius:?}\n{more}\n"
    )
}

/// A horizontal sheet that looks up, or down.
pub(crate) fn sheet(name: &str, material: &str, z: f64, up: bool) -> String {
    let v = if up { 1.0 } else { -1.0 };
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"rectangle\"\nmaterial = \"{material}\"\ncorner = [-0.5, {:?}, {z:?}]\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, {v:?}, 0.0]\n",
        -0.5 * v
    )
}

/// A receiver that counts on both sides.
pub(crate) fn receiver(surface: &str) -> String {
    format!("[[receiver]]\nsurface = \"{surface}\"\nside = \"both\"\ncells = [1, 1]\n")
}

fn flux(scene: &Scene, per_replicate: u64, seed: u64) -> (Outcome, Estimate) {
    let outcome = run(scene, Sequence::SobolOwen, per_replicate, 16, seed);
    let estimate = outcome.receiver_flux_lm(0);
    (outcome, estimate)
}

/// Runs a scene whose first receiver gets an exact flux, lm.
fn assert_flux(label: &str, text: &str, exact_lm: f64) {
    assert_flux_by(1 << 12, label, text, exact_lm);
}

/// The same, with so many photons a replicate.
fn assert_flux_by(per_replicate: u64, label: &str, text: &str, exact_lm: f64) {
    let (outcome, estimate) = flux(&scene(text), per_replicate, 7);
    assert_total(label, &outcome, estimate, exact_lm);
}

fn refusals(text: &str) -> Vec<Diagnostic> {
    try_scene(text).err().unwrap_or_default()
}

#[test]
fn a_block_on_a_black_table_has_a_film_under_it_or_is_glued_whatever_the_names() {
    for (cube, table) in [("cube", "table"), ("zcube", "table"), ("a", "b"), ("b", "a")] {
        for (contact, indices) in [
            ("", &[1.0, 1.5, 1.0][..]),
            ("contact = \"film\"", &[1.0, 1.5, 1.0]),
            ("contact = \"glued\"", &[1.0, 1.5]),
        ] {
            let text = [LAMP, GLASS, BLACK].concat()
                + &slab(cube, "glass", 0.0, 0.1, contact)
                + &sheet(table, "black", 0.0, true)
                + &receiver(table);
            assert_flux(&format!("{cube} on {table}, {contact}"), &text, 1000.0 * passed(indices));
        }
    }
}

/// The lamp, block and table of `a_block_on_a_table`, turned and moved together.
fn placed(turn_deg: [f64; 3], by: [f64; 3], contact: &str, order: bool) -> String {
    let place = format!("rotate_deg = {turn_deg:?}\ntranslate = {by:?}\n");
    let block = slab("block", "glass", 0.0, 0.1, &(contact.to_owned() + "\n" + &place));
    let table = sheet("table", "black", 0.0, true) + &place;
    let turn = caustix::geometry::Transform::new(DVec3::ONE, turn_deg.into(), by.into()).unwrap();
    let [from, aim] = [turn.point(DVec3::Z * 2.0), turn.normal(DVec3::NEG_Z)].map(|v| v.to_array());
    let lamp = format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = {from:?}\naim = {aim:?}\nradius = 0.03\nflux_lm = 1000.0\n"
    );
    let surfaces = if order { block + &table } else { table + &block };
    [&lamp, GLASS, BLACK, &surfaces, &receiver("table")].concat()
}

#[test]
fn contact_does_not_depend_on_the_place() {
    for i in 0..20 {
        let number = |k: u32| f64::from((i * 7919 + k * 104_729) % 1009) / 1009.0 - 0.5;
        let turn = [0, 1, 2].map(|k| 360.0 * number(k));
        let by = [3, 4, 5].map(|k| 10.0f64.powi(i as i32 % 5 - 2) * number(k));
        for (contact, indices) in
            [("contact = \"film\"", &[1.0, 1.5, 1.0][..]), ("contact = \"glued\"", &[1.0, 1.5])]
        {
            let text = placed(turn, by, contact, i % 2 == 0);
            assert_flux_by(1 << 10, &format!("place {i}, {contact}"), &text, 1000.0 * passed(indices));
        }
    }
}

#[test]
fn a_block_on_a_white_table_gathers_what_gaps_say() {
    let text = |contact: &str, low: f64| {
        [LAMP, GLASS, "[material.white]\ntype = \"lambertian\"\nreflectance = 0.9\n"].concat()
            + &slab("zcube", "glass", low, low + 0.1, contact)
            + &sheet("table", "white", 0.0, true)
            + &receiver("table")
    };
    let of = |contact: &str, low: f64| flux(&scene(&text(contact, low)), 1 << 13, 11).1;
    for (contact, gap, known) in [("", 1e-6, 1073.17), ("contact = \"glued\"", -1e-9, 1338.75)] {
        let (touching, apart) = (of(contact, 0.0), of(contact, gap));
        let error = touching.standard_error.unwrap().hypot(apart.standard_error.unwrap());
        println!("{contact}: {touching:?}, apart {apart:?}, known {known}");
        assert!((touching.value - apart.value).abs() < 4.0 * error);
        assert!((touching.value - known).abs() < 4.0 * touching.standard_error.unwrap().hypot(0.1));
    }
}

#[test]
fn plates_stacked_and_cemented() {
    for (contact, films) in [("contact = \"film\"", true), ("contact = \"glued\"", false)] {
        let mut text = [LAMP, GLASS, BLACK].concat();
        let mut indices = vec![1.0];
        for k in 0..10 {
            // Tenths that rounding makes inexact, so that neighbours' faces agree to rounding only by their own numbers.
            let low = 0.1 * f64::from(k);
            text += &slab(&format!("plate {}", (k * 7) % 10), "glass", low, 0.1 * f64::from(k + 1), contact);
            if films || k == 0 {
                indices.extend([1.5, 1.0]);
            }
        }
        text += &(sheet("floor", "black", -0.5, true) + &receiver("floor"));
        assert_flux(contact, &text, 1000.0 * passed(&indices));
    }
}

#[test]
fn a_block_in_a_corner_is_as_one_with_gaps() {
    let text = |gap: f64| {
        let lamp = LAMP
            .replace("[0.0, 0.0, -1.0]", "[1.0, 0.3, -1.5]")
            .replace("[0.0, 0.0, 2.0]", "[-0.3, -0.09, 0.6]");
        let wall = "[[surface]]\nname = \"wall\"\ntype = \"rectangle\"\nmaterial = \"white\"\ncorner = [0.25, -1.0, -0.15]\nedge_u = [0.0, 0.0, 1.0]\nedge_v = [0.0, 2.0, 0.0]\n";
        [&lamp, GLASS, "[material.white]\ntype = \"lambertian\"\nreflectance = 0.5\n", wall].concat()
            + &cuboid("block", "glass", [-0.25, -0.25, -0.15 + gap], [0.25 - gap, 0.25, 0.35], "")
            + &sheet("floor", "white", -0.15, true)
            + &receiver("floor")
            + &receiver("wall").replace("[[receiver]]", "[[receiver]]\nname = \"on the wall\"")
    };
    let of = |gap: f64| run(&scene(&text(gap)), Sequence::SobolOwen, 1 << 13, 16, 5);
    let (touching, apart) = (of(0.0), of(1e-6));
    for receiver in 0..2 {
        let (a, b) = (touching.receiver_flux_lm(receiver), apart.receiver_flux_lm(receiver));
        println!("{a:?} {b:?}");
        assert!((a.value - b.value).abs() < 4.0 * a.standard_error.unwrap().hypot(b.standard_error.unwrap()));
    }
}

#[test]
fn bodies_that_overlap_in_part_are_refused_or_ranked() {
    let text = |water: &str, glass: &str, low: f64| {
        [LAMP, GLASS, WATER, BLACK].concat()
            + &slab("a", "glass", 0.0, 0.1, glass)
            + &slab("b", "water", low, 0.2, water)
            + &sheet("floor", "black", -0.5, true)
            + &receiver("floor")
    };
    for low in [0.099, 0.099_999, 0.05] {
        let refused = refusals(&text("", "", low));
        let said = refused.iter().map(|d| format!("{} {:?}", d.found(), d.advice())).collect::<String>();
        assert!(said.contains("\"a\" and \"b\"") && said.contains("priority = 1"), "{low}: {said}");
        for (water, glass) in [("priority = 1", ""), ("", "priority = 2"), ("priority = -3", "")] {
            let exact = 1000.0 * passed(&[1.0, 1.333, 1.5, 1.0]);
            assert_flux(&format!("{low} {water}{glass}"), &text(water, glass, low), exact);
        }
    }
}

#[test]
fn the_inner_of_nested_bodies_fills_its_space_to_any_depth() {
    // Boxes in one another, of indices that go up and down, more than any fixed list has room for.
    let depth = 24;
    let mut text = [LAMP, BLACK].concat();
    let ior = |k: i32| 1.0 + 0.1 * f64::from((k * 5) % 7 + 1);
    for k in 0..depth {
        let edge = 0.4 - 0.01 * f64::from(k);
        text += &format!("[material.m{k}]\ntype = \"dielectric\"\nior = {:?}\n", ior(k));
        text += &cuboid(&format!("box {}", (k * 11) % depth), &format!("m{k}"), [-edge; 3], [edge; 3], "");
    }
    text += &(sheet("floor", "black", -0.6, true) + &receiver("floor"));
    let down = (0..depth).map(ior);
    let up = (0..depth - 1).rev().map(ior);
    let indices: Vec<f64> = [1.0].into_iter().chain(down).chain(up).chain([1.0]).collect();
    let (outcome, estimate) = flux(&scene(&text), 1 << 11, 3);
    assert_total("nested boxes", &outcome, estimate, 1000.0 * passed(&indices));
}

#[test]
fn glass_in_glass_is_one_body() {
    let text = |inner: &str| {
        [LAMP, GLASS, BLACK].concat()
            + &sphere("ball", "glass", [0.0, 0.0, 0.5], 0.1, "")
            + inner
            + &sheet("floor", "black", 0.0, true)
            + &receiver("floor")
    };
    let alone = flux(&scene(&text("")), 1 << 12, 2).1;
    for inner in [
        sphere("core", "glass", [0.0, 0.0, 0.5], 0.05, ""),
        sphere("beside", "glass", [0.02, 0.01, 0.5], 0.12, ""),
        cuboid("block", "glass", [-0.02, -0.03, 0.45], [0.03, 0.04, 0.55], ""),
    ] {
        let (outcome, both) = flux(&scene(&text(&inner)), 1 << 12, 2);
        if !inner.contains("beside") {
            assert_eq!(both.value, alone.value, "{inner}");
        }
        assert!(outcome.ledger.is_balanced());
    }
}

#[test]
fn a_bubble_and_a_sphere_that_fills_it() {
    let text = |more: &str| {
        [LAMP, WATER, BLACK, "[material.air]\ntype = \"dielectric\"\nior = 1.0\n"].concat()
            + &cuboid("pool", "water", [-0.3; 3], [0.3; 3], "")
            + more
            + &sheet("floor", "black", -0.5, true)
            + &receiver("floor")
    };
    let bubble = sphere("bubble", "air", [0.0; 3], 0.1, "");
    let of = |more: &str| flux(&scene(&text(more)), 1 << 11, 2).1;
    let (full, filled) =
        (of(""), of(&(bubble.clone() + &sphere("fill", "water", [0.0; 3], 0.1, "priority = 1"))));
    assert_eq!(full.value, filled.value, "water in the bubble is as no bubble");
    let hollow = of(&(bubble.clone() + &sphere("fill", "water", [0.0; 3], 0.1, "priority = -1")));
    assert_eq!(hollow.value, of(&bubble).value, "the bubble wins over its filling");
    assert!(hollow.value < full.value - 1.0);
    let refused = refusals(&text(&(bubble + &sphere("fill", "water", [0.0; 3], 0.1, ""))));
    assert!(refused.iter().any(|d| d.found().contains("\"bubble\" and \"fill\"")), "{refused:?}");
}

#[test]
fn bodies_touch_under_water_and_liquid_in_a_box() {
    // Two blocks of glass in contact in water have a film of water, or none.
    for (contact, middle) in [("contact = \"film\"", &[1.5, 1.333, 1.5][..]), ("contact = \"glued\"", &[1.5])]
    {
        let text = [LAMP, GLASS, WATER, BLACK].concat()
            + &cuboid("pool", "water", [-0.3; 3], [0.3; 3], "")
            + &slab("lower", "glass", -0.1, 0.0, contact)
            + &slab("upper", "glass", 0.0, 0.1, "")
            + &sheet("floor", "black", -0.5, true)
            + &receiver("floor");
        let indices = [&[1.0, 1.333], middle, &[1.333, 1.0]].concat();
        assert_flux(contact, &text, 1000.0 * passed(&indices));
    }
    // A flush rim: water that reaches to the top of the glass it stands in, which overlaps it.
    let text = [LAMP, GLASS, WATER, BLACK].concat()
        + &cuboid("tumbler", "glass", [-0.2; 3], [0.2; 3], "")
        + &cuboid("water", "water", [-0.1, -0.1, -0.1], [0.1, 0.1, 0.2], "")
        + &sheet("floor", "black", -0.5, true)
        + &receiver("floor");
    assert_flux("flush", &text, 1000.0 * passed(&[1.0, 1.333, 1.5, 1.0]));
}

#[test]
fn an_open_surface_changes_the_medium_and_bodies_stand_in_it() {
    let text = [LAMP, GLASS, WATER, BLACK].concat()
        + &sheet("pond", "water", 0.4, true)
        + &slab("block", "glass", 0.1, 0.2, "")
        + &sheet("floor", "black", 0.0, true)
        + &receiver("floor");
    assert_flux("block in a pond", &text, 1000.0 * passed(&[1.0, 1.333, 1.5, 1.333]));
    // A block that stands out of it.
    let text = text.replace("[0.05, 0.05, 0.2]", "[0.05, 0.05, 0.5]");
    assert_flux("block that stands out", &text, 1000.0 * passed(&[1.0, 1.5, 1.333]));
    // A scene in water.
    let text = [LAMP, GLASS, WATER, BLACK, "[ambient]\nmedium = \"water\"\n"].concat()
        + &slab("block", "glass", 0.1, 0.2, "")
        + &sheet("floor", "black", 0.0, true)
        + &receiver("floor");
    assert_flux("block in water", &text, 1000.0 * passed(&[1.333, 1.5, 1.333]));
    // A lamp under the surface shines up.
    let lamp =
        LAMP.replace("[0.0, 0.0, 2.0]", "[0.0, 0.0, 0.1]").replace("-1.0]", "1.0]") + "medium = \"water\"\n";
    let text = [&lamp, WATER, BLACK].concat()
        + &sheet("pond", "water", 0.4, true)
        + &sheet("ceiling", "black", 1.0, false)
        + &receiver("ceiling");
    let (outcome, estimate) = flux(&scene(&text), 1 << 13, 4);
    assert_total("a lamp in a pond", &outcome, estimate, 1000.0 * (1.0 - (0.333f64 / 2.333).powi(2)));
    assert_eq!(outcome.census.exceptions.contradicted.len(), 0);
    let unsaid = scene(&text.replace("medium = \"water\"\n", ""));
    assert!(
        flux(&unsaid, 1 << 10, 4)
            .0
            .census
            .exceptions
            .contradicted
            .contains_key(&caustix::geometry::SurfaceId(0))
    );
}

#[test]
fn a_lamp_in_its_dome_and_in_a_tank() {
    let lamp = "[[emitter]]\ntype = \"isotropic\"\nposition = [0.0, 0.0, 0.0]\nflux_lm = 1000.0\n";
    let room = sphere("room", "black", [0.0; 3], 1.0, "") + &receiver("room");
    let text = [lamp, GLASS, BLACK].concat() + &sphere("dome", "glass", [0.0; 3], 0.0025, "") + &room;
    let (outcome, estimate) = flux(&scene(&text), 1 << 12, 4);
    assert_eq!(estimate.value, 1000.0, "at normal incidence from inside everything leaves in the end");
    assert!(outcome.ledger.is_balanced());
    // A bulb of two spheres: hollow glass.
    let bulb = sphere("outer", "glass", [0.0; 3], 0.03, "") + &sphere("inner", "air", [0.0; 3], 0.029, "");
    let air = "[material.air]\ntype = \"dielectric\"\nior = 1.0\n";
    let text = [lamp, GLASS, air, BLACK].concat() + &bulb + &room;
    let (outcome, estimate) = flux(&scene(&text), 1 << 12, 4);
    assert_eq!(estimate.value, 1000.0);
    assert!(outcome.ledger.is_balanced());
}

/// Part of all directions of which every cosine to an axis is below c.
fn part_within(c: f64) -> f64 {
    let steps = 2000;
    let middle = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
    let inside = |i: i32, k: i32| {
        let (z, phi) = (middle(i), 0.5 * std::f64::consts::PI * middle(k));
        let r = (1.0 - z * z).sqrt();
        z < c && r * phi.cos() < c && r * phi.sin() < c
    };
    let count = (0..steps).map(|i| (0..steps).filter(|k| inside(i, *k)).count()).sum::<usize>();
    count as f64 / f64::from(steps * steps)
}

#[test]
fn a_clear_tank_keeps_the_light_that_it_reflects_totally_at_all_its_walls() {
    let lamp = "[[emitter]]\ntype = \"isotropic\"\nposition = [0.0, 0.0, 0.001]\nflux_lm = 1000.0\n";
    // Of so small an index that little is kept: every photon that is costs thousands of reflections.
    let ior = 1.28f64;
    let text = [lamp, &WATER.replace("1.333", &ior.to_string()), BLACK].concat()
        + &sphere("room", "black", [0.0; 3], 1.0, "")
        + &cuboid("tank", "water", [-0.2, -0.1, -0.1], [0.2, 0.1, 0.1], "")
        + &receiver("room");
    let (outcome, estimate) = flux(&scene(&text), 1 << 9, 4);
    let kept = 1000.0 * part_within((1.0 - 1.0 / (ior * ior)).sqrt());
    println!("{kept} lm kept, {:?}, {estimate:?}", outcome.trapped_lm());
    assert_total("trapped", &outcome, outcome.trapped_lm(), kept);
    assert_total("in the room", &outcome, estimate, 1000.0 - kept);
    assert!(outcome.ledger.is_balanced() && outcome.ledger.killed == 0);
    let said = warnings(&scene(&text), &outcome);
    assert!(said.iter().any(|w| w.code == "trapped" && w.surfaces == ["tank"]), "{said:?}");
}

/// The scene of the lamp, a black floor and one mesh of glass.
fn with_mesh(mesh: Mesh) -> Scene {
    let mut builder = SceneBuilder::new();
    let frame = AimFrame::new(DVec3::NEG_Z, None).unwrap();
    let beam = Beam::new(DVec3::Z * 2.0, frame, BeamSection::Disc { radius: 0.03 }, 1000.0).unwrap();
    builder.emitter("lamp", Emitter::Beam(beam));
    builder.surface("mesh", mesh.into(), Material::Dielectric(Dielectric::new(1.5, None).unwrap()));
    let floor = Rectangle::new(DVec3::new(-0.5, -0.5, -0.5), DVec3::X, DVec3::Y).unwrap();
    builder.surface("floor", Shape::Rectangle(floor), Material::Absorber);
    builder.receiver(ReceiverSpec::new("floor", "floor").unwrap().with_cells([1, 1]).unwrap());
    builder.build().unwrap()
}

#[test]
fn a_mesh_wound_inwards_is_the_same_body_and_one_that_cuts_itself_is_the_union_of_its_parts() {
    let cube = |low: f64, high: f64, half: f64| {
        box_mesh(DVec3::new(-half, -half, low), DVec3::new(half, half, high)).unwrap()
    };
    let of = |mesh: Mesh| flux(&with_mesh(mesh), 1 << 12, 9);
    let (_, outward) = of(cube(0.0, 0.1, 0.05));
    let (_, inward) = of(cube(0.0, 0.1, 0.05).reversed());
    assert_eq!(outward.value, inward.value);
    // Boxes that cut each other, lie in each other, share a face; all in one mesh.
    for (low, high, half) in [(0.05, 0.2, 0.04), (0.02, 0.08, 0.04), (0.1, 0.2, 0.05)] {
        let (a, b) = (cube(0.0, 0.1, 0.05), cube(low, high, half));
        let first = a.vertices().len() as u32;
        let parts = MeshParts {
            vertices: a.vertices().iter().chain(b.vertices()).copied().collect(),
            triangles: a
                .triangles()
                .iter()
                .copied()
                .chain(b.triangles().iter().map(|t| t.map(|v| v + first)))
                .collect(),
            ..MeshParts::default()
        };
        let (mesh, _) = Mesh::new(parts, Smoothing::Flat, true).unwrap();
        let (outcome, estimate) = of(mesh);
        assert_total(&format!("{low} to {high}"), &outcome, estimate, 1000.0 * passed(&[1.0, 1.5, 1.0]));
    }
}

#[test]
fn light_that_never_ends_is_refused_and_named() {
    for material in ["type = \"mirror\"\nreflectance = 1", "type = \"lambertian\"\nreflectance = 1"] {
        let text = |more: &str| {
            let lamp = LAMP.replace("[0.0, 0.0, 2.0]", "[0.0, 0.0, 0.0]");
            format!("{lamp}[material.white]\n{material}\n{GLASS}{BLACK}")
                + &cuboid("room", "white", [-1.0; 3], [1.0; 3], "")
                + &sphere("ball", "glass", [0.5, 0.5, 0.5], 0.1, "")
                + more
                + "[[receiver]]\nsurface = \"room\"\nside = \"back\"\n"
        };
        let refused = refusals(&text(""));
        assert!(refused.iter().any(|d| d.found().contains("\"room\", where nothing absorbs")), "{refused:?}");
        assert!(refusals(&text(&sheet("plate", "black", 0.1, true))).is_empty());
    }
}

#[test]
fn a_run_says_what_is_wrong_with_it() {
    let codes = |text: &str| -> Vec<(&str, Severity)> {
        let scene = scene(text);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 8, 8, 1);
        warnings(&scene, &outcome).iter().map(|w| (w.code, w.severity)).collect()
    };
    let floor = |more: &str| sheet("floor", "black", 0.0, true) + &receiver("floor") + more;
    assert_eq!(codes(&([LAMP, BLACK].concat() + &floor(""))), []);
    // The floor looks down.
    let turned = [LAMP, BLACK].concat() + &floor("").replace("\"both\"", "\"back\"");
    assert_eq!(codes(&turned), [("other-side", Severity::Doubtful)]);
    // The lamp looks up.
    let up = LAMP.replace("-1.0]", "1.0]");
    assert_eq!(codes(&([&up, BLACK].concat() + &floor(""))), [("aimed-away", Severity::Doubtful)]);
    // A pane of two open sheets whose lower one looks up.
    let pane = |up: bool| {
        [LAMP, GLASS, BLACK].concat()
            + &sheet("upper", "glass", 0.4, true)
            + &sheet("lower", "glass", 0.3, up)
            + &floor("")
    };
    assert_eq!(codes(&pane(false)), []);
    assert_eq!(codes(&pane(true)), [("contradicted-medium", Severity::Untrusted)]);
}
