//! PLY, text and binary in both byte orders: one object with the faces of the `face` element.

use antumbra_scene::{ObjectInput, PartInput, SceneInput};

use crate::bytes::Cursor;
use crate::error::{CornerCount, Damage, Place, check_finite};
use crate::read::Up;

pub(crate) fn read(bytes: &[u8], up: Up) -> Result<SceneInput, Damage> {
    let (header, body) = Header::parse(bytes)?;
    let mut values = Values::new(&header, bytes, body);
    let mut part = PartInput::default();
    let mut total = CornerCount::default();
    let mut faces = Vec::new();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, up, &mut part)?,
            "face" => read_faces(element, &mut values, &mut total, &mut faces)?,
            _ => skip(element, &mut values)?,
        }
    }
    // Faces may stand before the vertices, so indices are checked last.
    for (i, face) in faces.iter().enumerate() {
        if let Some(bad) = face.iter().find(|v| **v as usize >= part.vertices.len()) {
            let found = format!(
                "vertex {bad} does not exist, there are {}",
                part.vertices.len()
            );
            return Err(Damage::broken(
                Place::Item {
                    list: "face",
                    index: i as u64,
                },
                found,
            ));
        }
        part.faces.push(face);
    }
    Ok(SceneInput {
        objects: vec![ObjectInput {
            name: None,
            parts: vec![part],
        }],
        source_name: String::new(),
    })
}

fn read_vertices(
    element: &Element,
    values: &mut Values<'_>,
    up: Up,
    part: &mut PartInput,
) -> Result<(), Damage> {
    let axis = |name: &str| {
        let found = element
            .properties
            .iter()
            .position(|p| p.name == name && p.list.is_none());
        found.ok_or_else(|| {
            Damage::broken(
                Place::Whole,
                format!("the vertices have no property {name:?}"),
            )
        })
    };
    let axes = [axis("x")?, axis("y")?, axis("z")?];
    part.vertices.reserve(values.at_most(element.count));
    for i in 0..element.count {
        let mut point = [0.0; 3];
        for (k, property) in element.properties.iter().enumerate() {
            let place = Place::Item {
                list: "vertex",
                index: i,
            };
            if let Some(count) = property.list {
                let n = values.length(count, &place)?;
                for _ in 0..n {
                    values.next(property.kind, &place)?;
                }
                continue;
            }
            let value = values.next(property.kind, &place)?;
            if let Some(axis) = axes.iter().position(|a| *a == k) {
                point[axis] = value;
            }
        }
        check_finite(point, || Place::Whole, i)?;
        part.vertices.push(up.turn(point));
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    values: &mut Values<'_>,
    total: &mut CornerCount,
    faces: &mut Vec<Vec<u32>>,
) -> Result<(), Damage> {
    let is_indices =
        |p: &Property| p.list.is_some() && (p.name == "vertex_indices" || p.name == "vertex_index");
    let Some(indices) = element.properties.iter().position(is_indices) else {
        return Err(Damage::broken(
            Place::Whole,
            "the faces have no list `vertex_indices`",
        ));
    };
    for i in 0..element.count {
        let place = Place::Item {
            list: "face",
            index: i,
        };
        for (k, property) in element.properties.iter().enumerate() {
            let n = match property.list {
                Some(count) => values.length(count, &place)?,
                None => 1,
            };
            let mut face = Vec::new();
            for _ in 0..n {
                let value = values.next(property.kind, &place)?;
                if k == indices {
                    if !(0.0..=f64::from(u32::MAX)).contains(&value) || value.fract() != 0.0 {
                        return Err(Damage::broken(
                            place,
                            format!("{value} is no vertex number"),
                        ));
                    }
                    face.push(value as u32);
                }
            }
            if k == indices {
                if face.len() < 3 {
                    let found = format!("{} corners, at least three are needed", face.len());
                    return Err(Damage::broken(place, found));
                }
                total.add(face.len())?;
                faces.push(face);
            }
        }
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), Damage> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for i in 0..element.count {
        let place = Place::Item {
            list: "entry of another element,",
            index: i,
        };
        for property in &element.properties {
            let n = match property.list {
                Some(count) => values.length(count, &place)?,
                None => 1,
            };
            for _ in 0..n {
                values.next(property.kind, &place)?;
            }
        }
    }
    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }
}

struct Property {
    name: String,
    kind: Kind,
    /// The type of the length, if this is a list.
    list: Option<Kind>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
}

