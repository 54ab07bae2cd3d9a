//! The text of a scene without its `[camera]`: what photons depend on. Two scenes that differ in their cameras alone have the
//! same, so photons that were kept serve both.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text without its `[camera]` table, in whichever of TOML's ways it is written: from the header to the next one, comments
/// between them included, or the lines of its keys. Blank lines at the end go, too, in every scene. A text that is no TOML stays
/// as it is.
pub fn without_camera(text: &str) -> String {
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Ok(root) = DeTable::parse(body) else { return text.to_string() };
    let mut kept = String::with_capacity(body.len());
    let mut from = 0;
    for range in camera_ranges(body, root.get_ref()) {
        kept += body.get(from..range.start).unwrap_or_default();
        from = range.end.max(from);
    }
    kept += body.get(from..).unwrap_or_default();
    let mut kept = kept.trim_end().to_string();
    kept.push('\n');
    kept
}

/// Whole lines, in the order of the text.
fn camera_ranges(text: &str, root: &DeTable<'_>) -> Vec<Range<usize>> {
    let Some((key, value)) = root.iter().find(|(key, _)| key.get_ref() == "camera") else {
        return Vec::new();
    };
    let line_start = |at: usize| text.get(..at).and_then(|t| t.rfind('\n')).map_or(0, |n| n + 1);
    let line_end = |at: usize| text.get(at..).and_then(|t| t.find('\n')).map_or(text.len(), |n| at + n + 1);
    let lines = |span: Range<usize>| line_start(span.start)..line_end(span.end.saturating_sub(1));
    let opening = |at: usize, c: char| text.get(at..).is_some_and(|t| t.starts_with(c));
    let span = value.span();
    if opening(span.start, '[') {
        let start = line_start(span.start);
        // The next thing of the scene that is not the camera's stands under a header of its own.
        let next = starts(root).into_iter().filter(|at| *at > span.start).min();
        let next = next.map_or(text.len(), line_start);
        return std::iter::once(start..next).collect();
    }
    if opening(span.start, '{') {
        return vec![lines(key.span().start..span.end)];
    }
    // camera.position = ..., camera.pixels = ...: a line or more for each key.
    let entries = value.get_ref().as_table().into_iter().flat_map(|table| table.iter());
    let mut ranges: Vec<_> = entries.map(|(key, value)| lines(key.span().start..value.span().end)).collect();
    ranges.sort_by_key(|range| range.start);
    ranges
}

/// Where the keys and tables of everything but the camera begin.
fn starts(root: &DeTable<'_>) -> Vec<usize> {
    let mut found = Vec::new();
    for (key, value) in root.iter().filter(|(key, _)| key.get_ref() != "camera") {
        found.push(key.span().start);
        collect(value, &mut found);
    }
    found
}

fn collect(value: &Spanned<DeValue<'_>>, found: &mut Vec<usize>) {
    found.push(value.span().start);
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table.iter() {
                found.push(key.span().start);
                collect(value, found);
            }
        }
        DeValue::Array(items) => items.iter().for_each(|item| collect(item, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEFORE: &str = "# a scene\n[[emitter]]\ntype = \"isotropic\"\n\n";
    const AFTER: &str =
        "[material.red]\ntype = \"lambertian\"\n\n[[emitter]]\nname = \"[camera]\"\n[run]\nseed = 1\n";
    const CAMERA: &str = "[camera]   # the picture\nposition = [1,\n  2, 3]\n# fov_deg = 3\nexposure = \"\"\"\n[run]\n\"\"\"\n\n";

    #[test]
    fn the_table_goes_with_its_comments_wherever_it_stands() {
        let bare = format!("{BEFORE}{AFTER}");
        assert_eq!(without_camera(&bare), bare);
        assert_eq!(without_camera(&format!("{BEFORE}{CAMERA}{AFTER}")), bare);
        let headless = bare.trim_start_matches("# a scene\n");
        assert_eq!(without_camera(&format!("{CAMERA}{headless}")), headless);
        assert_eq!(without_camera(&format!("{CAMERA}{bare}")), headless, "a comment before the next header");
        assert_eq!(without_camera(&format!("{bare}\n{CAMERA}")), bare);
        assert_eq!(without_camera(&format!("{bare}\n  [ camera ]\nfov_deg = 4")), bare);
        assert_eq!(without_camera(&format!("\u{feff}{bare}\n{CAMERA}")), bare);
        let crlf = |text: &str| text.replace('\n', "\r\n");
        let expected = format!("{}\n", crlf(&bare).trim_end());
        assert_eq!(without_camera(&crlf(&format!("{BEFORE}{CAMERA}{AFTER}"))), expected);
    }

    #[test]
    fn inline_and_dotted_tables_go_too() {
        let bare = format!("{BEFORE}{AFTER}");
        let inline = "camera = { fov_deg = 40, pixels = [4, 3] } # small\n";
        assert_eq!(without_camera(&format!("{inline}{bare}")), bare);
        let dotted = "camera.fov_deg = 40\n# of the scene\ncamera.pixels = [\n  4, # wide\n  3]\n";
        assert_eq!(without_camera(&format!("{dotted}{bare}")), format!("# of the scene\n{bare}"));
    }

    #[test]
    fn another_camera_leaves_the_same_and_another_scene_does_not() {
        let with = |camera: &str, seed: u32| {
            without_camera(&format!("{BEFORE}[camera]\n{camera}\n{AFTER}[x]\ny = {seed}\n"))
        };
        assert_eq!(with("fov_deg = 40", 1), with("fov_deg = 50 # wide\nsamples = 4\n\n# end", 1));
        assert_ne!(with("fov_deg = 40", 1), with("fov_deg = 40", 2));
        // What is no TOML is not touched.
        assert_eq!(without_camera("[camera\nx"), "[camera\nx");
    }
}
