//! The choices of the papers as options.

use antumbra::cull::{CullOptions, LeafTest, Method, MinimumCost, Order, Probability, Selection};
use antumbra_scene::{ObjectId, Scene};
use clap::{Args, ValueEnum};

use crate::classes::listing;
use crate::failure::Failure;

/// How to cull.
#[derive(Args, Clone, Debug)]
pub(super) struct MethodArgs {
    /// A set of options to start from
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    preset: Preset,
    /// How nodes are tested
    #[arg(long, value_enum, value_name = "METHOD")]
    method: Option<MethodArg>,
    /// Where the occluders of a frame come from
    #[arg(long, value_enum, value_name = "FROM")]
    select: Option<SelectArg>,
    /// How far away, in scene units; goes with `--select previous`, and means it if no other is given
    #[arg(long, value_name = "LENGTH", value_parser = crate::values::positive)]
    within: Option<f64>,
    /// The most occluders of a frame
    #[arg(long, value_name = "N")]
    best: Option<usize>,
    /// The most occluders found for a region
    #[arg(long, value_name = "N", default_value_t = 128)]
    region_best: usize,
    /// The smallest area-angle of an occluder, in steradians
    #[arg(long, value_name = "SR", value_parser = cost)]
    min_angle: Option<f64>,
    /// In which order occluders are inserted
    #[arg(long, value_enum, value_name = "ORDER")]
    order: Option<OrderArg>,
    /// Nodes whose objects have fewer polygons are not tested: a number, or `auto`, by what drawing and tests cost
    #[arg(long, value_name = "N", value_parser = minimum)]
    minimum_cost: Option<MinimumCost>,
    /// With `--minimum-cost auto`: drawing an object costs as much as so many visited tree nodes, some 3 ns each
    #[arg(long, value_name = "N", default_value_t = 300.0, value_parser = cost, requires = "minimum_cost")]
    object_cost: f64,
    /// The same of each of its triangles
    #[arg(long, value_name = "N", default_value_t = 2.0, value_parser = cost, requires = "minimum_cost")]
    triangle_cost: f64,
    /// Test every node in every frame
    #[arg(long)]
    no_updating: bool,
    /// The probability to keep a visible leaf untested, or `auto`
    #[arg(long, value_name = "P", value_parser = probability)]
    skip: Option<Probability>,
    /// The probability to try propagation along ropes, or `auto`
    #[arg(long, value_name = "P", value_parser = probability)]
    propagate: Option<Probability>,
    /// Keep the occlusion tree as long as the eye rests
    #[arg(long)]
    reuse_tree: bool,
    /// Test the boxes of objects only, not their polygons
    #[arg(long)]
    no_polygons: bool,
    /// Classes whose objects can be opened
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    doors: Vec<String>,
    /// Doors that are open, by name or id
    #[arg(long, value_name = "ID,ID", value_delimiter = ',', requires = "doors")]
    open: Vec<String>,
}

