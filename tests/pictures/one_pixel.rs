//! What the camera's tests share: pictures of one pixel with their parts told apart, photons as a run keeps them, and the
//! text of small scenes.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use caustix::geometry::Geometry;
use caustix::picture::camera::{Film, Pass, Sums, View, render};
use caustix::picture::gather::Density;
use caustix::picture::photon_map::{PhotonMap, PhotonStore};
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::scene::camera::{Bandwidth, CameraSpec, Kernel};
use caustix::sequence::owen::OwenPoints;
use caustix::surface::Grey;
use caustix::tally::Receivers;
use caustix::transport::parallel::{How, trace_range};
use glam::DVec3;

use crate::photons::{choice, density_of};
pub use crate::support::pictures::camera;

/// The photons of some replicates of 2^m photons each, as a run keeps them: (caustic, diffuse).
pub fn photons(scene: &Scene, replicates: Range<u32>, m: u32, seed: u64) -> [PhotonMap<1>; 2] {
    let mut store = PhotonStore::<1>::new(scene);
    let nobody = Receivers::new(&scene.geometry, &[]);
    let interrupt = AtomicBool::new(false);
    for replicate in replicates {
        let how =
            How { reuse: true, sampling: Sampling::default(), interrupt: &interrupt, progress: &|_| {} };
        let sink = || store.sink(nobody.sink(), replicate);
        trace_range(scene, &scene.emitters, &OwenPoints::new(seed, replicate), 0..1 << m, Grey, how, sink);
    }
    let frame = store.frame();
    store.take().unwrap().map(|blocks| PhotonMap::build(blocks.concat(), frame, 1.0))
}

/// Replicates of every test.
pub const REPLICATES: u32 = 16;

/// A number with its standard error.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    pub value: f64,
    pub error: f64,
}

/// A pixel and what it is made of: the passes of one kind of light each.
#[derive(Debug)]
pub struct Pixel {
    pub emission: Part,
    pub direct: Part,
    pub caustic: Part,
    pub diffuse: Part,
    pub all: Part,
}

/// One pass.
pub fn pass(view: &View<'_>, pass: &Pass<'_, 1>) -> Film<1> {
    let mut sums = Sums::new(view.camera.pixels).unwrap();
    let done = render(view, pass, &mut sums, &AtomicBool::new(false), &|_| {}).unwrap();
    assert!(done.unseen == 0 && done.killed == 0);
    sums.finish()
}

/// The pass of all there is: densities of all photons, of this many replicates.
pub fn all<'d>(densities: &'d [Density<'d, 1>], replicates: u32) -> Pass<'d, 1> {
    Pass { emission: true, direct: true, ..part(densities, 0..replicates, true) }
}

/// A pass of further photons of these replicates.
pub fn part<'d>(densities: &'d [Density<'d, 1>], replicates: Range<u32>, finishes: bool) -> Pass<'d, 1> {
    Pass { densities, replicates, finishes, emission: false, direct: false }
}

/// The density of all photons within a radius, m.
pub fn within<'m>(
    geometry: &'m Geometry,
    map: &'m PhotonMap<1>,
    photon_lm: f64,
    radius_m: f64,
) -> Density<'m, 1> {
    density_of(geometry, map, photon_lm, choice(Bandwidth::Radius(radius_m), Kernel::default(), 1))
}

/// The first pixel of a picture.
pub fn first(film: &Film<1>) -> Part {
    Part { value: film.value[0][0], error: film.standard_error[0] }
}

/// The picture of 16 x 2^m photons within `radius_m`, of one pixel, in its parts.
pub fn pixel(scene: &Scene, spec: &CameraSpec, m: u32, radius_m: f64) -> Pixel {
    let photon_lm = scene.emitters.flux_lm() / (f64::from(REPLICATES) * (1u64 << m) as f64);
    let maps = photons(scene, 0..REPLICATES, m, 7);
    // A run leaves out the density of no photons at all: that there are none anywhere is no doubt about one place.
    let densities = |kinds: &[usize]| -> Vec<Density<'_, 1>> {
        let maps = kinds.iter().map(|k| &maps[*k]).filter(|map| !map.photons().is_empty());
        maps.map(|map| within(&scene.geometry, map, photon_lm, radius_m)).collect()
    };
    let view = View::new(scene, &camera(spec.clone()), 11).unwrap();
    let [caustic, diffuse, both] = [densities(&[0]), densities(&[1]), densities(&[0, 1])];
    let only = |emission: bool, direct: bool| Pass { emission, direct, ..Pass::<1>::EMISSION };
    let result = Pixel {
        emission: first(&pass(&view, &only(true, false))),
        direct: first(&pass(&view, &only(false, true))),
        caustic: first(&pass(&view, &part(&caustic, 0..REPLICATES, true))),
        diffuse: first(&pass(&view, &part(&diffuse, 0..REPLICATES, true))),
        all: first(&pass(&view, &all(&both, REPLICATES))),
    };
    let sum =
        [result.emission, result.direct, result.caustic, result.diffuse].map(|p| p.value).iter().sum::<f64>();
    assert!((result.all.value - sum).abs() <= 1e-9 * sum, "the parts make the whole: {result:?}");
    result
}

