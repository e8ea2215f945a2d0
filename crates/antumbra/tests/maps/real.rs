//! Measured buildings and levels, where they are at hand; random triangles that cross.

use antumbra::map::{Dissolve, MapOptions, Mapper, Viewpoint};
use antumbra::scene::synth::{TriangleParams, random_triangles};
use antumbra::scene::{PolygonId, Scene, SceneBuilder};
use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::item_buffer::{Camera, ItemBuffer};
use antumbra_testkit::random::Random;
use antumbra_testkit::ray_caster::{RayCaster, Triangle};
use dashu_int::IBig;

use crate::oracle::{
    Cell, Direction, FirstHits, cells, check_beside, directions as directions_of, dot, unit,
};

/// Directions nearer to an edge than this, in radians, are left to the exact test.
const NEAR: f64 = 1e-5;

fn views() -> usize {
    if long() { 20 } else { 1 }
}

/// At most so many exact directions a view, and half of them where the map has as many; 20 views make 100,000.
fn exact() -> usize {
    if long() { 10_000 } else { 2_000 }
}

fn rays() -> usize {
    if long() { 1_000_000 } else { 20_000 }
}

fn measured(name: &str) {
    let folder = data().map(|d| d.join("walk"));
    let Some(folder) = folder.filter(|f| f.join(format!("{name}.glb")).is_file()) else {
        skip(&format!("{name}.glb is not at hand"));
        return;
    };
    let input = antumbra_io::read_scene(&folder.join(format!("{name}.glb"))).expect("readable");
    let path = std::fs::read_to_string(folder.join(format!("{name}.path"))).expect("a path");
    let frames: Vec<[f64; 3]> = path
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let mut numbers = line
                .split_whitespace()
                .map(|w| w.parse().expect("a number"));
            std::array::from_fn(|_| numbers.next().expect("three numbers"))
        })
        .collect();
    let low = std::array::from_fn(|k| frames.iter().map(|f| f[k]).fold(f64::MAX, f64::min));
    let high = std::array::from_fn(|k| frames.iter().map(|f| f[k]).fold(f64::MIN, f64::max));
    let (scene, _) = SceneBuilder::new(input)
        .cells_box(Some((low, high)))
        .build()
        .expect("a scene");
    let step = frames.len() / views();
    let eyes: Vec<[f64; 3]> = frames.into_iter().step_by(step).take(views()).collect();
    check_views(name, &scene, &eyes);
}

#[test]
fn duplex() {
    measured("duplex");
}

#[test]
fn kit_institute() {
    measured("kit_institute");
}

#[test]
fn quake_e1m1() {
    measured("quake_e1m1");
}

#[test]
fn delft_block() {
    measured("delft_block");
}

#[test]
fn crossing_triangles() {
    let params = TriangleParams {
        count: 600,
        area: 200.0,
        source_area: 50.0,
        seed: 5,
    };
    let (scene, _) = SceneBuilder::new(random_triangles(&params))
        .cells_box(Some(([-99.0; 3], [99.0; 3])))
        .build()
        .expect("a scene");
    let mut random = Random::new(9);
    let eyes: Vec<[f64; 3]> = (0..views())
        .map(|_| std::array::from_fn(|_| 180.0 * random.unit() - 90.0))
        .collect();
    check_views("triangles", &scene, &eyes);
}

fn check_views(name: &str, scene: &Scene, eyes: &[[f64; 3]]) {
    let caster = caster(scene);
    let mapper = Mapper::new(scene);
    for (i, &eye) in eyes.iter().enumerate() {
        let options = MapOptions {
            dissolve: Dissolve::Nothing,
            ..MapOptions::default()
        };
        let map = mapper
            .map(&Viewpoint::Sphere(eye), &options)
            .expect("a view");
        map.sanity_check()
            .unwrap_or_else(|e| panic!("{name} {i}: {e}"));
        let grid = scene.grid().snap(eye).expect("on the grid");
        let hits = FirstHits::new(scene, grid);
        let beside = check_beside(&map, &hits, exact());
        let view = format!("{name} {i}");
        let shown = || Shown::new(&view, &map, &hits);
        let rays = check_rays(shown(), &caster, grid.to_f64());
        let pixels = check_buffers(shown(), &caster, grid.to_f64());
        note(&format!(
            "{view}: {beside} exact directions, {rays} rays, {pixels} pixels"
        ));
        let dissolved = MapOptions::default();
        let map = mapper
            .map(&Viewpoint::Sphere(eye), &dissolved)
            .expect("a view");
        map.sanity_check()
            .unwrap_or_else(|e| panic!("{name} {i}: {e}"));
        let sum: f64 = map.faces().iter().map(|f| f.measure).sum();
        let sphere = 4.0 * std::f64::consts::PI;
        assert!((sum - sphere).abs() < 1e-9 * sphere, "{name} {i}: {sum}");
    }
}