/// Named sets of options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// Fast and nearly tight
    #[default]
    Fast,
    /// Every polygon may occlude
    Tight,
    /// As in the papers: FME with 32 occluders of the frame before
    Paper,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodArg {
    /// The frustum alone
    F,
    /// Plain occlusion tree, faces of boxes split
    Fse,
    /// Marked edges, boxes whole, exact test in leaves
    Fme,
    /// Marked edges, boxes whole, conservative test in leaves
    Fmc,
    /// As fme, outlines of boxes split in inner nodes
    Inner,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SelectArg {
    /// What hid something before, then whatever the sweep meets
    Sweep,
    /// The largest area-angles in leaves seen before
    Previous,
    /// The occluders of the region, found beforehand, then whatever the sweep meets
    Region,
    /// The occluders of the region alone
    RegionOnly,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OrderArg {
    /// By distance
    Distance,
    /// By squared distance over the square root of the area-angle
    Prominence,
    /// By an autopartition BSP
    Autopartition,
}

fn cost(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(cost) if cost.is_finite() && cost >= 0.0 => Ok(cost),
        _ => Err("expected a number that is not negative".to_owned()),
    }
}

fn probability(text: &str) -> Result<Probability, String> {
    if text == "auto" {
        return Ok(Probability::SelfTuned);
    }
    match text.parse::<f64>() {
        Ok(p) if (0.0..=1.0).contains(&p) => Ok(Probability::Fixed(p)),
        _ => Err("expected a number from 0 to 1, or auto".to_owned()),
    }
}

fn minimum(text: &str) -> Result<MinimumCost, String> {
    if text == "auto" {
        // What the costs are is said by other options.
        return Ok(MinimumCost::Automatic {
            object: 0.0,
            triangle: 0.0,
        });
    }
    text.parse()
        .map(MinimumCost::Polygons)
        .map_err(|_| "expected a number of polygons, or auto".to_owned())
}

impl MethodArgs {
    /// The options, and the doors that are open.
    pub(super) fn options(
        &self,
        scene: &Scene,
        seed: u64,
    ) -> Result<(CullOptions, Vec<ObjectId>), Failure> {
        let mut options = match self.preset {
            Preset::Fast => CullOptions::default(),
            Preset::Tight => CullOptions::tight(),
            Preset::Paper => CullOptions::paper(Method::Modified(LeafTest::Exact), 32),
        };
        options.seed = seed;
        if let Some(method) = self.method {
            options.method = match method {
                MethodArg::F => Method::Frustum,
                MethodArg::Fse => Method::Standard,
                MethodArg::Fme => Method::Modified(LeafTest::Exact),
                MethodArg::Fmc => Method::Modified(LeafTest::Conservative),
                MethodArg::Inner => Method::Inner,
            };
        }
        if self.within.is_some() && !matches!(self.select, None | Some(SelectArg::Previous)) {
            return Err(Failure::Usage(
                "--within goes with --select previous alone".to_owned(),
            ));
        }
        let distance = self.within.unwrap_or(f64::INFINITY);
        match self.select {
            Some(SelectArg::Sweep) => options.selection = Selection::Sweep,
            Some(region @ (SelectArg::Region | SelectArg::RegionOnly)) => {
                options.selection = Selection::Region {
                    occluders: self.region_best,
                    sweep: region == SelectArg::Region,
                };
            }
            Some(SelectArg::Previous) => options.selection = Selection::Previous { distance },
            None if self.within.is_some() => {
                options.selection = Selection::Previous { distance };
            }
            None => {}
        }
        match self.order {
            Some(OrderArg::Distance) => options.order = Order::Distance,
            Some(OrderArg::Prominence) => options.order = Order::Prominence,
            Some(OrderArg::Autopartition) => options.order = Order::Autopartition,
            None => {}
        }
        options.max_occluders = self.best.unwrap_or(options.max_occluders);
        options.min_angle = self.min_angle.unwrap_or(options.min_angle);
        options.minimum_cost = match self.minimum_cost {
            Some(MinimumCost::Automatic { .. }) => MinimumCost::Automatic {
                object: self.object_cost,
                triangle: self.triangle_cost,
            },
            Some(given) => given,
            None => options.minimum_cost,
        };
        options.polygons &= !self.no_polygons;
        let coherence = &mut options.coherence;
        coherence.updating &= !self.no_updating;
        coherence.skip = self.skip;
        coherence.propagation = self.propagate;
        coherence.reuse_tree = self.reuse_tree;
        let open = self.doors(scene, &mut options)?;
        Ok((options, open))
    }

    fn doors(&self, scene: &Scene, options: &mut CullOptions) -> Result<Vec<ObjectId>, Failure> {
        let classes: Vec<String> = self.doors.iter().map(|c| c.to_lowercase()).collect();
        let is_door = |object: ObjectId| {
            let class = scene.object(object).class.as_deref().unwrap_or("");
            classes.contains(&class.to_lowercase())
        };
        options.doors = (0..scene.objects().len() as u32)
            .map(ObjectId)
            .filter(|&o| is_door(o))
            .collect();
        if !classes.is_empty() && options.doors.is_empty() {
            let objects = scene.objects().iter();
            let known: Vec<String> = objects.filter_map(|o| o.class.clone()).collect();
            return Err(Failure::Usage(format!(
                "--doors {}: no object has such a class; {}",
                self.doors.join(","),
                listing(&known)
            )));
        }
        let open = self.open.iter().map(|name| {
            let found = scene
                .find_object(name)
                .filter(|id| options.doors.contains(id));
            found.ok_or_else(|| {
                Failure::Usage(format!("--open {name}: no door has this name or id"))
            })
        });
        open.collect()
    }

    /// What a title calls it.
    pub(super) fn name(&self) -> String {
        let preset = match self.preset {
            Preset::Fast => "fast",
            Preset::Tight => "tight",
            Preset::Paper => "paper",
        };
        match self.method {
            Some(method) => format!("{preset}, {}", format!("{method:?}").to_uppercase()),
            None => preset.to_owned(),
        }
    }
}
