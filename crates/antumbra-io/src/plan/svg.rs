//! SVG drawings: every line, polyline, polygon, rectangle, circle, ellipse and path, with the
//! transformations of its groups, in user units; but no rectangle of 100 % of the drawing, which is paper. y stays as it is and runs down, so that cells are given in the
//! coordinates of the drawing.
//!
//! Coordinates stay doubles, which is why no renderer's tree (of single floats) is read.

use std::collections::HashMap;

use antumbra_scene::plan::PlanInput;
use kurbo::{Affine, BezPath, Point};
use roxmltree::{Document, Node, ParsingOptions};

use super::curve::{arc, path_lines};
use super::push_line;
use crate::error::{Damage, Place};

/// `use` elements within `use` elements at most.
const NESTED: u32 = 16;
/// Elements within elements at most.
const DEPTH: u32 = 256;
/// Elements drawn, or segments of them, at most: `use` elements may multiply a small file without end.
const ELEMENTS: usize = 4_000_000;

pub(super) fn read(text: &str) -> Result<PlanInput, Damage> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let at = e.pos();
        let said = e.to_string();
        let said = said.split(" at ").next().unwrap_or_default().to_owned();
        Damage::new(
            Place::Line(at.row.into()),
            said,
            "repair or export the SVG again",
        )
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(Damage::new(
            Place::Whole,
            format!(
                "the outermost element is `{}`, not `svg`",
                root.tag_name().name()
            ),
            "give an SVG drawing",
        ));
    }
    let named = root
        .descendants()
        .filter_map(|n| Some((n.attribute("id")?, n)));
    let mut reader = Reader {
        // The first of equal names counts.
        named: named.collect::<Vec<_>>().into_iter().rev().collect(),
        plan: PlanInput::default(),
        curves: 0,
        skipped: 0,
        backgrounds: 0,
        drawn: 0,
    };
    reader.plan.class("");
    reader.children(root, &Context::default())?;
    let Reader {
        mut plan,
        curves,
        skipped,
        backgrounds,
        ..
    } = reader;
    plan.y_down = true;
    if curves > 0 {
        plan.notes.push(match curves {
            1 => "1 curved element became chords".to_owned(),
            n => format!("{n} curved elements became chords"),
        });
    }
    if skipped > 0 {
        plan.notes.push(match skipped {
            1 => "1 text or image is left out".to_owned(),
            n => format!("{n} texts and images are left out"),
        });
    }
    if backgrounds > 0 {
        plan.notes.push(match backgrounds {
            1 => "1 rectangle as large as the drawing is left out: a background".to_owned(),
            n => format!("{n} rectangles as large as the drawing are left out: backgrounds"),
        });
    }
    Ok(plan)
}

/// What an element inherits.
#[derive(Clone)]
struct Context {
    transform: Affine,
    class: String,
    nested: u32,
    depth: u32,
}

impl Default for Context {
    fn default() -> Self {
        Self {
            transform: Affine::IDENTITY,
            class: String::new(),
            nested: 0,
            depth: 0,
        }
    }
}

struct Reader<'a, 'i> {
    /// The elements that have a name, for those that use them.
    named: HashMap<&'a str, Node<'a, 'i>>,
    plan: PlanInput,
    curves: u32,
    skipped: u32,
    backgrounds: u32,
    drawn: usize,
}

