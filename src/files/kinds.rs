//! What a file is, by its content and not its name: for messages about a file that was given where one of another
//! kind is read.

use crate::error::{Diagnostic, Kind};
use crate::files::decode::{decode, is_utf16};

/// What a file is good for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    /// A scene.
    Scene,
    /// A photometric file (IES LM-63, EULUMDAT).
    Photometric,
    /// A scattering table.
    Scattering,
    /// An OBJ file.
    Mesh,
    /// A saved photon map.
    PhotonMap,
    /// A PNG.
    Image,
    /// Nothing here, as it stands: what to do with it.
    None(&'static str),
}

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FileKind {
    /// Its name, with an article.
    pub what: &'static str,
    /// What it is good for.
    pub good_for: Use,
}

impl FileKind {
    /// What to do with a file of this kind, which is called so.
    pub fn advice(self, file: &str) -> String {
        match self.good_for {
            Use::Scene => format!("`caustix render {file}` renders it"),
            Use::Photometric => format!(
                "`caustix photometry {file}` says what it holds; in a scene it is the `file` of an [[emitter]] of type \"photometric\""
            ),
            Use::Scattering => format!(
                "`caustix bsdf {file}` says what it holds; in a scene it is the `file` of a material of type \"tabulated\""
            ),
            Use::Mesh => "in a scene it is the `file` of a [[surface]] of type \"mesh\"".into(),
            Use::PhotonMap => format!("`caustix render SCENE.toml --map {file}` makes a picture of it"),
            Use::Image => "in a scene it can be the `image` of a [[surface]] of type \"heightfield\"".into(),
            Use::None(advice) => advice.into(),
        }
    }

    /// The command that is meant for such a file.
    pub fn command(self, file: &str) -> Option<String> {
        match self.good_for {
            Use::Scene => Some(format!("caustix render {file}")),
            Use::Photometric => Some(format!("caustix photometry {file}")),
            Use::Scattering => Some(format!("caustix bsdf {file}")),
            Use::PhotonMap => Some(format!("caustix render SCENE.toml --map {file}")),
            Use::Mesh | Use::Image | Use::None(_) => None,
        }
    }
}

const TO_OBJ: Use = Use::None("export the mesh as OBJ, or convert the file (Blender, MeshLab)");
const BODIES: Use =
    Use::None("make a mesh of it and export that as OBJ (FreeCAD, or the program that wrote it)");
const TO_PNG: Use = Use::None("convert the picture to a PNG of 8 or 16 bits (GIMP, ImageMagick)");
const TO_IES: Use =
    Use::None("it is not read: convert the file to IES LM-63 or EULUMDAT, or ask the maker for one of them");
const TO_TABLE: Use =
    Use::None("convert the table: docs/SCATTERING.md shows a text that a spreadsheet can write");
const UNPACK: Use = Use::None("unpack it, and give the file that is in it");
const DOCUMENT: Use = Use::None("ask for the data itself: no tables are read out of documents");
const PAGE: Use = Use::None(
    "a web page was saved in place of the file: open it in a browser and download the file it links to",
);
const AS_TEXT: Use = Use::None("save it as plain text");
const FOREIGN: Use = Use::None("docs/SCENE.md has the format of scenes, and scenes/ examples");
const RESULT: Use = Use::None(
    "viewers of EXR open it (tev, DJV, OpenCV); as heights of a surface, convert it to a PNG of 16 bits",
);

/// How files of one kind begin.
const BEGINNINGS: [(&[u8], &str, Use); 27] = [
    (b"caustixM", "a photon map", Use::PhotonMap),
    (b"\x89PNG", "a PNG picture", Use::Image),
    (b"\x76\x2f\x31\x01", "an EXR picture", RESULT),
    (b"\xff\xd8\xff", "a JPEG picture", TO_PNG),
    (b"II*\0", "a TIFF picture", TO_PNG),
    (b"MM\0*", "a TIFF picture", TO_PNG),
    (b"GIF8", "a GIF picture", TO_PNG),
    (b"#?RADIANCE", "a Radiance picture (.hdr)", TO_PNG),
    (b"#?RGBE", "a Radiance picture (.hdr)", TO_PNG),
    (b"ply\n", "a PLY file", TO_OBJ),
    (b"ply\r", "a PLY file", TO_OBJ),
    (b"OFF", "an OFF file", TO_OBJ),
    (b"COFF", "an OFF file", TO_OBJ),
    (b"glTF", "a glTF file", TO_OBJ),
    (b"Kaydara FBX", "an FBX file", TO_OBJ),
    (b"; FBX", "an FBX file", TO_OBJ),
    (b"BLENDER", "a Blender file", TO_OBJ),
    (b"ISO-10303-21", "a STEP file", BODIES),
    (b"AutoCAD Binary DXF", "a DXF file", BODIES),
    (b"AC10", "a DWG file", BODIES),
    (b"%PDF", "a PDF document", DOCUMENT),
    (b"{\\rtf", "a formatted text (RTF)", AS_TEXT),
    (b"\xd0\xcf\x11\xe0", "an office document", DOCUMENT),
    (b"PK\x03\x04", "a ZIP archive (or 3MF, or an office document)", UNPACK),
    (b"\x1f\x8b", "a file packed by gzip", UNPACK),
    (b"7z\xbc\xaf", "a 7z archive", UNPACK),
    (b"tensor_file", "an RGL tensor file", TO_TABLE),
];