#[allow(clippy::print_stdout, reason = "the test harness captures it")]
fn note(text: &str) {
    println!("    {text}");
}

fn caster(scene: &Scene) -> RayCaster {
    let triangles = scene.polygons().filter(|p| p.occludes).flat_map(|p| {
        let c: Vec<[f64; 3]> = p.corners.iter().map(|c| c.to_f64()).collect();
        let fan = 1..c.len() - 1;
        let one = |i: usize| Triangle {
            corners: [c[0], c[i], c[i + 1]],
            owner: p.id.0,
        };
        fan.map(one).collect::<Vec<_>>()
    });
    RayCaster::new(triangles.collect())
}

/// A convex cell for floats: inward normals, and a cap around it.
struct Shape {
    owner: Option<PolygonId>,
    normals: Vec<[f64; 3]>,
    axis: [f64; 3],
    radius: f64,
}

impl Shape {
    fn new(cell: &Cell, directions: &[[f64; 3]]) -> Self {
        let d: Vec<[f64; 3]> = cell
            .vertices
            .iter()
            .map(|&v| directions[v as usize])
            .collect();
        let axis = unit(
            d.iter()
                .fold([0.0; 3], |s, v| [s[0] + v[0], s[1] + v[1], s[2] + v[2]]),
        );
        let radius = d
            .iter()
            .map(|v| dot(*v, axis).clamp(-1.0, 1.0).acos())
            .fold(0.0, f64::max);
        let n = d.len();
        let normal = |i: usize| {
            let (u, v) = (d[i], d[(i + 1) % n]);
            let c = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            // Borders run so that the product points inward, or all of them against it.
            let c = unit(c);
            if dot(c, axis) < 0.0 { c.map(|x| -x) } else { c }
        };
        Self {
            owner: cell.owner,
            normals: (0..n).map(normal).collect(),
            axis,
            radius,
        }
    }
}

/// Cells by the bins of a cube of directions.
struct Bins(Vec<Vec<u32>>);

const BINS: usize = 16;

impl Bins {
    fn new(shapes: &[Shape]) -> Self {
        let mut bins = vec![Vec::new(); 6 * BINS * BINS];
        for (i, bin) in bins.iter_mut().enumerate() {
            let (face, at) = (i / (BINS * BINS), i % (BINS * BINS));
            let place = |n: usize| (2 * n + 1) as f64 / BINS as f64 - 1.0;
            let mut d = [0.0; 3];
            d[face / 2] = if face % 2 == 0 { 1.0 } else { -1.0 };
            d[(face / 2 + 1) % 3] = place(at % BINS);
            d[(face / 2 + 2) % 3] = place(at / BINS);
            let center = unit(d);
            // Half the diagonal of a bin, seen from the middle of the cube, with some room.
            let reach = 1.5 / BINS as f64;
            let near = |s: &Shape| dot(s.axis, center).clamp(-1.0, 1.0).acos() < s.radius + reach;
            bin.extend((0..shapes.len() as u32).filter(|&s| near(&shapes[s as usize])));
        }
        Self(bins)
    }

    fn at(&self, d: [f64; 3]) -> &[u32] {
        let axis = (0..3)
            .max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs()))
            .unwrap_or(0);
        let largest = d[axis].abs();
        let bin = |c: f64| (((c / largest + 1.0) / 2.0 * BINS as f64) as usize).min(BINS - 1);
        let (u, v) = (bin(d[(axis + 1) % 3]), bin(d[(axis + 2) % 3]));
        let face = 2 * axis + usize::from(d[axis] < 0.0);
        &self.0[face * BINS * BINS + v * BINS + u]
    }
}

/// A map, ready to be asked what it shows in a direction.
struct Shown<'a> {
    name: &'a str,
    cells: Vec<Cell>,
    exact: Vec<Direction>,
    shapes: Vec<Shape>,
    bins: Bins,
    hits: &'a FirstHits,
    checked: usize,
    slipped: usize,
}

