//! Small scenes full of degeneracies, for properties: a few polygons on a coarse raster, so that
//! shared edges, common planes, crossings and coincidences are the rule.
//!
//! `ANTUMBRA_SEED` starts another sequence of scenes, `ANTUMBRA_CASES` asks for another number.

use std::cell::Cell;
use std::fmt;

use antumbra::region::BakeOptions;
use antumbra::scene::{
    BuildReport, CellKind, Faces, ObjectId, ObjectInput, PartInput, Scene, SceneBuilder,
    SceneInput, ViewCell,
};
use antumbra_kernel::{Aabb, Point};
use antumbra_testkit::corpus::{Case, Expect, From, Query};
use antumbra_testkit::environment::long;
use antumbra_testkit::scene::Polygon;
use antumbra_testkit::segment::normal;
use dashu_int::IBig;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use crate::scenes::note;

/// Of this many scenes with coordinates one step off the raster, one may hold an object whose free
/// lines are too thin for a line through fine points. On the raster nothing may be unknown.
const RARE: u32 = 300;
/// The frame that all these scenes lie in, so that their grids are the same.
const FRAME: f64 = 4_000_000.0;

/// A small scene, a cell, and the chances that its laws take.
#[derive(Clone)]
pub(crate) struct Small {
    pub case: Case,
    /// A box.
    pub cell: [[i64; 3]; 2],
    /// A polygon to be added.
    pub extra: Vec<[i64; 3]>,
    /// Whether some coordinates are one grid step off the raster.
    pub jittered: bool,
    /// What everything else that is random depends on.
    pub seed: u64,
}

impl fmt::Debug for Small {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "seed {}, extra {:?}", self.seed, self.extra)?;
        writeln!(f, "about = \"\"")?;
        for p in &self.case.polygons {
            writeln!(
                f,
                "\n[[polygon]]\nobject = {:?}\ncorners = {:?}",
                p.object, p.corners
            )?;
            if !p.occludes {
                writeln!(f, "occludes = false")?;
            }
        }
        let [min, max] = self.cell;
        writeln!(f, "\n[[query]]\nkind = \"pair\"\nfrom = \"a\"\nto = \"b\"")?;
        writeln!(
            f,
            "\n[[query]]\nkind = \"cell\"\nmin = {min:?}\nmax = {max:?}"
        )
    }
}

/// How coarse a scene is.
#[derive(Clone, Copy, Debug)]
struct Raster {
    reach: i64,
    step: i64,
    /// Whether coordinates may be one grid step off the raster.
    jitter: bool,
}

fn raster() -> impl Strategy<Value = Raster> {
    let reach = prop_oneof![Just(1_i64), Just(2), Just(4)];
    let step = prop_oneof![Just(1_i64), Just(6), Just(256), Just(100_000)];
    (reach, step, any::<bool>()).prop_map(|(reach, step, jitter)| Raster {
        reach,
        step,
        jitter: jitter && step > 6,
    })
}

fn coordinate(raster: Raster) -> impl Strategy<Value = i64> {
    let off = i64::from(raster.jitter);
    let off = prop_oneof![3 => Just(0_i64), 1 => -off..=off];
    (-raster.reach..=raster.reach, off).prop_map(move |(c, off)| c * raster.step + off)
}

fn point(raster: Raster) -> impl Strategy<Value = [i64; 3]> {
    [coordinate(raster), coordinate(raster), coordinate(raster)]
}

/// A rectangle in a plane of the raster, a triangle, or a parallelogram.
fn polygon(raster: Raster) -> impl Strategy<Value = Vec<[i64; 3]>> {
    let rectangle = (0..3_usize, point(raster), point(raster)).prop_map(|(axis, a, b)| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        [(a[i], a[j]), (b[i], a[j]), (b[i], b[j]), (a[i], b[j])]
            .map(|(u, v)| {
                let mut p = a;
                (p[i], p[j]) = (u, v);
                p
            })
            .to_vec()
    });
    let triangle = [point(raster), point(raster), point(raster)].prop_map(|t| t.to_vec());
    let corner = [point(raster), point(raster), point(raster)];
    let parallelogram = corner.prop_map(|[p, u, v]| {
        let sum = std::array::from_fn(|k| u[k] + v[k] - p[k]);
        vec![p, u, sum, v]
    });
    prop_oneof![3 => rectangle, 3 => triangle, 1 => parallelogram]
        .prop_filter("no area", |c| normal(c).iter().any(|n| *n != IBig::ZERO))
}

/// Object a, object b, and others.
fn scene(raster: Raster, most: usize) -> impl Strategy<Value = Case> {
    let polygon = move || (polygon(raster), prop::bool::weighted(0.9));
    let ends = move || prop::collection::vec(polygon(), 1..=2);
    let others = prop::collection::vec(polygon(), 0..=most);
    (ends(), ends(), others, any::<bool>()).prop_map(|(a, b, others, joined)| {
        let mut polygons = Vec::new();
        let mut push = |object: String, (corners, occludes)| {
            polygons.push(Polygon {
                object,
                corners,
                occludes,
            });
        };
        a.into_iter().for_each(|p| push("a".to_owned(), p));
        b.into_iter().for_each(|p| push("b".to_owned(), p));
        for (i, p) in others.into_iter().enumerate() {
            // Some objects have several polygons.
            let number = if joined { i / 3 } else { i };
            push(format!("o{number}"), p);
        }
        let query = Query {
            from: From::Object("a".to_owned()),
            to: "b".to_owned(),
            expect: Expect::Hidden,
            touching: false,
            conservative: false,
            witness: None,
            why: String::new(),
        };
        Case {
            name: "small".to_owned(),
            about: String::new(),
            polygons,
            queries: vec![query],
        }
    })
}

