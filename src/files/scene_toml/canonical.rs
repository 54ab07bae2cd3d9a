//! A scene's text without what light does not depend on: comments, layout, the order of keys, ways of writing a number, and a
//! table such as the camera. Two texts that differ in these alone have the same form, so photons that were kept serve both.

use std::collections::BTreeMap;

use toml::de::{DeTable, DeValue};

/// Gives the hash of the content of the file of this name.
type HashOf<'h> = &'h dyn Fn(&str) -> Option<String>;

/// The values of a TOML text but for one table, keys sorted. A file, named by `file` or `image`, stands for its content, of which
/// `hash_of` gives the hash. A text that is no TOML stays as it is.
pub(crate) fn canonical(text: &str, without: &str, hash_of: HashOf<'_>) -> String {
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    match DeTable::parse(body) {
        Ok(root) => of_table(root.get_ref(), without, hash_of),
        Err(_) => text.to_string(),
    }
}

fn of_table(table: &DeTable<'_>, without: &str, hash_of: HashOf<'_>) -> String {
    let mut entries: BTreeMap<_, _> =
        table.iter().map(|(key, value)| (key.get_ref().as_ref(), value.get_ref())).collect();
    entries.remove(without);
    let form = |(key, value): (&str, &DeValue<'_>)| {
        let file = value.as_str().filter(|_| ["file", "image"].contains(&key));
        let form = file.and_then(hash_of).unwrap_or_else(|| of_value(value, hash_of));
        format!("{key:?}={form};")
    };
    format!("{{{}}}", entries.into_iter().map(form).collect::<String>())
}

fn of_value(value: &DeValue<'_>, hash_of: HashOf<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Integer(integer) => match i128::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) => number.to_string(),
            Err(_) => integer.as_str().to_string(),
        },
        DeValue::Float(float) => match float.as_str().parse::<f64>() {
            // Whole numbers look like integers, others as the shortest decimal that is read as the same bits.
            Ok(number) => number.to_string(),
            Err(_) => float.as_str().to_string(),
        },
        DeValue::Array(items) => {
            let items: String = items.iter().map(|item| of_value(item.get_ref(), hash_of) + ",").collect();
            format!("[{items}]")
        }
        DeValue::Table(table) => of_table(table, "", hash_of),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[[emitter]]\ntype = \"photometric\"\nfile = \"a.ies\"\nposition = [1, 2.5, 0]\n\
                         [material.red]\nreflectance = 0.5\n[run]\nseed = 18446744073709551615\n";
    const CAMERA: &str = "[camera]   # the picture\nposition = [1,\n  2, 3]\n# fov_deg = 3\nexposure = \"\"\"\n[run]\n\"\"\"\n\n";

    fn form(text: &str) -> String {
        canonical(text, "camera", &|name| (name == "a.ies").then(|| "HASH".to_owned()))
    }

    #[test]
    fn comments_layout_order_numbers_and_the_camera_make_no_difference() {
        for same in [
            format!("\u{feff}# a scene\n\n{}", SCENE.replace('\n', "  # why\r\n\r\n")),
            format!("{SCENE}{CAMERA}"),
            format!("{CAMERA}{SCENE}"),
            format!("camera = {{ fov_deg = 40, pixels = [4, 3] }}\n{SCENE}"),
            format!("camera.fov_deg = 40\n{SCENE}"),
            SCENE.replace("2.5", "0.25e1").replace("[1,", "[1.0,").replace(" 0]", " 0x0]"),
            SCENE.replace(
                "type = \"photometric\"\nfile = \"a.ies\"",
                "file = \"a.ies\"\ntype = 'photometric'",
            ),
            "[run]\nseed = 18446744073709551615\n".to_owned() + SCENE.split("[run]").next().unwrap(),
            SCENE.replace("[material.red]\n", "[material]\nred."),
        ] {
            assert_eq!(form(&same), form(SCENE), "{same}");
        }
        assert!(form(SCENE).contains("HASH") && !form(SCENE).contains("a.ies"));
    }

    #[test]
    fn every_other_value_makes_a_difference() {
        for other in [
            SCENE.replace("2.5", "2.5000000000000004"),
            SCENE.replace("615", "614"),
            SCENE.replace("0]", "-0.0]"),
            SCENE.replace("[1, 2.5", "[2.5, 1"),
            SCENE.replace("a.ies", "b.ies"),
            SCENE.replace("red", "blue"),
            SCENE.replace("photometric", "isotropic"),
            SCENE.replace("0.5", "\"0.5\""),
            SCENE.replace("reflectance = 0.5", "reflectance = 0.5\ncamera = 1"),
            SCENE.replace("seed", "photons"),
            SCENE.replace("file =", "lamp_set = 2\nfile ="),
            SCENE.replace("file =", "tilt_deg = 2\nfile ="),
        ] {
            assert_ne!(form(&other), form(SCENE), "{other}");
        }
        let other_content = canonical(SCENE, "camera", &|_| Some("OTHER".to_owned()));
        assert_ne!(other_content, form(SCENE));
        assert_eq!(
            canonical("[camera\nx", "camera", &|_| None),
            "[camera\nx",
            "what is no TOML is not touched"
        );
    }
}
