//! The checker: verifies every certificate of a view cell and recomputes nothing.
//!
//! It follows `docs/formats/certificates.md` and shares nothing with the engine but the integers,
//! the scene and the file format. It searches for nothing: trees are walked, their cuts made and
//! their leaves tested. In doubt it says no.

mod big;
mod claims;
mod cone;
mod ends;
mod fast;
mod middle;
mod modular;
mod numbers;
mod piece;
mod plan;
mod real;
mod rows;
#[cfg(test)]
mod sampled;
mod start;
mod tree;
mod witness;

use antumbra_kernel::{Aabb, LIMIT};
use antumbra_scene::{
    BoxContact, KdNode, ObjectId, PolygonId, PolygonRef, Scene, ViewCell, box_contact,
    polygons_touch,
};

pub use plan::{PlanCheck, check_plan};

use crate::proof::{CellProof, Claim, Target};
use crate::verdict::{Accuracy, VisibleEntry};
use ends::Source;

/// What the checker found about one cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CheckReport {
    /// Objects whose visibility was verified.
    pub visible_checked: u64,
    /// Objects that are certainly hidden.
    pub hidden_checked: u64,
    /// What is wrong, as sentences; empty if the result is proved.
    pub failed: Vec<String>,
}

/// Verifies the result of a bake for one cell: every visible object is visible, every object that
/// is listed neither as visible nor as unknown is hidden, and every claim holds.
///
/// Exact, single-threaded, and indifferent to what the bytes hold: a damaged proof fails.
#[must_use]
pub fn check_cell(
    scene: &Scene,
    cell: &ViewCell,
    visible: &[VisibleEntry],
    unknown: &[ObjectId],
    accuracy: Accuracy,
    proof: &[u8],
) -> CheckReport {
    let mut report = CheckReport::default();
    if !on_the_grid(&cell.bounds) {
        report.fail(cell, "its box is inverted or reaches beyond the grid");
        return report;
    }
    let Some(source) = Source::new(scene, cell) else {
        report.fail(cell, "its source object is not in the scene");
        return report;
    };
    let check = CellCheck {
        scene,
        cell,
        source,
        accuracy,
    };
    check.label(&mut report);
    let listed = check.visible(visible, unknown, &mut report);
    match CellProof::from_bytes(proof) {
        Ok(proof) => {
            let covered = check.claims(&proof.claims, &mut report);
            check.hidden(&listed, &covered, &mut report);
        }
        Err(error) => report.fail(cell, &error.to_string()),
    }
    report
}

fn on_the_grid(bounds: &Aabb) -> bool {
    let pairs = bounds.min.to_array().into_iter().zip(bounds.max.to_array());
    pairs
        .into_iter()
        .all(|(low, high)| -LIMIT < low && low <= high && high < LIMIT)
}

impl CheckReport {
    fn fail(&mut self, cell: &ViewCell, what: &str) {
        self.failed.push(format!("cell {}: {what}", cell.name));
    }
}

struct CellCheck<'a> {
    scene: &'a Scene,
    cell: &'a ViewCell,
    source: Source,
    accuracy: Accuracy,
}

