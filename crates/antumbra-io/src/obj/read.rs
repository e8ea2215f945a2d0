//! Reads Wavefront OBJ text.
//!
//! Every `o` statement begins an object; a file without any has one object for each `g` statement
//! that faces follow. Faces before the first of them form a nameless object. `usemtl` gives the
//! class. Faces keep all their corners. Materials files are not read: OBJ has no alpha mode.

use std::borrow::Cow;

use antumbra_scene::{ObjectInput, PartInput, SceneInput};

use crate::error::{CornerCount, Damage, Place, check_finite};
use crate::read::Up;

pub(crate) fn read(bytes: &[u8], up: Up) -> Result<SceneInput, Damage> {
    if let Some(at) = bytes.iter().position(|b| *b == 0) {
        let found = "a zero byte, which OBJ text never holds";
        return Err(Damage::new(
            Place::Byte(at as u64),
            found,
            "give a text file",
        ));
    }
    let text = String::from_utf8_lossy(bytes);
    let lines = logical_lines(text.trim_start_matches('\u{feff}'));
    // Faces may refer to vertices further down, so all vertices are read first.
    let mut vertices = Vec::new();
    let mut named_objects = false;
    for line in &lines {
        match line.keyword() {
            "v" => vertices.push(up.turn(vertex(line, vertices.len())?)),
            "o" => named_objects = true,
            _ => {}
        }
    }
    let mut builder = Builder::new(&vertices, named_objects);
    for line in &lines {
        match line.keyword() {
            "v" => builder.vertices_so_far += 1,
            "f" => builder.face(line)?,
            "o" => builder.begin(line.rest()),
            "g" if !named_objects => builder.begin(line.rest()),
            "usemtl" => {
                builder.class = Some(line.rest().to_owned()).filter(|name| !name.is_empty())
            }
            _ => {}
        }
    }
    Ok(builder.finish())
}

/// A line with its number, its comment cut off and continuation lines joined.
struct Line<'a> {
    number: u64,
    text: Cow<'a, str>,
}

impl Line<'_> {
    fn keyword(&self) -> &str {
        self.text
            .split_ascii_whitespace()
            .next()
            .unwrap_or_default()
    }

    /// What follows the keyword.
    fn rest(&self) -> &str {
        let text = self.text.trim();
        text.split_once(|c: char| c.is_ascii_whitespace())
            .map_or("", |(_, rest)| rest.trim())
    }

    fn place(&self) -> Place {
        Place::Line(self.number)
    }
}

fn logical_lines(text: &str) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    let mut continued = false;
    for (i, raw) in text.lines().enumerate() {
        let raw = raw.split('#').next().unwrap_or_default().trim_end();
        let (body, goes_on) = match raw.strip_suffix('\\') {
            Some(body) => (body, true),
            None => (raw, false),
        };
        match lines.last_mut() {
            Some(last) if continued => {
                let joined = last.text.to_mut();
                joined.push(' ');
                joined.push_str(body);
            }
            _ if body.trim().is_empty() && !goes_on => {}
            _ => lines.push(Line {
                number: i as u64 + 1,
                text: Cow::Borrowed(body),
            }),
        }
        continued = goes_on;
    }
    lines
}

fn vertex(line: &Line<'_>, index: usize) -> Result<[f64; 3], Damage> {
    let mut words = line.text.split_ascii_whitespace().skip(1);
    let mut point = [0.0; 3];
    for c in &mut point {
        let word = words.next().unwrap_or_default();
        *c = word.parse().map_err(|_| {
            Damage::broken(
                line.place(),
                format!("a vertex needs three numbers, found {word:?}"),
            )
        })?;
    }
    check_finite(point, || line.place(), index as u64)?;
    Ok(point)
}

struct Builder<'a> {
    vertices: &'a [[f64; 3]],
    vertices_so_far: usize,
    scene: SceneInput,
    /// The object that faces go to; `None` before the first one.
    current: Option<ObjectInput>,
    /// Whether an object without faces still counts.
    keep_empty: bool,
    class: Option<String>,
    /// Where each file vertex stands in the part that used it last: (part's serial, index there).
    copies: Vec<(u32, u32)>,
    /// The serial number of the current object's first part; serials never repeat.
    first_serial: u32,
    total: CornerCount,
    face: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(vertices: &'a [[f64; 3]], keep_empty: bool) -> Self {
        Self {
            vertices,
            vertices_so_far: 0,
            scene: SceneInput::default(),
            current: None,
            keep_empty,
            class: None,
            copies: vec![(u32::MAX, 0); vertices.len()],
            first_serial: 0,
            total: CornerCount::default(),
            face: Vec::new(),
        }
    }

    fn begin(&mut self, name: &str) {
        self.close();
        let name = Some(name.to_owned()).filter(|name| !name.is_empty());
        self.current = Some(ObjectInput {
            name,
            parts: Vec::new(),
        });
    }

    fn close(&mut self) {
        let Some(object) = self.current.take() else {
            return;
        };
        if self.keep_empty || !object.parts.is_empty() {
            self.first_serial += object.parts.len() as u32;
            self.scene.objects.push(object);
        }
    }

    fn face(&mut self, line: &Line<'_>) -> Result<(), Damage> {
        self.face.clear();
        for word in line.text.split_ascii_whitespace().skip(1) {
            let index = resolve(word, self.vertices_so_far, self.vertices.len())
                .ok_or_else(|| bad_index(line, word, self.vertices.len()))?;
            self.face.push(index);
        }
        let n = self.face.len();
        if n < 3 {
            let found = format!("a face with {n} corners, at least three are needed");
            return Err(Damage::broken(line.place(), found));
        }
        self.total.add(n)?;
        let object = self.current.get_or_insert_default();
        // The newest part is the likely one.
        let found = object
            .parts
            .iter()
            .rposition(|part| part.class == self.class);
        let at = found.unwrap_or_else(|| {
            object.parts.push(PartInput {
                class: self.class.clone(),
                ..PartInput::default()
            });
            object.parts.len() - 1
        });
        let part = &mut object.parts[at];
        let serial = self.first_serial + at as u32;
        for corner in &mut self.face {
            let copy = &mut self.copies[*corner as usize];
            if copy.0 != serial {
                *copy = (serial, part.vertices.len() as u32);
                part.vertices.push(self.vertices[*corner as usize]);
            }
            *corner = copy.1;
        }
        part.faces.push(&self.face);
        Ok(())
    }

    fn finish(mut self) -> SceneInput {
        self.close();
        self.scene
    }
}

