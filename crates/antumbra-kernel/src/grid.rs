//! The border between floats and integers: scene coordinates are snapped here, once.

use crate::point::{LIMIT, Point};

/// An integer grid laid over scene space: `scene = origin + step * grid`.
///
/// Everything after [`Grid::snap`] is exact for the snapped scene; [`Grid::to_scene`] is for
/// output only and never feeds a predicate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    origin: [f64; 3],
    step: f64,
}

/// Which way a coordinate goes when it lies between two grid values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// To the nearest grid value (scenes).
    Nearest,
    /// Towards minus infinity (lower corners of cells).
    Down,
    /// Towards plus infinity (upper corners of cells).
    Up,
}

/// Why a point could not be snapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SnapError {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The coordinates as given.
        point: [f64; 3],
    },
    /// A coordinate lies outside the 24-bit range of the grid.
    OutOfRange {
        /// The coordinates as given.
        point: [f64; 3],
        /// The largest distance from the origin that this grid can hold.
        reach: f64,
    },
}

impl std::fmt::Display for SnapError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { point: [x, y, z] } => {
                write!(f, "the point ({x}, {y}, {z}) is not finite")
            }
            Self::OutOfRange {
                point: [x, y, z],
                reach,
            } => write!(
                f,
                "the point ({x}, {y}, {z}) is farther than {reach} from the grid's origin: choose a coarser grid"
            ),
        }
    }
}

impl std::error::Error for SnapError {}

impl Grid {
    /// A grid with a given origin and step.
    ///
    /// Returns `None` unless all numbers are finite and the step is positive.
    #[must_use]
    pub fn new(origin: [f64; 3], step: f64) -> Option<Self> {
        let ok = origin.iter().all(|c| c.is_finite()) && step.is_finite() && step > 0.0;
        ok.then_some(Self { origin, step })
    }

    /// The finest grid with a power-of-two step, centred on a box in scene units, that holds the box.
    ///
    /// A point box gets step 1. Returns `None` if the box is not finite.
    #[must_use]
    pub fn fitting(min: [f64; 3], max: [f64; 3]) -> Option<Self> {
        let half = (0..3)
            .map(|k| (max[k] / 2.0 - min[k] / 2.0).abs())
            .fold(0.0, f64::max);
        // One step is kept free on each side, so that outward rounding stays on the grid.
        let room = f64::from(LIMIT - 4);
        let mut step = 1.0_f64;
        if half > 0.0 && half.is_finite() {
            while half / step > room {
                step *= 2.0;
            }
            while half / (step / 2.0) <= room && step > f64::MIN_POSITIVE * 4.0 {
                step /= 2.0;
            }
        }
        // The origin is itself a multiple of the step, so that a re-centred scene keeps its raster.
        let origin = std::array::from_fn(|k| ((min[k] / 2.0 + max[k] / 2.0) / step).round() * step);
        Self::new(origin, step)
    }

    /// The scene coordinates of the grid point (0, 0, 0).
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The distance of two neighbouring grid values in scene units.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Snaps a point in scene units to the nearest grid point.
    ///
    /// # Errors
    /// If a coordinate is not finite or out of the grid's range.
    pub fn snap(&self, point: [f64; 3]) -> Result<Point, SnapError> {
        self.snap_with(point, [Rounding::Nearest; 3])
    }

    /// Snaps a point with a rounding of its own for each axis.
    ///
    /// # Errors
    /// If a coordinate is not finite or out of the grid's range.
    pub fn snap_with(&self, point: [f64; 3], rounding: [Rounding; 3]) -> Result<Point, SnapError> {
        if point.iter().any(|c| !c.is_finite()) {
            return Err(SnapError::NotFinite { point });
        }
        let mut out = [0_i32; 3];
        for k in 0..3 {
            let t = (point[k] - self.origin[k]) / self.step;
            let r = match rounding[k] {
                Rounding::Nearest => t.round(),
                Rounding::Down => t.floor(),
                Rounding::Up => t.ceil(),
            };
            if r.abs() >= f64::from(LIMIT) {
                let reach = f64::from(LIMIT) * self.step;
                return Err(SnapError::OutOfRange { point, reach });
            }
            // In range by the test above, so the cast is exact.
            out[k] = r as i32;
        }
        Ok(Point::from(out))
    }

    /// The scene coordinates of a grid point, for output.
    #[must_use]
    pub fn to_scene(&self, p: Point) -> [f64; 3] {
        self.to_scene_f64(p.to_f64())
    }

    /// The scene coordinates of a position given in fractional grid steps, for output.
    #[must_use]
    pub fn to_scene_f64(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + self.step * p[k])
    }

    /// Fractional grid coordinates of a scene point, for sampling and pictures.
    #[must_use]
    pub fn to_grid_f64(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (p[k] - self.origin[k]) / self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::{Grid, Rounding, SnapError};
    use crate::Point;

    #[test]
    fn the_finest_fitting_grid_holds_its_box() {
        let grid = Grid::fitting([-100.0, 0.0, 5.0], [100.0, 20.0, 9.0]).expect("finite");
        assert!(grid.step() < 0.000_024 && grid.step() > 0.000_011);
        for p in [[-100.0, 0.0, 5.0], [100.0, 20.0, 9.0]] {
            let q = grid.to_scene(grid.snap(p).expect("fits"));
            for k in 0..3 {
                assert!((q[k] - p[k]).abs() <= grid.step() / 2.0);
            }
        }
    }

    #[test]
    fn bad_points_are_refused() {
        let grid = Grid::new([0.0; 3], 1.0).expect("finite");
        assert!(matches!(
            grid.snap([f64::NAN, 0.0, 0.0]),
            Err(SnapError::NotFinite { .. })
        ));
        assert!(matches!(
            grid.snap([1e9, 0.0, 0.0]),
            Err(SnapError::OutOfRange { .. })
        ));
        assert!(Grid::new([0.0; 3], 0.0).is_none());
        assert!(Grid::fitting([0.0; 3], [f64::INFINITY; 3]).is_none());
    }

    #[test]
    fn rounding_goes_where_it_is_told() {
        let grid = Grid::new([0.0; 3], 1.0).expect("finite");
        let r = [Rounding::Down, Rounding::Up, Rounding::Nearest];
        assert_eq!(grid.snap_with([0.4, 0.4, 0.4], r), Ok(Point::new(0, 1, 0)));
    }
}
