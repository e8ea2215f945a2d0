//! `.pvs` and `.proof` files: written in any order, interrupted anywhere, altered anywhere.

use std::fs;
use std::path::Path;

use antumbra_io::compare::compare;
use antumbra_io::export::export;
use antumbra_io::pvs::{
    Accuracy, CellIndex, CellRecord, PvsCell, PvsCellKind, PvsHeader, VisibleRecord, WitnessRecord,
    encode_pvs,
};
use antumbra_io::{ProofFile, PvsFile, PvsWriter};
use antumbra_kernel::{Aabb, Grid, Point};

const OBJECTS: u32 = 40;

/// 3 x 2 x 2 cells of 100 grid steps, and one whose source is an object.
fn header() -> PvsHeader {
    let mut cells = Vec::new();
    for (x, y, z) in (0..12).map(|i| (i % 3, i / 3 % 2, i / 6)) {
        let min = Point::new(100 * x, 100 * y, 100 * z);
        let max = Point::new(100 * x + 100, 100 * y + 100, 100 * z + 100);
        cells.push(PvsCell {
            name: format!("{x} {y} {z}"),
            bounds: Aabb::new(min, max),
            kind: PvsCellKind::Box,
        });
    }
    let bounds = Aabb::new(Point::new(-50, 0, 0), Point::new(50, 0, 10));
    cells.push(PvsCell {
        name: "source".into(),
        bounds,
        kind: PvsCellKind::Object(3),
    });
    PvsHeader {
        scene_hash: [42; 32],
        grid: Grid::new([1.0, 2.0, -3.0], 0.25).expect("finite"),
        options: "cells=grid:25".into(),
        proofs: true,
        objects: (0..OBJECTS).map(|i| format!("object {i} é")).collect(),
        planes: (0..OBJECTS as i32)
            .map(|i| [[i, 0, 0], [i, 5, 0], [i, 0, 5]])
            .collect(),
        cells,
    }
}

fn record(cell: u32) -> CellRecord {
    let witness = |object: u32| WitnessRecord {
        polygon: object,
        source: cell % 3,
        from: [i64::from(cell) << 22, 5, -7],
        through: [(i64::from(cell) << 22) + 65536, 5 + i64::from(object), -7],
    };
    let visible = (0..OBJECTS)
        .filter(|o| o % (cell + 2) == 0)
        .map(|object| VisibleRecord {
            object,
            witness: (object % 4 != 0).then(|| witness(object)),
        });
    let visible: Vec<_> = visible.collect();
    let accuracy = [
        Accuracy::Exact,
        Accuracy::Conservative,
        Accuracy::AggressiveBelow(1e-4),
        Accuracy::Approximate,
    ];
    let seen = |object: &u32| visible.iter().any(|v| v.object == *object);
    let unknown = [1, 39]
        .into_iter()
        .filter(|o| cell % 5 == 4 && !seen(o))
        .collect();
    CellRecord {
        accuracy: accuracy[cell as usize % 4],
        visible,
        unknown,
    }
}

fn records() -> Vec<CellRecord> {
    (0..13).map(record).collect()
}

fn proof(cell: u32) -> Vec<u8> {
    (0..cell * 100)
        .flat_map(|i| (i / 7).to_le_bytes())
        .collect()
}

fn file() -> PvsFile {
    PvsFile::from_bytes(
        encode_pvs(&header(), &records()).expect("good records"),
        "t.pvs",
    )
    .expect("own file")
}

#[test]
fn all_is_read_back() {
    let (file, header) = (file(), header());
    file.verify().expect("unaltered");
    assert_eq!(file.provenance(), &header.provenance());
    assert_eq!(file.provenance().scene_hash(), Some([42; 32]));
    assert_eq!(file.planes().expect("unaltered"), header.planes);
    for (i, record) in records().into_iter().enumerate() {
        let cell = CellIndex(i as u32);
        assert_eq!(file.cell(cell).as_ref(), Some(&header.cells[i]));
        assert_eq!(file.record(cell).expect("unaltered"), record);
        let mut all: Vec<u32> = record.visible.iter().map(|v| v.object).collect();
        all.extend(&record.unknown);
        all.sort_unstable();
        assert_eq!(
            file.visible(cell)
                .expect("unaltered")
                .iter()
                .collect::<Vec<_>>(),
            all
        );
        let touching = record
            .visible
            .iter()
            .filter(|v| v.witness.is_none())
            .map(|v| v.object);
        assert!(file.touching(cell).expect("unaltered").iter().eq(touching));
        assert_eq!(
            file.unknown(cell)
                .expect("unaltered")
                .iter()
                .collect::<Vec<_>>(),
            record.unknown
        );
    }
    assert!((0..OBJECTS).all(|o| file.object_name(o) == Some(&header.objects[o as usize])));
    assert!(file.visible(CellIndex(13)).is_err() && file.cell(CellIndex(13)).is_none());
}

