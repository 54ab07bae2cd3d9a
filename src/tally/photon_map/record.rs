//! One kept photon, packed.

use glam::DVec3;

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

/// It arrived on the side the outward normal points to.
pub const FRONT: u32 = 1 << 16;
/// It was scattered before: light of L (S|D)* D (S|D)* D, not of L S+ D.
pub const SCATTERED: u32 = 1 << 17;

/// Positions as integers: the bounds of the scene in 2^32 steps an axis.
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

/// A unit vector in 32 bits: octahedral map, 16 bits each; error below 1e-4 rad.
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
