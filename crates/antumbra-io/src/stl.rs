//! STL, text and binary: bare triangles. A binary file is one object, a text file one for each
//! `solid`.

use antumbra_scene::{ObjectInput, PartInput, SceneInput};

use crate::error::{CornerCount, Damage, Place, check_finite};
use crate::format::binary_stl_facets;
use crate::read::Up;

/// Bytes before the facet list of a binary file, and bytes a facet.
const HEADER: usize = 84;
const FACET: usize = 50;

pub(crate) fn read(bytes: &[u8], up: Up) -> Result<SceneInput, Damage> {
    let exact = binary_stl_facets(bytes)
        .is_some_and(|n| bytes.len() as u64 == (HEADER as u64) + FACET as u64 * n);
    let text = bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .trim_ascii_start();
    if !exact && text.starts_with(b"solid") {
        read_text(bytes, up)
    } else {
        read_binary(bytes, up)
    }
}

fn read_binary(bytes: &[u8], up: Up) -> Result<SceneInput, Damage> {
    let Some(count) = binary_stl_facets(bytes) else {
        let found = format!(
            "{} bytes are too few for the {HEADER}-byte header of a binary STL file",
            bytes.len()
        );
        return Err(Damage::broken(Place::Whole, found));
    };
    let body = &bytes[HEADER..];
    if (body.len() as u64) < count * FACET as u64 {
        let found = format!(
            "the header promises {count} facets, but the file ends inside facet {} of them",
            body.len() / FACET
        );
        return Err(Damage::broken(Place::Byte(bytes.len() as u64), found));
    }
    CornerCount::default().add((count as usize).saturating_mul(3))?;
    let mut part = PartInput::default();
    for (i, facet) in body.chunks_exact(FACET).take(count as usize).enumerate() {
        // 12 floats: the normal (ignored, it follows from the corners), then three corners.
        let float = |k: usize| {
            f64::from(f32::from_le_bytes([
                facet[k],
                facet[k + 1],
                facet[k + 2],
                facet[k + 3],
            ]))
        };
        let corners = [12, 24, 36].map(|k| [float(k), float(k + 4), float(k + 8)]);
        for (k, corner) in corners.into_iter().enumerate() {
            check_finite(
                corner,
                || Place::Byte((HEADER + FACET * i + 12 * (k + 1)) as u64),
                3 * i as u64 + k as u64,
            )?;
        }
        push_facet(&mut part, &corners, up);
    }
    Ok(SceneInput {
        objects: vec![ObjectInput {
            name: None,
            parts: vec![part],
        }],
        source_name: String::new(),
    })
}

fn read_text(bytes: &[u8], up: Up) -> Result<SceneInput, Damage> {
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}');
    let mut objects: Vec<ObjectInput> = Vec::new();
    let mut part: Option<PartInput> = None;
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut total = CornerCount::default();
    let mut last_line = 0;
    for (i, line) in text.lines().enumerate() {
        let place = || Place::Line(i as u64 + 1);
        last_line = i as u64 + 1;
        let mut words = line.split_ascii_whitespace();
        let outside = |what: &str| Damage::broken(place(), format!("`{what}` outside of a solid"));
        match words.next().unwrap_or_default() {
            "" | "outer" | "endloop" => {}
            "solid" => {
                if part.is_some() {
                    return Err(Damage::broken(
                        place(),
                        "a `solid` begins inside another one",
                    ));
                }
                let name = words.collect::<Vec<_>>().join(" ");
                objects.push(ObjectInput {
                    name: (!name.is_empty()).then_some(name),
                    parts: Vec::new(),
                });
                part = Some(PartInput::default());
            }
            "facet" => {
                part.as_ref().ok_or_else(|| outside("facet"))?;
                corners.clear();
            }
            "vertex" => {
                part.as_ref().ok_or_else(|| outside("vertex"))?;
                let mut point = [0.0; 3];
                for c in &mut point {
                    let word = words.next().unwrap_or_default();
                    *c = word.parse().map_err(|_| {
                        Damage::broken(
                            place(),
                            format!("a vertex needs three numbers, found {word:?}"),
                        )
                    })?;
                }
                check_finite(point, place, corners.len() as u64)?;
                corners.push(point);
            }
            "endfacet" => {
                let part = part.as_mut().ok_or_else(|| outside("endfacet"))?;
                if corners.len() < 3 {
                    let found =
                        format!("a facet with {} vertices, three are needed", corners.len());
                    return Err(Damage::broken(place(), found));
                }
                total.add(corners.len())?;
                push_facet(part, &corners, up);
                corners.clear();
            }
            "endsolid" => {
                let part = part.take().ok_or_else(|| outside("endsolid"))?;
                if let Some(object) = objects.last_mut() {
                    object.parts.push(part);
                }
            }
            word => {
                let found = format!("{word:?} is no STL keyword");
                return Err(Damage::new(
                    place(),
                    found,
                    "give a text STL file of facets and vertices",
                ));
            }
        }
    }
    if part.is_some() {
        return Err(Damage::broken(
            Place::Line(last_line),
            "the file ends before `endsolid`",
        ));
    }
    Ok(SceneInput {
        objects,
        source_name: String::new(),
    })
}