#[test]
fn points_find_the_first_cell_that_contains_them() {
    let (file, header) = (file(), header());
    for i in 0..4000 {
        let step = |k: i32| (i * (17 + k * 30) % 230 - 10) * 2;
        let p = Point::new(step(0), step(1), step(2));
        let contains = |cell: &PvsCell| {
            cell.kind == PvsCellKind::Box && cell.bounds.contains(&Aabb { min: p, max: p })
        };
        let expected = header.cells.iter().position(contains);
        let found = file.cell_at(header.grid.to_scene(p));
        assert_eq!(found, expected.map(|i| CellIndex(i as u32)));
    }
    assert_eq!(file.cell_at([f64::NAN, 0.0, 0.0]), None);
    assert_eq!(file.cell_at([1e30, 0.0, 0.0]), None);
}

#[test]
fn files_without_cells_or_objects_are_fine() {
    let empty = PvsHeader {
        objects: vec![],
        planes: vec![],
        cells: vec![],
        ..header()
    };
    let file =
        PvsFile::from_bytes(encode_pvs(&empty, &[]).expect("nothing"), "e.pvs").expect("own file");
    file.verify().expect("unaltered");
    assert_eq!((file.cell_count(), file.object_count()), (0, 0));
    assert_eq!(file.cell_at([0.0; 3]), None);
}

#[test]
fn contradictions_are_refused() {
    let refuse = |record: CellRecord, expected: &str| {
        let mut all = records();
        all[2] = record;
        let text = encode_pvs(&header(), &all).expect_err(expected).to_string();
        assert!(text.starts_with(&format!("cell 2: {expected}")), "{text}");
    };
    let mut swapped = record(2);
    swapped.visible.swap(0, 1);
    refuse(swapped, "the objects are not in ascending order");
    refuse(
        CellRecord {
            unknown: vec![OBJECTS],
            ..record(2)
        },
        "object 40 does not exist, there are 40",
    );
    refuse(
        CellRecord {
            unknown: vec![4],
            ..record(2)
        },
        "object 4 is both visible and unknown",
    );
    let text = encode_pvs(&header(), &records()[..5])
        .expect_err("too few")
        .to_string();
    assert!(
        text.starts_with("cell 5: results end here, but there are 13 cells"),
        "{text}"
    );
}

/// All that a file says; `Err` as soon as it notices an alteration.
fn all_answers(bytes: Vec<u8>) -> Result<String, String> {
    let file = PvsFile::from_bytes(bytes, "t.pvs").map_err(|e| e.to_string())?;
    file.verify().map_err(|e| e.to_string())?;
    serde_json::to_string(&export(&file, true).map_err(|e| e.to_string())?)
        .map_err(|e| e.to_string())
}