/// Bytes of a binary STL file before its facets, and of one facet.
const STL: (usize, usize) = (84, 50);

/// Bytes that are looked at as text.
const HEAD: usize = 64 << 10;

/// How caustix's own scattering tables begin.
pub(crate) const SCATTERING: &str = "caustix-scattering";

/// Words that the scattering tables of Zemax begin with.
pub(crate) const ZEMAX: [&str; 5] =
    ["Source", "Symmetry", "SpectralContent", "ScatterType", "SampleRotation"];

/// What these bytes are, as far as they can be told.
pub(crate) fn kind_of(bytes: &[u8]) -> Option<FileKind> {
    let kind = |what, good_for| Some(FileKind { what, good_for });
    if let Some((_, what, good_for)) = BEGINNINGS.iter().find(|(head, _, _)| bytes.starts_with(head)) {
        return kind(what, *good_for);
    }
    let tagged = |at: usize, tag: &[u8]| bytes.get(at..at + tag.len()) == Some(tag);
    if tagged(0, b"RIFF") && tagged(8, b"WEBP") {
        return kind("a WebP picture", TO_PNG);
    }
    if tagged(4, b"ftyphei") || tagged(4, b"ftypmif1") || tagged(4, b"ftypavif") {
        return kind("a HEIF picture", TO_PNG);
    }
    // Its length follows the magic; two letters alone are no proof.
    let stated = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    if tagged(0, b"BM") && stated(6) == Some(0) {
        return kind("a BMP picture", TO_PNG);
    }
    if tagged(0, b"MM") && stated(2).is_some_and(|n| n as usize == bytes.len()) {
        return kind("a 3DS file", TO_OBJ);
    }
    let facets = stated(80).and_then(|n| (n as usize).checked_mul(STL.1));
    if facets.is_some_and(|facets| facets + STL.0 == bytes.len()) {
        return kind("an STL file", TO_OBJ);
    }
    let (what, good_for) = of_text(&decode(&bytes[..bytes.len().min(HEAD)]))?;
    kind(what, good_for)
}

/// What a text is.
fn of_text(text: &str) -> Option<(&'static str, Use)> {
    let trimmed = text.trim_matches(|c: char| c.is_whitespace() || c == '\0' || c == '\u{feff}');
    let is_comment = |line: &&str| line.trim_start().starts_with('#');
    let mut words = trimmed.lines().skip_while(is_comment).flat_map(str::split_whitespace);
    if trimmed.is_empty() {
        return Some((EMPTY, Use::None("was it saved, and copied whole?")));
    }
    let first = words.next()?;
    if trimmed.starts_with('<') {
        return Some(of_markup(trimmed));
    }
    // The lines of EULUMDAT are looked at first: no label of LM-63 reads like all of them.
    if is_eulumdat(text) {
        return Some(("an EULUMDAT file (.ldt)", Use::Photometric));
    }
    if is_lm63(text) {
        return Some(("an IES photometric file (LM-63)", Use::Photometric));
    }
    if first.eq_ignore_ascii_case(SCATTERING) || ZEMAX.iter().any(|word| first.eq_ignore_ascii_case(word)) {
        return Some(("a scattering table", Use::Scattering));
    }
    let (is_speos, second) = (first.eq_ignore_ascii_case("OPTIS"), words.next());
    if is_speos || (first.eq_ignore_ascii_case("type") && second == Some("bsdf_data")) {
        return Some((if is_speos { "a Speos file" } else { "a FRED file" }, TO_TABLE));
    }
    let headers = ["[[emitter]]", "[[surface]]", "[[receiver]]", "[material.", "[camera]"];
    if text.lines().any(|line| headers.iter().any(|header| line.trim_start().starts_with(header))) {
        return Some(("a scene", Use::Scene));
    }
    if first.starts_with('{') {
        let is_gltf = text.contains("\"asset\"") && text.contains("\"version\"");
        return Some(if is_gltf { ("a glTF file", TO_OBJ) } else { ("a JSON file", FOREIGN) });
    }
    let is_facet = |word: &str| word == "facet" || word == "endsolid";
    if first == "solid" && (second.is_some_and(is_facet) || words.any(is_facet)) {
        return Some(("an STL file", TO_OBJ));
    }
    if first == "0" && trimmed.lines().nth(1).is_some_and(|line| line.trim() == "SECTION") {
        return Some(("a DXF file", BODIES));
    }
    // IGES has the letter of a section in column 73.
    if text.lines().next().is_some_and(|line| line.get(72..74) == Some("S ")) {
        return Some(("an IGES file", BODIES));
    }
    is_obj(text).then_some(("a mesh (OBJ)", Use::Mesh))
}

