//! GeoJSON (RFC 7946, and the `crs` member of its predecessor): lines and polygons as segments, polygons
//! as view cells.

use std::fmt;

use antumbra_scene::plan::PlanInput;
use serde::Deserialize;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::project::{Crs, Projection};
use super::{PlanReadOptions, push_line};
use crate::error::{Damage, Place};

#[derive(Deserialize)]
struct Document {
    #[serde(rename = "type")]
    kind: Option<String>,
    features: Option<Vec<Feature>>,
    geometry: Option<Geometry>,
    geometries: Option<Vec<Geometry>>,
    coordinates: Option<Nest>,
    properties: Option<Map<String, Value>>,
    crs: Option<Value>,
    /// Written by plans in local lengths: where their origin lies.
    origin: Option<Value>,
    id: Option<Value>,
}

#[derive(Deserialize)]
struct Feature {
    properties: Option<Map<String, Value>>,
    geometry: Option<Geometry>,
    id: Option<Value>,
}

#[derive(Deserialize)]
struct Geometry {
    #[serde(rename = "type")]
    kind: String,
    coordinates: Option<Nest>,
    geometries: Option<Vec<Geometry>>,
}

/// Coordinates, as deep as they are nested.
enum Nest {
    Empty,
    Number(f64),
    Position([f64; 2]),
    Line(Vec<[f64; 2]>),
    Lines(Vec<Vec<[f64; 2]>>),
    Polygons(Vec<Vec<Vec<[f64; 2]>>>),
}

