//! Every sequence carries photons: the flux of a point source through one face of the cube around it is a sixth.

use caustix::sequence::Sequence;

use crate::support::judge::{sidak, student_p};
use crate::support::scenes::{run, scene};

const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
flux_lm = 600.0
position = [0.0, 0.0, 1.0]
[material.black]
type = "absorber"
[[surface]]
name = "face"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "face"
cells = [8, 8]
"#;

#[test]
fn a_sixth_of_the_flux_reaches_a_face_whatever_the_sequence() {
    let scene = scene(SCENE);
    let randomised = Sequence::ALL.iter().filter(|s| s.is_randomised()).count();
    for sequence in Sequence::ALL {
        let name = sequence.name();
        // 1000 is no power of two and less than the first stage.
        if sequence.is_randomised() {
            let outcome = run(&scene, sequence, 1000, 16, 1);
            let flux = outcome.receiver_flux_lm(0);
            let error = flux.standard_error.unwrap();
            println!("{name:<22} {:.3} lm +- {error:.3}", flux.value);
            assert!(sidak(student_p((flux.value - 100.0) / error, 15), randomised) > 1e-3, "{name}");
        } else {
            let outcome = run(&scene, sequence, 1 << 14, 1, 1);
            let flux = outcome.receiver_flux_lm(0);
            println!("{name:<22} {:.3} lm", flux.value);
            // Independent points would be 1.8 lm off in the root mean square.
            assert!((flux.value - 100.0).abs() < 0.6 && flux.standard_error.is_none(), "{name}");
        }
    }
}

#[test]
fn a_set_for_n_points_is_traced_in_one_stage_and_counts_every_point_once() {
    // Hammersley's coordinate 0 is i / N: 16 384 points, all of them, give the z of the direction evenly, so the flux into
    // the lower half is exact. Were the set made for another number than is traced, it would not be.
    let ceiling = SCENE.replace("[-1.0, -1.0, 0.0]", "[-1e6, -1e6, 0.0]").replace("2.0", "2e6");
    let scene = scene(&ceiling);
    for sequence in [Sequence::Hammersley, Sequence::Lattice, Sequence::HammersleyRotation] {
        let flux = run(&scene, sequence, 1 << 14, 1, 1).receiver_flux_lm(0);
        assert!((flux.value - 300.0).abs() <= 600.0 / 16_384.0, "{}: {}", sequence.name(), flux.value);
    }
}