const EMPTY: &str = "an empty file";

/// Markup of which no more is known: scattering tables have their own to say of it.
const XML: &str = "an XML file";

/// What a text in angle brackets is.
fn of_markup(text: &str) -> (&'static str, Use) {
    let lower = text.to_lowercase();
    let has = |word: &str| lower.contains(word);
    match () {
        () if has("<!doctype html") || has("<html") => ("a web page (HTML)", PAGE),
        () if has("<windowelement") => ("a scattering table (Klems XML)", Use::Scattering),
        () if has("iestm33") => ("an IES TM-33 file (XML)", TO_IES),
        () if has("<svg") => ("an SVG drawing", TO_PNG),
        () if has("<collada") => ("a COLLADA file", TO_OBJ),
        () if has("<scene") => ("a scene of another program (XML)", FOREIGN),
        // Other photometric files in XML (UNI 11733, TM-33 with another root).
        () if has("luminaire") || has("photometr") || has("candela") => ("a photometric file in XML", TO_IES),
        () => (XML, FOREIGN),
    }
}

/// Whether it is LM-63, which has a line TILT=, and whose newer editions say what they are.
pub(crate) fn is_lm63(text: &str) -> bool {
    let starts = |line: &str, beginning: &str| {
        line.trim_start().get(..beginning.len()).is_some_and(|head| head.eq_ignore_ascii_case(beginning))
    };
    let is_tilt = |line: &str| starts(line, "TILT") && line.trim_start()[4..].trim_start().starts_with('=');
    let begins = text.trim_matches(|c: char| c.is_whitespace() || c == '\0' || c == '\u{feff}');
    starts(begins, "IESNA") || starts(begins, "IES:LM-63") || text.split(['\n', '\r']).any(is_tilt)
}

/// Whether lines 2 to 7 are those of an EULUMDAT file: type, symmetry, planes, their distance, angles and theirs.
pub(crate) fn is_eulumdat(text: &str) -> bool {
    let numbers: Vec<f64> = lines_2_to_7(text).map_while(|number| number).collect();
    let [kind, symmetry, planes, between_planes, angles, between_angles] = numbers[..] else { return false };
    let is_whole = |x: f64, low: f64, high: f64| x.fract() == 0.0 && (low..=high).contains(&x);
    is_whole(kind, 0.0, 3.0)
        && is_whole(symmetry, 0.0, 4.0)
        && is_whole(planes, 1.0, 1e5)
        && is_whole(angles, 1.0, 1e5)
        && (0.0..=360.0).contains(&between_planes)
        && (0.0..=180.0).contains(&between_angles)
}

/// Whether it looks like a damaged EULUMDAT file: four of these lines have one number each. Its reader says what is wrong.
pub(crate) fn is_nearly_eulumdat(text: &str) -> bool {
    lines_2_to_7(text).flatten().count() >= 4
}

/// The numbers of lines 2 to 7, `None` where a line has none or several; text may stand behind one.
fn lines_2_to_7(text: &str) -> impl Iterator<Item = Option<f64>> {
    let lines = text.split(if text.contains('\n') { '\n' } else { '\r' });
    let number = |word: &str| word.replace(',', ".").parse::<f64>().ok().filter(|x| x.is_finite());
    lines.skip(1).take(6).map(move |line| {
        let mut words = line.split(|c: char| c.is_whitespace() || c == '\0').filter(|word| !word.is_empty());
        let first = words.next().and_then(number);
        first.filter(|_| words.next().and_then(number).is_none())
    })
}

/// Whether a text begins with lines of an OBJ file, a vertex among them.
fn is_obj(text: &str) -> bool {
    const KEYWORDS: [&str; 9] = ["v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"];
    let words =
        |line: &str| line.split('#').next().map(|line| line.split_whitespace().map(str::to_owned).collect());
    let lines = text.lines().filter_map(words).filter(|words: &Vec<String>| !words.is_empty());
    let first: Vec<Vec<String>> = lines.take(20).collect();
    let is_vertex = |words: &Vec<String>| {
        words[0] == "v" && words.iter().filter(|x| x.parse::<f64>().is_ok()).count() > 2
    };
    first.iter().any(is_vertex) && first.iter().all(|words| KEYWORDS.contains(&words[0].as_str()))
}

