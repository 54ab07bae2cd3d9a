//! The text of an OBJ file, looked at line by line: tobj names no lines, takes NaN and indices of vertices that do not stand there
//! yet, divides by weights, and makes faces of long lines.
//!
//! Only `v`, `vn` and `f` carry geometry. Their lines go on to tobj as they stand, without comments and colours; groups, materials,
//! texture coordinates and file references do not.

use crate::error::words::limit;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::visible;
use crate::geometry::MAX_COORDINATE_M;

/// Elements (`v`, `vn`, corners of `f`) a file may have in all.
pub const MAX_OBJ_ELEMENTS: usize = 1 << 28;

/// Keywords that carry nothing a surface needs.
const IGNORED: [&str; 12] =
    ["o", "g", "s", "usemtl", "mtllib", "vt", "l", "p", "vp", "usemap", "maplib", "shadow_obj"];

/// A checked file.
#[derive(Debug, Default)]
pub(crate) struct Checked {
    /// The lines `v`, `vn` and `f`.
    pub geometry: String,
    /// Whether each corner, in file order, names a normal.
    pub corner_has_normal: Vec<bool>,
    /// Line of each face, from 1.
    pub face_lines: Vec<usize>,
    /// What was left out.
    pub warnings: Vec<Diagnostic>,
    /// Vertices and normals.
    points: usize,
}

impl Checked {
    /// Triangles of all fans.
    pub fn triangles(&self) -> usize {
        self.corner_has_normal.len() - 2 * self.face_lines.len()
    }

    /// Vertices and normals.
    pub fn points(&self) -> usize {
        self.points
    }
}

struct Line<'a> {
    number: usize,
    text: &'a str,
}

impl Line<'_> {
    /// A diagnostic at a word of this line.
    fn refuse(&self, kind: Kind, word: &str, found: String, required: &str) -> Diagnostic {
        let offset = (word.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        let column = self.text.get(..offset).map_or(1, |before| before.chars().count() + 1);
        Diagnostic::new(kind, found, required).at(self.number, column)
    }

    fn numbers(&self, words: &[&str]) -> Result<Vec<f64>> {
        let number = |word: &&str| match word.parse::<f64>() {
            Ok(x) if x.abs() <= MAX_COORDINATE_M => Ok(x),
            Ok(_) => Err(self.refuse(Kind::Range, word, quote(word), "a finite number up to 1e30")),
            Err(_) if word.contains(',') => Err(self.refuse(
                Kind::Syntax,
                word,
                quote(word),
                "a number with a decimal point, not a comma",
            )),
            Err(_) => Err(self.refuse(Kind::Syntax, word, quote(word), "a number")),
        };
        words.iter().map(number).collect()
    }
}

/// A word in quotation marks, cut to a length a message can bear.
fn quote(word: &str) -> String {
    let short: String = word.chars().take(40).collect();
    format!("\"{}\"", visible(&short))
}

