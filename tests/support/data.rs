//! Files for tests: the project's own and, where CAUSTIX_TEST_DATA names a folder, real ones.

use std::path::{Path, PathBuf};

/// The project's folder.
pub fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The path of one of its files, for a command's line.
pub fn in_project(path: &str) -> String {
    project().join(path).display().to_string()
}

/// The folder of real files; `None` where CAUSTIX_TEST_DATA is not set. Either way a line says so, by which `.ci/run` counts the
/// tests that read real files and those that skipped: so all of them come here.
pub fn real_folder() -> Option<PathBuf> {
    match std::env::var_os("CAUSTIX_TEST_DATA") {
        Some(folder) => {
            println!("real files: read");
            Some(folder.into())
        }
        None => {
            println!("real files: skipped, CAUSTIX_TEST_DATA is not set");
            None
        }
    }
}

/// The photometric files of the project, in the order of their names.
pub fn own_files() -> Vec<PathBuf> {
    sorted_files(&project().join("ies"))
}

/// The path of one of them.
pub fn own_file(name: &str) -> PathBuf {
    project().join("ies").join(name)
}

/// The well-formed real photometric files, as `ies/expected.json` of the data folder judges them, in the order of their names;
/// `None` where there is no [`real_folder`].
pub fn real_files() -> Option<Vec<PathBuf>> {
    let folder = real_folder()?.join("ies");
    let expected: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("expected.json")).unwrap()).unwrap();
    let well_formed = |path: &PathBuf| {
        let name = path.strip_prefix(&folder).unwrap().to_str().unwrap();
        expected["files"][name]["verdict"].as_str().is_some_and(|v| v.starts_with("well formed"))
    };
    let folders = ["permissive", "copyleft", "no-licence"];
    Some(folders.iter().flat_map(|f| sorted_files(&folder.join(f))).filter(well_formed).collect())
}

fn sorted_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_ies = |p: &PathBuf| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("ies"));
    let mut files: Vec<PathBuf> = entries.filter(is_ies).collect();
    files.sort();
    files
}