#[test]
fn an_altered_file_errs_and_never_lies() {
    let bytes = encode_pvs(&header(), &records()).expect("good records");
    let truth = all_answers(bytes.clone());
    truth.as_ref().expect("unaltered");
    for length in 0..bytes.len() {
        let text = all_answers(bytes[..length].to_vec()).expect_err("cut off");
        assert!(text.starts_with("t.pvs: "), "{text}");
    }
    for at in 0..bytes.len() {
        for bit in [0, 7] {
            let mut altered = bytes.clone();
            altered[at] ^= 1 << bit;
            let answers = all_answers(altered);
            assert!(
                answers.is_err() || answers == truth,
                "byte {at} was altered unnoticed"
            );
        }
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(all_answers(longer).is_err());
}

/// Valid checksums around damaged content: what a fault in a writer would produce.
#[test]
fn a_wrong_content_with_a_right_checksum_never_panics() {
    let bytes = encode_pvs(&header(), &records()).expect("good records");
    let checksum = |data: &[u8]| blake3::hash(data).as_bytes()[..8].to_vec();
    for section in 0..8 {
        let entry = 32 + 32 * section;
        let number =
            |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
        let (start, length) = (number(entry + 8), number(entry + 16));
        for at in start..start + length.min(600) {
            let mut altered = bytes.clone();
            altered[at] = altered[at].wrapping_add(1 + (at % 254) as u8);
            let sum = checksum(&altered[start..start + length]);
            altered[entry + 24..entry + 32].copy_from_slice(&sum);
            let sum = checksum(&[&altered[..24], &altered[32..32 + 8 * 32]].concat());
            altered[24..32].copy_from_slice(&sum);
            if let Ok(file) = PvsFile::from_bytes(altered, "t.pvs") {
                let _ = file.verify();
                let _ = file.cell_at([10.0, 10.0, 10.0]);
                let _ = export(&file, true);
            }
        }
    }
}

fn write(path: &Path, order: &[u32], kill_after: usize) -> (Vec<u8>, Vec<u8>) {
    let journal = PvsWriter::journal_path(path);
    let (first, rest) = order.split_at(kill_after);
    let writer = PvsWriter::create(path, header()).expect("writable");
    for cell in first {
        writer
            .push_cell(*cell, &record(*cell), &proof(*cell))
            .expect("writable");
    }
    drop(writer);
    // A kill in the middle of a write leaves half a record.
    let mut bytes = fs::read(&journal).expect("the journal");
    bytes.extend([17, 0, 0, 0, 0, 0, 0, 0, 1]);
    fs::write(&journal, bytes).expect("writable");
    assert!(!path.exists());

    let (writer, done) = PvsWriter::resume(path, header()).expect("the same bake");
    assert!(done.iter().all(|cell| first.contains(cell)) && done.len() == first.len());
    for cell in rest {
        writer
            .push_cell(*cell, &record(*cell), &proof(*cell))
            .expect("writable");
    }
    let finished = writer.finish().expect("complete");
    assert!(!journal.exists());
    let (pvs, proofs) = (fs::read(path), fs::read(PvsWriter::proof_path(path)));
    let (pvs, proofs) = (pvs.expect("written"), proofs.expect("written"));
    assert_eq!(finished.pvs_bytes, pvs.len() as u64);
    assert_eq!(finished.proof_bytes, Some(proofs.len() as u64));
    (pvs, proofs)
}

#[test]
fn order_and_interruptions_leave_no_trace() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    let forwards: Vec<u32> = (0..13).collect();
    let backwards: Vec<u32> = (0..13).rev().collect();
    let shuffled: Vec<u32> = (0..13).map(|i| i * 5 % 13).collect();
    let (pvs, proofs) = write(&path, &forwards, 0);
    assert_eq!(
        pvs,
        encode_pvs(&header(), &records()).expect("good records")
    );
    for (order, kill_after) in [(&forwards, 13), (&backwards, 4), (&shuffled, 7)] {
        fs::remove_file(&path).expect("written before");
        let again = write(&path, order, kill_after);
        assert!(again == (pvs.clone(), proofs.clone()), "{order:?}");
    }
    // Nothing else is left behind.
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2);

    let file = PvsFile::open(&path).expect("own file");
    let certificates = ProofFile::open(&PvsWriter::proof_path(&path)).expect("own file");
    certificates.check_belongs_to(&file).expect("one bake");
    for cell in 0..13 {
        assert_eq!(
            certificates.proof(CellIndex(cell)).expect("unaltered"),
            proof(cell)
        );
    }
    assert!(certificates.proof(CellIndex(13)).is_err());
    let other = PvsHeader {
        options: "cells=grid:26".into(),
        ..header()
    };
    let other = PvsFile::from_bytes(encode_pvs(&other, &records()).expect("good"), "o.pvs")
        .expect("own file");
    let text = certificates
        .check_belongs_to(&other)
        .expect_err("another bake")
        .to_string();
    assert!(text.contains("these are not the proofs of o.pvs"), "{text}");
}

