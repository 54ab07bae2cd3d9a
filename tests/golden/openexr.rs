//! Hashes of an EXR: every channel's sample type, size and values, every attribute.

use std::path::Path;

use exr::prelude::{
    AttributeValue, FlatSamples, ImageAttributes, LayerAttributes, ReadChannels as _, ReadLayers as _, read,
};

use crate::book::Parts;
use crate::content::{hash, told};

/// What differs between versions and between copies of a scene that are one scene.
const LEFT_OUT: [&str; 2] = ["caustix.version", "caustix.scene.sha256"];

/// The parts of the file.
pub fn parts(path: &Path) -> Parts {
    let image = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = image.from_file(path).unwrap();
    let mut parts = Parts::new();
    let several = image.layer_data.len() > 1;
    let others = image.attributes.other.clone();
    // A map has no order: its entries are parts of their own.
    let own = ImageAttributes { other: Default::default(), ..image.attributes };
    parts.push(("format".into(), hash(format!("{own:?}").as_bytes())));
    attributes(&mut parts, "", others);
    for (i, layer) in image.layer_data.iter().enumerate() {
        let prefix = if several { format!("layer{i} ") } else { String::new() };
        let own = LayerAttributes { other: Default::default(), ..layer.attributes.clone() };
        let text = format!("{own:?} {:?} {:?}", layer.size, layer.encoding);
        parts.push((format!("{prefix}layout"), hash(text.as_bytes())));
        attributes(&mut parts, &prefix, layer.attributes.other.clone());
        for channel in &layer.channel_data.list {
            let mut bytes =
                format!("{:?} {:?} {:?} ", layer.size, channel.sampling, channel.quantize_linearly);
            let values: Vec<u8> = match &channel.sample_data {
                FlatSamples::F16(values) => values.iter().flat_map(|v| v.to_bits().to_le_bytes()).collect(),
                FlatSamples::F32(values) => values.iter().flat_map(|v| v.to_bits().to_le_bytes()).collect(),
                FlatSamples::U32(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            };
            let kind = match &channel.sample_data {
                FlatSamples::F16(_) => "f16",
                FlatSamples::F32(_) => "f32",
                FlatSamples::U32(_) => "u32",
            };
            bytes += kind;
            let hashed = hash(&[bytes.as_bytes(), &values].concat());
            parts.push((format!("{prefix}channel:{}", utf8(channel.name.as_slice())), hashed));
        }
    }
    parts
}

fn attributes(
    parts: &mut Parts,
    prefix: &str,
    all: impl IntoIterator<Item = (exr::prelude::Text, AttributeValue)>,
) {
    for (name, value) in all {
        let name = utf8(name.as_slice());
        if LEFT_OUT.contains(&name.as_str()) {
            continue;
        }
        let text = match value {
            // The hash of a file that the scene names, two blanks, the file.
            AttributeValue::Text(text) if name.starts_with("caustix.scene.file") => {
                let text = utf8(text.as_slice());
                text.split_once("  ").map_or(text.clone(), |(_, file)| file.to_string())
            }
            AttributeValue::Text(text) => utf8(text.as_slice()),
            // The shortest digits that read back as the same bits.
            AttributeValue::F64(number) => format!("{number:?}f64"),
            AttributeValue::F32(number) => format!("{number:?}f32"),
            other => format!("{other:?}"),
        };
        let name = name.strip_prefix("caustix.").map_or(name.clone(), |own| format!("@{own}"));
        parts.push((format!("{prefix}{name}"), told(&text)));
    }
}

fn utf8(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}