impl<'a> Shown<'a> {
    fn new(name: &'a str, map: &antumbra::map::VisibilityMap, hits: &'a FirstHits) -> Self {
        let directions: Vec<[f64; 3]> = map.vertices().iter().map(|v| v.ray).collect();
        let cells = cells(map);
        let shapes: Vec<Shape> = cells.iter().map(|c| Shape::new(c, &directions)).collect();
        Self {
            name,
            exact: directions_of(map),
            bins: Bins::new(&shapes),
            cells,
            shapes,
            hits,
            checked: 0,
            slipped: 0,
        }
    }

    /// The owner of the one cell that holds a direction well inside must be among those seen.
    fn check(&mut self, d: [f64; 3], owners: &[u32]) {
        let d = unit(d);
        let inside = |s: &&u32| {
            let shape = &self.shapes[**s as usize];
            shape.normals.iter().all(|n| dot(*n, d) > NEAR)
        };
        let Some(&cell) = self.bins.at(d).iter().find(inside) else {
            return;
        };
        let owner = self.shapes[cell as usize].owner;
        let agrees = match owner {
            Some(id) => owners.contains(&id.0),
            None => owners.is_empty(),
        };
        if !agrees {
            // Floats may slip between triangles, or lose a hit: big integers have the last word.
            let exact = d.map(|c| IBig::from((c * (1_u64 << 60) as f64) as i64));
            if !holds(&self.cells[cell as usize], &self.exact, &exact) {
                // The float border of a cell with a very short edge points anywhere.
                return;
            }
            let first = self.hits.along(&exact).first().copied();
            assert_eq!(first, owner, "{}: {d:?}: rays say {owners:?}", self.name);
            self.slipped += 1;
        }
        self.checked += 1;
    }

    /// How many directions of so many were checked: at least half of them.
    fn done(self, of: usize) -> usize {
        let (name, checked, slipped) = (self.name, self.checked, self.slipped);
        assert!(
            slipped * 10_000 <= checked,
            "{name}: rays were wrong {slipped} times"
        );
        assert!(
            checked > of / 2,
            "{name}: only {checked} rays are off the edges"
        );
        checked
    }
}

/// Random rays.
fn check_rays(mut shown: Shown<'_>, caster: &RayCaster, eye: [f64; 3]) -> usize {
    let mut random = Random::new(7);
    for _ in 0..rays() {
        let z = 2.0 * random.unit() - 1.0;
        let turn = random.unit() * std::f64::consts::TAU;
        let r = (1.0 - z * z).sqrt();
        let d = [r * turn.cos(), r * turn.sin(), z];
        let hits = caster.hits(eye, d, (0.0, f64::INFINITY));
        let limit = hits.first().map_or(0.0, |h| h.t * (1.0 + 1e-9));
        let first = hits.iter().take_while(|h| h.t <= limit);
        let owners: Vec<u32> = first.map(|h| h.owner).collect();
        shown.check(d, &owners);
    }
    shown.done(rays())
}

/// An item buffer on each side of a cube around the viewpoint.
fn check_buffers(mut shown: Shown<'_>, caster: &RayCaster, eye: [f64; 3]) -> usize {
    let side = if long() { 512 } else { 64 };
    for face in 0..6 {
        let mut toward = eye;
        toward[face / 2] += if face % 2 == 0 { 1.0 } else { -1.0 };
        let mut up = [0.0; 3];
        up[(face / 2 + 1) % 3] = 1.0;
        let camera = Camera {
            eye,
            toward,
            up,
            angle: 90.0,
            size: [side, side],
        };
        let buffer = ItemBuffer::render(caster, &camera, 1e-9);
        for row in 0..side {
            for column in 0..side {
                shown.check(camera.through(column, row), buffer.pixel(column, row));
            }
        }
    }
    shown.done(6 * side * side)
}

/// Whether a convex cell holds a direction strictly: by big integers.
fn holds(cell: &Cell, rays: &[Direction], d: &Direction) -> bool {
    let n = cell.vertices.len();
    let side = |i: usize| -> IBig {
        let u = &rays[cell.vertices[i] as usize];
        let v = &rays[cell.vertices[(i + 1) % n] as usize];
        let m = |a: usize, b: usize| &u[a] * &v[b] - &u[b] * &v[a];
        m(1, 2) * &d[0] + m(2, 0) * &d[1] + m(0, 1) * &d[2]
    };
    (0..n).all(|i| side(i) > IBig::ZERO) || (0..n).all(|i| side(i) < IBig::ZERO)
}
