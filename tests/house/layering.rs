//! The import rule: a module uses only what stands before it in `src/lib.rs`.
//!
//! The order of the `pub mod` lines there is the law; this test reads the sources as text and names every line that
//! breaks it. Comments and strings do not count: a doc comment may point anywhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

pub fn source_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The modules in the order of lib.rs.
fn order_of(lib: &str) -> Vec<String> {
    lib.lines()
        .filter_map(|line| line.trim().strip_prefix("pub mod ")?.strip_suffix(';'))
        .map(str::to_string)
        .collect()
}

/// Source text with comments, string and character literals blanked; lines stay where they are.
fn code_only(source: &str) -> String {
    let chars: Vec<char> = source.chars().collect();
    let mut out = String::with_capacity(source.len());
    let blank = |out: &mut String, from: usize, to: usize| {
        out.extend(chars[from..to].iter().map(|c| if *c == '\n' { '\n' } else { ' ' }));
        to
    };
    let mut i = 0;
    while i < chars.len() {
        let rest = &chars[i..];
        i = match rest {
            ['/', '/', ..] => {
                let end = rest.iter().position(|c| *c == '\n').map_or(chars.len(), |n| i + n);
                blank(&mut out, i, end)
            }
            ['/', '*', ..] => {
                let end = block_comment_end(&chars, i);
                blank(&mut out, i, end)
            }
            ['r', '#' | '"', ..] if raw_string_hashes(rest).is_some() && !continues_a_word(&chars, i) => {
                let hashes = raw_string_hashes(rest).unwrap();
                let close: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
                let body = i + hashes + 2;
                let end = (body..chars.len())
                    .find(|at| chars[*at..].starts_with(&close))
                    .map_or(chars.len(), |at| at + close.len());
                blank(&mut out, i, end)
            }
            ['"', ..] => {
                let mut end = i + 1;
                while end < chars.len() && chars[end] != '"' {
                    end += if chars[end] == '\\' { 2 } else { 1 };
                }
                blank(&mut out, i, (end + 1).min(chars.len()))
            }
            ['\'', '\\', ..] => {
                let end = (i + 3..chars.len()).find(|at| chars[*at] == '\'').map_or(chars.len(), |at| at + 1);
                blank(&mut out, i, end)
            }
            // A character; a lifetime has no second quote there.
            ['\'', _, '\'', ..] => blank(&mut out, i, i + 3),
            [c, ..] => {
                out.push(*c);
                i + 1
            }
            [] => break,
        };
    }
    out
}