impl<'a, 'i> Reader<'a, 'i> {
    fn children(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Damage> {
        node.children()
            .filter(Node::is_element)
            .try_for_each(|child| self.element(child, context))
    }

    fn element(&mut self, node: Node<'a, 'i>, context: &Context) -> Result<(), Damage> {
        if hidden(node) {
            return Ok(());
        }
        self.drawn += 1;
        if self.drawn.max(self.plan.segments.len()) > ELEMENTS {
            return Err(Damage::new(
                place(node),
                format!("more than {ELEMENTS} elements or segments are drawn"),
                "split the drawing",
            ));
        }
        let mut inner = context.clone();
        inner.depth += 1;
        if inner.depth > DEPTH {
            return Err(too_deep(place(node)));
        }
        inner.transform = context.transform * transform(node)?;
        match node.tag_name().name() {
            "g" | "a" | "switch" | "svg" => {
                if let Some(name) = layer(node) {
                    inner.class = name;
                }
                self.children(node, &inner)
            }
            "use" => self.used(node, inner),
            "text" | "image" | "foreignObject" => {
                self.skipped += 1;
                Ok(())
            }
            "rect" if is_background(node) => {
                self.backgrounds += 1;
                Ok(())
            }
            name => match shape(node, name)? {
                Some(shape) => self.draw(node, &inner, &shape),
                None => Ok(()),
            },
        }
    }

    /// What a `use` element refers to, where it says.
    fn used(&mut self, node: Node<'a, 'i>, mut inner: Context) -> Result<(), Damage> {
        let link = node.attributes().find(|a| a.name() == "href");
        let Some(id) = link.and_then(|a| a.value().strip_prefix('#')) else {
            return Ok(());
        };
        inner.nested += 1;
        if inner.nested > NESTED {
            return Err(Damage::new(
                place(node),
                format!("`use` elements are nested more than {NESTED} deep"),
                "draw the element itself",
            ));
        }
        let Some(&target) = self.named.get(id) else {
            return Err(Damage::broken(
                place(node),
                format!(
                    "there is no element `{}` to use",
                    super::text::shortened(id)
                ),
            ));
        };
        inner.transform *= Affine::translate((
            number(node, "x")?.unwrap_or(0.0),
            number(node, "y")?.unwrap_or(0.0),
        ));
        if target.tag_name().name() == "symbol" {
            self.children(target, &inner)
        } else {
            self.element(target, &inner)
        }
    }

    fn draw(&mut self, node: Node<'a, 'i>, context: &Context, shape: &Shape) -> Result<(), Damage> {
        let lines = match shape {
            Shape::Lines(lines) => {
                let at = |p: &Point| {
                    let p = context.transform * *p;
                    [p.x, p.y]
                };
                vec![lines.iter().map(at).collect::<Vec<_>>()]
            }
            Shape::Path(path) => path_lines(path, context.transform),
        };
        self.curves += u32::from(shape.is_curved(node));
        if lines.iter().flatten().flatten().any(|c| !c.is_finite()) {
            return Err(Damage::broken(place(node), "a coordinate is not finite"));
        }
        let class = match node.attribute("class") {
            Some(class) => class.to_owned(),
            None => context.class.clone(),
        };
        let class = self.plan.class(&class);
        let feature = self.plan.features.len() as u32;
        self.plan
            .features
            .push(node.attribute("id").unwrap_or_default().to_owned());
        for line in &lines {
            push_line(&mut self.plan, line, class, feature);
        }
        Ok(())
    }
}

enum Shape {
    Lines(Vec<Point>),
    Path(BezPath),
}

impl Shape {
    fn is_curved(&self, node: Node<'_, '_>) -> bool {
        match self {
            Self::Lines(_) => matches!(node.tag_name().name(), "circle" | "ellipse"),
            Self::Path(path) => path
                .elements()
                .iter()
                .any(|e| matches!(e, kurbo::PathEl::QuadTo(..) | kurbo::PathEl::CurveTo(..))),
        }
    }
}

/// The outline of an element; `None` if it has none.
fn shape(node: Node<'_, '_>, name: &str) -> Result<Option<Shape>, Damage> {
    let of = |key| Ok::<f64, Damage>(number(node, key)?.unwrap_or(0.0));
    Ok(match name {
        "line" => Some(Shape::Lines(vec![
            Point::new(of("x1")?, of("y1")?),
            Point::new(of("x2")?, of("y2")?),
        ])),
        "polyline" | "polygon" => {
            let mut points = points(node)?;
            if name == "polygon" && points.len() > 2 {
                points.push(points[0]);
            }
            Some(Shape::Lines(points))
        }
        "rect" => {
            let (x, y, w, h) = (of("x")?, of("y")?, of("width")?, of("height")?);
            let corner = |dx, dy| Point::new(x + dx, y + dy);
            let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h), (0.0, 0.0)];
            (w > 0.0 && h > 0.0)
                .then(|| Shape::Lines(corners.map(|(dx, dy)| corner(dx, dy)).to_vec()))
        }
        "circle" | "ellipse" => {
            let (rx, ry) = if name == "circle" {
                (of("r")?, of("r")?)
            } else {
                (of("rx")?, of("ry")?)
            };
            let center = Point::new(of("cx")?, of("cy")?);
            let turn = (0.0, std::f64::consts::TAU);
            (rx > 0.0 && ry > 0.0).then(|| {
                let mut points = arc(center, [rx, 0.0], [0.0, ry], turn);
                let first = points[0];
                if let Some(last) = points.last_mut() {
                    *last = first;
                }
                Shape::Lines(points)
            })
        }
        "path" => {
            let data = node.attribute("d").unwrap_or_default();
            let path = BezPath::from_svg(data).map_err(|e| {
                Damage::broken(place(node), format!("the path data is damaged ({e})"))
            })?;
            Some(Shape::Path(path))
        }
        _ => None,
    })
}

