//! Inputs that `examples/fuzz` found a fault with, each as small as it could be made: what is said of them now.

use std::path::Path;

use caustix::files::obj::{ObjOptions, parse_obj};
use caustix::files::scene_toml::count::parse_count;

/// Words of a file stood in messages as they were: control characters move a terminal's cursor and change its colours.
#[test]
fn control_characters_of_a_file_are_escaped() {
    let obj = |text: &str| {
        parse_obj(text.as_bytes(), Path::new("a.obj"), &ObjOptions::default()).unwrap_err().to_string()
    };
    assert_eq!(obj("v 0 0 \u{10}"), "a.obj:1:7: found \"\\u{10}\"; required: a number");
    assert_eq!(obj("v 0 0 \u{1b}[31m"), "a.obj:1:7: found \"\\u{1b}[31m\"; required: a number");
    assert_eq!(
        obj("v 0 0 0\nf 1/\u{7f}/ 1 1"),
        "a.obj:2:3: found \"1/\\u{7f}/\"; required: a whole number for the texture coordinate"
    );
    assert_eq!(
        parse_count("\0").unwrap_err().to_string(),
        "found `\\0`; required: a whole number from 1 to 2^48, written like 4_456_448, 4.5e6 or 2^22"
    );
}