impl CellCheck<'_> {
    fn describe(&self, id: ObjectId) -> String {
        match self.scene.objects().get(id.index()) {
            Some(object) => format!("object {} \"{}\"", id.0, object.name),
            None => format!("object {}", id.0),
        }
    }

    /// A box cell that an occluder enters cannot be exact.
    fn label(&self, report: &mut CheckReport) {
        if self.accuracy != Accuracy::Exact || !self.source.is_box {
            return;
        }
        let mut entering = None;
        for_each_in_box(self.scene, &self.cell.bounds, |polygon| {
            if polygon.occludes
                && entering.is_none()
                && box_contact(polygon, &self.cell.bounds) == BoxContact::Enters
            {
                entering = Some(polygon.id);
            }
        });
        if let Some(id) = entering {
            let what = format!("it is labelled exact, but occluder {} enters it", id.0);
            report.fail(self.cell, &what);
        }
    }

    /// Verifies the visible entries; returns which objects need no proof of being hidden.
    fn visible(
        &self,
        visible: &[VisibleEntry],
        unknown: &[ObjectId],
        report: &mut CheckReport,
    ) -> Vec<bool> {
        let mut listed = vec![false; self.scene.objects().len()];
        for id in unknown {
            match listed.get_mut(id.index()) {
                Some(entry) => *entry = true,
                None => report.fail(
                    self.cell,
                    &format!("unknown object {} is not in the scene", id.0),
                ),
            }
        }
        for entry in visible {
            match self.visible_entry(entry) {
                Ok(()) => report.visible_checked += 1,
                Err(what) => {
                    let object = self.describe(entry.object);
                    report.fail(
                        self.cell,
                        &format!("{object} is listed as visible, but {what}"),
                    );
                }
            }
            if let Some(entry) = listed.get_mut(entry.object.index()) {
                *entry = true;
            }
        }
        listed
    }

    fn visible_entry(&self, entry: &VisibleEntry) -> Result<(), String> {
        let Some(object) = self.scene.objects().get(entry.object.index()) else {
            return Err("it is not in the scene".into());
        };
        if entry.touching {
            let mut polygons = self.scene.polygons_of(entry.object);
            return if polygons.any(|polygon| self.touches(&polygon)) {
                Ok(())
            } else {
                Err("it does not touch the cell".into())
            };
        }
        let Some(witness) = &entry.witness else {
            return Err("it has no witness and does not claim to touch the cell".into());
        };
        if !object.polygons.contains(&witness.polygon.0) {
            return Err(format!(
                "its witness ends on polygon {}, which is not its own",
                witness.polygon.0
            ));
        }
        witness::check_witness(self.scene, &self.source, witness)
            .map_err(|what| format!("its witness fails: {what}"))
    }

    /// Whether a polygon meets the closed cell.
    fn touches(&self, polygon: &PolygonRef<'_>) -> bool {
        if self.source.is_box {
            return box_contact(polygon, &self.cell.bounds) != BoxContact::Apart;
        }
        let mut own = self
            .source
            .own
            .clone()
            .map(|i| self.scene.polygon(PolygonId(i)));
        own.any(|other| polygons_touch(polygon, &other))
    }

    /// Verifies all claims; returns which polygons the valid ones hide.
    fn claims(&self, claims: &[Claim], report: &mut CheckReport) -> Vec<bool> {
        let mut covered = vec![false; self.scene.polygon_count()];
        let may_ignore = matches!(self.accuracy, Accuracy::AggressiveBelow(_));
        for (number, claim) in claims.iter().enumerate() {
            if let Err(what) = claims::check_claim(self.scene, &self.source, may_ignore, claim) {
                let target = match claim.target {
                    Target::Box(Aabb { min, max }) => {
                        format!("the box from {:?} to {:?}", min.to_array(), max.to_array())
                    }
                    Target::Polygon(id) => format!("polygon {}", id.0),
                };
                report.fail(self.cell, &format!("claim {number} about {target}: {what}"));
                continue;
            }
            match claim.target {
                Target::Polygon(id) => covered[id.index()] = true,
                Target::Box(bounds) => for_each_in_box(self.scene, &bounds, |polygon| {
                    if bounds.contains(&polygon.bounds()) {
                        covered[polygon.id.index()] = true;
                    }
                }),
            }
        }
        covered
    }

    /// Every object that is not listed is hidden.
    fn hidden(&self, listed: &[bool], covered: &[bool], report: &mut CheckReport) {
        for (i, object) in self.scene.objects().iter().enumerate() {
            let polygons = object.polygons.clone();
            if listed[i] || polygons.is_empty() || polygons == self.source.own {
                continue;
            }
            let id = ObjectId(i as u32);
            if let Some(open) = polygons.clone().find(|&k| !covered[k as usize]) {
                let object = self.describe(id);
                let what = format!(
                    "{object} is listed neither as visible nor as unknown, but no valid claim hides its polygon {open}"
                );
                report.fail(self.cell, &what);
            } else if self.scene.polygons_of(id).any(|p| self.touches(&p)) {
                let object = self.describe(id);
                report.fail(
                    self.cell,
                    &format!("{object} touches the cell but is not listed"),
                );
            } else {
                report.hidden_checked += 1;
            }
        }
    }
}

/// Calls `visit` for every polygon that may meet a box, some more than once.
fn for_each_in_box(scene: &Scene, bounds: &Aabb, mut visit: impl FnMut(&PolygonRef<'_>)) {
    let kd = scene.kd();
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    let mut stack = vec![0_usize];
    while let Some(node) = stack.pop() {
        match kd.nodes().get(node) {
            None => {}
            Some(&KdNode::Inner {
                axis,
                at,
                lower,
                upper,
            }) => {
                if low[usize::from(axis)] <= at {
                    stack.push(lower as usize);
                }
                if high[usize::from(axis)] >= at {
                    stack.push(upper as usize);
                }
            }
            Some(&KdNode::Leaf { first, count }) => {
                for &id in kd.leaf_items(first, count) {
                    visit(&scene.polygon(id));
                }
            }
        }
    }
}
