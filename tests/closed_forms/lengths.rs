//! A scene in another unit of length, and one moved: the text of a scene file with its lengths changed.

use std::path::Path;

use caustix::files::bytes::Base;
use caustix::files::scene_toml::parse;
use caustix::scene::Scene;
use toml::{Table, Value};

use crate::support::data::project;

/// A scene file as TOML values.
pub fn table(path: &Path) -> Table {
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

/// The scene of such values; paths are relative to `scenes/`.
pub fn scene(table: &Table) -> Scene {
    let text = toml::to_string(table).unwrap();
    let file = parse(&text, "test.toml", Base::Directory(project().join("scenes")));
    file.and_then(|file| file.build()).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// Applies `change` to a number, or to all numbers of a list.
fn change(value: &mut Value, with: &dyn Fn(usize, f64) -> f64, at: usize) {
    match value {
        Value::Integer(i) => *value = Value::Float(with(at, *i as f64)),
        Value::Float(x) => *x = with(at, *x),
        Value::Array(items) => items.iter_mut().enumerate().for_each(|(i, item)| change(item, with, i)),
        other => panic!("{other} is no length"),
    }
}

fn times(table: &mut Table, keys: &[&str], s: f64) {
    for key in keys {
        if let Some(value) = table.get_mut(*key) {
            change(value, &|_, x| x * s, 0);
        }
    }
}

fn parts<'t>(scene: &'t mut Table, key: &str) -> impl Iterator<Item = &'t mut Table> {
    let list = scene.get_mut(key).and_then(Value::as_array_mut).map(|list| list.as_mut_slice());
    list.unwrap_or_default().iter_mut().map(|part| part.as_table_mut().unwrap())
}

/// The scene with every length times `s`, its camera's included, and luminances to match.
pub fn scaled(mut scene: Table, s: f64) -> Table {
    parts(&mut scene, "emitter").for_each(|e| times(e, &["position", "radius", "size"], s));
    for surface in parts(&mut scene, "surface") {
        let lengths = [
            "translate",
            "corner",
            "edge_u",
            "edge_v",
            "min",
            "max",
            "center",
            "radius",
            "vertex",
            "focal_length",
        ];
        times(surface, &lengths, s);
        times(surface, &["origin", "size", "height"], s);
        if surface["type"].as_str() == Some("mesh") {
            surface.entry("scale").or_insert(Value::Float(1.0));
            times(surface, &["scale"], s);
        }
        parts(surface, "waves").for_each(|w| times(w, &["amplitude", "wavelength"], s));
        if let Some(noise) = surface.get_mut("noise").and_then(Value::as_table_mut) {
            times(noise, &["amplitude"], s);
            parts(noise, "octaves").for_each(|o| times(o, &["wavelength"], s));
        }
    }
    if let Some(camera) = scene.get_mut("camera").and_then(Value::as_table_mut) {
        times(camera, &["position", "look_at", "lens_radius", "focus", "radius", "progressive_radius"], s);
        // The same flux gives luminances of the inverse square.
        times(camera, &["background", "exposure"], 1.0 / (s * s));
    }
    scene
}

/// The scene with its emitters and surfaces moved.
pub fn shifted(mut scene: Table, by: [f64; 3]) -> Table {
    let zero = || Value::Array(vec![Value::Float(0.0); 3]);
    for (key, place) in [("emitter", "position"), ("surface", "translate")] {
        for part in parts(&mut scene, key) {
            change(part.entry(place).or_insert_with(zero), &|i, x| x + by[i], 0);
        }
    }
    scene
}
