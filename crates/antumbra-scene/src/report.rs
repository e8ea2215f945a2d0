//! What the builder did to a scene: every repair, by object.

use std::fmt;

use crate::ObjectId;

/// What became of the input of a [`crate::SceneBuilder`].
///
/// [`fmt::Display`] writes a summary line and one line for each repaired object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// The grid step in scene units.
    pub grid_step: f64,
    /// The largest distance that snapping moved a vertex, in scene units.
    pub largest_movement: f64,
    /// How many objects there are.
    pub objects: usize,
    /// How many faces were given.
    pub faces: usize,
    /// How many polygons the scene has.
    pub polygons: usize,
    /// How many of them are occluders.
    pub occluders: usize,
    /// The objects to which something happened beyond snapping and merging, by id.
    pub repairs: Vec<ObjectRepairs>,
}

/// What was repaired in one object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectRepairs {
    /// The object.
    pub object: ObjectId,
    /// Its name.
    pub name: String,
    /// The counts.
    pub counts: RepairCounts,
}

/// How often each repair was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RepairCounts {
    /// Faces without area on the grid: dropped.
    pub degenerate: usize,
    /// Faces that repeat another one of the object: dropped.
    pub duplicate: usize,
    /// Polygons, after merging, that others of the object cover in the same plane: dropped.
    pub covered: usize,
    /// Faces that are not planar or not convex on the grid: cut into triangles.
    pub triangulated: usize,
    /// Vertices within one grid step of an edge they do not belong to: inserted.
    pub inserted: usize,
    /// Triangles added to close the slits between such vertices and their edges.
    pub sealing: usize,
}

impl RepairCounts {
    /// Whether nothing was repaired.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The counts of both.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            degenerate: self.degenerate + other.degenerate,
            duplicate: self.duplicate + other.duplicate,
            covered: self.covered + other.covered,
            triangulated: self.triangulated + other.triangulated,
            inserted: self.inserted + other.inserted,
            sealing: self.sealing + other.sealing,
        }
    }
}

impl BuildReport {
    /// The repairs of all objects together.
    #[must_use]
    pub fn totals(&self) -> RepairCounts {
        self.repairs
            .iter()
            .fold(RepairCounts::default(), |sum, r| sum.plus(&r.counts))
    }
}

impl fmt::Display for RepairCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            (self.degenerate, "degenerate faces dropped"),
            (self.duplicate, "duplicate faces dropped"),
            (
                self.triangulated,
                "faces not planar or not convex cut into triangles",
            ),
            (
                self.inserted,
                "vertices inserted into edges within a grid step",
            ),
            (self.sealing, "triangles added to close the slits"),
        ];
        let mut first = true;
        for (count, what) in parts.into_iter().filter(|(count, _)| *count > 0) {
            let comma = if first { "" } else { ", " };
            write!(f, "{comma}{count} {what}")?;
            first = false;
        }
        if first {
            write!(f, "nothing repaired")
        } else {
            Ok(())
        }
    }
}

impl fmt::Display for BuildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} objects, {} faces, {} polygons ({} occluders), grid step {}, moved by {:.3e} at most",
            self.objects,
            self.faces,
            self.polygons,
            self.occluders,
            self.grid_step,
            self.largest_movement
        )?;
        for ObjectRepairs {
            object,
            name,
            counts,
        } in &self.repairs
        {
            writeln!(f, "object {} \"{name}\": {counts}", object.0)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{BuildReport, ObjectRepairs, RepairCounts};
    use crate::ObjectId;

    #[test]
    fn the_report_reads_as_sentences() {
        let counts = RepairCounts {
            degenerate: 2,
            inserted: 1,
            sealing: 1,
            ..Default::default()
        };
        let repairs = vec![
            ObjectRepairs {
                object: ObjectId(3),
                name: "wall".into(),
                counts,
            },
            ObjectRepairs {
                object: ObjectId(5),
                name: "slab".into(),
                counts,
            },
        ];
        let report = BuildReport {
            objects: 6,
            grid_step: 0.5,
            repairs,
            ..Default::default()
        };
        assert_eq!(report.totals().degenerate, 4);
        let text = report.to_string();
        assert!(
            text.contains("object 3 \"wall\": 2 degenerate faces dropped, 1 vertices inserted"),
            "{text}"
        );
        assert_eq!(RepairCounts::default().to_string(), "nothing repaired");
        assert!(RepairCounts::default().is_empty() && !counts.is_empty());
    }
}
