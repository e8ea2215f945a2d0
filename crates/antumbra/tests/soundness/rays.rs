//! Rays against verdicts: whatever a ray out of a cell meets first must be in the cell's set.
//!
//! The ray caster works in floats, so a hit outside of the set is a suspicion. It is decided again
//! by exact rationals: it counts if the segment starts in the open cell, crosses the interior of
//! the polygon, and strictly misses every occluder after it has left the cell.

use antumbra::region::{BakeOptions, Baker, CellResult};
use antumbra::scene::ViewCell;
use antumbra_testkit::environment::long;
use antumbra_testkit::random::Random;
use antumbra_testkit::rational::RationalPoint;
use antumbra_testkit::ray_caster::{RayCaster, Triangle};

use crate::judge::{Judge, Start, ahead};
use crate::scenes::{Place, measured, note, office_floor, office_light, small_maze, triangles};

/// What the rays found.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub rays: u64,
    pub hits: u64,
    /// Hits outside of the set, by floats.
    pub suspicions: u64,
}

/// The largest jitter of a border ray, in grid steps, is 2 to this power.
const WIDEST: f64 = 12.0;

struct Shooter<'a> {
    judge: &'a Judge,
    caster: &'a RayCaster,
    cell: &'a ViewCell,
    /// Whether an object may be seen.
    listed: Vec<bool>,
    /// Polygons of listed objects: past their edges is where leaks are. Others are aimed at, too.
    edges: Vec<usize>,
    random: Random,
}

impl Shooter<'_> {
    /// A point in the open box, often next to its border, where the view is widest.
    fn origin(&mut self) -> [f64; 3] {
        let (min, max) = (self.cell.bounds.min.to_f64(), self.cell.bounds.max.to_f64());
        std::array::from_fn(|k| {
            let part = match self.random.index(4) {
                0 => 1e-6 * (1.0 + self.random.unit()),
                1 => 1.0 - 1e-6 * (1.0 + self.random.unit()),
                _ => 0.001 + 0.998 * self.random.unit(),
            };
            min[k] + (max[k] - min[k]) * part
        })
    }

    fn direction(&mut self, origin: [f64; 3]) -> [f64; 3] {
        if self.edges.is_empty() || self.random.index(2) == 0 {
            return std::array::from_fn(|_| {
                // Three sums of uniform numbers: nearly normal, so nearly uniform on the sphere.
                (0..6).map(|_| self.random.unit() - 0.5).sum::<f64>()
            });
        }
        // Past an edge, at any order of distance from 1/1000 step on.
        let polygon = match self.random.index(3) {
            0 => self.random.index(self.judge.polygons().len()),
            _ => self.edges[self.random.index(self.edges.len())],
        };
        let corners = &self.judge.polygons()[polygon].corners;
        let i = self.random.index(corners.len());
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let part = self.random.unit();
        let reach = 2.0_f64.powf(-10.0 + (10.0 + WIDEST) * self.random.unit());
        std::array::from_fn(|k| {
            let on_edge = a[k] as f64 + (b[k] - a[k]) as f64 * part;
            on_edge + reach * (2.0 * self.random.unit() - 1.0) - origin[k]
        })
    }

    /// Shoots one ray; the error is a counterexample.
    fn shoot(&mut self, tally: &mut Tally) -> Result<(), String> {
        let origin = self.origin();
        let direction = self.direction(origin);
        tally.rays += 1;
        let (min, max) = (self.cell.bounds.min.to_f64(), self.cell.bounds.max.to_f64());
        let leave = (0..3)
            .filter(|&k| direction[k] != 0.0)
            .map(|k| {
                let side = if direction[k] > 0.0 { max[k] } else { min[k] };
                (side - origin[k]) / direction[k]
            })
            .fold(f64::INFINITY, f64::min);
        if !leave.is_finite() {
            return Ok(());
        }
        for hit in self.caster.hits(origin, direction, (leave, f64::INFINITY)) {
            let polygon = hit.owner as usize;
            tally.hits += 1;
            let object = self.judge.owner(polygon);
            if !self.listed[object.index()] {
                tally.suspicions += 1;
                self.decide(origin, direction, polygon)?;
            }
            if self.judge.polygons()[polygon].occludes {
                break;
            }
        }
        Ok(())
    }

    /// Decides a suspicion exactly.
    fn decide(&self, origin: [f64; 3], direction: [f64; 3], polygon: usize) -> Result<(), String> {
        let through = std::array::from_fn(|k| origin[k] + direction[k]);
        let points = (
            RationalPoint::from_f64(origin),
            RationalPoint::from_f64(through),
        );
        let (Some(from), Some(through)) = points else {
            return Ok(());
        };
        let corners = &self.judge.polygons()[polygon].corners;
        let Some(to) = ahead(&from, &through, corners) else {
            return Ok(());
        };
        let (min, max) = (self.cell.bounds.min.to_i64(), self.cell.bounds.max.to_i64());
        let segment = [from, to];
        match self.judge.proves(Start::Box(min, max), &segment, polygon) {
            Err(_) => Ok(()),
            Ok(()) => Err(format!(
                "cell {} ({min:?} to {max:?}) is said not to see object {}, but the segment from {} to {} on polygon {polygon} is free",
                self.cell.name,
                self.judge.owner(polygon).0,
                segment[0],
                segment[1],
            )),
        }
    }
}

