//! Laws that every line space keeps, and every occlusion tree in it.

mod space;
mod tree;

use antumbra_lines::{Cone3, Plane3, Space3};

/// Small pseudo-random integers.
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn below(&mut self, n: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 20) % n as u64) as i64
    }

    pub(crate) fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below(high - low + 1)
    }
}

/// A triangle of directions with third components around `z`, turned inward; `None` if it is flat.
pub(crate) fn triangle(random: &mut Random, reach: i64, z: i64) -> Option<[[i64; 3]; 3]> {
    let mut d: [[i64; 3]; 3] = std::array::from_fn(|_| {
        let slant = random.between(0, z / 2);
        [
            random.between(-reach, reach),
            random.between(-reach, reach),
            z + slant,
        ]
    });
    let [a, b, c] = d.map(|v| v.map(i128::from));
    let cross = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    let volume: i128 = (0..3).map(|k| cross[k] * c[k]).sum();
    if volume < 0 {
        d.reverse();
    }
    (volume != 0).then_some(d)
}

/// A cone and hyperplanes in a space of R^3; small numbers, so that many of them touch.
pub(crate) fn cones(seed: u64, reach: i64) -> Option<(Space3, Cone3, Vec<Plane3>)> {
    let mut random = Random(seed * 2 + 88_172_645_463_325_252);
    let mut space = Space3::new();
    let cone = triangle(&mut random, reach, reach)?;
    let cone = space.cone(&cone);
    let mut planes = Vec::new();
    for _ in 0..4 {
        let other = triangle(&mut random, reach, reach)?;
        planes.push(space.plane_through(other[0], other[1]));
    }
    Some((space, cone, planes))
}
