//! OpenEXR files as tests read them: the first layer, f32 and u32 channels, text and numbers of its attributes.
#![allow(dead_code, clippy::unwrap_used, missing_docs)]

use std::collections::BTreeMap;
use std::path::Path;

use exr::prelude::{AttributeValue, FlatSamples, ReadChannels as _, ReadLayers as _, read};

/// Values of a channel.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    F32(Vec<f32>),
    U32(Vec<u32>),
}

/// An attribute's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    Text(String),
    Number(f64),
}

/// What is in a file; channels and attributes by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    pub width: usize,
    pub height: usize,
    pub channels: Vec<(String, Samples)>,
    pub attributes: BTreeMap<String, Attribute>,
}

pub fn read_maps(path: impl AsRef<Path>) -> exr::error::Result<Maps> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)?;
    let layer = image.layer_data;
    let channels = layer.channel_data.list.into_iter().map(|channel| {
        let samples = match channel.sample_data {
            FlatSamples::F32(values) => Samples::F32(values),
            FlatSamples::U32(values) => Samples::U32(values),
            FlatSamples::F16(values) => Samples::F32(values.iter().map(|v| v.to_f32()).collect()),
        };
        (text(channel.name.as_slice()), samples)
    });
    let others = image.attributes.other.into_iter().chain(layer.attributes.other);
    let attributes = others.filter_map(|(name, value)| {
        let value = match value {
            AttributeValue::Text(t) => Attribute::Text(text(t.as_slice())),
            AttributeValue::F64(number) => Attribute::Number(number),
            AttributeValue::F32(number) => Attribute::Number(f64::from(number)),
            AttributeValue::I32(number) => Attribute::Number(f64::from(number)),
            _ => return None,
        };
        Some((text(name.as_slice()), value))
    });
    Ok(Maps {
        width: layer.size.width(),
        height: layer.size.height(),
        channels: channels.collect(),
        attributes: attributes.collect(),
    })
}