fn fans(judge: &Judge) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for (i, polygon) in judge.polygons().iter().enumerate() {
        let float = |c: [i64; 3]| c.map(|v| v as f64);
        for pair in polygon.corners[1..].windows(2) {
            triangles.push(Triangle {
                corners: [polygon.corners[0], pair[0], pair[1]].map(float),
                owner: i as u32,
            });
        }
    }
    triangles
}

/// Bakes some cells of a place, checks their entries, and shoots rays at what they call hidden.
fn attack(place: &Place, cells: usize, rays: u64, seed: u64) -> (Tally, Vec<String>) {
    let judge = Judge::new(&place.scene);
    let caster = RayCaster::new(fans(&judge));
    let baker = Baker::new(&place.scene);
    let (mut tally, mut failures) = (Tally::default(), Vec::new());
    let cells = place.some_cells(cells, seed);
    let (mut sum, mut followed) = (0, 0);
    let share = rays.div_ceil(cells.len() as u64);
    for (number, cell) in cells.iter().enumerate() {
        let result = baker.bake_cell(cell, &BakeOptions::default());
        sum += result.visible.len();
        if !result.unknown.is_empty() {
            failures.push(format!("cell {}: unknown {:?}", cell.name, result.unknown));
        }
        match judge.check_entries(&place.scene, cell, &result.visible) {
            Ok(count) => followed += count,
            Err(why) => failures.push(why),
        }
        let seed = seed ^ (number as u64) << 32;
        let listed = listed(&judge, &result);
        if let Err(why) = shoot_all(&judge, &caster, cell, listed, share, seed, &mut tally) {
            failures.push(why);
        }
    }
    note(&format!(
        "{}: {} cells, {sum} visible, {followed} witnesses followed, {tally:?}",
        place.name,
        cells.len()
    ));
    (tally, failures)
}

/// Which objects a result lists.
fn listed(judge: &Judge, result: &CellResult) -> Vec<bool> {
    let mut listed = vec![false; judge.objects()];
    for entry in &result.visible {
        listed[entry.object.index()] = true;
    }
    listed
}

fn shoot_all(
    judge: &Judge,
    caster: &RayCaster,
    cell: &ViewCell,
    listed: Vec<bool>,
    rays: u64,
    seed: u64,
    tally: &mut Tally,
) -> Result<(), String> {
    let edges = (0..judge.polygons().len())
        .filter(|&i| listed[judge.owner(i).index()])
        .collect();
    let mut shooter = Shooter {
        judge,
        caster,
        cell,
        listed,
        edges,
        random: Random::new(seed),
    };
    (0..rays).try_for_each(|_| shooter.shoot(tally))
}

fn holds((tally, failures): (Tally, Vec<String>)) {
    assert!(tally.rays > 0 && tally.hits > 0, "{tally:?}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The first number in a short run, the second in a long one.
fn pick<T>(short: T, slow: T) -> T {
    if long() { slow } else { short }
}

#[test]
fn no_ray_leaves_the_set_of_a_duplex_house() {
    if let Some(place) = measured("duplex", 2.0) {
        let cells = pick(6, usize::MAX);
        holds(attack(&place, cells, pick(80_000, 4_000_000), 11));
    }
}

#[test]
#[ignore = "slow: a five-storey office"]
fn no_ray_leaves_the_set_of_an_institute() {
    if let Some(place) = measured("kit_institute", 2.0) {
        holds(attack(&place, 60, 2_500_000, 12));
    }
}

#[test]
fn no_ray_leaves_the_set_of_a_game_level() {
    if let Some(place) = measured("quake_e1m1", 2.0) {
        holds(attack(&place, pick(2, 60), pick(40_000, 2_000_000), 13));
    }
}

#[test]
fn no_ray_leaves_the_set_of_an_office_floor() {
    holds(attack(
        &office_floor(2.0),
        pick(3, 60),
        pick(30_000, 500_000),
        14,
    ));
    holds(attack(
        &office_light(),
        pick(2, 30),
        pick(20_000, 400_000),
        15,
    ));
}

#[test]
fn no_ray_leaves_the_set_of_a_maze() {
    holds(attack(
        &small_maze(2.0),
        pick(3, 60),
        pick(30_000, 500_000),
        16,
    ));
}

#[test]
fn no_ray_leaves_the_set_of_random_triangles() {
    holds(attack(
        &triangles(400, 10.0),
        pick(3, 40),
        pick(20_000, 300_000),
        17,
    ));
}

/// The attack itself is tested: what is taken out of a set must be noticed.
#[test]
fn rays_notice_what_is_missing() {
    let place = office_floor(2.0);
    let judge = Judge::new(&place.scene);
    let caster = RayCaster::new(fans(&judge));
    let cell = place.some_cells(1, 14)[0];
    let result = Baker::new(&place.scene).bake_cell(cell, &BakeOptions::default());
    let seen: Vec<_> = result.visible.iter().filter(|e| !e.touching).collect();
    let noticed = seen.iter().filter(|entry| {
        let mut listed = listed(&judge, &result);
        listed[entry.object.index()] = false;
        let mut tally = Tally::default();
        shoot_all(&judge, &caster, cell, listed, 40_000, 3, &mut tally).is_err()
    });
    let (noticed, all) = (noticed.count(), seen.len());
    note(&format!(
        "{noticed} of {all} missing objects noticed by 40000 rays"
    ));
    assert!(all > 20 && noticed * 10 >= all * 6, "{noticed} of {all}");
}
