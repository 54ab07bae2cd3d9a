//! One kept photon, packed.

use std::io::{self, Read, Write};

use glam::DVec3;

use crate::math::varint::damaged;

/// A photon that arrived: 24 bytes and 4 a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Photon<const C: usize> {
    /// Position in the [`Frame`]'s steps.
    pub cell: [u32; 3],
    /// The way it travelled: octahedral, 16 bits each.
    pub direction: u32,
    /// The primitive it arrived on, counted through all surfaces.
    pub primitive: u32,
    /// Replicate (low 16 bits) and the two flags.
    pub tag: u32,
    /// Its weight by channel: luminance 1.
    pub weight: [f32; C],
}

impl<const C: usize> Photon<C> {
    /// Bytes of a photon that is written.
    pub const BYTES: usize = 24 + 4 * C;

    /// Its bytes, little endian: cell, direction, primitive, tag, weights.
    pub fn bytes(&self) -> impl Iterator<Item = u8> + use<C> {
        let [x, y, z] = self.cell;
        let words = [x, y, z, self.direction, self.primitive, self.tag].into_iter();
        words.chain(self.weight.map(f32::to_bits)).flat_map(u32::to_le_bytes)
    }

    /// Writes photons.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_all(photons: &[Self], out: &mut dyn Write) -> io::Result<()> {
        let mut some = photons.chunks(1 << 12);
        some.try_for_each(|some| out.write_all(&some.iter().flat_map(Self::bytes).collect::<Vec<u8>>()))
    }

    /// Reads a photon on one of so many primitives.
    ///
    /// # Errors
    /// Those of the reader; a photon on another primitive.
    pub fn read(from: &mut dyn Read, primitives: usize) -> io::Result<Self> {
        let mut bytes = [0; Photon::<3>::BYTES];
        let bytes = &mut bytes[..Self::BYTES];
        from.read_exact(bytes)?;
        let photon = Self::from_bytes(bytes);
        if photon.primitive as usize >= primitives {
            return Err(damaged("a photon on a surface that is not there"));
        }
        Ok(photon)
    }

    /// The photon of so many bytes; nonsense of another number of them.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        let mut words = bytes.as_chunks::<4>().0.iter().map(|w| u32::from_le_bytes(*w));
        let mut next = || words.next().unwrap_or_default();
        Self {
            cell: [next(), next(), next()],
            direction: next(),
            primitive: next(),
            tag: next(),
            weight: std::array::from_fn(|_| f32::from_bits(next())),
        }
    }
}

/// It arrived on the side the outward normal points to.
pub const FRONT: u32 = 1 << 16;
/// It met a diffuse surface before this one; without the flag only specular ones, which makes a caustic. (Direct light is not
/// kept.)
pub const SCATTERED: u32 = 1 << 17;

/// Positions as integers: 2^32 positions an axis over the bounds of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    low: DVec3,
    step: DVec3,
}

impl Frame {
    /// Of a box.
    pub fn new(low: DVec3, high: DVec3) -> Self {
        Self { low, step: (high - low) / 4_294_967_295.0 }
    }

    /// The integers of a position in the box.
    #[inline]
    pub fn cell(&self, position: DVec3) -> [u32; 3] {
        let of = |p: f64, low: f64, step: f64| if step > 0.0 { ((p - low) / step + 0.5) as u32 } else { 0 };
        [
            of(position.x, self.low.x, self.step.x),
            of(position.y, self.low.y, self.step.y),
            of(position.z, self.low.z, self.step.z),
        ]
    }

    /// Length of a step along each axis, m.
    #[inline]
    pub fn steps_m(&self) -> DVec3 {
        self.step
    }

    /// The position of the integers 0, m.
    pub fn low(&self) -> DVec3 {
        self.low
    }

    /// The frame of these numbers, as [`Frame::low`] and [`Frame::steps_m`] give them.
    pub fn from_steps(low: DVec3, step: DVec3) -> Self {
        Self { low, step }
    }

    /// The position of integers.
    #[inline]
    pub fn position(&self, cell: [u32; 3]) -> DVec3 {
        self.low + self.step * DVec3::new(f64::from(cell[0]), f64::from(cell[1]), f64::from(cell[2]))
    }

    /// Least and greatest integers that a position within `radius_m` of `centre` can have.
    #[inline]
    pub(crate) fn cells_about(&self, centre: DVec3, radius_m: f64) -> ([u32; 3], [u32; 3]) {
        let (centre, low, step) = (centre.to_array(), self.low.to_array(), self.step.to_array());
        // A step more on either side than the ball needs covers rounding. The conversion saturates.
        let of = |k: usize, offset: f64, room: f64, without: u32| {
            if step[k] > 0.0 { ((centre[k] - low[k] + offset) / step[k] + room) as u32 } else { without }
        };
        (
            std::array::from_fn(|k| of(k, -radius_m, -2.0, 0)),
            std::array::from_fn(|k| of(k, radius_m, 2.0, u32::MAX)),
        )
    }

    /// Upper bound on the distance from `point` to any position of the frame, m.
    pub(crate) fn farthest_m(&self, point: DVec3) -> f64 {
        let high = self.position([u32::MAX; 3]);
        (point - self.low).abs().max((point - high).abs()).length() * (1.0 + 1e-12)
    }
}

impl<const C: usize> Photon<C> {
    /// Which replicate it belongs to.
    #[inline]
    pub fn replicate(&self) -> usize {
        (self.tag & 0xffff) as usize
    }

    /// Whether it arrived on the side the outward normal points to.
    #[inline]
    pub fn is_front(&self) -> bool {
        self.tag & FRONT != 0
    }

    /// Whether it was scattered before.
    #[inline]
    pub fn is_scattered(&self) -> bool {
        self.tag & SCATTERED != 0
    }

    /// The way it travelled, unit.
    #[inline]
    pub fn direction(&self) -> DVec3 {
        unpack(self.direction)
    }
}

/// A unit vector in 32 bits: octahedral map (Meyer et al., On Floating-Point Normal Vectors, EGSR 2010), 16
/// bits each; off by at most 6.474e-5 rad. On the octahedron |x| + |y| + |z| = 1 rounding moves a point by up
/// to (d, d, 2 d), d = 1 / 65535, half a step: sqrt 6 d, which is seen largest in the middle of a face, 1 /
/// sqrt 3 from the centre: sqrt 18 / 65535.
#[inline]
pub fn pack(direction: DVec3) -> u32 {
    let n = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let (mut x, mut y) = (n.x, n.y);
    if n.z < 0.0 {
        (x, y) = ((1.0 - n.y.abs()) * 1f64.copysign(n.x), (1.0 - n.x.abs()) * 1f64.copysign(n.y));
    }
    let bits = |v: f64| ((v * 0.5 + 0.5) * 65535.0 + 0.5) as u32;
    bits(x) | bits(y) << 16
}

/// The unit vector of [`pack`].
#[inline]
pub fn unpack(bits: u32) -> DVec3 {
    let of = |b: u32| f64::from(b & 0xffff) / 65535.0 * 2.0 - 1.0;
    let (x, y) = (of(bits), of(bits >> 16));
    let z = 1.0 - x.abs() - y.abs();
    let v = if z < 0.0 {
        DVec3::new((1.0 - y.abs()) * 1f64.copysign(x), (1.0 - x.abs()) * 1f64.copysign(y), z)
    } else {
        DVec3::new(x, y, z)
    };
    v.normalize()
}