fn block_comment_end(chars: &[char], start: usize) -> usize {
    let (mut depth, mut at) = (0usize, start);
    while at < chars.len() {
        match chars[at..] {
            ['/', '*', ..] => (depth, at) = (depth + 1, at + 2),
            ['*', '/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    chars.len()
}

fn raw_string_hashes(rest: &[char]) -> Option<usize> {
    let hashes = rest[1..].iter().take_while(|c| **c == '#').count();
    (rest.get(1 + hashes) == Some(&'"')).then_some(hashes)
}

fn continues_a_word(chars: &[char], at: usize) -> bool {
    at > 0 && (chars[at - 1].is_alphanumeric() || chars[at - 1] == '_')
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The paths that a path's tail stands for: `a::b` is one, `{a::b, c}` two. Aliases are cut off.
fn leaves(tail: &str) -> Vec<Vec<String>> {
    let tail = tail.trim_start();
    if let Some(group) = tail.strip_prefix('{') {
        return members(group).into_iter().flat_map(leaves).collect();
    }
    let word: String = tail.chars().take_while(|c| is_word(*c)).collect();
    let rest = &tail[word.len()..];
    match rest.strip_prefix("::") {
        Some(rest) => leaves(rest).into_iter().map(|path| [vec![word.clone()], path].concat()).collect(),
        None => vec![vec![word]],
    }
}

/// The parts of a group between its braces, of which the first is cut off already.
fn members(group: &str) -> Vec<&str> {
    let (mut depth, mut items, mut start) = (0usize, Vec::new(), 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                items.push(&group[start..at]);
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                items.push(&group[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    items
}

/// Every path of the crate that this code of a module names, from the crate's root, with its line.
pub fn imports(code: &str, module: &[String]) -> Vec<(usize, Vec<String>)> {
    let mut found = Vec::new();
    for root in ["crate::", "caustix::", "super::"] {
        let mut from = 0;
        while let Some(offset) = code[from..].find(root) {
            let at = from + offset;
            from = at + root.len();
            if code[..at].chars().next_back().is_some_and(|c| is_word(c) || c == ':') {
                continue;
            }
            let (mut tail, mut base) = (&code[from..], Vec::new());
            if root == "super::" {
                let mut climbed = 1;
                while let Some(rest) = tail.strip_prefix("super::") {
                    (tail, climbed) = (rest, climbed + 1);
                }
                base = module[..module.len().saturating_sub(climbed)].to_vec();
            }
            let line = code[..at].matches('\n').count() + 1;
            found.extend(leaves(tail).into_iter().map(|path| (line, [base.clone(), path].concat())));
        }
    }
    found.sort();
    found
}

/// The code of a file without comments, literals and unit tests: tests may use what they like.
pub fn code_of(source: &str) -> String {
    let code = code_only(source);
    let tests = code.find("#[cfg(test)]\nmod tests {").unwrap_or(code.len());
    code[..tests].to_string()
}

/// What is wrong in one file of a room; `module` is its path from the crate's root.
fn violations(order: &[String], module: &[String], file: &str, source: &str) -> Vec<String> {
    let rank = |name: &str| order.iter().position(|m| m == name);
    let room = &module[0];
    let Some(own) = rank(room) else { return vec![format!("{file}: module {room} is not in lib.rs")] };
    imports(&code_of(source), module)
        .into_iter()
        .filter(|(_, path)| rank(&path[0]).is_some_and(|r| r > own))
        .map(|(line, path)| format!("{file}:{line}: {room} uses {}, which comes after it", path[0]))
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect()
}

pub fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        // Unit tests in files of their own may use what they like.
        if path.file_stem().is_some_and(|name| name == "tests") {
            continue;
        }
        if path.is_dir() {
            rust_files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

#[test]
fn no_module_imports_upward() {
    let root = source_root();
    let order = order_of(&fs::read_to_string(root.join("lib.rs")).unwrap());
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for path in &files {
        let relative = path.strip_prefix(&root).unwrap();
        let parts: Vec<String> =
            relative.with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect();
        if parts == ["lib"] || parts == ["main"] {
            continue;
        }
        let module = &parts[..parts.len() - usize::from(parts.last().unwrap() == "mod")];
        let source = fs::read_to_string(path).unwrap();
        seen +=
            imports(&code_of(&source), module).iter().filter(|(_, path)| order.contains(&path[0])).count();
        wrong.extend(violations(&order, module, &relative.display().to_string(), &source));
    }
    assert!(wrong.is_empty(), "upward imports:\n{}", wrong.join("\n"));
    // Were the reader of sources blind, it would find nothing wrong either.
    assert!(files.len() > 80 && seen > 150, "{} files, {seen} imports seen", files.len());
}

#[test]
fn lib_lists_every_module_from_errors_to_the_command_line() {
    let root = source_root();
    let order = order_of(&fs::read_to_string(root.join("lib.rs")).unwrap());
    assert_eq!(order[..2], ["error", "units"]);
    assert_eq!(order.last().unwrap(), "cli");
    for pair in [
        ("sequence", "sample"),
        ("scene", "transport"),
        ("tally", "estimate"),
        ("geometry", "surface"),
        ("run", "picture"),
        ("picture", "lab"),
        ("scene", "files"),
        ("files", "report"),
    ] {
        let rank = |name: &str| order.iter().position(|m| m == name).unwrap();
        assert!(rank(pair.0) < rank(pair.1), "{pair:?}");
    }
    for entry in fs::read_dir(&root).unwrap() {
        let name = entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned();
        assert!(["lib", "main"].contains(&name.as_str()) || order.contains(&name), "{name} is not in lib.rs");
    }
}

/// A source with every way to break the rule that the reader knows, and every way to look as if.
const FABRICATED: &str = r##"//! Compare [`crate::cli`].
use crate::math::frame;
use crate::{error::Kind, scene::{Scene, build}, units};
/* crate::report /* crate::image */ crate::tally */
fn text() -> &'static str { "crate::cli \" crate::cli" }
fn raw() -> &'static str { r#"crate::cli "crate::cli" "# }
fn quote<'a>(_: &'a str) -> char { '"' }
fn late() { crate::transport::walk::walk() }
fn climbed() { super::super::image::exr::write_maps() }
fn sideways() { super::report() }
fn own() { my_crate::cli::main() }
"##;

#[test]
fn a_fabricated_bad_source_is_seen_and_its_good_lines_are_not() {
    let order: Vec<String> =
        ["error", "units", "math", "sample", "scene", "transport", "tally", "image", "report", "cli"]
            .map(str::to_string)
            .into();
    let module = |path: &str| path.split("::").map(str::to_string).collect::<Vec<_>>();
    let found = violations(&order, &module("sample::bad"), "sample/bad.rs", FABRICATED);
    assert_eq!(
        found,
        [
            "sample/bad.rs:3: sample uses scene, which comes after it",
            "sample/bad.rs:8: sample uses transport, which comes after it",
            "sample/bad.rs:9: sample uses image, which comes after it",
        ]
    );
    assert!(violations(&order, &module("cli::bad"), "cli/bad.rs", FABRICATED).is_empty());
    assert_eq!(violations(&order, &module("new"), "new.rs", ""), ["new.rs: module new is not in lib.rs"]);
}
