//! The nearest known word to a misspelt one.

use crate::error::Diagnostic;

/// The known word nearest to `word`, or `None` where no word is near enough to be what was meant.
///
/// Case is ignored, and a swap of two neighbours counts as one difference. Near enough is: at most half of the longer word's characters differ, or one of the two is
/// a beginning of the other of at least two characters. Of equally near words the first listed wins.
pub fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    // A longer word matches nothing here, and the distance costs the product of both lengths.
    const LONGEST_WORD: usize = 64;
    if word.len() > LONGEST_WORD {
        return None;
    }
    let word = word.to_lowercase();
    let mut best: Option<(usize, &'k str)> = None;
    for &candidate in known.iter().filter(|k| k.len() <= LONGEST_WORD) {
        let lower = candidate.to_lowercase();
        let distance = strsim::osa_distance(&word, &lower);
        let longer = word.chars().count().max(lower.chars().count());
        let shorter = word.chars().count().min(lower.chars().count());
        let begins = shorter >= 2 && (word.starts_with(&lower) || lower.starts_with(&word));
        if (2 * distance <= longer || begins) && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// What people write, and what it is called here; the first that is known in its place is meant.
const OTHER_WORDS: [(&str, &[&str]); 45] = [
    ("ies", &["photometric"]),
    ("ldt", &["photometric"]),
    ("luminaire", &["photometric"]),
    ("point", &["isotropic"]),
    ("omni", &["isotropic"]),
    ("laser", &["collimated"]),
    ("parallel", &["collimated"]),
    ("directional", &["collimated"]),
    ("area", &["panel"]),
    ("glass", &["dielectric", "ior"]),
    ("water", &["dielectric"]),
    ("plastic", &["dielectric"]),
    ("acrylic", &["dielectric"]),
    ("transparent", &["dielectric"]),
    ("refractive", &["dielectric"]),
    ("metal", &["mirror"]),
    ("specular", &["mirror"]),
    ("diffuse", &["lambertian"]),
    ("matte", &["lambertian"]),
    ("white", &["lambertian"]),
    ("black", &["absorber"]),
    ("bsdf", &["tabulated"]),
    ("brdf", &["tabulated"]),
    ("measured", &["tabulated"]),
    ("plane", &["rectangle"]),
    ("quad", &["rectangle"]),
    ("ball", &["sphere"]),
    ("cube", &["box"]),
    ("cuboid", &["box"]),
    ("obj", &["mesh"]),
    ("stl", &["mesh"]),
    ("outside", &["front"]),
    ("top", &["front"]),
    ("inside", &["back"]),
    ("bottom", &["back"]),
    ("origin", &["corner", "center", "position"]),
    ("corner", &["origin"]),
    ("location", &["position", "center", "corner"]),
    ("direction", &["aim", "look_at"]),
    ("target", &["look_at", "aim"]),
    ("lumens", &["flux_lm"]),
    ("n", &["ior"]),
    ("index", &["ior"]),
    ("refractive_index", &["ior"]),
    ("resolution", &["cells", "pixels"]),
];

/// The known word for what is called otherwise elsewhere.
fn called<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let (_, names) = OTHER_WORDS.iter().find(|(other, _)| word.eq_ignore_ascii_case(other))?;
    names.iter().find_map(|name| known.iter().find(|known| *known == name)).copied()
}

/// The known word that this one was meant to be, as far as one can tell.
pub fn meant<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    called(word, known).or_else(|| nearest(word, known))
}

/// The error with the known word that was probably meant instead of `word`, in these quotation marks.
pub fn hinted(error: Diagnostic, word: &str, known: &[&str], mark: char) -> Diagnostic {
    match meant(word, known) {
        Some(near) => error.hint(format!("did you mean {mark}{near}{mark}?")),
        None => error,
    }
}

/// `"a, b or c"`.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::from("nothing"),
        [only] => (*only).to_string(),
        [head @ .., tail] => format!("{} or {tail}", head.join(", ")),
    }
}

/// `"\"a\", \"b\" or \"c\""`.
pub fn list_quoted(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    list(&quoted.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_is_found_and_strangers_are_not() {
        let known = ["position", "aim", "up", "flux_lm", "focal_length"];
        for (word, found) in [
            ("positon", Some("position")),
            ("pos", Some("position")),
            ("iam", Some("aim")),
            ("AIM", Some("aim")),
            ("flux", Some("flux_lm")),
            ("flux_klm", Some("flux_lm")),
            ("focallength", Some("focal_length")),
            ("zebra", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, &known), found, "{word}");
        }
        assert_eq!(nearest(&"p".repeat(1 << 20), &known), None);
    }

    #[test]
    fn words_of_other_programs_are_translated_where_there_is_such_a_thing() {
        let meant = |word: &str, known: &[&str]| {
            hinted(Diagnostic::new(crate::error::Kind::Unknown, "", ""), word, known, '"')
                .advice()
                .map(str::to_owned)
        };
        assert_eq!(
            meant("Glass", &["mirror", "dielectric"]).as_deref(),
            Some("did you mean \"dielectric\"?")
        );
        assert_eq!(meant("origin", &["edge_u", "corner"]).as_deref(), Some("did you mean \"corner\"?"));
        assert_eq!(meant("glass", &["mirror"]), None);
    }

    #[test]
    fn words_are_listed_with_or() {
        assert_eq!(list(&["a"]), "a");
        assert_eq!(list(&["a", "b"]), "a or b");
        assert_eq!(list(&["a", "b", "c"]), "a, b or c");
    }
}
