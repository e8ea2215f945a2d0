//! How long a renderer waits for its potentially visible set: from a point to the objects.
//! Goal: under 10 microseconds from a warm mapped file.
#![allow(
    missing_docs,
    reason = "criterion's macros make undocumented functions"
)]

use std::hint::black_box;
use std::path::Path;

use antumbra_io::pvs::{Accuracy, CellRecord, PvsCell, PvsCellKind, PvsHeader, VisibleRecord};
use antumbra_io::{PvsFile, PvsWriter};
use antumbra_kernel::{Aabb, Grid, Point};
use criterion::{Criterion, criterion_group, criterion_main};

const SIDE: i32 = 40;
const SIZE: i32 = 1000;
const OBJECTS: u32 = 10_000;

/// A building of 40 x 40 x 4 cells with 10,000 objects, each cell seeing some 300 of them.
fn write(path: &Path) {
    let cell = |i: i32| {
        let (x, y, z) = (i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE));
        let corner = |d: i32| Point::new((x + d) * SIZE, (y + d) * SIZE, (z + d) * SIZE);
        PvsCell {
            name: i.to_string(),
            bounds: Aabb::new(corner(0), corner(1)),
            kind: PvsCellKind::Box,
        }
    };
    let header = PvsHeader {
        scene_hash: [0; 32],
        grid: Grid::new([0.0; 3], 0.01).expect("finite"),
        options: "cells=grid:10".to_owned(),
        proofs: false,
        objects: (0..OBJECTS).map(|i| format!("object {i}")).collect(),
        planes: Vec::new(),
        cells: (0..SIDE * SIDE * 4).map(cell).collect(),
    };
    let cells = header.cells.len() as u32;
    let writer = PvsWriter::create(path, header).expect("writable");
    for cell in 0..cells {
        let visible = (0..OBJECTS)
            .filter(|o| o.wrapping_mul(2_654_435_761).wrapping_add(cell * 977) % 33 == 0);
        let visible = visible
            .map(|object| VisibleRecord {
                object,
                witness: None,
            })
            .collect();
        let record = CellRecord {
            accuracy: Accuracy::Exact,
            visible,
            unknown: Vec::new(),
        };
        writer.push_cell(cell, &record, &[]).expect("writable");
    }
    writer.finish().expect("complete");
}

fn benches(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("building.pvs");
    write(&path);
    let file = PvsFile::open(&path).expect("own file");
    let points: Vec<[f64; 3]> = (0..1024)
        .map(|i| {
            [
                f64::from(i * 37 % 400) + 0.5,
                f64::from(i * 91 % 400) + 0.5,
                f64::from(i % 40) + 0.5,
            ]
        })
        .collect();
    // The answers are right before they are timed.
    for [x, y, z] in &points {
        let expected = (x / 10.0) as u32 + 40 * (y / 10.0) as u32 + 1600 * (z / 10.0) as u32;
        let cell = file.cell_at([*x, *y, *z]).expect("inside");
        assert_eq!(cell.0, expected);
        let seen = file.visible(cell).expect("unaltered");
        assert!((200..400).contains(&seen.len()), "{}", seen.len());
        assert!(
            seen.iter()
                .all(|o| o.wrapping_mul(2_654_435_761).wrapping_add(cell.0 * 977) % 33 == 0)
        );
    }
    let mut next = 0;
    let mut point = || {
        next = (next + 1) % points.len();
        points[next]
    };
    criterion.bench_function("cell_at", |b| b.iter(|| file.cell_at(black_box(point()))));
    criterion.bench_function("cell_at and visible", |b| {
        b.iter(|| {
            file.cell_at(black_box(point()))
                .map(|cell| file.visible(cell))
        });
    });
    criterion.bench_function("open", |b| b.iter(|| PvsFile::open(black_box(&path))));
}

criterion_group!(queries, benches);
criterion_main!(queries);
