//! Inside a room, files form no circle: whatever a file uses of its neighbours does not, by any way, use the file.
//!
//! A folder's own `mod.rs` is its contract: it may list what stands in its files, and they may use the types it defines, so
//! edges from and to it do not count. A name that it re-exports counts as the file that the name comes from.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::layering::{code_of, imports, rust_files, source_root};

/// Which neighbours each file or subfolder of a folder uses.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// The folder's place below src/ as a module path.
fn module_of(folder: &Path) -> Vec<String> {
    let below = folder.strip_prefix(source_root()).unwrap();
    below.iter().map(|part| part.to_string_lossy().into_owned()).collect()
}

/// Names that a folder's mod.rs re-exports from its files: name to file.
fn re_exports(code: &str, children: &BTreeSet<String>) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for statement in code.split(';').filter_map(|s| s.trim().split_once("use ")) {
        let path = format!("crate::{}", statement.1.trim_start_matches("self::"));
        for (_, path) in imports(&path, &[]) {
            if let [child, .., name] = path.as_slice()
                && children.contains(child)
            {
                found.insert(name.clone(), child.clone());
            }
        }
    }
    found
}

fn uses_in(folder: &Path) -> Uses {
    let module = module_of(folder);
    let mut files = Vec::new();
    rust_files(folder, &mut files);
    let child_of = |path: &Path| {
        let first = path.strip_prefix(folder).unwrap().iter().next().unwrap().to_string_lossy().into_owned();
        first.trim_end_matches(".rs").to_string()
    };
    let children: BTreeSet<String> = files.iter().map(|f| child_of(f)).filter(|c| c != "mod").collect();
    let contract = fs::read_to_string(folder.join("mod.rs")).map(|s| code_of(&s)).unwrap_or_default();
    let names = re_exports(&contract, &children);
    let mut uses = Uses::new();
    for file in files.iter().filter(|f| child_of(f) != "mod") {
        let own = child_of(file);
        let parts = module_of(&file.with_extension(""));
        let own_module = &parts[..parts.len() - usize::from(parts.last().unwrap() == "mod")];
        for (_, path) in imports(&code_of(&fs::read_to_string(file).unwrap()), own_module) {
            let Some(next) = path.strip_prefix(module.as_slice()).and_then(|rest| rest.first()) else {
                continue;
            };
            let target = names.get(next).unwrap_or(next);
            if children.contains(target) && *target != own {
                uses.entry(own.clone()).or_default().insert(target.clone());
            }
        }
    }
    uses
}

/// Everything that a file uses by any way.
fn reached(uses: &Uses, from: &str) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from.to_string()];
    while let Some(at) = open.pop() {
        for next in uses.get(&at).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

/// The files of each circle, in the order of their names.
fn circles(uses: &Uses) -> BTreeSet<Vec<String>> {
    let reach: BTreeMap<&String, BTreeSet<String>> = uses.keys().map(|k| (k, reached(uses, k))).collect();
    let back = |a: &String, b: &String| reach.get(b).is_some_and(|r| r.contains(a));
    reach
        .iter()
        .filter(|(file, r)| r.contains(**file))
        .map(|(file, r)| r.iter().filter(|other| back(file, other)).cloned().collect())
        .collect()
}

fn folders(root: &Path, into: &mut Vec<std::path::PathBuf>) {
    for entry in fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            into.push(path.clone());
            folders(&path, into);
        }
    }
}

#[test]
fn files_of_a_room_form_no_circle() {
    let mut rooms = Vec::new();
    folders(&source_root(), &mut rooms);
    rooms.sort();
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for room in &rooms {
        let uses = uses_in(room);
        seen += uses.values().map(BTreeSet::len).sum::<usize>();
        let place = module_of(room).join("/");
        wrong.extend(circles(&uses).into_iter().map(|files| format!("{place}: {}", files.join(", "))));
    }
    assert!(wrong.is_empty(), "circles:\n{}", wrong.join("\n"));
    assert!(rooms.len() > 20 && seen > 100, "{} rooms, {seen} uses seen", rooms.len());
}

#[test]
fn a_circle_of_three_is_found_and_a_chain_is_not() {
    let graph = |edges: &[(&str, &str)]| {
        let mut uses = Uses::new();
        for (from, to) in edges {
            uses.entry((*from).to_string()).or_default().insert((*to).to_string());
        }
        uses
    };
    assert!(circles(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    let found = circles(&graph(&[("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")]));
    assert_eq!(found.into_iter().collect::<Vec<_>>(), [["a", "b", "c"]]);
}