fn points(node: Node<'_, '_>) -> Result<Vec<Point>, Damage> {
    let text = node.attribute("points").unwrap_or_default();
    let mut numbers = Vec::new();
    for word in text
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|w| !w.is_empty())
    {
        numbers.push(parse(node, word)?);
    }
    if numbers.len() % 2 == 1 {
        return Err(Damage::broken(
            place(node),
            "`points` holds an odd number of coordinates",
        ));
    }
    Ok(numbers.chunks(2).map(|c| Point::new(c[0], c[1])).collect())
}

/// Whether a rectangle has the size of the drawing, whatever that is: paper, not a wall.
fn is_background(node: Node<'_, '_>) -> bool {
    let all = |key| node.attribute(key).is_some_and(|v| v.trim() == "100%");
    all("width") && all("height")
}

/// A length in user units; `px` is one.
fn number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>, Damage> {
    let Some(text) = node.attribute(name) else {
        return Ok(None);
    };
    parse(node, text.trim().trim_end_matches("px")).map(Some)
}

fn parse(node: Node<'_, '_>, word: &str) -> Result<f64, Damage> {
    let found = word.parse().ok().filter(|v: &f64| v.is_finite());
    found.ok_or_else(|| {
        Damage::new(
            place(node),
            format!(
                "`{}` is not a number of user units",
                super::text::shortened(word)
            ),
            "export the drawing with plain numbers",
        )
    })
}

fn transform(node: Node<'_, '_>) -> Result<Affine, Damage> {
    let Some(text) = node.attribute("transform") else {
        return Ok(Affine::IDENTITY);
    };
    let t: svgtypes::Transform = text
        .parse()
        .map_err(|e| Damage::broken(place(node), format!("the transformation is damaged ({e})")))?;
    Ok(Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]))
}

/// Switched off, by attribute or style.
fn hidden(node: Node<'_, '_>) -> bool {
    let style = node.attribute("style").unwrap_or_default();
    let none = |key: &str, value: &str| {
        node.attribute(key) == Some(value)
            || style.split(';').any(|rule| {
                rule.split_once(':')
                    .is_some_and(|(k, v)| k.trim() == key && v.trim() == value)
            })
    };
    none("display", "none") || none("visibility", "hidden")
}

/// The name of a group: the label of a layer, its class, or its id.
fn layer(node: Node<'_, '_>) -> Option<String> {
    let label = node.attributes().find(|a| a.name() == "label");
    label
        .map(|a| a.value())
        .or(node.attribute("class"))
        .or(node.attribute("id"))
        .map(str::to_owned)
}

fn too_deep(place: Place) -> Damage {
    Damage::new(
        place,
        format!("elements are nested more than {DEPTH} deep"),
        "ungroup them in the drawing",
    )
}

fn place(node: Node<'_, '_>) -> Place {
    let at = node.document().text_pos_at(node.range().start);
    Place::Line(at.row.into())
}
