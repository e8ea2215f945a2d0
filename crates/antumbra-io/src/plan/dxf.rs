//! DXF drawings: lines, polylines with bulges, arcs, circles, ellipses, splines, solids, and blocks that
//! are inserted; each entity with its layer.

use std::collections::HashMap;
use std::f64::consts::TAU;

use antumbra_scene::plan::PlanInput;
use dxf::entities::{Entity, EntityType, Insert, Spline};
use dxf::{Drawing, DxfError};
use kurbo::{Affine, Point};

use super::curve::{arc, bulge};
use super::push_line;
use crate::error::{Damage, Place};

/// Blocks inserted within blocks at most.
const NESTED: u32 = 16;
/// Entities drawn, or segments of them, at most: blocks may multiply a small file without end.
const ENTITIES: usize = 4_000_000;

pub(super) fn read(text: &str) -> Result<PlanInput, Damage> {
    let drawing =
        Drawing::load(&mut text.as_bytes()).map_err(|e| damage(&e, text.lines().count()))?;
    let blocks = drawing.blocks().map(|b| (b.name.as_str(), b)).collect();
    let off = drawing
        .layers()
        .filter(|l| !l.is_layer_on)
        .map(|l| l.name.as_str());
    let mut reader = Reader {
        plan: PlanInput::default(),
        blocks,
        off: off.collect(),
        drawn: 0,
        left_out: 0,
        curves: 0,
    };
    reader.plan.class("");
    let context = Context {
        transform: Affine::IDENTITY,
        layer: None,
        nested: 0,
    };
    for entity in drawing.entities() {
        reader.entity(entity, &context)?;
    }
    let Reader {
        mut plan,
        left_out,
        curves,
        ..
    } = reader;
    if curves > 0 {
        plan.notes.push(match curves {
            1 => "1 curved entity became chords".to_owned(),
            n => format!("{n} curved entities became chords"),
        });
    }
    if left_out > 0 {
        plan.notes.push(match left_out {
            1 => "1 text, hatch, hidden or other entity without lines is left out".to_owned(),
            n => {
                format!("{n} texts, hatches, hidden and other entities without lines are left out")
            }
        });
    }
    Ok(plan)
}

/// `lines` is how many there are: where a drawing ends that stops too soon.
fn damage(error: &DxfError, lines: usize) -> Damage {
    let line = match error {
        DxfError::ParseFloatError(_, at)
        | DxfError::ParseIntError(_, at)
        | DxfError::ParseError(at)
        | DxfError::UnexpectedCode(_, at)
        | DxfError::UnexpectedByte(_, at)
        | DxfError::UnexpectedEnumValue(at)
        | DxfError::ExpectedTableType(at)
        | DxfError::WrongValueType(at) => Some(*at),
        DxfError::UnexpectedCodePair(pair, _) => Some(pair.offset),
        DxfError::UnexpectedEndOfInput => Some(lines),
        _ => None,
    };
    let said = match error {
        DxfError::UnexpectedCodePair(pair, _) => {
            format!("the group {} does not belong here", pair.code)
        }
        DxfError::UnexpectedEndOfInput => "the drawing stops before its end".to_owned(),
        _ => error.to_string(),
    };
    let said = said.split(" at line").next().unwrap_or_default();
    Damage::new(
        line.map_or(Place::Whole, |at| Place::Line(at as u64)),
        said.to_owned(),
        "repair the DXF or export it again as text",
    )
}

/// What an entity of a block inherits.
#[derive(Clone, Copy)]
struct Context<'a> {
    transform: Affine,
    /// The layer of what layer 0 of a block holds.
    layer: Option<&'a str>,
    nested: u32,
}

struct Reader<'a> {
    plan: PlanInput,
    blocks: HashMap<&'a str, &'a dxf::Block>,
    off: std::collections::HashSet<&'a str>,
    drawn: usize,
    left_out: u32,
    curves: u32,
}