#[test]
fn a_journal_survives_a_cut_anywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    let writer = PvsWriter::create(&path, header()).expect("writable");
    let mut ends = vec![];
    let journal = PvsWriter::journal_path(&path);
    for cell in 0..4 {
        ends.push(fs::metadata(&journal).expect("the journal").len());
        writer
            .push_cell(cell, &record(cell), &proof(cell))
            .expect("writable");
    }
    drop(writer);
    let bytes = fs::read(&journal).expect("the journal");
    for length in ends[0] as usize..bytes.len() {
        fs::write(&journal, &bytes[..length]).expect("writable");
        let (_, done) = PvsWriter::resume(&path, header()).expect("the same bake");
        let whole = ends[1..]
            .iter()
            .filter(|end| **end <= length as u64)
            .count();
        assert_eq!(done.len(), whole, "{length} bytes");
    }
    // An altered record is as good as none: it and all after it are baked again.
    let mut altered = bytes;
    altered[ends[2] as usize + 40] ^= 1;
    fs::write(&journal, altered).expect("writable");
    let (_, done) = PvsWriter::resume(&path, header()).expect("the same bake");
    assert!(done.into_iter().eq([0, 1]));
}

#[test]
fn a_journal_of_another_bake_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    drop(PvsWriter::create(&path, header()).expect("writable"));
    let mut other_cells = header();
    other_cells.cells.pop();
    let cases = [
        (
            PvsHeader {
                options: "cells=grid:26".into(),
                ..header()
            },
            "it was begun with the options \"cells=grid:25\", now they are \"cells=grid:26\"",
        ),
        (
            PvsHeader {
                scene_hash: [1; 32],
                ..header()
            },
            "it was begun with another scene",
        ),
        (
            PvsHeader {
                proofs: false,
                ..header()
            },
            "it was begun with another grid, program version or choice of proofs",
        ),
        (other_cells, "it was begun with other cells or objects"),
    ];
    for (header, expected) in cases {
        let error = PvsWriter::resume(&path, header).expect_err(expected);
        assert!(
            error.to_string().contains(expected) && !error.is_path_error(),
            "{error}"
        );
    }
    // One bake at a time.
    let open = PvsWriter::resume(&path, header()).expect("the same bake");
    let error = PvsWriter::resume(&path, header())
        .expect_err("in use")
        .to_string();
    assert!(
        error.contains("another bake is writing this file"),
        "{error}"
    );
    drop(open);
    fs::write(PvsWriter::journal_path(&path), "my notes").expect("writable");
    let error = PvsWriter::resume(&path, header())
        .expect_err("no journal")
        .to_string();
    assert!(error.contains("this is no journal of a bake"), "{error}");
}

#[test]
fn unfinished_bakes_write_no_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    let writer = PvsWriter::create(&path, header()).expect("writable");
    writer.push_cell(0, &record(0), &[]).expect("writable");
    let again = writer
        .push_cell(0, &record(0), &[])
        .expect_err("twice")
        .to_string();
    assert!(again.starts_with("cell 0: it was added before"), "{again}");
    let missing = writer.finish().expect_err("incomplete").to_string();
    assert!(
        missing.starts_with("cell 1: its results are missing"),
        "{missing}"
    );
    assert!(!path.exists() && PvsWriter::journal_path(&path).exists());
    let error =
        PvsWriter::create(&folder.path().join("no/folder.pvs"), header()).expect_err("no folder");
    assert!(error.is_path_error(), "{error}");
    assert!(PvsWriter::create(&folder.path().join("a.proof"), header()).is_err());
    assert!(
        PvsFile::open(folder.path())
            .expect_err("a folder")
            .is_path_error()
    );
    assert!(PvsFile::open(&path).expect_err("no file").is_path_error());
    fs::write(&path, "").expect("writable");
    let error = PvsFile::open(&path).expect_err("empty");
    assert!(
        !error.is_path_error() && error.to_string().contains("the file is empty"),
        "{error}"
    );
}

#[test]
fn a_bake_without_proofs_leaves_no_old_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    fs::write(PvsWriter::proof_path(&path), "old").expect("writable");
    let writer = PvsWriter::create(
        &path,
        PvsHeader {
            proofs: false,
            ..header()
        },
    )
    .expect("writable");
    (0..13).for_each(|cell| {
        writer
            .push_cell(cell, &record(cell), &proof(cell))
            .expect("writable")
    });
    assert_eq!(writer.finish().expect("complete").proof, None);
    assert!(path.exists() && !PvsWriter::proof_path(&path).exists());
}