/// The error that a file is of another kind than the one which is read here. `None` where it is of this kind or of
/// none that is known: then what the reader says of it is to be told.
///
/// `required` is what is read, and `name` what the file is called.
pub(crate) fn instead(bytes: &[u8], read: Use, required: &str, name: &str) -> Option<Diagnostic> {
    let kind = kind_of(bytes);
    let refused = |found: &str, advice: String| {
        let class = if found == EMPTY { Kind::Missing } else { Kind::Unavailable };
        Some(Diagnostic::new(class, found, required).hint(advice).at(1, 1).in_file(name))
    };
    let is_unknown = |kind: &FileKind| kind.what == XML && read == Use::Scattering;
    match kind.filter(|kind| !is_unknown(kind)) {
        Some(kind) if kind.good_for != read => refused(kind.what, kind.advice(name)),
        // Photometric files are read in any encoding.
        _ if read != Use::Photometric && is_utf16(bytes) => {
            refused("a text in UTF-16", "save it as UTF-8".into())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_their_content() {
        let binary_stl = [&[0u8; 80][..], &1u32.to_le_bytes(), &[0u8; 50]].concat();
        let three_ds = [&b"MM"[..], &14u32.to_le_bytes(), &[0u8; 8]].concat();
        let iges = format!("{:72}S      1\n", "");
        let ldt = "maker\r\n1\r\n1\r\n19\r\n10\r\n19\r\n5,0\r\nr\r\n";
        let utf16: Vec<u8> = "TILT=NONE\n1 2".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let cases: [(&[u8], &str); 32] = [
            (b"", "an empty file"),
            (b" \r\n\0", "an empty file"),
            (b"\xef\xbb\xbf[[emitter]]\ntype", "a scene"),
            (b"# x\n\n  [material.glass]\n", "a scene"),
            (b"IESNA91\n", "an IES photometric file (LM-63)"),
            (b"maker\n tilt = NONE\n", "an IES photometric file (LM-63)"),
            (&utf16, "an IES photometric file (LM-63)"),
            (ldt.as_bytes(), "an EULUMDAT file (.ldt)"),
            (b"<?xml version=\"1.0\"?><IESTM33-22>", "an IES TM-33 file (XML)"),
            (b"<Luminaire><Emitter/>", "a photometric file in XML"),
            (b"<!DOCTYPE html>\n<title>", "a web page (HTML)"),
            (b"<WindowElement>", "a scattering table (Klems XML)"),
            (b"<scene version=\"3\">", "a scene of another program (XML)"),
            (b"caustix-scattering 1\n", "a scattering table"),
            (b"# made by\nv 0 0 0\n", "a mesh (OBJ)"),
            (b"solid a\nfacet normal 0 0 1\n", "an STL file"),
            (&binary_stl, "an STL file"),
            (&three_ds, "a 3DS file"),
            (b"{\"asset\": {\"version\": \"2.0\"}}", "a glTF file"),
            (b"{\"a\": 1}", "a JSON file"),
            (b"0\nSECTION\n", "a DXF file"),
            (iges.as_bytes(), "an IGES file"),
            (b"ISO-10303-21;", "a STEP file"),
            (b"RIFF....WEBPVP8 ", "a WebP picture"),
            (b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0", "a BMP picture"),
            (b"MM\0*\0\0\0\x08", "a TIFF picture"),
            (b"\x76\x2f\x31\x01\x02", "an EXR picture"),
            (b"\0\0\0\x18ftypheic", "a HEIF picture"),
            (b"%PDF-1.7", "a PDF document"),
            (b"PK\x03\x04", "a ZIP archive (or 3MF, or an office document)"),
            (b"caustixM\x01", "a photon map"),
            (b"{\\rtf1 IESNA91", "a formatted text (RTF)"),
        ];
        for (bytes, what) in cases {
            assert_eq!(kind_of(bytes).map(|kind| kind.what), Some(what));
        }
        for bytes in [&b"BMW\nx"[..], b"hello", b"v\n", b"1 2 3\n", b"emitter:\n - a", b"sphere x"] {
            assert_eq!(kind_of(bytes), None, "{}", String::from_utf8_lossy(bytes));
        }
        // Not for one that is of the kind which is read, but for its encoding.
        assert_eq!(instead(&utf16, Use::Photometric, "an IES file", "a.ies"), None);
        let scene: Vec<u8> = "[[emitter]]".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(instead(&scene, Use::Scene, "a scene", "a").unwrap().advice(), Some("save it as UTF-8"));
    }
}
