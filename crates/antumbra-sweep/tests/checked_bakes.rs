//! Bakes of many scenes, checked: the checker accepts what the engine proves, and no claim that
//! something visible is hidden.

use antumbra_kernel::{Aabb, Point};
use antumbra_scene::{
    CellKind, Faces, ObjectId, ObjectInput, PartInput, PolygonId, Scene, SceneBuilder, SceneInput,
    ViewCell,
};
use antumbra_sweep::{
    BakeOptions, Baker, CellProof, CellResult, Claim, GateProof, Node, Reason, Target, Tree,
    check_cell,
};
use antumbra_testkit::corpus;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 11
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn between(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low) as u64 + 1) as i64
    }
}

type Polygons = Vec<Vec<[i64; 3]>>;

/// Objects of polygons with grid coordinates.
fn scene(objects: &[Polygons]) -> Scene {
    let objects = objects
        .iter()
        .map(|polygons| {
            let mut part = PartInput::default();
            let mut faces = Faces::default();
            for polygon in polygons {
                let first = part.vertices.len() as u32;
                part.vertices
                    .extend(polygon.iter().map(|p| p.map(|c| c as f64)));
                faces.push(&(first..first + polygon.len() as u32).collect::<Vec<_>>());
            }
            part.faces = faces;
            ObjectInput {
                name: None,
                parts: vec![part],
            }
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: "test".into(),
    };
    let frame = ([-100_000.0; 3], [100_000.0; 3]);
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0))
        .cells_box(Some(frame))
        .build()
        .expect("a good scene");
    scene
}

fn triangles(
    random: &mut Random,
    count: usize,
    extent: i64,
    size: i64,
    raster: i64,
) -> Vec<Polygons> {
    (0..count)
        .map(|_| {
            let mut point =
                |c: [i64; 3], r: i64| c.map(|c| (c + random.between(-r, r)) / raster * raster);
            let center = point([0; 3], extent);
            vec![(0..3).map(|_| point(center, size)).collect()]
        })
        .collect()
}

/// Axis-parallel rectangles and boxes on a coarse raster: everything touches and is coplanar.
fn blocks(random: &mut Random, count: usize, extent: i64, raster: i64) -> Vec<Polygons> {
    (0..count)
        .map(|_| {
            let low: [i64; 3] = [0; 3].map(|_| random.between(-extent, extent) * raster);
            let mut high = low.map(|c| c + random.between(1, 4) * raster);
            let flat = random.below(4) as usize;
            if flat < 3 {
                high[flat] = low[flat];
            }
            let mut faces = Vec::new();
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                if flat < 3 && k != flat {
                    continue;
                }
                for at in [low[k], high[k]] {
                    let corner = |a: i64, b: i64| {
                        let mut p = [0; 3];
                        (p[k], p[i], p[j]) = (at, a, b);
                        p
                    };
                    faces.push(vec![
                        corner(low[i], low[j]),
                        corner(high[i], low[j]),
                        corner(high[i], high[j]),
                        corner(low[i], high[j]),
                    ]);
                    if flat < 3 {
                        break;
                    }
                }
            }
            faces
        })
        .collect()
}

fn box_cell(low: [i64; 3], size: i64) -> ViewCell {
    let p = |c: [i64; 3]| Point::new(c[0] as i32, c[1] as i32, c[2] as i32);
    ViewCell {
        name: format!("{low:?}"),
        bounds: Aabb::new(p(low), p(low.map(|c| c + size))),
        kind: CellKind::Box,
    }
}

fn object_cell(scene: &Scene, id: ObjectId) -> Option<ViewCell> {
    Some(ViewCell {
        name: format!("object {}", id.0),
        bounds: scene.object_bounds(id)?,
        kind: CellKind::Object(id),
    })
}

