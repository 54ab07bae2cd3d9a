//! A good scene in parts, and how a broken one is judged.

use caustix::error::{Diagnostic, Kind};
use caustix::files::bytes::Base;
use caustix::files::scene_toml::{SceneFile, parse};

/// Where an error is expected in a text of the tests.
pub const MARK: char = '«';

pub const LAMP: &str = "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 2]\nflux_lm = 100\n";
pub const BLACK: &str = "[material.black]\ntype = \"absorber\"\n";

pub const PLATE: &str = "[[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
                     corner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";

pub const RECEIVER: &str = "[[receiver]]\nsurface = \"plate\"\n";

pub fn read(text: &str) -> Result<SceneFile, Vec<Diagnostic>> {
    parse(text, "test.toml", Base::Directory(".".into()))
}

/// The text without its marks, and the line and column of each.
pub fn unmarked(text: &str) -> (String, Vec<(usize, usize)>) {
    let (mut plain, mut places) = (String::new(), Vec::new());
    let (mut line, mut column) = (1, 1);
    for c in text.chars() {
        if c == MARK {
            places.push((line, column));
            continue;
        }
        plain.push(c);
        column += 1;
        if c == '\n' {
            (line, column) = (line + 1, 1);
        }
    }
    (plain, places)
}

/// The scene has exactly one error, at its mark: (kind, found, required); returns it.
#[track_caller]
pub fn expect(text: &str, kind: Kind, found: &str, required: &str) -> Diagnostic {
    let (plain, places) = unmarked(text);
    let built = read(&plain).and_then(SceneFile::build);
    let errors = built.expect_err("the scene should be refused");
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert_eq!(places.len(), 1, "one mark");
    let error = errors[0].clone();
    assert_eq!((error.line(), error.column()), (Some(places[0].0), Some(places[0].1)), "{error}");
    assert_eq!(error.file(), Some("test.toml"));
    assert_eq!(error.kind(), kind, "{error}");
    assert_eq!(error.found(), found);
    assert_eq!(error.required(), required);
    error
}

/// A scene whose emitter is `body`.
pub fn emitter(body: &str) -> String {
    format!("{body}\n{BLACK}{PLATE}{RECEIVER}")
}

pub fn material(body: &str) -> String {
    format!("{LAMP}{body}\n{PLATE}{RECEIVER}")
}

pub fn surface(body: &str) -> String {
    format!("{LAMP}{BLACK}{PLATE}{RECEIVER}[[surface]]\nname = \"s\"\nmaterial = \"black\"\n{body}\n")
}

pub fn receiver(body: &str) -> String {
    format!("{LAMP}{BLACK}{PLATE}{body}\n")
}

pub const METRES: &str = "a number of metres from -1e9 to 1e9";
pub const LENGTH: &str = "a length from 1e-9 to 1e9 m";
