//! Where the faces of a cell go on the grid: outwards, but never past a wall they stand on.
//!
//! A wall snaps to the nearest grid value, a cell outwards. So a cell that was flush with a wall
//! might reach one step beyond it, and see through it. Therefore a face goes to the plane of an
//! occluder that lies less than one step from it, to the nearer one of two, and outwards only
//! where there is none. One step, not half of one: files hold coordinates as 32-bit floats, which
//! are as coarse as the grid, so that flush faces may differ by half a step before they are snapped.
//!
//! Equal coordinates go to equal grid values if there is a wall, and to both sides of the
//! coordinate if there is none: so neighbors never leave a slit between them.

use antumbra_kernel::LIMIT;
use rustc_hash::FxHashSet;

use crate::Scene;

/// The axis-parallel planes in which occluders lie, by axis.
pub(super) struct Walls {
    planes: [FxHashSet<i32>; 3],
}

/// Which face of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Low,
    High,
}

impl Walls {
    /// The planes of a scene; linear in its size.
    pub(super) fn of(scene: &Scene) -> Self {
        let mut planes: [FxHashSet<i32>; 3] = Default::default();
        for polygon in scene.polygons().filter(|polygon| polygon.occludes) {
            let axes = polygon.plane.normal.map(|n| n != 0);
            if let [true, false, false] | [false, true, false] | [false, false, true] = axes {
                for k in (0..3).filter(|&k| axes[k]) {
                    planes[k].insert(polygon.corners[0].to_array()[k]);
                }
            }
        }
        Self { planes }
    }

    /// The grid values of the lower and the upper face of a cell along an axis, from coordinates
    /// in fractional grid steps. They differ by one step at least.
    pub(super) fn span(&self, axis: usize, low: f64, high: f64) -> (i32, i32) {
        let flush = (
            self.face(axis, low, End::Low),
            self.face(axis, high, End::High),
        );
        if flush.0 < flush.1 {
            return flush;
        }
        // Thinner than a step: the cell must keep an interior.
        let (low, high) = (outwards(low, End::Low), outwards(high, End::High));
        if low < high {
            (low, high)
        } else {
            (low.min(LIMIT - 2), low.min(LIMIT - 2) + 1)
        }
    }

    fn face(&self, axis: usize, at: f64, end: End) -> i32 {
        let nearest = on_grid(at.round());
        let other = on_grid(at.floor()) + on_grid(at.ceil()) - nearest;
        let is_wall = |value: &i32| self.planes[axis].contains(value);
        [nearest, other]
            .into_iter()
            .find(is_wall)
            .unwrap_or_else(|| outwards(at, end))
    }
}

fn outwards(at: f64, end: End) -> i32 {
    on_grid(match end {
        End::Low => at.floor(),
        End::High => at.ceil(),
    })
}

/// A whole grid value, cut off at the ends of the grid.
fn on_grid(value: f64) -> i32 {
    let end = f64::from(LIMIT - 1);
    value.clamp(-end, end) as i32
}

#[cfg(test)]
mod tests {
    use super::Walls;

    fn walls(x: &[i32]) -> Walls {
        let planes = [
            x.iter().copied().collect(),
            Default::default(),
            Default::default(),
        ];
        Walls { planes }
    }

    #[test]
    fn without_walls_faces_go_outwards() {
        assert_eq!(walls(&[]).span(0, 2.6, 7.4), (2, 8));
        assert_eq!(walls(&[3, 7]).span(1, 2.6, 7.4), (2, 8));
        assert_eq!(walls(&[]).span(0, 2.0, 7.0), (2, 7));
    }

    #[test]
    fn a_face_stays_at_the_wall_it_stands_on() {
        assert_eq!(walls(&[3, 7]).span(0, 2.6, 7.4), (3, 7));
        assert_eq!(walls(&[3, 7]).span(0, 2.1, 7.9), (3, 7));
        assert_eq!(walls(&[2, 8]).span(0, 2.6, 7.4), (2, 8));
        assert_eq!(walls(&[2, 3, 7, 8]).span(0, 2.6, 7.4), (3, 7));
        // One step away is not flush.
        assert_eq!(walls(&[3, 6]).span(0, 2.0, 7.0), (2, 7));
    }

    #[test]
    fn neighbors_leave_no_slit() {
        for list in [&[][..], &[4], &[5], &[4, 5]] {
            for at in [4.0, 4.2, 4.5, 4.8, 5.0] {
                let walls = walls(list);
                let (below, above) = (walls.span(0, 1.0, at), walls.span(0, at, 9.0));
                assert!(below.1 >= above.0, "{list:?} at {at}");
                let near = [at.floor() as i32, at.ceil() as i32];
                assert!(below.1 == above.0 || !near.iter().any(|n| list.contains(n)));
            }
        }
    }

    #[test]
    fn a_thin_cell_keeps_an_interior() {
        assert_eq!(walls(&[]).span(0, 4.0, 4.0), (4, 5));
        assert_eq!(walls(&[4]).span(0, 3.8, 4.1), (3, 5));
        let end = antumbra_kernel::LIMIT - 1;
        assert_eq!(
            walls(&[]).span(0, f64::from(end), f64::from(end)),
            (end - 1, end)
        );
    }
}