/// Bakes, checks and returns how many hidden objects were verified.
fn holds(scene: &Scene, cell: &ViewCell) -> u64 {
    let result = Baker::new(scene).bake_cell(cell, &BakeOptions::default());
    let report = check_cell(
        scene,
        cell,
        &result.visible,
        &result.unknown,
        result.accuracy,
        &result.proof,
    );
    assert!(report.failed.is_empty(), "{:#?}", report.failed);
    assert_eq!(report.visible_checked, result.visible.len() as u64);
    forged_claims_fail(scene, cell, &result);
    report.hidden_checked
}

/// Nothing visible passes for hidden: not uncovered, not with any other claim's reason, not by one
/// occluder, not as imaginary.
fn forged_claims_fail(scene: &Scene, cell: &ViewCell, result: &CellResult) {
    let proof = CellProof::from_bytes(&result.proof).expect("a certificate");
    let mut random = Random(77);
    for (i, entry) in result.visible.iter().enumerate().step_by(7) {
        let mut others = result.visible.clone();
        others.remove(i);
        let mut claims = Vec::new();
        for k in scene.object(entry.object).polygons.clone() {
            let target = Target::Polygon(PolygonId(k));
            let reason = match random.below(3) {
                0 if !proof.claims.is_empty() => proof.claims
                    [random.below(proof.claims.len() as u64) as usize]
                    .reason
                    .clone(),
                1 => Reason::Covered {
                    polygon: PolygonId(random.below(scene.polygon_count() as u64) as u32),
                },
                _ => {
                    let tree = Tree {
                        nodes: vec![Node::Imaginary],
                    };
                    let sources = match cell.kind {
                        CellKind::Box => 6,
                        CellKind::Object(id) => 2 * scene.polygons_of(id).count() as u32,
                    };
                    let gates = (0..2 * sources)
                        .map(|n| GateProof {
                            source: n / 2,
                            target: n % 2,
                            tree: tree.clone(),
                        })
                        .collect();
                    Reason::Gates(gates)
                }
            };
            claims.push(Claim { target, reason });
        }
        let forged = CellProof { claims }.to_bytes();
        let rest: Vec<ObjectId> = (0..scene.objects().len() as u32)
            .map(ObjectId)
            .filter(|id| *id != entry.object)
            .collect();
        let report = check_cell(scene, cell, &[], &rest, result.accuracy, &forged);
        assert_eq!(report.hidden_checked, 0, "object {}", entry.object.0);
        assert!(!report.failed.is_empty());
    }
}

#[test]
fn random_triangles() {
    let mut random = Random(3);
    let mut hidden = 0;
    for (count, size, raster) in [(60, 40_000, 1), (150, 30_000, 10_000), (300, 25_000, 1)] {
        let scene = scene(&triangles(&mut random, count, 100_000 - size, size, raster));
        for _ in 0..2 {
            let low = [0; 3].map(|_| random.between(-8, 8) * 5000);
            hidden += holds(&scene, &box_cell(low, 10_000));
        }
        for id in [1, 5, 9].map(ObjectId) {
            hidden += object_cell(&scene, id).map_or(0, |cell| holds(&scene, &cell));
        }
    }
    assert!(hidden > 20, "{hidden}");
}

#[test]
fn aligned_blocks() {
    let mut random = Random(9);
    let mut hidden = 0;
    for (count, extent, raster) in [(40, 4, 100), (120, 6, 100), (60, 4, 1)] {
        let scene = scene(&blocks(&mut random, count, extent, raster));
        for _ in 0..3 {
            let low = [0; 3].map(|_| random.between(-extent, extent) * raster);
            hidden += holds(&scene, &box_cell(low, raster));
        }
        for id in [1, 5, 9].map(ObjectId) {
            hidden += object_cell(&scene, id).map_or(0, |cell| holds(&scene, &cell));
        }
    }
    assert!(hidden > 100, "{hidden}");
}

