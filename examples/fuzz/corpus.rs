//! Small good files of every format, most of them made here: what is damaged.

use caustix::files::photon_map;
use caustix::picture::photon_map::{Frame, Photon, SavedMap};
use glam::DVec3;

/// A file of the project's own.
pub fn own(path: &str) -> Vec<u8> {
    std::fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a file of the project")
}

pub const TILT: &str = "1\n5\n0 22.5 45 67.5 90\n1.0 0.97 0.95 0.93 0.9\n";

pub fn lamps() -> Vec<Vec<u8>> {
    let mut all: Vec<_> =
        ["spot", "downlight", "uplight", "batwing", "wall_washer_1991", "headlamp_a", "panel_2019"]
            .map(|name| own(&format!("ies/{name}.ies")))
            .into();
    let spot = String::from_utf8(own("ies/spot.ies")).expect("text");
    all.push(spot.replace("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 45 90\n1 .9 .8").into());
    all.push(spot.replace("TILT=NONE", "TILT=C:\\lamps\\lamp.tlt").into());
    all.push(spot.encode_utf16().flat_map(u16::to_le_bytes).collect());
    all
}

/// Every symmetry; several lamp sets, by set and by field; commas.
pub fn eulumdats() -> Vec<Vec<u8>> {
    let even = |step: usize, n: usize| (0..n).map(|i| format!("{}\r\n", step * i)).collect::<String>();
    let file = |isym: usize, planes: usize, sets: &str| {
        let head = format!("Nobody\r\n3\r\n{isym}\r\n8\r\n45\r\n7\r\n30\r\nr\r\nn\r\n1\r\nf\r\nd\r\n");
        let sizes = "1200\r\n300\r\n60\r\n1100\r\n200\r\n0\r\n0\r\n5\r\n0\r\n50\r\n100\r\n1\r\n0\r\n";
        let values: String = (0..7 * planes).map(|i| format!("{}.25\r\n", 60 + i % 7)).collect();
        format!("{head}{sizes}{sets}{}{}{}{values}", "0.5\r\n".repeat(10), even(45, 8), even(30, 7))
    };
    let one = "1\r\n1\r\nLED\r\n1000\r\n4000\r\n80\r\n10\r\n";
    let two = "2\r\n1\r\nA\r\n1000\r\n4000\r\n80\r\n10\r\n-1\r\nB\r\n2000\r\nnw\r\n>90\r\n20\r\n";
    let by_field = "2\r\n1\r\n-1\r\nA\r\nB\r\n1000\r\n2000\r\n4000\r\nnw\r\n80\r\n>90\r\n10\r\n20\r\n";
    let planes = [(0, 8), (1, 1), (2, 5), (3, 5), (4, 3)];
    let mut all: Vec<String> = planes.map(|(isym, planes)| file(isym, planes, one)).into();
    all.extend([two, by_field].map(|sets| file(1, 1, sets)));
    all.push(file(3, 5, one).replace('.', ","));
    all.into_iter().map(String::into_bytes).collect()
}

const TEXT: &str = "caustix-scattering 1\nname small\nframe specular\nsymmetry plane\nchannels 3\ntheta_i 0 45\npolar 0 10 30\n\
                    azimuth 0 90 180\nlobe reflection front\nincidence 0\n1 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5 6\n\
                    7 8 9\nincidence 45\n0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9\n1 1 1 1 1 1 1 1 1\n0 0 0 0 0 0 0 0 3e-3\n\
                    lobe transmission both\nchannels 1\nincidence 0\n1 2 3\n4 5 6\n7 8 9\nincidence 45\n1 2 3\n4 5 6\n7 8 9\n";
const ORTHOTROPIC: &str = "caustix-scattering 1\nlobe reflection both\nframe surface\nsymmetry orthotropic\ntheta_i 0 60\nphi_i 0 45 90\n\
                           polar 0 45 90\nazimuth 0 90 180 270\nincidence 0 0\n.1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\nincidence 60 0\n\
                           .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\nincidence 0 45\n.1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\nincidence 60 45\n\
                           .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\nincidence 0 90\n.1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\nincidence 60 90\n\
                           .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1 .1\n";