impl<'de> Deserialize<'de> for Nest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Nest;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("numbers or lists of coordinates")
            }
            fn visit_f64<E>(self, v: f64) -> Result<Nest, E> {
                Ok(Nest::Number(v))
            }
            fn visit_i64<E>(self, v: i64) -> Result<Nest, E> {
                Ok(Nest::Number(v as f64))
            }
            fn visit_u64<E>(self, v: u64) -> Result<Nest, E> {
                Ok(Nest::Number(v as f64))
            }
            fn visit_unit<E>(self) -> Result<Nest, E> {
                Ok(Nest::Empty)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Nest, A::Error> {
                match seq.next_element::<Nest>()? {
                    None => Ok(Nest::Empty),
                    Some(Nest::Number(x)) => {
                        let y = seq.next_element::<f64>()?;
                        let y =
                            y.ok_or_else(|| A::Error::custom("a position needs two numbers"))?;
                        while seq.next_element::<f64>()?.is_some() {}
                        Ok(Nest::Position([x, y]))
                    }
                    Some(Nest::Position(first)) => rest(seq, first, |n| {
                        if let Nest::Position(p) = n {
                            Some(p)
                        } else {
                            None
                        }
                    })
                    .map(Nest::Line),
                    Some(Nest::Line(first)) => rest(seq, first, |n| match n {
                        Nest::Line(l) => Some(l),
                        Nest::Empty => Some(Vec::new()),
                        _ => None,
                    })
                    .map(Nest::Lines),
                    Some(Nest::Lines(first)) => rest(seq, first, |n| match n {
                        Nest::Lines(l) => Some(l),
                        Nest::Empty => Some(Vec::new()),
                        _ => None,
                    })
                    .map(Nest::Polygons),
                    Some(Nest::Empty) => {
                        while seq.next_element::<Nest>()?.is_some() {}
                        Ok(Nest::Empty)
                    }
                    Some(Nest::Polygons(_)) => {
                        Err(A::Error::custom("coordinates are nested too deeply"))
                    }
                }
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// The remaining elements of a list, all of one kind.
fn rest<'de, A: SeqAccess<'de>, T>(
    mut seq: A,
    first: T,
    same: impl Fn(Nest) -> Option<T>,
) -> Result<Vec<T>, A::Error> {
    let mut out = vec![first];
    while let Some(next) = seq.next_element::<Nest>()? {
        let next = same(next).ok_or_else(|| {
            A::Error::custom("the elements of a list of coordinates differ in depth")
        })?;
        out.push(next);
    }
    Ok(out)
}

fn document(text: &str) -> Result<(Vec<Feature>, Option<Value>, bool), Damage> {
    let parsed: Document = serde_json::from_str(text).map_err(|e| {
        let place = Place::Json {
            line: e.line(),
            column: e.column(),
        };
        let said = e.to_string();
        let said = said
            .split(" at line ")
            .next()
            .unwrap_or_default()
            .to_owned();
        Damage::new(place, said, "repair or export the GeoJSON again")
    })?;
    let local = parsed.origin.is_some();
    let kind = parsed.kind.as_deref().unwrap_or_default();
    let features = match kind {
        "FeatureCollection" => parsed.features.ok_or_else(|| {
            Damage::broken(Place::Whole, "the FeatureCollection has no `features`")
        })?,
        "Feature" => vec![Feature {
            properties: parsed.properties,
            geometry: parsed.geometry,
            id: parsed.id,
        }],
        "Point" | "MultiPoint" | "LineString" | "MultiLineString" | "Polygon" | "MultiPolygon"
        | "GeometryCollection" => vec![Feature {
            properties: None,
            geometry: Some(Geometry {
                kind: kind.to_owned(),
                coordinates: parsed.coordinates,
                geometries: parsed.geometries,
            }),
            id: None,
        }],
        _ => {
            return Err(Damage::new(
                Place::Whole,
                "this JSON is not GeoJSON: it has no `type` of GeoJSON",
                "give a FeatureCollection, a Feature or a geometry",
            ));
        }
    };
    Ok((features, parsed.crs, local))
}

/// The lines of a geometry, in order: rings and polylines.
fn lines(geometry: Geometry, feature: usize, out: &mut Vec<Vec<[f64; 2]>>) -> Result<(), Damage> {
    let place = Place::Item {
        list: "feature",
        index: feature as u64,
    };
    let Geometry {
        kind,
        coordinates,
        geometries,
    } = geometry;
    match (kind.as_str(), coordinates) {
        ("GeometryCollection", _) => {
            for part in geometries.into_iter().flatten() {
                lines(part, feature, out)?;
            }
        }
        ("Point" | "MultiPoint", _) => {}
        (_, None | Some(Nest::Empty)) => {}
        ("LineString", Some(Nest::Line(line))) => out.push(line),
        ("MultiLineString" | "Polygon", Some(Nest::Lines(lines))) => out.extend(lines),
        ("MultiPolygon", Some(Nest::Polygons(polygons))) => {
            out.extend(polygons.into_iter().flatten());
        }
        ("LineString" | "MultiLineString" | "Polygon" | "MultiPolygon", Some(_)) => {
            return Err(Damage::broken(
                place,
                format!("the coordinates do not have the depth of a {kind}"),
            ));
        }
        (other, _) => {
            let name: String = other.chars().filter(|c| !c.is_control()).take(30).collect();
            return Err(Damage::broken(
                place,
                format!("`{name}` is no geometry of GeoJSON"),
            ));
        }
    }
    Ok(())
}

pub(super) fn read(text: &str, options: &PlanReadOptions) -> Result<PlanInput, Damage> {
    let (features, crs, local) = document(text)?;
    let mut plan = PlanInput {
        crs: crs.as_ref().map(Value::to_string),
        ..PlanInput::default()
    };
    plan.class("");
    let mut points_only = 0_usize;
    for (index, feature) in features.into_iter().enumerate() {
        let class = class_of(
            feature.properties.as_ref(),
            options.class_property.as_deref(),
        );
        let class = plan.class(&class);
        plan.features
            .push(name_of(feature.properties.as_ref(), feature.id.as_ref()));
        let mut found = Vec::new();
        if let Some(geometry) = feature.geometry {
            lines(geometry, index, &mut found)?;
        }
        let before = plan.segments.len();
        for line in &found {
            push_line(&mut plan, line, class, index as u32);
        }
        points_only += usize::from(plan.segments.len() == before);
    }
    if points_only > 0 {
        plan.notes.push(match points_only {
            1 => "1 feature has no lines: it is left out".to_owned(),
            n => format!("{n} features have no lines: they are left out"),
        });
    }
    let ends = || plan.segments.iter().flat_map(|s| s.ends);
    if let Some(projection) = projection(crs.as_ref(), local, options.crs, ends)? {
        for segment in &mut plan.segments {
            segment.ends = segment.ends.map(|p| projection.apply(p));
        }
        plan.notes.push(projected(&projection));
        plan.projected_around = Some(projection.middle());
    }
    Ok(plan)
}

fn projected(projection: &Projection) -> String {
    let [lon, lat] = projection.middle();
    format!("longitude and latitude were projected to metres around ({lon}, {lat})")
}

/// How to project, if the coordinates are degrees.
fn projection<I: Iterator<Item = [f64; 2]>>(
    crs: Option<&Value>,
    local: bool,
    asked: Crs,
    points: impl Fn() -> I,
) -> Result<Option<Projection>, Damage> {
    let start = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (low, high) = points().fold(start, |(l, h), p| {
        (
            [0, 1].map(|k| l[k].min(p[k])),
            [0, 1].map(|k| h[k].max(p[k])),
        )
    });
    let in_range = low[0] >= -180.0 && high[0] <= 180.0 && low[1] >= -90.0 && high[1] <= 90.0;
    let named = crs
        .and_then(|c| c.pointer("/properties/name"))
        .and_then(Value::as_str)
        .unwrap_or_default()
        .to_ascii_uppercase();
    let degrees = match asked {
        Crs::Planar => false,
        Crs::LonLat => true,
        Crs::FromFile if named.ends_with("CRS84") || named.ends_with("4326") => true,
        Crs::FromFile if !named.is_empty() || local => false,
        Crs::FromFile => in_range && high[0] - low[0] < 1.0 && high[1] - low[1] < 1.0,
    };
    if !degrees || low[0] > high[0] {
        return Ok(None);
    }
    if !in_range {
        return Err(Damage::new(
            Place::Whole,
            format!(
                "the coordinates from ({}, {}) to ({}, {}) are no longitudes and latitudes",
                low[0], low[1], high[0], high[1]
            ),
            "name their coordinate system in `crs`, or give --crs planar",
        ));
    }
    let middle = [0, 1].map(|k| low[k] / 2.0 + high[k] / 2.0);
    Ok(Some(Projection::around(middle)))
}

fn class_of(properties: Option<&Map<String, Value>>, asked: Option<&str>) -> String {
    let Some(properties) = properties else {
        return String::new();
    };
    let found = match asked {
        Some(name) => properties.get(name),
        None => ["class", "layer", "type"]
            .iter()
            .find_map(|n| properties.get(*n)),
    };
    found.map(plain).unwrap_or_default()
}

fn name_of(properties: Option<&Map<String, Value>>, id: Option<&Value>) -> String {
    let of = |key: &str| properties.and_then(|p| p.get(key));
    of("name")
        .or(of("id"))
        .or(id)
        .map(plain)
        .unwrap_or_default()
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

/// A view cell of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CellInput {
    /// The feature's `id`, as text; its number in the file if it has none.
    pub id: String,
    /// The outline: a ring, a line of two points, or one point.
    pub outline: Vec<[f64; 2]>,
}

/// Reads view cells from GeoJSON: a polygon, a line of two points or a point a feature. `around` is where
/// the plan was projected, if it was: then cells are degrees, too.
///
/// # Errors
/// If the GeoJSON is damaged, or a feature is no cell.
pub fn parse_cells(text: &str, around: Option<[f64; 2]>) -> Result<Vec<CellInput>, Damage> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        let advice = "give GeoJSON with a polygon, a line of two points or a point a feature";
        return Err(Damage::new(Place::Whole, "the file is empty", advice));
    }
    let (features, ..) = document(text)?;
    let projection = around.map(Projection::around);
    let mut cells = Vec::with_capacity(features.len());
    for (index, feature) in features.into_iter().enumerate() {
        let id = feature.properties.as_ref().and_then(|p| p.get("id"));
        let id = id.or(feature.id.as_ref()).map_or(index.to_string(), plain);
        let mut outline = outline(feature.geometry, index)?;
        if let Some(projection) = projection {
            outline.iter_mut().for_each(|p| *p = projection.apply(*p));
        }
        cells.push(CellInput { id, outline });
    }
    Ok(cells)
}