/// The corpus: what it calls hidden is proved, what it calls visible is seen.
#[test]
fn the_corpus() {
    let mut checked = 0;
    for case in corpus::load() {
        let names = case.objects();
        let id = |name: &str| {
            let at = names.iter().position(|n| *n == name);
            ObjectId(at.expect("a name of the case") as u32)
        };
        let Some(scene) = corpus_scene(&case) else {
            continue;
        };
        for query in &case.queries {
            let cell = match &query.from {
                corpus::From::Cell { min, max } => {
                    let p = |c: &[i64; 3]| {
                        let c = c.map(|c| c as f64);
                        scene.grid().snap(c).expect("on the grid")
                    };
                    ViewCell {
                        bounds: Aabb::new(p(min), p(max)),
                        ..box_cell([0; 3], 1)
                    }
                }
                corpus::From::Object(name) => object_cell(&scene, id(name)).expect("polygons"),
            };
            let result = Baker::new(&scene).bake_cell(&cell, &BakeOptions::default());
            let report = check_cell(
                &scene,
                &cell,
                &result.visible,
                &result.unknown,
                result.accuracy,
                &result.proof,
            );
            assert!(
                report.failed.is_empty(),
                "{}: {:#?}",
                case.name,
                report.failed
            );
            let object = id(&query.to);
            let seen = result.visible.iter().find(|v| v.object == object);
            // Touching a source object makes visible, whatever a pair says.
            if seen.is_none_or(|v| !v.touching || query.touching) {
                let expected = query.expect == corpus::Expect::Visible;
                assert_eq!(seen.is_some(), expected, "{}: {}", case.name, query.why);
                checked += 1;
            }
            forged_claims_fail(&scene, &cell, &result);
        }
    }
    assert!(checked > 50, "{checked}");
}

/// The scene of a case on a grid of its unit; `None` if it needs the grid's last units, which the
/// builder keeps free.
fn corpus_scene(case: &corpus::Case) -> Option<Scene> {
    let objects = case.objects().into_iter().map(|name| {
        let polygons = case.polygons_of(name).map(|i| &case.polygons[i]);
        let parts = polygons.map(|polygon| {
            let mut faces = Faces::default();
            faces.push(&(0..polygon.corners.len() as u32).collect::<Vec<_>>());
            PartInput {
                translucent: !polygon.occludes,
                vertices: polygon
                    .corners
                    .iter()
                    .map(|p| p.map(|c| c as f64))
                    .collect(),
                faces,
                ..Default::default()
            }
        });
        ObjectInput {
            name: Some(name.into()),
            parts: parts.collect(),
        }
    });
    let input = SceneInput {
        objects: objects.collect(),
        source_name: case.name.clone(),
    };
    let (scene, _) = SceneBuilder::new(input).grid(Some(1.0)).build().ok()?;
    Some(scene)
}

/// Bytes of a real certificate with random damage: no panic, and nothing hidden that is visible.
#[test]
fn damaged_certificates() {
    let mut random = Random(21);
    let scene = scene(&blocks(&mut random, 60, 5, 100));
    let cell = box_cell([0, 0, 0], 100);
    let result = Baker::new(&scene).bake_cell(&cell, &BakeOptions::default());
    let visible: Vec<bool> = (0..scene.objects().len() as u32)
        .map(|k| result.visible.iter().any(|v| v.object.0 == k))
        .collect();
    for _ in 0..300 {
        let mut bytes = result.proof.clone();
        for _ in 0..1 + random.below(3) {
            let at = random.below(bytes.len() as u64) as usize;
            match random.below(3) {
                0 => bytes[at] = random.next() as u8,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, random.below(12) as u8),
            }
        }
        // Everything is said to be hidden.
        let report = check_cell(&scene, &cell, &[], &[], result.accuracy, &bytes);
        let refused = report
            .failed
            .iter()
            .filter(|f| f.contains("listed"))
            .count();
        let seen = visible.iter().filter(|v| **v).count();
        assert!(report.hidden_checked == 0 || refused >= seen, "{report:?}");
    }
}
