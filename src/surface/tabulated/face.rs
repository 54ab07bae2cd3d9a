//! What a table does to light from either side of a surface.

use crate::scattering::{Quantity, ScatterTable};
use crate::surface::tabulated::layer::Layer;
use crate::surface::tabulated::{Options, Sides};

/// What happens to light from one side.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Face {
    /// Which layers reflect and transmit it.
    pub layers: [Option<usize>; 2],
    pub coloured: bool,
    /// Whether theta_i and phi_i matter.
    pub has_angles: bool,
    pub has_azimuths: bool,
    /// Where what the table leaves goes on to; `None` where it is absorbed.
    pub rest: Option<Quantity>,
}

/// Which layers serve which side.
pub(crate) fn faces(table: &ScatterTable, layers: &[Layer], options: &Options) -> [Face; 2] {
    let index = |quantity: Quantity, from_front: bool| {
        let lobe = table.lobe(quantity, from_front)?;
        table.lobes.iter().position(|other| std::ptr::eq(lobe, other))
    };
    let of_side = |from_front| [Quantity::Reflection, Quantity::Transmission].map(|q| index(q, from_front));
    let (mut front, mut back) = (of_side(true), of_side(false));
    match options.sides {
        Sides::Front => {}
        Sides::Back => std::mem::swap(&mut front, &mut back),
        Sides::Both if front == [None; 2] => front = back,
        Sides::Both if back == [None; 2] => back = front,
        Sides::Both => {}
    }
    [front, back].map(|indices: [Option<usize>; 2]| {
        let has = |test: fn(&Layer) -> bool| indices.into_iter().flatten().any(|k| test(&layers[k]));
        let rest = match indices {
            [None, None] => None,
            [_, Some(_)] => Some(Quantity::Transmission),
            [Some(_), None] => Some(Quantity::Reflection),
        };
        Face {
            layers: indices,
            coloured: has(|layer| layer.channels == 3),
            has_angles: has(Layer::has_angles),
            has_azimuths: has(Layer::has_azimuths),
            rest: rest.filter(|_| options.specular_remainder),
        }
    })
}
