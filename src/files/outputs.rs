//! That no file which is written takes the place of another that the same command reads or writes.

use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};

/// Refuses an output that is an input, or that comes twice. Links count as what they lead to.
///
/// # Errors
/// [`Kind::Range`], with the path.
pub fn check_outputs(outputs: &[PathBuf], inputs: &[PathBuf]) -> Result<()> {
    let refused = |found: &str, path: &Path| {
        let required = "a name or a folder of its own for what is written";
        Err(Diagnostic::new(Kind::Range, format!("{found}, which this command would overwrite"), required)
            .hint("give another folder with -o, or another name")
            .in_file(path))
    };
    let mut read: Vec<PathBuf> = inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
    read.sort();
    for path in outputs {
        if path.canonicalize().is_ok_and(|led_to| read.binary_search(&led_to).is_ok()) {
            return refused("a file that this command reads", path);
        }
    }
    // Cases are not told apart: some file systems don't.
    let without_case = |path: PathBuf| match path.file_name().and_then(|name| name.to_str()) {
        Some(name) => path.with_file_name(name.to_uppercase()),
        None => path,
    };
    let mut written: Vec<(PathBuf, &PathBuf)> =
        outputs.iter().map(|path| (without_case(entry(path)), path)).collect();
    written.sort();
    match written.windows(2).find(|two| two[0].0 == two[1].0) {
        Some(two) => refused("another result of this command", two[1].1),
        None => Ok(()),
    }
}

/// The name in its folder, however the folder is named.
pub fn entry(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().or_else(|_| std::path::absolute(folder));
    match (folder, path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_path_buf(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn inputs_and_outputs_are_told_apart_by_where_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("out")).unwrap();
        std::fs::write(path("lamp.ies"), "").unwrap();
        let refused = |outputs: &[&str], inputs: &[&str]| {
            let all = |names: &[&str]| names.iter().map(|name| path(name)).collect::<Vec<_>>();
            check_outputs(&all(outputs), &all(inputs)).err().map(|e| e.found().to_string())
        };
        assert_eq!(refused(&["a.exr", "out/a.exr", "b.exr"], &["lamp.ies", "gone.ies"]), None);
        assert!(refused(&["a.exr", "out/../lamp.ies"], &["lamp.ies"]).unwrap().contains("reads"));
        for same in ["out/../out/a.exr", "out/A.EXR"] {
            assert!(refused(&["out/a.exr", same], &[]).unwrap().contains("another result"));
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(path("lamp.ies"), path("out/floor.png")).unwrap();
            assert!(refused(&["out/floor.png"], &["lamp.ies"]).is_some());
            assert!(refused(&["out/floor.png"], &["out/floor.png"]).is_some());
            std::os::unix::fs::symlink(path("out"), path("also")).unwrap();
            assert!(refused(&["out/a.exr", "also/a.exr"], &[]).is_some());
        }
    }
}
