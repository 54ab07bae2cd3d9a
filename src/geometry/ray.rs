//! A ray in the frame its leaves are tested in.

use glam::DVec3;

/// A ray with the axis permutation and shear that turn it into the z axis.
///
/// S. Woop, C. Benthin, I. Wald: Watertight Ray/Triangle Intersection, JCGT 2 (1), 2013. The sheared coordinates of a
/// vertex depend on the vertex and the ray alone, so triangles that share a vertex see it at the same place bit for
/// bit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    pub o: [f64; 3],
    pub kx: usize,
    pub ky: usize,
    pub kz: usize,
    pub sx: f64,
    pub sy: f64,
    pub sz: f64,
}

/// A vertex as the ray sees it: `x`, `y` across the ray, `z` the ray's parameter [m].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sheared {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

impl Ray {
    /// A ray of unit direction; `None` where origin or direction is not finite or the direction is zero.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        let d = direction.to_array();
        let m = [d[0].abs(), d[1].abs(), d[2].abs()];
        let kz = if m[0] >= m[1] && m[0] >= m[2] {
            0
        } else if m[1] >= m[2] {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        if d[kz] < 0.0 {
            std::mem::swap(&mut kx, &mut ky);
        }
        let valid = origin.is_finite() && direction.is_finite() && d[kz] != 0.0;
        valid.then(|| Self {
            origin,
            direction,
            o: origin.to_array(),
            kx,
            ky,
            kz,
            sx: d[kx] / d[kz],
            sy: d[ky] / d[kz],
            sz: 1.0 / d[kz],
        })
    }

    /// The vertex in the ray's frame.
    #[inline(always)]
    pub fn shear(&self, v: [f64; 3]) -> Sheared {
        let depth = v[self.kz] - self.o[self.kz];
        Sheared {
            x: (v[self.kx] - self.o[self.kx]) - self.sx * depth,
            y: (v[self.ky] - self.o[self.ky]) - self.sy * depth,
            z: self.sz * depth,
        }
    }
}
