//! Completions and the manual page have every option that `--help` has.

use crate::support::stranger::Stranger;

const COMMANDS: [&str; 9] =
    ["render", "photometry", "check", "compare", "sweep", "sample", "bsdf", "completions", "man"];

/// The long options that the help of a subcommand lists.
fn options(s: &Stranger, command: &str) -> Vec<String> {
    let (code, help, _) = s.types(&format!("{command} --help"));
    assert_eq!(code, 0);
    let is_of_a_name = |c: char| c.is_ascii_lowercase() || c == '-';
    let listed = help.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
    let long = listed.filter_map(|line| line.split("--").nth(1));
    long.map(|name| name.chars().take_while(|c| is_of_a_name(*c)).collect()).collect()
}

#[test]
fn every_option_of_help_can_be_completed() {
    let s = Stranger::new();
    let all: Vec<String> = COMMANDS.iter().flat_map(|command| options(&s, command)).collect();
    assert!(all.len() > 40 && all.contains(&"save-map".to_string()), "{all:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (code, script, err) = s.types(&format!("completions {shell}"));
        assert_eq!((code, err.as_str()), (0, ""), "{shell}");
        for option in &all {
            let spelt = if shell == "fish" { format!("-l {option}") } else { format!("--{option}") };
            assert!(script.contains(&spelt), "{shell}: no {spelt}");
        }
        for command in COMMANDS {
            assert!(script.contains(command), "{shell}: no {command}");
        }
    }
    s.is_told("completions csh", 2, &["invalid value 'csh'", "bash, elvish, fish, powershell, zsh"]);
}

#[test]
fn the_manual_page_has_every_command_and_option() {
    let s = Stranger::new();
    let (code, page, err) = s.types("man");
    assert_eq!((code, err.as_str()), (0, ""));
    // Roff writes a hyphen that is one as \-.
    let plain = page.replace("\\-", "-");
    assert!(plain.contains(".TH caustix 1"), "{}", &plain[..200]);
    for command in COMMANDS {
        let title = format!(".SH \"CAUSTIX {}\"", command.to_uppercase());
        let (_, section) = plain.split_once(&title).unwrap_or_else(|| panic!("no {title}"));
        // The synopsis lists them, too; here each is explained.
        let section = section.split("\n.SH ").next().unwrap();
        let explained = section.split_once(".SS OPTIONS").map_or("", |(_, options)| options);
        for option in options(&s, command).iter().filter(|option| *option != "help") {
            assert!(explained.contains(&format!("--{option}")), "{command}: no --{option}\n{section}");
        }
    }
}
