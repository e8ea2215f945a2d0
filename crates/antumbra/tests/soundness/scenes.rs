//! Where the large scenes come from: measured buildings if they are at hand, and generated ones.

use antumbra::scene::synth::{
    FloorPlan, MazeParams, OfficeKind, TriangleParams, floor, maze, office, random_triangles,
};
use antumbra::scene::{CellSpec, Scene, SceneBuilder, SceneInput, ViewCell, make_cells};
use antumbra_testkit::environment::{data, skip};
use antumbra_testkit::random::Random;

/// A scene and its view cells.
pub(crate) struct Place {
    pub name: &'static str,
    pub scene: Scene,
    pub cells: Vec<ViewCell>,
}

impl Place {
    fn new(name: &'static str, input: SceneInput, spec: &CellSpec) -> Self {
        let reach = spec.reach(&input);
        let (scene, _) = SceneBuilder::new(input)
            .cells_box(reach)
            .build()
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let cells = make_cells(&scene, spec).unwrap_or_else(|e| panic!("{name}: {e}"));
        Self { name, scene, cells }
    }

    /// Some of the cells, spread by chance; all if there are not more.
    pub(crate) fn some_cells(&self, count: usize, seed: u64) -> Vec<&ViewCell> {
        let mut cells: Vec<&ViewCell> = self.cells.iter().collect();
        if cells.len() > count {
            Random::new(seed).shuffle(&mut cells);
            cells.truncate(count);
        }
        cells
    }
}

fn grid(size: f64) -> CellSpec {
    CellSpec::Grid(size)
}

/// A measured building; says so and returns nothing if it is not at hand.
pub(crate) fn measured(name: &'static str, size: f64) -> Option<Place> {
    let path = data().map(|d| d.join(format!("walk/{name}.glb")));
    let Some(path) = path.filter(|p| p.is_file()) else {
        skip(&format!("{name}.glb is not at hand (see ANTUMBRA_DATA)"));
        return None;
    };
    let input = antumbra_io::read_scene(&path).unwrap_or_else(|e| panic!("{e}"));
    Some(Place::new(name, input, &grid(size)))
}

/// The furnished floor, with cubes of a size.
pub(crate) fn office_floor(size: f64) -> Place {
    let FloorPlan { scene, .. } = floor(7);
    Place::new("floor", scene, &grid(size))
}

/// The most crowded office, lit from its lamp.
pub(crate) fn office_light() -> Place {
    let input = office(OfficeKind::Office4Star);
    Place::new("office4star", input, &grid(2.0))
}

/// A small maze.
pub(crate) fn small_maze(size: f64) -> Place {
    let params = MazeParams {
        rooms: 4,
        furniture: 2,
        seed: 3,
    };
    Place::new("maze", maze(&params), &grid(size))
}

/// Random triangles that cross each other and the cells.
pub(crate) fn triangles(count: u32, size: f64) -> Place {
    let params = TriangleParams {
        count,
        area: 200.0,
        source_area: 50.0,
        seed: 5,
    };
    Place::new("triangles", random_triangles(&params), &grid(size))
}

/// Says a number that the run measured.
#[allow(clippy::print_stdout, reason = "the test harness captures it")]
pub(crate) fn note(text: &str) {
    println!("    {text}");
}
