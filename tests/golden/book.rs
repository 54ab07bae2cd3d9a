//! The recorded hashes: a line for each file of each run, with a hash for each of its parts.

use std::collections::BTreeMap;

/// Name and hash of each part of a file.
pub type Parts = Vec<(String, String)>;

const HEAD: &str = "\
# What caustix wrote before: run, file, and for each part of the file a short value as it is or 16 hexadecimal
# digits of SHA-256. `@name` is an EXR's attribute `caustix.name`. Made by the test beside this file; its head
# says how and when to make it anew.
";

/// Files whose pixels are a drawing of numbers, not numbers.
const DRAWINGS: [&str; 2] = [".png", ".svg"];

/// Hashes by run and file.
#[derive(Default)]
pub struct Book {
    files: BTreeMap<(String, String), BTreeMap<String, String>>,
}

impl Book {
    /// Adds a file of a run.
    pub fn add(&mut self, run: &str, file: &str, parts: Parts) {
        let count = parts.len();
        let parts: BTreeMap<String, String> =
            parts.into_iter().map(|(k, v)| (k.replace(' ', "_"), v)).collect();
        assert_eq!(parts.len(), count, "{run}: {file} has two parts of one name");
        let earlier = self.files.insert((run.to_string(), file.to_string()), parts);
        assert!(earlier.is_none(), "{run}: {file} twice");
    }

    /// Those of some runs.
    pub fn only(&self, wanted: impl Fn(&str) -> bool) -> Self {
        let kept = self.files.iter().filter(|((run, _), _)| wanted(run));
        Self { files: kept.map(|(key, parts)| (key.clone(), parts.clone())).collect() }
    }

    /// Both together.
    pub fn with(mut self, other: Self) -> Self {
        self.files.extend(other.files);
        self
    }

    /// As it stands in the repository.
    pub fn to_text(&self) -> String {
        let mut text = HEAD.to_string();
        for (section, drawn) in [("numbers", false), ("drawings", true)] {
            text += &format!("\n[{section}]\n");
            for ((run, file), parts) in self.files.iter().filter(|((_, file), _)| is_drawing(file) == drawn) {
                let parts: Vec<String> = parts.iter().map(|(part, hash)| format!("{part}={hash}")).collect();
                text += &format!("{run}\t{file}\t{}\n", parts.join(" "));
            }
        }
        text
    }

    /// Reads what [`Self::to_text`] wrote.
    pub fn from_text(text: &str) -> Self {
        let mut book = Self::default();
        for line in text.lines().filter(|line| line.contains('\t')) {
            let [run, file, parts] = line.split('\t').collect::<Vec<_>>()[..] else {
                panic!("run, file and parts instead of {line}")
            };
            let part = |word: &str| {
                let (part, hash) = word.rsplit_once('=').expect("part=hash");
                (part.to_string(), hash.to_string())
            };
            book.add(run, file, parts.split(' ').filter(|word| !word.is_empty()).map(part).collect());
        }
        book
    }

    /// What is missing, new or another in `found`, in words.
    pub fn differences(&self, found: &Self) -> Vec<String> {
        let mut told = Vec::new();
        for ((run, file), parts) in &self.files {
            let Some(now) = found.files.get(&(run.clone(), file.clone())) else {
                told.push(format!("{run}: {file} is no longer written"));
                continue;
            };
            for (part, hash) in parts {
                match now.get(part) {
                    None => told.push(format!("{run}: {file}: {part} is gone")),
                    Some(other) if other != hash => {
                        told.push(format!("{run}: {file}: {part} is {other}, was {hash}"));
                    }
                    Some(_) => {}
                }
            }
            let new = now.keys().filter(|part| !parts.contains_key(*part));
            told.extend(new.map(|part| format!("{run}: {file}: {part} is new")));
        }
        let new = found.files.keys().filter(|key| !self.files.contains_key(*key));
        told.extend(new.map(|(run, file)| format!("{run}: {file} is new")));
        told
    }
}

fn is_drawing(file: &str) -> bool {
    DRAWINGS.iter().any(|ending| file.ends_with(ending))
}

#[test]
fn a_book_reads_what_it_wrote_and_names_every_difference() {
    let parts = |list: &[(&str, &str)]| list.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
    let mut book = Book::default();
    book.add("a", "plate.exr", parts(&[("channel hits", "01"), ("attribute x=y", "02")]));
    book.add("a", "plate.png", parts(&[("pixels", "03")]));
    let mut other = Book::from_text(&book.to_text());
    assert_eq!(book.differences(&other), [""; 0]);
    other = Book::default();
    other.add("a", "plate.exr", parts(&[("channel hits", "09"), ("new", "02")]));
    other.add("b", "plate.exr", parts(&[]));
    assert_eq!(
        book.differences(&other),
        [
            "a: plate.exr: attribute_x=y is gone",
            "a: plate.exr: channel_hits is 09, was 01",
            "a: plate.exr: new is new",
            "a: plate.png is no longer written",
            "b: plate.exr is new",
        ]
    );
}