pub const ZEMAX: &str = "# small\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n\
                         SampleRotation 1\n0\nAngleOfIncidence 2\n10\t50\nScatterAzimuth 3\n0\t90\t180\nScatterRadial 3\n0\t5\t90\n\n\
                         Monochrome\nDataBegin\nTIS 0.1\n1e-2 2e-2 3e-2\n1e-2 2e-2 3e-2\n1e-2 2e-2 3e-2\nTIS 0.2\n1 2 3\n4 5 6\n7 8 9\n\
                         DataEnd\n";
pub const WINDOW: &str = "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>Columns\
                          </IncidentDataStructure><AngleBasis><AngleBasisName>Two</AngleBasisName><AngleBasisBlock><nPhis>1</nPhis>\
                          <ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock>\
                          <AngleBasisBlock><nPhis>2</nPhis><ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta>\
                          </ThetaBounds></AngleBasisBlock></AngleBasis></DataDefinition><WavelengthData><Wavelength>Visible</Wavelength>\
                          <WavelengthDataBlock><WavelengthDataDirection>Transmission Front</WavelengthDataDirection><ColumnAngleBasis>Two\
                          </ColumnAngleBasis><RowAngleBasis>Two</RowAngleBasis><ScatteringData>0.1, 0.2, 0.3,\n0.1, 0.2, 0.3,\n\
                          0.4, 0.5, 0.6</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>";

pub fn texts() -> Vec<Vec<u8>> {
    vec![TEXT.into(), ORTHOTROPIC.into(), own("brdf_tables/lambert.scatter")]
}

pub fn zemaxes() -> Vec<Vec<u8>> {
    let around = ZEMAX.replace("PlaneSymmetrical", "Asymmetrical").replace("0\t90\t180", "0\t120\t240");
    let (head, block) = ZEMAX.split_once("Monochrome\nDataBegin").expect("a block");
    let blocks: String =
        ["X", "Y", "Z"].map(|channel| format!("Tristimulus{channel}\nDataBegin{block}")).concat();
    let coloured = head.replace("Monochrome", "XYZ") + &blocks;
    vec![ZEMAX.into(), around.into(), coloured.into()]
}

pub fn meshes() -> Vec<Vec<u8>> {
    let polygons = "# a \no thing\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0 .5 .5 .5\nvn 0 0 1\nvt 0 0\nvn 0 1 0\nf 1//1 2//1 3//2 4//2\nf -4 -3 -2\n\
                    usemtl x\ns 1\nf 1/1/1 2/1/2 3/1/1\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let mut stl = vec![b' '; 84];
    stl[80] = 1;
    stl.extend([0; 50]);
    vec![
        own("scenes/prism.obj"),
        own("scenes/opal_cover.obj"),
        polygons.into(),
        format!("\u{feff}{polygons}").into(),
        stl,
        b"ply\nformat ascii 1.0\n".to_vec(),
        b"solid a\nfacet normal 0 0 1\nendsolid".to_vec(),
        b"glTF\x02\0\0\0".to_vec(),
    ]
}

pub fn pictures() -> Vec<Vec<u8>> {
    use png::{BitDepth::*, ColorType::*};
    [
        (Grayscale, Eight, 12),
        (Grayscale, Sixteen, 24),
        (Rgb, Eight, 36),
        (Rgba, Sixteen, 96),
        (Indexed, One, 3),
        (GrayscaleAlpha, Eight, 24),
    ]
    .into_iter()
    .map(|(colour, depth, length)| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 4, 3);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == Indexed {
            encoder.set_palette(&[0, 0, 0, 255, 255, 255][..]);
        }
        let data: Vec<u8> = (0..length).map(|i: u8| i.wrapping_mul(37)).collect();
        encoder.write_header().and_then(|mut w| w.write_image_data(&data)).expect("a picture");
        bytes
    })
    .collect()
}

/// The hash of the scene that saved photons are of.
pub const HASH: &str = "0123456789abcdef";

pub fn photons() -> Vec<Vec<u8>> {
    let mut all = [saved::<1>(), saved::<3>()];
    all.sort();
    all.into()
}

