//! What is said of command lines that cannot be read: what to type instead.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::error::{Diagnostic, Kind};
use crate::files::kinds::{FileKind, kind_of};
use crate::report::numbers::printable;

use super::Command;

/// Adds to an argument that is not known what there is instead.
pub(super) fn with_tip(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidArg) else { return error };
    let is_unknown = error.kind() == ErrorKind::UnknownArgument;
    let tip = match with_option(found) {
        _ if !is_unknown || error.get(ContextKind::SuggestedArg).is_some() => return error,
        Some(command) if found.starts_with('-') => format!("`caustix {command}` has {found}"),
        None if found.starts_with('-') => "`--help` lists the options".to_string(),
        _ if Path::new(found).exists() => "one file is read at a time".to_string(),
        _ => "names and numbers with spaces stand in quotes, and long options have two dashes".to_string(),
    };
    error.remove(ContextKind::SuggestedArg);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// The subcommand that has this option.
fn with_option(option: &str) -> Option<String> {
    let command = Command::command();
    let has = |sub: &&clap::Command| sub.get_arguments().any(|a| a.get_long() == option.strip_prefix("--"));
    command.get_subcommands().find(has).map(|sub| sub.get_name().to_string())
}

/// What is to be said of a file or a folder that stands where a subcommand should.
pub(super) fn of_file(error: &clap::Error) -> Option<Diagnostic> {
    let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let path = Path::new(name);
    if path.is_dir() {
        return Some(a_folder(path, "a command and a file"));
    }
    let required = "a command before the file";
    let Some(head) = head(path) else {
        let is_file_name = path.extension().is_some() || name.contains('/');
        let found = "no command, and no file of this name";
        return is_file_name.then(|| Diagnostic::new(Kind::Io, found, required).in_file(path));
    };
    let shown = typed(name);
    let (what, advice) = match kind_of(&head) {
        Some(kind) => (kind.what, advice(kind, &shown)),
        None => {
            ("a file of no kind that is known", format!("a scene is rendered by `caustix render {shown}`"))
        }
    };
    Some(Diagnostic::new(Kind::Unknown, what, required).hint(advice).in_file(path))
}

fn advice(kind: FileKind, shown: &str) -> String {
    kind.command(shown).map_or_else(|| kind.advice(shown), |command| format!("type `{command}`"))
}

/// That a folder is no file, and which scenes are in it.
pub(super) fn a_folder(path: &Path, required: &str) -> Diagnostic {
    let entries = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut scenes: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    scenes.sort();
    let error = Diagnostic::new(Kind::Io, "a folder", required).in_file(path);
    let Some(first) = scenes.first() else { return error.hint("there is no scene (.toml) in it") };
    let more = match scenes.len() {
        1 => "the scene in it".to_string(),
        many => format!("the first of {many} scenes in it"),
    };
    error.hint(format!("`caustix render {}` renders {more}", typed(&first.display().to_string())))
}

/// The first bytes of a file; none where it is not there, or no file.
fn head(path: &Path) -> Option<Vec<u8>> {
    const MOST: u64 = 64 << 10;
    // The kind is asked before opening: opening a pipe waits for its other end.
    if !fs::metadata(path).is_ok_and(|metadata| metadata.is_file()) {
        return None;
    }
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(MOST).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// A name as it is typed in a shell.
fn typed(name: &str) -> String {
    let name = printable(name);
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,:^=+\\".contains(c);
    if name.chars().all(is_plain) { name } else { format!("'{name}'") }
}
