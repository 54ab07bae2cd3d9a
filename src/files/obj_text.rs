//! The text of an OBJ file, checked line by line before the reader sees it: the reader names no lines.
//!
//! Only `v`, `vn` and `f` carry geometry. What passes is written out again as just these, so groups, materials,
//! texture coordinates, colours and file references never reach the reader.

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::MAX_COORDINATE_M;

/// Elements (`v`, `vn`, corners of `f`) a file may have in all.
pub const MAX_OBJ_ELEMENTS: usize = 1 << 28;

/// Keywords that carry nothing a surface needs.
const IGNORED: [&str; 12] =
    ["o", "g", "s", "usemtl", "mtllib", "vt", "l", "p", "vp", "usemap", "maplib", "shadow_obj"];

/// A checked file.
#[derive(Debug, Default)]
pub(crate) struct Checked {
    /// The geometry alone: `v x y z`, `vn x y z`, `f v v v` or `f v//n v//n v//n`.
    pub text: String,
    /// Whether each corner, in file order, names a normal.
    pub corner_has_normal: Vec<bool>,
    /// Line of each face, from 1.
    pub face_lines: Vec<usize>,
    /// What was left out.
    pub warnings: Vec<Diagnostic>,
}

struct Line<'a> {
    number: usize,
    text: &'a str,
}

impl Line<'_> {
    /// A diagnostic at a word of this line.
    fn refuse(&self, word: &str, found: String, required: &str) -> Diagnostic {
        let offset = (word.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        let column = self.text.get(..offset).map_or(1, |before| before.chars().count() + 1);
        Diagnostic::new(Kind::Syntax, found, required).at(self.number, column)
    }

    fn number(&self, word: &str) -> Result<f64> {
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() && x.abs() <= MAX_COORDINATE_M => Ok(x),
            Ok(_) => {
                let required = format!("a finite number up to {MAX_COORDINATE_M:e}");
                Err(Diagnostic::new(Kind::Range, quote(word), required).at(self.number, self.column(word)))
            }
            Err(_) => Err(self.refuse(word, quote(word), "a number")),
        }
    }

    fn column(&self, word: &str) -> usize {
        let offset = (word.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        self.text.get(..offset).map_or(1, |before| before.chars().count() + 1)
    }
}

/// A word in quotation marks, cut to a length a message can bear.
fn quote(word: &str) -> String {
    let short: String = word.chars().take(40).collect();
    format!("\"{short}\"")
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
            return Err(line.refuse(content, "a line continued by \\".into(), "one statement a line"));
        }
        let words: Vec<&str> = words.collect();
        elements += words.len();
        if elements > MAX_OBJ_ELEMENTS {
            let required = format!("at most {MAX_OBJ_ELEMENTS}");
            return Err(Diagnostic::new(Kind::Limit, "too many elements", required).at(line.number, 1));
        }
        match keyword {
            "v" => {
                vertex(&line, keyword, &words, &mut checked.text)?;
                vertices += 1;
            }
            "vn" => {
                normal(&line, keyword, &words, &mut checked.text)?;
                normals += 1;
            }
            "f" => {
                face(&line, keyword, &words, (vertices, normals), &mut checked)?;
                checked.face_lines.push(line.number);
            }
            _ if IGNORED.contains(&keyword) => {}
            _ if checked.warnings.len() < 10 => checked.warnings.push(line.refuse(
                keyword,
                format!("{} (ignored)", quote(keyword)),
                "v, vn, f: polygons are read",
            )),
            _ => {}
        }
    }
    if checked.face_lines.is_empty() {
        return Err(Diagnostic::new(Kind::Missing, "no face", "at least one line f"));
    }
    Ok(checked)
}

fn write(out: &mut String, keyword: &str, xyz: [f64; 3]) {
    // The shortest decimal that reads back as the same bits.
    out.push_str(&format!("{keyword} {:e} {:e} {:e}\n", xyz[0], xyz[1], xyz[2]));
}

fn vertex(line: &Line, keyword: &str, words: &[&str], out: &mut String) -> Result<()> {
    let numbers = words.iter().map(|w| line.number(w)).collect::<Result<Vec<f64>>>()?;
    match numbers[..] {
        // Three more are a colour.
        [x, y, z] | [x, y, z, _, _, _] => write(out, "v", [x, y, z]),
        [x, y, z, 1.0] => write(out, "v", [x, y, z]),
        [_, _, _, w] => return Err(line.refuse(words[3], format!("weight {w}"), "no weight, or 1")),
        _ => {
            let found = format!("a vertex of {} numbers", numbers.len());
            return Err(line.refuse(keyword, found, "x, y, z"));
        }
    }
    Ok(())
}

fn normal(line: &Line, keyword: &str, words: &[&str], out: &mut String) -> Result<()> {
    let numbers = words.iter().map(|w| line.number(w)).collect::<Result<Vec<f64>>>()?;
    let [x, y, z] = numbers[..] else {
        let found = format!("a normal of {} numbers", numbers.len());
        return Err(line.refuse(keyword, found, "x, y, z"));
    };
    if glam::DVec3::new(x, y, z).try_normalize().is_none() {
        return Err(line.refuse(words[0], "a normal of length 0".into(), "a direction"));
    }
    write(out, "vn", [x, y, z]);
    Ok(())
}

fn face(
    line: &Line,
    keyword: &str,
    words: &[&str],
    (vertices, normals): (usize, usize),
    checked: &mut Checked,
) -> Result<()> {
    if words.len() < 3 {
        let found = format!("a face of {} corners", words.len());
        return Err(line.refuse(keyword, found, "at least three"));
    }
    checked.text.push('f');
    for word in words {
        let parts: Vec<&str> = word.split('/').collect();
        if parts.len() > 3 {
            return Err(line.refuse(word, quote(word), "v, v/vt, v//vn or v/vt/vn"));
        }
        let v = resolve(line, word, parts[0], vertices, "vertex")?;
        if let Some(vt) = parts.get(1).filter(|t| !t.is_empty())
            && vt.parse::<i64>().is_err()
        {
            return Err(line.refuse(word, quote(word), "a whole number for the texture coordinate"));
        }
        let n = match parts.get(2) {
            Some(n) => Some(resolve(line, word, n, normals, "normal")?),
            None => None,
        };
        checked.corner_has_normal.push(n.is_some());
        match n {
            Some(n) => checked.text.push_str(&format!(" {v}//{n}")),
            None => checked.text.push_str(&format!(" {v}")),
        }
    }
    checked.text.push('\n');
    Ok(())
}

/// An index from 1; negative ones count back from the last element so far.
fn resolve(line: &Line, word: &str, index: &str, count: usize, what: &str) -> Result<usize> {
    let Ok(i) = index.parse::<i64>() else {
        return Err(line.refuse(word, quote(word), &format!("a whole number for the {what}")));
    };
    let from_one = if i < 0 { i128::from(i) + count as i128 + 1 } else { i128::from(i) };
    if from_one >= 1 && from_one <= count as i128 {
        return Ok(from_one as usize);
    }
    let found = format!("{what} {i} where there are {count} so far");
    Err(Diagnostic::new(Kind::Range, found, format!("1 to {count}, or -{count} to -1"))
        .at(line.number, line.column(word)))
}