fn outline(geometry: Option<Geometry>, index: usize) -> Result<Vec<[f64; 2]>, Damage> {
    let place = Place::Item {
        list: "feature",
        index: index as u64,
    };
    let wrong = |found: String| {
        let advice = "give one polygon without holes, a line of two points, or a point";
        Err(Damage::new(place.clone(), found, advice))
    };
    let Some(Geometry {
        kind, coordinates, ..
    }) = geometry
    else {
        return wrong("the cell has no geometry".to_owned());
    };
    match (kind.as_str(), coordinates) {
        ("Polygon", Some(Nest::Lines(mut rings))) if rings.len() == 1 => Ok(rings.remove(0)),
        ("MultiPolygon", Some(Nest::Polygons(mut parts)))
            if parts.len() == 1 && parts[0].len() == 1 =>
        {
            Ok(parts.remove(0).remove(0))
        }
        ("LineString", Some(Nest::Line(line))) if line.len() == 2 => Ok(line),
        ("Point", Some(Nest::Position(p))) => Ok(vec![p]),
        ("Polygon", Some(Nest::Lines(rings))) => {
            let holes = rings.len() - 1;
            let word = if holes == 1 { "hole" } else { "holes" };
            wrong(format!("the cell has {holes} {word}"))
        }
        (other, _) => {
            let name: String = other.chars().filter(|c| !c.is_control()).take(30).collect();
            wrong(format!("a {name} is no view cell"))
        }
    }
}