#[test]
fn altered_proofs_err_and_never_lie() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("level.pvs");
    let order: Vec<u32> = (0..13).collect();
    let (_, bytes) = write(&path, &order, 5);
    let answers = |bytes: Vec<u8>| -> Result<Vec<Vec<u8>>, String> {
        let file = ProofFile::from_bytes(bytes, "t.proof").map_err(|e| e.to_string())?;
        (0..13)
            .map(|cell| file.proof(CellIndex(cell)).map_err(|e| e.to_string()))
            .collect()
    };
    let truth = answers(bytes.clone()).expect("unaltered");
    assert_eq!(truth, (0..13).map(proof).collect::<Vec<_>>());
    for length in 0..bytes.len() {
        let text = answers(bytes[..length].to_vec()).expect_err("cut off");
        assert!(text.starts_with("t.proof: "), "{text}");
    }
    for at in 0..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 4;
        assert!(answers(altered).is_err(), "byte {at} was altered unnoticed");
    }
}

#[test]
fn comparison_counts_what_only_one_has() {
    let truth = file();
    let same = compare(&truth, &file()).expect("comparable");
    assert_eq!(
        (same.only_a, same.only_b, same.q_over, same.q_under),
        (0, 0, 0.0, 0.0)
    );
    assert!(same.differences.is_empty() && same.entries_a == same.entries_b);

    let mut other = records();
    other[0].visible.pop();
    other[1].visible.insert(
        1,
        VisibleRecord {
            object: 1,
            witness: None,
        },
    );
    other[1].visible.insert(
        2,
        VisibleRecord {
            object: 2,
            witness: None,
        },
    );
    let other = PvsFile::from_bytes(encode_pvs(&header(), &other).expect("good"), "o.pvs")
        .expect("own file");
    let found = compare(&other, &truth).expect("comparable");
    assert_eq!((found.only_a, found.only_b), (2, 1));
    assert_eq!(
        found.q_over,
        2.0 / truth
            .cells()
            .map(|c| truth.visible(c).expect("fine").len())
            .sum::<u64>() as f64
    );
    assert_eq!(found.differences.len(), 2);
    assert_eq!(
        (
            found.differences[0].only_b.as_slice(),
            found.differences[1].only_a.as_slice()
        ),
        (&[38][..], &[1, 2][..])
    );

    let mut moved = header();
    moved.cells[3].bounds.max.x += 9;
    let moved = PvsFile::from_bytes(encode_pvs(&moved, &records()).expect("good"), "m.pvs")
        .expect("own file");
    let text = compare(&truth, &moved)
        .expect_err("other cells")
        .to_string();
    assert!(
        text.starts_with("m.pvs: cell 3 is another box than in t.pvs"),
        "{text}"
    );
}

#[test]
fn the_export_has_the_promised_keys() {
    let export =
        serde_json::to_value(export(&file(), true).expect("unaltered")).expect("plain data");
    assert_eq!(
        export["objects"][3],
        serde_json::json!({"id": 3, "name": "object 3 é"})
    );
    let cell = &export["cells"][1];
    assert_eq!(cell["id"], 1);
    assert_eq!(cell["name"], "1 0 0");
    assert_eq!(cell["min"], serde_json::json!([26.0, 2.0, -3.0]));
    assert_eq!(cell["max"], serde_json::json!([51.0, 27.0, 22.0]));
    assert_eq!(cell["accuracy"], "conservative");
    assert_eq!(cell["touching"], serde_json::json!([0, 12, 24, 36]));
    let witness = &cell["witnesses"][0];
    // From x = 64 steps; the plane of polygon 3 is x = 3.
    assert_eq!(witness["object"], 3);
    assert_eq!(witness["from"][0], 17.0);
    assert_eq!(
        witness["from_exact"],
        serde_json::json!(["17", "524293/262144", "-786439/262144"])
    );
    assert_eq!(witness["to_exact"][0], "7/4");
    assert_eq!(witness["to"][0], 1.75);
    let visible = cell["visible"].as_array().expect("a list").len();
    let others = cell["witnesses"].as_array().expect("a list").len();
    assert_eq!(visible, others + 4);
    assert_eq!(export["cells"][12]["source"], 3);
}