impl Header {
    /// The header, and where the data begins.
    fn parse(bytes: &[u8]) -> Result<(Self, usize), Damage> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut at = 0;
        for number in 1_u64.. {
            let place = Place::Line(number);
            let rest = &bytes[at..];
            let Some(end) = rest.iter().position(|b| *b == b'\n') else {
                return Err(Damage::broken(place, "the file ends before `end_header`"));
            };
            at += end + 1;
            let line = String::from_utf8_lossy(&rest[..end]);
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["ply"] | ["comment" | "obj_info", ..] => {}
                ["format", name, ..] => {
                    encoding = Some(match name {
                        "ascii" => Encoding::Text,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => {
                            return Err(Damage::broken(
                                place,
                                format!("the format {name:?} does not exist"),
                            ));
                        }
                    });
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| {
                        Damage::broken(place, format!("{count:?} is no number of elements"))
                    })?;
                    elements.push(Element {
                        name: name.to_owned(),
                        count,
                        properties: Vec::new(),
                    });
                }
                ["property", "list", count, kind, name] => {
                    let list = Some(parse_kind(count, &place)?);
                    let kind = parse_kind(kind, &place)?;
                    push_property(
                        &mut elements,
                        Property {
                            name: name.to_owned(),
                            kind,
                            list,
                        },
                        place,
                    )?;
                }
                ["property", kind, name] => {
                    let kind = parse_kind(kind, &place)?;
                    let property = Property {
                        name: name.to_owned(),
                        kind,
                        list: None,
                    };
                    push_property(&mut elements, property, place)?;
                }
                ["end_header"] => break,
                _ => {
                    let found = format!("{:?} is no header line", line.trim());
                    return Err(Damage::broken(place, found));
                }
            }
        }
        let Some(encoding) = encoding else {
            return Err(Damage::broken(
                Place::Whole,
                "the header has no `format` line",
            ));
        };
        Ok((Self { encoding, elements }, at))
    }
}

fn parse_kind(name: &str, place: &Place) -> Result<Kind, Damage> {
    Kind::parse(name)
        .ok_or_else(|| Damage::broken(place.clone(), format!("{name:?} is no PLY type")))
}

fn push_property(elements: &mut [Element], property: Property, place: Place) -> Result<(), Damage> {
    let Some(element) = elements.last_mut() else {
        return Err(Damage::broken(place, "a property before the first element"));
    };
    element.properties.push(property);
    Ok(())
}

/// The numbers of the body, whatever their encoding.
enum Values<'a> {
    Text {
        words: std::str::SplitAsciiWhitespace<'a>,
        bytes: usize,
    },
    Binary {
        cursor: Cursor<'a>,
        start: usize,
        big: bool,
    },
    /// Text that is not text.
    Broken { at: usize },
}

impl<'a> Values<'a> {
    fn new(header: &Header, bytes: &'a [u8], start: usize) -> Self {
        let body = &bytes[start..];
        match header.encoding {
            Encoding::Text => match std::str::from_utf8(body) {
                Ok(text) => Self::Text {
                    words: text.split_ascii_whitespace(),
                    bytes: body.len(),
                },
                Err(error) => Self::Broken {
                    at: start + error.valid_up_to(),
                },
            },
            encoding => Self::Binary {
                cursor: Cursor::new(body),
                start,
                big: encoding == Encoding::Big,
            },
        }
    }

    /// A room to reserve for `count` items: not more than the body can hold.
    fn at_most(&self, count: u64) -> usize {
        let room = match self {
            Self::Text { bytes, .. } => *bytes,
            Self::Binary { cursor, .. } => cursor.remaining(),
            Self::Broken { .. } => 0,
        };
        usize::try_from(count).unwrap_or(usize::MAX).min(room / 3)
    }

    fn length(&mut self, kind: Kind, place: &Place) -> Result<u64, Damage> {
        let value = self.next(kind, place)?;
        if value < 0.0 || value.fract() != 0.0 {
            return Err(Damage::broken(
                place.clone(),
                format!("{value} is no length of a list"),
            ));
        }
        Ok(value as u64)
    }

    /// The next number. All PLY types fit a double exactly.
    fn next(&mut self, kind: Kind, place: &Place) -> Result<f64, Damage> {
        let ended = || Damage::broken(place.clone(), "the file ends here");
        match self {
            Self::Text { words, .. } => {
                let word = words.next().ok_or_else(ended)?;
                word.parse()
                    .map_err(|_| Damage::broken(place.clone(), format!("{word:?} is no number")))
            }
            Self::Binary { cursor, start, big } => {
                let at = *start + cursor.offset();
                binary(cursor, kind, *big).ok_or_else(|| {
                    Damage::broken(place.clone(), format!("the file ends at byte {at}"))
                })
            }
            Self::Broken { at } => Err(Damage::broken(
                Place::Byte(*at as u64),
                "this is not text, as the header says",
            )),
        }
    }
}

