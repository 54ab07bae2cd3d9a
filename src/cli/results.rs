//! The folder of a command's results: taken for one run, told of.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::error::words::{NAMED, names};
use crate::files::folder::Folder;
use crate::files::set::Written;
use crate::scene::Scene;

use super::say;

/// What the folder of a run is for.
const FOR_RESULTS: &str = "a directory for the results";

/// Takes the folder for this run, and says what was found in it.
///
/// # Errors
/// A folder that cannot be made or written to, or that another run has.
pub fn take(path: &Path) -> Result<Folder> {
    let folder = Folder::take(path, FOR_RESULTS)?;
    folder.remarks().iter().for_each(|remark| say(&format!("caustix: {remark}")));
    Ok(folder)
}

/// Files that a scene was read from: its own and those that it names.
pub fn inputs(scene_file: Option<&Path>, scene: &Scene) -> Vec<PathBuf> {
    let Some(path) = scene_file else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    let named = scene.identity.files.iter().map(|(name, _)| folder.join(name));
    std::iter::once(path.to_path_buf()).chain(named).collect()
}

/// Says what could not be written, and what lies in the folder besides. For the end of a run, before its summary.
pub fn tell(folder: &Folder, written: &Written, inputs: &[PathBuf]) {
    for error in &written.errors {
        say(&format!("error: {error}"));
    }
    let asked = folder.path().display();
    if written.keeps_older {
        let rest = match is_written(folder, written) {
            true => format!("what could be written is in {}", written.directory.display()),
            false => "nothing else could be written".to_string(),
        };
        say(&format!("caustix: the older results in {asked} are left as they were; {rest}"));
        return;
    }
    let ours: BTreeSet<String> = written.files.sha256.keys().cloned().collect();
    let others = folder.others(&ours, inputs);
    if !others.is_empty() {
        let files = if others.len() == 1 { "a file" } else { "files" };
        say(&format!(
            "caustix: {asked} also holds {files} that this run did not write: {}",
            names(&others, NAMED)
        ));
    }
}

/// Where results went, for the last line of a summary.
pub fn written_to(folder: &Folder, written: &Written) -> String {
    let directory = written.directory.display();
    match (is_written(folder, written), written.errors.is_empty()) {
        (false, _) => format!("nothing written to {directory}\n"),
        (true, true) => format!("written to {directory}\n"),
        (true, false) => format!("written to {directory}, but for what is told above\n"),
    }
}

fn is_written(folder: &Folder, written: &Written) -> bool {
    !written.keeps_older || written.directory != folder.path()
}
