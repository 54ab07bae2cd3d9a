//! The photon map's pictures of caustics against splatted ones: what the bias figure promises, and how the bias shrinks.
//! `examples/picture_bias.rs` measures the same with more photons and on more scenes.

use caustix::scene::camera::{Bandwidth, CameraSpec};

use crate::picture_bias::{Reference, Row, mapped, rate, splatted};
use crate::support::caustic_views::{View, ball, pane, plan};
use crate::support::pictures::camera;

const REPLICATES: u32 = 8;
const SEEDS: u64 = 3;
const LADDER: [u32; 3] = [14, 16, 18];

fn reference(view: &View) -> Reference {
    splatted(&view.scene, &camera(view.spec.clone()), &plan(21, 16, 1000).unwrap()).unwrap()
}

fn row(view: &View, reference: &Reference, bandwidth: Bandwidth, m: u32, seeds: u64) -> Row {
    let spec = camera(CameraSpec { bandwidth, ..view.spec.clone() });
    let picture = |seed| mapped(&view.scene, &spec, &plan(m, REPLICATES, seed).unwrap()).unwrap();
    let row = Row::new(reference, 1 << m, &(1..=seeds).map(picture).collect::<Vec<_>>());
    println!("{} {bandwidth:?}: {row:.4?}", view.name);
    row
}

/// The three numbers asked of a picture, at 2^18 photons; with fewer, what holds for them too; and the rates.
fn check(view: &View) {
    let reference = reference(view);
    assert!(reference.lit().count() > 400);
    let rows = LADDER.map(|m| row(view, &reference, Bandwidth::Automatic, m, SEEDS));
    for row in &rows {
        assert!(row.agree >= 0.95, "{row:?}");
        assert!(row.figure_covers_bias >= 0.68, "{row:?}");
    }
    let most = rows[2];
    assert!(most.figure < 0.02, "{most:?}");
    // A figure of nothing covers nothing; one of far too much would cover everything.
    assert!(rows[0].figure < 4.0 * rows[0].bias_without_noise(), "{:?}", rows[0]);
    let [figure, radius] = [rate(&rows, |r| r.figure), rate(&rows, |r| r.radius_m)];
    // Independent points and a smooth density: N^(-1/3). Nets are less noisy, and edges ask for narrower radii still: up to
    // r ~ N^(-3/8), and r^2 is the bias where it is smooth (docs/PICTURE.md, Bias).
    println!("{}: bias figure ~ N^{figure:.3}, radius ~ N^{radius:.3}", view.name);
    assert!(figure < -1.0 / 3.0 && figure > -0.75, "{figure}");
    // A radius told to shrink as N^(-1/6): the bias grows as it at edges and as its square where the density is smooth.
    let shrunk = rows[0].radius_m * libm::exp2(-f64::from(LADDER[2] - LADDER[0]) / 6.0);
    let narrow = row(view, &reference, Bandwidth::Radius(shrunk), LADDER[2], 2);
    let wide = row(view, &reference, Bandwidth::Radius(rows[0].radius_m), LADDER[0], SEEDS);
    let bias = rate(&[wide, narrow], Row::bias_without_noise);
    println!("{}: bias ~ N^{bias:.3} for a radius ~ N^(-1/6)", view.name);
    assert!(bias < -1.0 / 6.0 && bias > -0.40, "{bias}");
}

#[test]
fn a_ball_in_a_beam() {
    check(&ball(24).unwrap());
}

#[test]
fn a_pane_in_a_beam() {
    check(&pane(24).unwrap());
}