fn binary(cursor: &mut Cursor<'_>, kind: Kind, big: bool) -> Option<f64> {
    fn ordered<const N: usize>(cursor: &mut Cursor<'_>, big: bool) -> Option<[u8; N]> {
        let mut bytes = cursor.array::<N>()?;
        if big {
            bytes.reverse();
        }
        Some(bytes)
    }
    Some(match kind {
        Kind::I8 => f64::from(i8::from_le_bytes(ordered(cursor, big)?)),
        Kind::U8 => f64::from(u8::from_le_bytes(ordered(cursor, big)?)),
        Kind::I16 => f64::from(i16::from_le_bytes(ordered(cursor, big)?)),
        Kind::U16 => f64::from(u16::from_le_bytes(ordered(cursor, big)?)),
        Kind::I32 => f64::from(i32::from_le_bytes(ordered(cursor, big)?)),
        Kind::U32 => f64::from(u32::from_le_bytes(ordered(cursor, big)?)),
        Kind::F32 => f64::from(f32::from_le_bytes(ordered(cursor, big)?)),
        Kind::F64 => f64::from_le_bytes(ordered(cursor, big)?),
    })
}

#[cfg(test)]
mod tests {
    use super::read;
    use crate::Up;

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty uchar red\nproperty float y\nproperty double z\nelement face 2\nproperty list uchar int vertex_indices\nproperty int tag\nelement edge 1\nproperty int a\nend_header\n0 9 0 0\n1 9 0 0\n1 9 1 0.5\n0 9 1 0\n3 0 1 2 7\n4 0 1 2 3 7\n5\n";

    fn binary(big: bool) -> Vec<u8> {
        let name = if big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let header = TEXT
            .split_inclusive('\n')
            .take(14)
            .collect::<String>()
            .replace("ascii", name);
        let mut bytes = header.into_bytes();
        let mut put = |value: &[u8]| {
            let mut value = value.to_vec();
            if big {
                value.reverse();
            }
            bytes.extend(value);
        };
        for [x, y, z] in [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.5],
            [0.0, 1.0, 0.0_f32],
        ] {
            put(&x.to_le_bytes());
            put(&[9]);
            put(&y.to_le_bytes());
            put(&f64::from(z).to_le_bytes());
        }
        for face in [&[0_i32, 1, 2][..], &[0, 1, 2, 3]] {
            put(&[face.len() as u8]);
            for v in face.iter().chain(&[7]) {
                put(&v.to_le_bytes());
            }
        }
        put(&5_i32.to_le_bytes());
        bytes
    }

    #[test]
    fn all_encodings_give_the_same_scene() {
        let text = read(TEXT.as_bytes(), Up::Z).expect("valid");
        let part = &text.objects[0].parts[0];
        assert_eq!(part.vertices[2], [1.0, 1.0, 0.5]);
        assert_eq!(
            part.faces.iter().collect::<Vec<_>>(),
            [&[0, 1, 2][..], &[0, 1, 2, 3]]
        );
        assert_eq!(read(&binary(false), Up::Z).expect("valid"), text);
        assert_eq!(read(&binary(true), Up::Z).expect("valid"), text);
    }

    #[test]
    fn damage_is_named_with_its_place() {
        let cases = [
            (
                "3 0 1 2 7",
                "3 0 1 4 7",
                "face 0: vertex 4 does not exist, there are 4",
            ),
            ("3 0 1 2 7", "3 0 1 -1 7", "face 0: -1 is no vertex number"),
            ("1 9 1 0.5", "1 9 nan 0.5", "vertex 2 is (1, NaN, 0.5)"),
            ("1 9 1 0.5", "1 9 x 0.5", "vertex 2: \"x\" is no number"),
            ("vertex 4", "vertex 400", "vertex 7: the file ends here"),
            ("format ascii 1.0\n", "", "the header has no `format` line"),
            (
                "end_header",
                "end_headers",
                "line 14: \"end_headers\" is no header line",
            ),
            ("float x", "floaty x", "line 5: \"floaty\" is no PLY type"),
            ("float x", "float q", "the vertices have no property \"x\""),
        ];
        for (from, to, expected) in cases {
            let damage = read(TEXT.replace(from, to).as_bytes(), Up::Z)
                .expect_err(expected)
                .to_string();
            assert!(damage.starts_with(expected), "{damage}");
        }
        let bytes = binary(false);
        let damage = read(&bytes[..bytes.len() - 6], Up::Z)
            .expect_err("truncated")
            .to_string();
        assert!(
            damage.starts_with("face 1: the file ends at byte"),
            "{damage}"
        );
    }
}