/// A camera of one pixel of a tenth of a degree, 64 samples.
pub fn narrow(position: [f64; 3], look_at: [f64; 3]) -> CameraSpec {
    let (position, look_at) = (DVec3::from_array(position), DVec3::from_array(look_at));
    let view = (look_at - position).normalize();
    let up = if view.z.abs() > 0.9 { DVec3::Y } else { DVec3::Z };
    CameraSpec { samples: 64, ..CameraSpec::pinhole(position, look_at, up, 0.1, [1, 1]) }
}

/// Student's t with 15 degrees beyond this has a chance of 1e-4 (two-sided); about 60 numbers are judged so in all. (Where no photon
/// has a part, four sets of samples have 3 degrees: the same limit is then stricter than it need be.)
const MOST_T: f64 = 5.24;

/// Judges a number in its standard errors, which may be at most this part of it.
pub fn assert_close(label: &str, part: Part, exact: f64, largest_error: f64) {
    let t = (part.value - exact) / part.error;
    println!("{label}: {:.6} +- {:.1e}, exact {exact:.6}, t = {t:.2}", part.value, part.error);
    // A part without spread is compared to the digits that the pixel's width leaves.
    let slack = 1e-5 * exact;
    assert!(
        (part.value - exact).abs() <= MOST_T * part.error + slack,
        "{label}: {part:?}, exact {exact}, t = {t}"
    );
    assert!(part.error <= largest_error * exact, "{label}: {part:?} says little");
}

/// Judges that there is none.
pub fn assert_none(label: &str, part: Part) {
    assert!(part.value == 0.0, "{label}: {part:?}");
}

/// Materials: black, white (0.8), grey (0.5), pale (0.05), silver (0.9), glass (1.5), water (1.33).
pub const MATERIALS: &str = r#"
[material.black]
type = "absorber"
[material.white]
type = "lambertian"
reflectance = 0.8
[material.grey]
type = "lambertian"
reflectance = 0.5
[material.pale]
type = "lambertian"
reflectance = 0.05
[material.silver]
type = "mirror"
reflectance = 0.9
[material.glass]
type = "dielectric"
ior = 1.5
[material.water]
type = "dielectric"
ior = 1.33
"#;

/// A rectangle of this middle and these half edges; its front is along u x v.
pub fn plate(name: &str, material: &str, middle: [f64; 3], u: [f64; 3], v: [f64; 3]) -> String {
    let corner: [f64; 3] = std::array::from_fn(|k| middle[k] - u[k] - v[k]);
    let double = |e: [f64; 3]| e.map(|x| 2.0 * x);
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"rectangle\"\nmaterial = \"{material}\"\ncorner = {corner:?}\nedge_u = {:?}\nedge_v = {:?}\n",
        double(u),
        double(v)
    )
}

/// A horizontal square that looks up.
pub fn floor(name: &str, material: &str, middle: [f64; 3], half: f64) -> String {
    plate(name, material, middle, [half, 0.0, 0.0], [0.0, half, 0.0])
}

/// A horizontal square that looks down.
pub fn ceiling(name: &str, material: &str, middle: [f64; 3], half: f64) -> String {
    plate(name, material, middle, [half, 0.0, 0.0], [0.0, -half, 0.0])
}

pub fn cuboid(name: &str, material: &str, min: [f64; 3], max: [f64; 3]) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"box\"\nmaterial = \"{material}\"\nmin = {min:?}\nmax = {max:?}\n"
    )
}

/// A round beam of parallel light.
pub fn beam(position: [f64; 3], aim: [f64; 3], radius: f64, flux_lm: f64) -> String {
    format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = {position:?}\naim = {aim:?}\nradius = {radius:?}\nflux_lm = {flux_lm:?}\n"
    )
}

pub fn lamp(position: [f64; 3], flux_lm: f64) -> String {
    format!("[[emitter]]\ntype = \"isotropic\"\nposition = {position:?}\nflux_lm = {flux_lm:?}\n")
}

/// A square panel.
pub fn panel(position: [f64; 3], aim: [f64; 3], side: f64, flux_lm: f64) -> String {
    format!(
        "[[emitter]]\ntype = \"panel\"\nposition = {position:?}\naim = {aim:?}\nup = {:?}\nsize = [{side:?}, {side:?}]\nflux_lm = {flux_lm:?}\n",
        if aim[2] == 0.0 { [0, 0, 1] } else { [0, 1, 0] }
    )
}