impl<'a> Reader<'a> {
    fn entity(&mut self, entity: &'a Entity, context: &Context<'a>) -> Result<(), Damage> {
        let layer = match (entity.common.layer.as_str(), context.layer) {
            ("0", Some(outer)) => outer,
            (own, _) => own,
        };
        if !entity.common.is_visible || entity.common.is_in_paper_space || self.off.contains(layer)
        {
            self.left_out += 1;
            return Ok(());
        }
        if let EntityType::Insert(insert) = &entity.specific {
            let name = entity.common.handle.as_string();
            return self.insert((insert, &name), layer, context);
        }
        let Some(Drawn { points, curved }) = lines(&entity.specific) else {
            self.left_out += 1;
            return Ok(());
        };
        self.count()?;
        let name = entity.common.handle.as_string();
        self.curves += u32::from(curved);
        let at = |p: Point| {
            let p = context.transform * p;
            [p.x, p.y]
        };
        let line: Vec<[f64; 2]> = points.into_iter().map(at).collect();
        if line.iter().flatten().any(|c| !c.is_finite()) {
            return Err(Damage::broken(
                Place::Whole,
                format!("a coordinate of the entity {name} is not finite"),
            ));
        }
        let class = self.plan.class(layer);
        let feature = self.plan.features.len() as u32;
        self.plan.features.push(name);
        push_line(&mut self.plan, &line, class, feature);
        Ok(())
    }

    /// Counts an entity or an inserted block.
    fn count(&mut self) -> Result<(), Damage> {
        self.drawn += 1;
        if self.drawn.max(self.plan.segments.len()) <= ENTITIES {
            return Ok(());
        }
        Err(Damage::new(
            Place::Whole,
            format!("more than {ENTITIES} entities, blocks or segments are drawn"),
            "split the drawing",
        ))
    }

