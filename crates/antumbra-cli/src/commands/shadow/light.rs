//! The light on the command line: a point, four corners, or a polygon of the scene.

use std::str::FromStr;

use antumbra_scene::Scene;

use crate::ends::{End, end};
use crate::failure::Failure;
use crate::load::SceneBox;
use crate::values::PointArg;

/// The light as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LightArg {
    /// A point in scene units.
    Point([f64; 3]),
    /// Four corners in scene units.
    Corners([[f64; 3]; 4]),
    /// An object or polygon of the scene.
    Name(String),
}

/// The light as it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Light {
    /// A point.
    Point([f64; 3]),
    /// A quadrangle.
    Area([[f64; 3]; 4]),
}

impl FromStr for LightArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let points: Result<Vec<[f64; 3]>, String> = text
            .split_whitespace()
            .map(|p| Ok(p.parse::<PointArg>()?.0))
            .collect();
        match (points.as_deref(), text.contains(',')) {
            (Ok([point]), _) => Ok(Self::Point(*point)),
            (Ok([a, b, c, d]), _) => Ok(Self::Corners([*a, *b, *c, *d])),
            (Ok([]), _) => Err("expected a light: a point, four corners, or a name".to_owned()),
            (Ok(points), _) => Err(format!(
                "expected one point, or the four corners of an area light, not {} points",
                points.len()
            )),
            // Names may hold commas; numbers that are not finite are no names.
            (Err(why), true) if text.starts_with(|c: char| c == '-' || c.is_ascii_digit()) => {
                Err(why.clone())
            }
            (Err(_), _) => Ok(Self::Name(text.to_owned())),
        }
    }
}

impl LightArg {
    /// The box around a light that is given by coordinates.
    pub(super) fn hull(&self) -> Option<SceneBox> {
        match self {
            Self::Point(at) => Some((*at, *at)),
            Self::Corners(corners) => {
                let bound = |pick: fn(f64, f64) -> f64| {
                    std::array::from_fn(|k| corners.iter().map(|c| c[k]).fold(corners[0][k], pick))
                };
                Some((bound(f64::min), bound(f64::max)))
            }
            Self::Name(_) => None,
        }
    }

    /// Finds what is named.
    pub(super) fn resolve(&self, scene: &Scene) -> Result<Light, Failure> {
        let name = match self {
            Self::Point(at) => return Ok(Light::Point(*at)),
            Self::Corners(corners) => return Ok(Light::Area(*corners)),
            Self::Name(name) => name,
        };
        let polygon = match end(scene, name)? {
            End::Point(at) => return Ok(Light::Point(at)),
            End::Polygon(id) => scene.polygon(id),
            End::Object(id) => {
                let polygons = scene.object(id).polygons.clone();
                if polygons.len() != 1 {
                    return Err(Failure::Content(format!(
                        "{name} has {} polygons; name the one that is the light, like {name}:0",
                        polygons.len()
                    )));
                }
                scene.polygon(antumbra_scene::PolygonId(polygons.start))
            }
        };
        match *polygon.corners {
            [a, b, c, d] => Ok(Light::Area([a, b, c, d].map(|p| scene.grid().to_scene(p)))),
            _ => Err(Failure::Content(format!(
                "{name} has {} corners; an area light has four: name another polygon, or give the corners",
                polygon.corners.len()
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::LightArg;

    #[test]
    fn points_corners_and_names() {
        assert_eq!("1,2,-3".parse(), Ok(LightArg::Point([1.0, 2.0, -3.0])));
        let four = "0,0,1 1,0,1 1,1,1 0,1,1".parse::<LightArg>();
        assert!(matches!(four, Ok(LightArg::Corners(_))), "{four:?}");
        assert_eq!(
            "lamp, left".parse(),
            Ok(LightArg::Name("lamp, left".into()))
        );
        assert_eq!("7:0".parse(), Ok(LightArg::Name("7:0".into())));
        for bad in ["", "1,2", "1,2,nan", "-1,2,inf", "0,0,0 1,1,1"] {
            assert!(bad.parse::<LightArg>().is_err(), "{bad}");
        }
    }
}