/// The zero-based vertex of a corner such as `7`, `7/1/2` or `-1`.
fn resolve(word: &str, so_far: usize, all: usize) -> Option<u32> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = match number {
        0 => return None,
        n if n > 0 => usize::try_from(n - 1).ok()?,
        n => so_far.checked_sub(usize::try_from(n.unsigned_abs()).ok()?)?,
    };
    (index < all).then(|| u32::try_from(index).ok())?
}

fn bad_index(line: &Line<'_>, word: &str, vertices: usize) -> Damage {
    Damage::broken(
        line.place(),
        format!("the corner {word:?} names no vertex; the file has {vertices}, counted from 1"),
    )
}

#[cfg(test)]
mod tests {
    use super::read;
    use crate::Up;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn names(text: &str) -> Vec<(Option<String>, usize)> {
        let scene = read(text.as_bytes(), Up::Z).expect("valid");
        let faces = |o: &antumbra_scene::ObjectInput| o.parts.iter().map(|p| p.faces.len()).sum();
        scene
            .objects
            .iter()
            .map(|o| (o.name.clone(), faces(o)))
            .collect()
    }

    #[test]
    fn objects_come_in_order_and_stay_when_empty() {
        let text = format!(
            "{QUAD}f 1 2 3\no a b\ng ignored\nf 1 2 3\nf 1 3 4\no empty\no a b\nf 1 2 3 4\n"
        );
        let expected = [
            (None, 1),
            (Some("a b"), 2),
            (Some("empty"), 0),
            (Some("a b"), 1),
        ];
        assert_eq!(
            names(&text),
            expected.map(|(n, k)| (n.map(str::to_owned), k))
        );
    }

    #[test]
    fn groups_are_objects_where_there_are_no_others() {
        let text = format!("g default\n{QUAD}g left\nf 1 2 3\ng right\nf 1// 3/4 4/1/2\n");
        let expected = [(Some("left"), 1), (Some("right"), 1)];
        assert_eq!(
            names(&text),
            expected.map(|(n, k)| (n.map(str::to_owned), k))
        );
    }

    #[test]
    fn materials_split_an_object_into_parts() {
        let text = format!(
            "{QUAD}usemtl a\nf 1 2 3\nusemtl b c # no\nf -4 -2 \\\n -1\nusemtl a\nf 1 2 3 4\n"
        );
        let scene = read(text.as_bytes(), Up::Y).expect("valid");
        let parts = &scene.objects[0].parts;
        assert_eq!(parts.len(), 2);
        assert_eq!(
            (parts[0].class.as_deref(), parts[0].faces.len()),
            (Some("a"), 2)
        );
        assert_eq!(
            (parts[1].class.as_deref(), parts[1].faces.len()),
            (Some("b c"), 1)
        );
        assert_eq!(
            parts[1].vertices,
            [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
        );
    }

    #[test]
    fn damage_is_named_with_its_line() {
        let cases = [
            (
                "f 1 2 5\n",
                "line 5: the corner \"5\" names no vertex; the file has 4",
            ),
            ("f 1 2 0\n", "line 5: the corner \"0\""),
            ("f 1 2 -5\n", "line 5: the corner \"-5\""),
            ("f 1 2 x\n", "line 5: the corner \"x\""),
            ("f 1 2\n", "line 5: a face with 2 corners"),
            (
                "v 0 inf 0\n",
                "line 5: vertex 4 is (0, inf, 0), which is not finite",
            ),
            ("v 0 1\n", "line 5: a vertex needs three numbers"),
            ("f 1 2 3\0\n", "byte 39: a zero byte"),
        ];
        for (tail, expected) in cases {
            let damage = read(format!("{QUAD}{tail}").as_bytes(), Up::Z).expect_err(expected);
            assert!(damage.to_string().starts_with(expected), "{damage}");
        }
    }
}
