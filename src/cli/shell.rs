//! `caustix completions SHELL` and `caustix man`, made from the arguments themselves.

use std::io;

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::error::{Diagnostic, Kind};

use super::{Command, Done, exit, print};

/// Arguments of `caustix completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    pub shell: Shell,
}

/// Runs `completions`; the exit code.
pub(super) fn completions(args: &CompletionsArgs) -> Done {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Command::command(), "caustix", &mut script);
    print(&String::from_utf8_lossy(&script));
    Ok(exit::DONE)
}

/// Runs `man`; the exit code.
pub(super) fn man() -> Done {
    let page =
        page().map_err(|e| Diagnostic::new(Kind::Io, format!("\"{e}\" while making the page"), "a page"))?;
    print(&page);
    Ok(exit::DONE)
}

/// One page of roff: the command, then a section for each subcommand.
fn page() -> io::Result<String> {
    let command = Command::command().disable_help_subcommand(true);
    let (mut page, whole) = (Vec::new(), Man::new(command.clone()));
    whole.render_title(&mut page)?;
    whole.render_name_section(&mut page)?;
    whole.render_synopsis_section(&mut page)?;
    whole.render_description_section(&mut page)?;
    whole.render_options_section(&mut page)?;
    let mut page = String::from_utf8_lossy(&page).into_owned();
    for sub in command.get_subcommands() {
        let name = format!("caustix {}", sub.get_name());
        let man = Man::new(sub.clone().bin_name(&name).disable_help_flag(true));
        let mut section = Vec::new();
        man.render_description_section(&mut section)?;
        man.render_synopsis_section(&mut section)?;
        man.render_options_section(&mut section)?;
        let section = String::from_utf8_lossy(&section).replace(".SH ", ".SS ");
        page += &format!(".SH \"{}\"\n{section}", name.to_uppercase());
    }
    let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    Ok(page + &format!(".SH EXAMPLES\n{after}\n"))
}
