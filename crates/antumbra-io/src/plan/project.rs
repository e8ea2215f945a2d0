//! Longitude and latitude to metres around the middle of a plan.
//!
//! Along meridian and parallel with the radii of the WGS 84 ellipsoid at the middle. The map is affine, so
//! that straight edges stay straight and nothing changes its side; over a city of 20 km lengths are
//! right to about a thousandth.

/// What the coordinates of a file are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Crs {
    /// What the file says. If it does not say: degrees if all are in range and the plan is less than one
    /// unit wide and high, else lengths.
    #[default]
    FromFile,
    /// Lengths in any unit.
    Planar,
    /// Degrees of longitude and latitude.
    LonLat,
}

/// The map from degrees to metres around a middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    middle: [f64; 2],
    scale: [f64; 2],
}

/// WGS 84: semi-major axis and squared eccentricity.
const AXIS: f64 = 6_378_137.0;
const ECCENTRICITY: f64 = 0.006_694_379_990_14;

impl Projection {
    /// Around a middle in degrees.
    #[must_use]
    pub fn around(middle: [f64; 2]) -> Self {
        let (sin, cos) = middle[1].to_radians().sin_cos();
        let w = (1.0 - ECCENTRICITY * sin * sin).sqrt();
        let parallel = AXIS / w * cos;
        let meridian = AXIS * (1.0 - ECCENTRICITY) / (w * w * w);
        Self {
            middle,
            scale: [parallel, meridian].map(f64::to_radians),
        }
    }

    pub(super) fn middle(&self) -> [f64; 2] {
        self.middle
    }

    /// From degrees to metres.
    #[must_use]
    pub fn apply(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (p[k] - self.middle[k]) * self.scale[k])
    }

    /// From metres to degrees.
    #[must_use]
    pub fn undo(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| p[k] / self.scale[k] + self.middle[k])
    }
}

#[cfg(test)]
mod tests {
    use super::Projection;

    #[test]
    fn a_degree_has_its_known_length() {
        let p = Projection::around([16.4, 48.2]);
        let [x, y] = p.apply([17.4, 49.2]);
        assert!((x - 74_330.0).abs() < 100.0, "{x}");
        assert!((y - 111_200.0).abs() < 30.0, "{y}");
        assert_eq!(p.apply([16.4, 48.2]), [0.0, 0.0]);
        let [lon, lat] = p.undo([x, y]);
        assert!((lon - 17.4).abs() < 1e-12 && (lat - 49.2).abs() < 1e-12);
    }
}