fn saved<const C: usize>() -> Vec<u8> {
    let photon = |i: u32| Photon {
        cell: [i, 2 * i, 7],
        direction: i << 16,
        primitive: i % 2,
        tag: (i % 4) | (1 << 16),
        weight: [0.5; C],
    };
    let map = SavedMap {
        scene_hash: HASH.into(),
        settings: "64 photons".into(),
        photons_traced: 64,
        replicates: 4,
        photon_lm: 1.5,
        frame: Frame::new(DVec3::ZERO, DVec3::ONE),
        photons: (0..9).map(photon).collect(),
    };
    let mut bytes = Vec::new();
    photon_map::write(&map, &mut bytes).expect("photons");
    bytes
}

pub const LIST: &str =
    "{\"caustix\": \"0.3.0\", \"photons\": 4096, \"files\": {\"floor.exr\": \"00\", \"floor.png\": \"01\"}}";

/// Scenes as texts: the project's own.
pub fn scenes() -> Vec<Vec<u8>> {
    let names =
        ["pool_seen", "wavy_glass_seen", "ball_lens", "reflector", "prism", "room", "wine", "satin_pane"];
    let mut all: Vec<_> = names.map(|name| own(&format!("scenes/{name}.toml"))).into();
    all.push(SCENE.into());
    all
}

/// A scene with something of everything, so small that it is built in no time.
pub const SCENE: &str = r#"
[[emitter]]
name = "lamp"
type = "photometric"
file = "lamp.ies"
position = [0.0, 0.0, 2.0]
aim = [0.0, 0.1, -1.0]
[[emitter]]
type = "panel"
position = [1.0, 0.0, 2.0]
size = [0.2, 0.1]
flux_lm = 300
cct_k = 3000
[[emitter]]
type = "collimated"
position = [0.0, 1.0, 2.0]
radius = 0.1
flux_lm = 10
colour = [1.0, 0.5, 0.2]
[material.black]
type = "absorber"
[material.paper]
type = "lambertian"
reflectance = [0.4, 0.5, 0.6]
transmittance = 0.2
[material.opal]
type = "tabulated"
file = "opal.scatter"
energy = "scale"
[material.glass]
type = "dielectric"
ior = 1.5
[[surface]]
name = "floor"
type = "rectangle"
material = "paper"
corner = [-2.0, -2.0, 0.0]
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 4.0, 0.0]
[[surface]]
name = "sheet"
type = "mesh"
material = "opal"
file = "sheet.obj"
translate = [0.0, 0.0, 1.5]
[[surface]]
name = "block"
type = "box"
material = "glass"
min = [-0.2, -0.2, 0.0]
max = [0.2, 0.2, 0.3]
contact = "glued"
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0.8, 0.0, 0.5]
radius = 0.2
priority = 1
[[surface]]
name = "hills"
type = "heightfield"
material = "black"
origin = [-1.0, 0.5, 0.2]
size = [0.5, 0.5]
facing = "up"
image = "hills.png"
height = [0.0, 0.1]
[[surface]]
name = "ripples"
type = "heightfield"
material = "glass"
origin = [-1.0, -1.0, 1.0]
size = [0.5, 0.5]
cells = [3, 2]
facing = "up"
waves = [{ amplitude = 0.01, wavelength = 0.3, direction_deg = 15 }]
[[receiver]]
surface = "floor"
cells = [4, 4]
grid = "EN 12464"
[[receiver]]
name = "hills back"
surface = "hills"
side = "back"
[camera]
position = [0.6, -1.8, 0.5]
look_at = [0.0, 0.0, 0.05]
fov_deg = 35
pixels = [4, 3]
samples = 4
[run]
photons = "2^10"
seed = 7
replicates = 4
"#;

/// That scene without what needs a file.
pub fn scene_without_files() -> String {
    let mut parts: Vec<&str> = SCENE.split("\n[").collect();
    parts.retain(|part| !["file = ", "image = ", "opal", "hills"].iter().any(|word| part.contains(word)));
    parts.join("\n[")
}