    fn insert(
        &mut self,
        (insert, name): (&'a Insert, &str),
        layer: &'a str,
        context: &Context<'a>,
    ) -> Result<(), Damage> {
        let Some(&block) = self.blocks.get(insert.name.as_str()) else {
            return Err(Damage::broken(
                Place::Whole,
                format!(
                    "there is no block `{}` for the insert {name}",
                    super::text::shortened(&insert.name)
                ),
            ));
        };
        if context.nested == NESTED {
            return Err(Damage::new(
                Place::Whole,
                format!("blocks are nested more than {NESTED} deep"),
                "explode them in the drawing",
            ));
        }
        let place = flipped(insert.extrusion_direction.z)
            * Affine::translate((insert.location.x, insert.location.y))
            * Affine::rotate(insert.rotation.to_radians());
        let scale = Affine::scale_non_uniform(insert.x_scale_factor, insert.y_scale_factor)
            * Affine::translate((-block.base_point.x, -block.base_point.y));
        for row in 0..i32::from(insert.row_count.max(1)) {
            for column in 0..i32::from(insert.column_count.max(1)) {
                let step = Affine::translate((
                    f64::from(column) * insert.column_spacing,
                    f64::from(row) * insert.row_spacing,
                ));
                let inner = Context {
                    transform: context.transform * place * step * scale,
                    layer: Some(layer),
                    nested: context.nested + 1,
                };
                self.count()?;
                for entity in &block.entities {
                    self.entity(entity, &inner)?;
                }
            }
        }
        Ok(())
    }
}

struct Drawn {
    points: Vec<Point>,
    curved: bool,
}

/// The line of an entity in its drawing or block.
fn lines(entity: &EntityType) -> Option<Drawn> {
    let (points, normal, curved) = match entity {
        EntityType::Line(e) => (vec![at(&e.p1), at(&e.p2)], 1.0, false),
        EntityType::LwPolyline(e) => {
            let vertices = e.vertices.iter().map(|v| (Point::new(v.x, v.y), v.bulge));
            let (points, curved) = polyline(vertices, e.is_closed());
            (points, e.extrusion_direction.z, curved)
        }
        EntityType::Polyline(e) if !e.is_polyface_mesh() && !e.is_3d_polygon_mesh() => {
            let drawn = e.vertices().filter(|v| !v.is_spline_frame_control_point());
            let vertices = drawn.map(|v| (at(&v.location), v.bulge));
            let (points, curved) = polyline(vertices, e.is_closed());
            let flat = !e.is_3d_polyline();
            (points, if flat { e.normal.z } else { 1.0 }, curved)
        }
        EntityType::Arc(e) => {
            let from = e.start_angle.to_radians();
            let to = from + (e.end_angle - e.start_angle).rem_euclid(360.0).to_radians();
            let to = if to == from { from + TAU } else { to };
            let r = e.radius;
            let points = arc(at(&e.center), [r, 0.0], [0.0, r], (from, to));
            (points, e.normal.z, true)
        }
        EntityType::Circle(e) => {
            let r = e.radius;
            let points = closed(arc(at(&e.center), [r, 0.0], [0.0, r], (0.0, TAU)));
            (points, e.normal.z, true)
        }
        EntityType::Ellipse(e) => {
            // In world coordinates; the normal turns the minor axis only.
            let major = [e.major_axis.x, e.major_axis.y];
            let ratio = e.minor_axis_ratio * e.normal.z.signum();
            let minor = [-major[1] * ratio, major[0] * ratio];
            // Files write the full turn with a few decimals less than a double has.
            let whole = (e.end_parameter - e.start_parameter - TAU).abs() < 1e-9;
            let turn = (e.end_parameter - e.start_parameter).rem_euclid(TAU);
            let from = e.start_parameter;
            let range = (from, from + if whole || turn == 0.0 { TAU } else { turn });
            let points = arc(at(&e.center), major, minor, range);
            (if whole { closed(points) } else { points }, 1.0, true)
        }
        EntityType::Spline(e) => (spline(e)?, 1.0, true),
        EntityType::Solid(e) => {
            // The third and fourth corner are given crosswise.
            let corners = [
                &e.first_corner,
                &e.second_corner,
                &e.fourth_corner,
                &e.third_corner,
            ];
            let mut points = corners.map(at).to_vec();
            points.push(points[0]);
            (points, e.extrusion_direction.z, false)
        }
        EntityType::Face3D(e) => {
            let corners = [
                &e.first_corner,
                &e.second_corner,
                &e.third_corner,
                &e.fourth_corner,
            ];
            let mut points = corners.map(at).to_vec();
            points.push(points[0]);
            (points, 1.0, false)
        }
        _ => return None,
    };
    let flip = flipped(normal);
    let points: Vec<Point> = points.into_iter().map(|p| flip * p).collect();
    (points.len() > 1).then_some(Drawn { points, curved })
}

fn at(p: &dxf::Point) -> Point {
    Point::new(p.x, p.y)
}

/// Entities seen from below are mirrored.
fn flipped(normal: f64) -> Affine {
    if normal < 0.0 {
        Affine::FLIP_X
    } else {
        Affine::IDENTITY
    }
}

fn closed(mut points: Vec<Point>) -> Vec<Point> {
    let first = points[0];
    if let Some(last) = points.last_mut() {
        *last = first;
    }
    points
}

/// The points of a polyline, and whether it has arcs.
fn polyline(vertices: impl Iterator<Item = (Point, f64)>, close: bool) -> (Vec<Point>, bool) {
    let mut vertices: Vec<(Point, f64)> = vertices.collect();
    if close && vertices.len() > 1 {
        vertices.push((vertices[0].0, 0.0));
    }
    let mut points: Vec<Point> = vertices.first().map(|v| v.0).into_iter().collect();
    for pair in vertices.windows(2) {
        points.extend(bulge(pair[0].0, pair[1].0, pair[0].1));
    }
    let drawn = vertices.len().saturating_sub(1);
    (points, vertices[..drawn].iter().any(|v| v.1 != 0.0))
}

/// A spline by de Boor's scheme, eight chords between two knots; its fit points if it has no knots.
fn spline(spline: &Spline) -> Option<Vec<Point>> {
    const CHORDS: u32 = 8;
    let knots = &spline.knot_values;
    let degree = usize::try_from(spline.degree_of_curve).ok()?;
    let count = spline.control_points.len();
    if degree == 0 || count <= degree || knots.len() != count + degree + 1 {
        let points = if spline.fit_points.is_empty() {
            &spline.control_points
        } else {
            &spline.fit_points
        };
        return Some(points.iter().map(at).collect());
    }
    let weight = |i: usize| spline.weight_values.get(i).copied().unwrap_or(1.0);
    let controls: Vec<[f64; 3]> = (spline.control_points.iter().enumerate())
        .map(|(i, p)| [p.x * weight(i), p.y * weight(i), weight(i)])
        .collect();
    let mut points = Vec::new();
    for span in degree..count {
        let (from, to) = (knots[span], knots[span + 1]);
        if from >= to {
            continue;
        }
        let first = u32::from(!points.is_empty());
        for i in first..=CHORDS {
            let t = from + (to - from) * f64::from(i) / f64::from(CHORDS);
            points.push(de_boor(&controls, knots, degree, span, t));
        }
    }
    Some(points)
}

fn de_boor(controls: &[[f64; 3]], knots: &[f64], degree: usize, span: usize, t: f64) -> Point {
    let mut d: Vec<[f64; 3]> = controls[span - degree..=span].to_vec();
    for level in 1..=degree {
        for j in (level..=degree).rev() {
            let i = span - degree + j;
            let (low, high) = (knots[i], knots[i + degree + 1 - level]);
            let a = if high > low {
                (t - low) / (high - low)
            } else {
                0.0
            };
            d[j] = std::array::from_fn(|k| (1.0 - a) * d[j - 1][k] + a * d[j][k]);
        }
    }
    let [x, y, w] = d[degree];
    Point::new(x / w, y / w)
}