fn push_facet(part: &mut PartInput, corners: &[[f64; 3]], up: Up) {
    let first = part.vertices.len() as u32;
    part.vertices.extend(corners.iter().map(|c| up.turn(*c)));
    let face: Vec<u32> = (first..first + corners.len() as u32).collect();
    part.faces.push(&face);
}

#[cfg(test)]
mod tests {
    use antumbra_scene::Faces;

    use super::read;
    use crate::Up;

    const TEXT: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0.5\n  endloop\n endfacet\nendsolid a b\n";

    fn binary(corners: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes.extend((corners.len() as u32 / 3).to_le_bytes());
        for facet in corners.chunks(3) {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flatten().flat_map(|c| c.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_give_the_same_faces() {
        let text = read(TEXT.as_bytes(), Up::Z).expect("valid");
        let bytes = binary(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]);
        let binary = read(&bytes, Up::Z).expect("valid");
        assert_eq!(text.objects[0].name.as_deref(), Some("a b"));
        assert_eq!(text.objects[0].parts, binary.objects[0].parts);
        assert_eq!(
            text.objects[0].parts[0].faces,
            Faces::from_iter([[0, 1, 2]])
        );
        let turned = read(&bytes, Up::Y).expect("valid");
        assert_eq!(turned.objects[0].parts[0].vertices[2], [0.0, -0.5, 1.0]);
    }

    #[test]
    fn damage_is_named_with_its_place() {
        let cases = [
            (
                TEXT.replace("vertex 1 0 0", "vertex 1 nan 0"),
                "line 5: vertex 1 is (1, NaN, 0)",
            ),
            (
                TEXT.replace("vertex 1 0 0", "vertex 1 0"),
                "line 5: a vertex needs three numbers",
            ),
            (
                TEXT.replace("   vertex 1 0 0\n", ""),
                "line 7: a facet with 2 vertices",
            ),
            (
                TEXT.replace("endsolid a b\n", ""),
                "line 8: the file ends before `endsolid`",
            ),
            (
                TEXT.replace("facet normal", "fact normal"),
                "line 2: \"fact\" is no STL keyword",
            ),
        ];
        for (text, expected) in cases {
            let damage = read(text.as_bytes(), Up::Z)
                .expect_err(expected)
                .to_string();
            assert!(damage.starts_with(expected), "{damage}");
        }
        let mut bytes = binary(&[[0.0; 3], [f32::INFINITY, 0.0, 0.0], [1.0; 3]]);
        let damage = read(&bytes, Up::Z).expect_err("infinite").to_string();
        assert!(
            damage.starts_with("byte 108: vertex 1 is (inf, 0, 0)"),
            "{damage}"
        );
        bytes.truncate(100);
        let damage = read(&bytes, Up::Z).expect_err("truncated").to_string();
        assert!(
            damage.starts_with("byte 100: the header promises 1 facets"),
            "{damage}"
        );
    }
}
