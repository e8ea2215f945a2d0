//! Naming things of a scene on the command line: objects, their polygons, points.

use antumbra_scene::{ObjectId, PolygonId, Scene};

use crate::failure::Failure;
use crate::values::PointArg;

/// One end of a pair query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// An object with all its polygons.
    Object(ObjectId),
    /// One polygon.
    Polygon(PolygonId),
    /// A point in scene units.
    Point([f64; 3]),
}

/// Resolves `object`, `object:polygon` or `x,y,z`; objects go by number or name, polygons by
/// their number within the object. A number is always an id; a name that contains a colon or
/// commas is found first.
pub(crate) fn end(scene: &Scene, text: &str) -> Result<End, Failure> {
    let missing = match object(scene, text) {
        Ok(id) => return Ok(End::Object(id)),
        Err(failure) => failure,
    };
    if let Ok(PointArg(point)) = text.parse() {
        return Ok(End::Point(point));
    }
    let Some((name, number)) = text.rsplit_once(':') else {
        return Err(missing);
    };
    let id = object(scene, name)?;
    let polygons = &scene.object(id).polygons;
    let index = number
        .parse::<u32>()
        .ok()
        .filter(|k| *k < polygons.end - polygons.start);
    match index {
        Some(k) => Ok(End::Polygon(PolygonId(polygons.start + k))),
        None => Err(Failure::Content(format!(
            "{text}: object {name} has {} polygons, numbered from 0; give one of these",
            polygons.end - polygons.start
        ))),
    }
}

/// Resolves an object by number or name.
pub(crate) fn object(scene: &Scene, text: &str) -> Result<ObjectId, Failure> {
    let objects = scene.objects();
    if let Ok(number) = text.parse::<u32>() {
        return if (number as usize) < objects.len() {
            Ok(ObjectId(number))
        } else {
            let count = objects.len();
            Err(Failure::Content(format!(
                "object {number} does not exist: the scene has {count} objects, numbered from 0; give a smaller number or a name"
            )))
        };
    }
    let named: Vec<usize> = objects
        .iter()
        .enumerate()
        .filter(|(_, o)| o.name == text)
        .map(|(i, _)| i)
        .collect();
    match named[..] {
        [id] => Ok(ObjectId(id as u32)),
        [] => Err(Failure::Content(format!(
            "no object is named '{text}'{}; give an object's number or name",
            similar(scene, text)
        ))),
        [first, second, ..] => Err(Failure::Content(format!(
            "{} objects are named '{text}' (numbers {first}, {second}, ...); give a number",
            named.len()
        ))),
    }
}

/// A hint if some name differs only in case or contains the text.
fn similar(scene: &Scene, text: &str) -> String {
    let wanted = text.to_lowercase();
    let near = scene.objects().iter().map(|o| &o.name).find(|name| {
        let name = name.to_lowercase();
        name == wanted || (!wanted.is_empty() && name.contains(&wanted))
    });
    near.map(|name| format!(", but one is named '{name}'"))
        .unwrap_or_default()
}