/// All of it, with at most some polygons besides source and target.
pub(crate) fn small(most: usize) -> impl Strategy<Value = Small> {
    raster().prop_flat_map(move |raster| {
        let cell = (point(raster), point(raster)).prop_map(move |(a, b)| {
            let low: [i64; 3] = std::array::from_fn(|k| a[k].min(b[k]));
            let high: [i64; 3] = std::array::from_fn(|k| a[k].max(b[k]));
            // A cell has a volume.
            [
                low,
                std::array::from_fn(|k| high[k].max(low[k] + raster.step)),
            ]
        });
        (scene(raster, most), cell, polygon(raster), any::<u64>()).prop_map(
            move |(case, cell, extra, seed)| Small {
                case,
                cell,
                extra,
                seed,
                jittered: raster.jitter,
            },
        )
    })
}

/// Runs a property on many small scenes; the sequence depends on nothing but the environment.
pub(crate) fn for_all(
    most: usize,
    (short, slow): (u32, u32),
    property: impl Fn(&Small) -> Result<(), String>,
) {
    let number = |name: &str| std::env::var(name).ok().and_then(|v| v.parse::<u64>().ok());
    let default = if long() { slow } else { short };
    let cases = number("ANTUMBRA_CASES").map_or(default, |c| c as u32);
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&number("ANTUMBRA_SEED").unwrap_or(1).to_le_bytes());
    let config = Config {
        cases,
        failure_persistence: None,
        max_local_rejects: u32::MAX,
        max_shrink_iters: 4000,
        ..Config::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let unknown = Cell::new(0_u32);
    let outcome = runner.run(&small(most), |s| match property(&s) {
        Err(why) if s.jittered && why.contains("unknown") => {
            unknown.set(unknown.get() + 1);
            Ok(())
        }
        other => other.map_err(TestCaseError::fail),
    });
    let unknown = unknown.get();
    note(&format!(
        "{cases} small scenes, {unknown} of them with something unknown"
    ));
    if let Err(why) = outcome {
        panic!("{why}");
    }
    assert!(unknown * RARE <= cases, "too often unknown: {unknown}");
}

/// Builds a small scene on a grid of step 1.
pub(crate) fn build(case: &Case) -> Scene {
    construct(case).0
}

fn construct(case: &Case) -> (Scene, BuildReport) {
    let part = |i: usize| {
        let polygon = &case.polygons[i];
        let mut faces = Faces::default();
        faces.push(&(0..polygon.corners.len() as u32).collect::<Vec<_>>());
        PartInput {
            class: None,
            translucent: !polygon.occludes,
            vertices: polygon
                .corners
                .iter()
                .map(|c| c.map(|v| v as f64))
                .collect(),
            faces,
        }
    };
    let objects = case
        .objects()
        .into_iter()
        .map(|name| ObjectInput {
            name: Some(name.to_owned()),
            parts: case.polygons_of(name).map(part).collect(),
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: case.name.clone(),
    };
    let (scene, report) = SceneBuilder::new(input)
        .grid(Some(1.0))
        .cells_box(Some(([-FRAME; 3], [FRAME; 3])))
        .build()
        .unwrap_or_else(|e| panic!("{e}"));
    scene.sanity_check().unwrap_or_else(|e| panic!("{e}"));
    (scene, report)
}

/// An object by name.
pub(crate) fn object(scene: &Scene, name: &str) -> Option<ObjectId> {
    scene
        .find_object(name)
        .filter(|id| !scene.object(*id).polygons.is_empty())
}

/// A box as a view cell.
pub(crate) fn cell([min, max]: [[i64; 3]; 2]) -> ViewCell {
    let p = |c: [i64; 3]| Point::from(c.map(|v| v as i32));
    ViewCell {
        name: "small".to_owned(),
        bounds: Aabb::new(p(min), p(max)),
        kind: CellKind::Box,
    }
}

/// Options with a seed.
pub(crate) fn seeded(seed: u64) -> BakeOptions {
    BakeOptions {
        seed,
        ..BakeOptions::default()
    }
}

/// The case itself if the builder has nothing to repair; else every polygon as an object of its
/// own, for what closes a slit of one grid step may depend on the order of polygons.
pub(crate) fn unrepaired(case: &Case) -> Case {
    if construct(case).1.totals().is_empty() {
        return case.clone();
    }
    let mut other = case.clone();
    for object in ["a", "b"] {
        let mut first = true;
        other
            .polygons
            .retain(|p| p.object != object || std::mem::take(&mut first));
    }
    for (i, p) in other.polygons.iter_mut().enumerate() {
        if p.object.starts_with('o') {
            p.object = format!("o{i}");
        }
    }
    other
}

/// The same case with each occluder besides a and b cut into triangles that are objects of their own.
pub(crate) fn cut_up(case: &Case) -> Case {
    let mut other = case.clone();
    other.polygons.clear();
    for (i, p) in case.polygons.iter().enumerate() {
        if p.object == "a" || p.object == "b" {
            other.polygons.push(p.clone());
            continue;
        }
        // A point on an edge, if the grid has one there, makes a T-vertex.
        let c = &p.corners;
        let mut corners = c.clone();
        if (0..3).all(|k| (c[0][k] + c[1][k]) % 2 == 0) {
            corners.insert(1, std::array::from_fn(|k| (c[0][k] + c[1][k]) / 2));
        }
        for (j, pair) in corners[1..].windows(2).enumerate() {
            let corners = vec![corners[0], pair[0], pair[1]];
            if normal(&corners).iter().any(|n| *n != IBig::ZERO) {
                other.polygons.push(Polygon {
                    object: format!("piece{i}-{j}"),
                    corners,
                    occludes: p.occludes,
                });
            }
        }
    }
    other
}