/// Checks a whole file.
pub(crate) fn check(text: &str) -> Result<Checked> {
    let mut checked = Checked::default();
    let (mut vertices, mut normals, mut elements) = (0usize, 0usize, 0usize);
    for (i, raw) in text.lines().enumerate() {
        let line = Line { number: i + 1, text: raw };
        let content = raw.split('#').next().unwrap_or("");
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        if content.trim_end().ends_with('\\') {
            let found = "a line continued by \\".into();
            return Err(line.refuse(Kind::Syntax, content, found, "one statement a line"));
        }
        let words: Vec<&str> = words.collect();
        elements += words.len();
        if elements > MAX_OBJ_ELEMENTS {
            let required = format!("at most {}", limit(MAX_OBJ_ELEMENTS as u64));
            return Err(Diagnostic::new(Kind::Limit, "too many elements", required).at(line.number, 1));
        }
        match keyword {
            "v" => {
                coordinates(&line, keyword, &words)?;
                // Numbers beyond the third are a colour, or a weight of 1.
                let [x, y, z] = [words[0], words[1], words[2]];
                checked.geometry.extend(["v ", x, " ", y, " ", z, "\n"]);
                vertices += 1;
            }
            "vn" => {
                coordinates(&line, keyword, &words)?;
                checked.geometry.extend([content, "\n"]);
                normals += 1;
            }
            "f" => {
                face(&line, keyword, &words, (vertices, normals), &mut checked.corner_has_normal)?;
                checked.geometry.extend([content, "\n"]);
                checked.face_lines.push(line.number);
            }
            _ if IGNORED.contains(&keyword) => {}
            _ if checked.warnings.len() < 10 => {
                let (found, required) =
                    (format!("{} (ignored)", quote(keyword)), "v, vn, f: polygons are read");
                checked.warnings.push(line.refuse(Kind::Syntax, keyword, found, required));
            }
            _ => {}
        }
    }
    if checked.face_lines.is_empty() {
        return Err(Diagnostic::new(
            Kind::Missing,
            "no face",
            "at least one line `f 1 2 3`: points and lines alone are no surface",
        ));
    }
    checked.points = vertices + normals;
    Ok(checked)
}

/// Checks the numbers of `v` or `vn`.
fn coordinates(line: &Line, keyword: &str, words: &[&str]) -> Result<()> {
    match (keyword, &line.numbers(words)?[..]) {
        // Three more are a colour.
        ("v", [_, _, _] | [_, _, _, 1.0] | [_, _, _, _, _, _]) => Ok(()),
        ("v", [_, _, _, w]) => {
            Err(line.refuse(Kind::Syntax, words[3], format!("weight {w}"), "no weight, or 1"))
        }
        ("vn", &[x, y, z]) if glam::DVec3::new(x, y, z).try_normalize().is_some() => Ok(()),
        ("vn", [_, _, _]) => {
            Err(line.refuse(Kind::Syntax, words[0], "a normal of length 0".into(), "a direction"))
        }
        (_, other) => {
            let what = if keyword == "v" { "vertex" } else { "normal" };
            let found = format!("a {what} of {} numbers", other.len());
            Err(line.refuse(Kind::Syntax, keyword, found, "x, y, z"))
        }
    }
}

/// Notes for each corner whether it names a normal.
fn face(
    line: &Line,
    keyword: &str,
    words: &[&str],
    (vertices, normals): (usize, usize),
    corner_has_normal: &mut Vec<bool>,
) -> Result<()> {
    if words.len() < 3 {
        let found = format!("a face of {} corners", words.len());
        return Err(line.refuse(Kind::Syntax, keyword, found, "at least three"));
    }
    for word in words {
        let mut parts = word.split('/');
        check_index(line, word, parts.next().unwrap_or_default(), vertices, "vertex")?;
        if parts.next().is_some_and(|t| !t.is_empty() && t.parse::<i64>().is_err()) {
            let required = "a whole number for the texture coordinate";
            return Err(line.refuse(Kind::Syntax, word, quote(word), required));
        }
        let normal = parts.next();
        if let Some(normal) = normal {
            check_index(line, word, normal, normals, "normal")?;
        }
        if parts.next().is_some() {
            return Err(line.refuse(Kind::Syntax, word, quote(word), "v, v/vt, v//vn or v/vt/vn"));
        }
        corner_has_normal.push(normal.is_some());
    }
    Ok(())
}

/// An index from 1; negative ones count back from the last element so far.
fn check_index(line: &Line, word: &str, index: &str, count: usize, what: &str) -> Result<()> {
    let Ok(i) = index.parse::<i64>() else {
        return Err(line.refuse(Kind::Syntax, word, quote(word), &format!("a whole number for the {what}")));
    };
    if i != 0 && i.unsigned_abs() <= count as u64 {
        return Ok(());
    }
    let found = format!("{what} {i} where there are {count} so far");
    Err(line.refuse(Kind::Range, word, found, &format!("1 to {count}, or -{count} to -1")))
}
