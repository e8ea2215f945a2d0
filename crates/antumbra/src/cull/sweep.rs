//! A frame: occluders are chosen and inserted, the hierarchy is swept, what is left is visible.

use antumbra_scene::ObjectId;

use super::bound::snap_eye;
use super::coherence::{Memory, State};
use super::fragment::Block;
use super::hierarchy::{Bounds, LeafFace};
use super::options::{LeafTest, Method, Order, Selection};
use super::select::keep_largest;
use super::tree::ROOT;
use super::{Camera, CullWork, Culler, Visible};

/// Which look at a frame it is. Each has a number of its own among the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    First,
    /// Asks only for what the first one has seen.
    Second,
}

impl Pass {
    /// Whether an object that was last seen in some frame is still to be asked for.
    #[inline]
    fn asks(self, last: u32, frame: u32) -> bool {
        match self {
            Self::First => last != frame,
            Self::Second => last + 1 == frame,
        }
    }
}

impl Culler {
    /// What a camera may see: everything that is not surely hidden or outside its frustum.
    ///
    /// Never panics, never allocates. An eye too far away for exact differences gets what is in the
    /// frustum.
    pub fn cull(&mut self, camera: &Camera) -> &Visible {
        if self.options.coherence.reuse_tree && self.eye.is_some() && self.rests == Some(*camera) {
            self.visible.work = CullWork {
                tree_reused: true,
                ..CullWork::default()
            };
            return &self.visible;
        }
        self.rests = Some(*camera);
        self.visible.objects.clear();
        self.visible.work = CullWork::default();
        if self.visible.frame >= u32::MAX - 2 {
            self.start_anew();
        }
        let before = self.first_look;
        self.next_frame();
        self.first_look = self.visible.frame;
        self.looked = before;
        let eye = self.grid.to_grid_f64(camera.eye());
        let near = snap_eye(eye);
        let occluding = near.is_some() && self.options.method != Method::Frustum;
        let eye = near.unwrap_or(eye);
        self.pass(camera, eye, occluding, Pass::First);
        if self.options.twice && occluding && self.options.selection.sweeps() {
            // Both are right, so what one of them hides is hidden.
            self.looked = self.first_look;
            self.next_frame();
            self.visible.objects.clear();
            self.pass(camera, eye, occluding, Pass::Second);
        }
        if !self.options.selection.sweeps() {
            self.choose_for_next(eye);
        }
        self.visible.objects.sort_unstable();
        let work = &mut self.visible.work;
        work.occluders = self.planted.len() as u64;
        work.tree_nodes = self.tree.node_count() as u64;
        self.costs.learn();
        &self.visible
    }

    fn pass(&mut self, camera: &Camera, eye: [f64; 3], occluding: bool, pass: Pass) {
        self.start_tree(camera, eye, occluding, pass);
        let regional = matches!(self.options.selection, Selection::Region { .. });
        self.given = if regional { self.tree.visits } else { 0 };
        self.sweep(eye, occluding, pass);
        self.visible.work.tree_steps += self.tree.steps;
        self.visible.work.tree_visits += self.tree.visits;
    }

    /// Starts again as a new culler does: before the numbers of frames run out, and after the look
    /// around. Never between the two looks at a frame: the second one asks by number for what the first
    /// one saw.
    pub(super) fn start_anew(&mut self) {
        self.visible.frames.fill(0);
        self.tried.fill(0);
        self.hidden.fill(0);
        self.memory.fill(Memory::NEW);
        self.visible.frame = 0;
        self.visible.objects.clear();
        self.visible.work = CullWork::default();
        self.first_look = u32::MAX;
        self.planted.clear();
        self.chosen.clear();
        self.eye = None;
    }

    fn next_frame(&mut self) {
        let visible = &mut self.visible;
        // The first frame is number 2: what was never seen was not seen in the frame before.
        visible.frame = visible.frame.max(1) + 1;
        self.seen_leaves.clear();
    }

    /// Builds the tree of the occluders that a frame starts with, or keeps the one there is.
    fn start_tree(&mut self, camera: &Camera, eye: [f64; 3], occluding: bool, pass: Pass) {
        let reuse = self.options.coherence.reuse_tree;
        let edges = camera.edges();
        if reuse && occluding && pass == Pass::First && self.eye == Some(eye) {
            self.tree.turn(&edges);
            self.visible.work.tree_reused = true;
            for &occluder in &self.planted {
                self.tried[occluder as usize] = self.visible.frame;
            }
            return;
        }
        if self.options.selection.sweeps() {
            self.choose_again();
        }
        if pass == Pass::First
            && let Selection::Region { sweep, .. } = self.options.selection
            && let Some(leaf) = self.hierarchy.leaf_at(eye)
        {
            if !sweep {
                self.chosen.clear();
            }
            let frame = self.visible.frame;
            for &(_, occluder) in &self.chosen {
                self.tried[occluder as usize] = frame;
            }
            let nodes = &self.hierarchy.nodes;
            let list = self.regions.of(leaf, |n| nodes[n as usize].parent);
            let list = &list[..list.len().min(self.options.max_occluders)];
            let tried = &self.tried;
            let more = list.iter().filter(|&&o| tried[o as usize] != frame);
            self.chosen.extend(more.map(|&o| (0.0, o)));
        }
        let marking = self.options.method != Method::Standard;
        self.tree.start(eye, &edges, occluding, reuse, marking);
        self.planted.clear();
        self.eye = occluding.then_some(eye);
        if !occluding {
            return;
        }
        let occluders = &self.occluders;
        for (key, occluder) in &mut self.chosen {
            *key = match pass {
                Pass::First => {
                    let near = occluders.bounds[*occluder as usize].squared_distance(eye);
                    match self.options.order {
                        Order::Prominence => {
                            near / occluders.area_angle(*occluder, eye).min(6.0).sqrt()
                        }
                        Order::Distance | Order::Autopartition => near,
                    }
                }
                Pass::Second => -occluders.area_angle(*occluder, eye),
            };
        }
        self.chosen
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if self.options.order == Order::Autopartition {
            self.occluders.partition(&mut self.chosen, eye);
        }
        for i in 0..self.chosen.len() {
            self.insert(self.chosen[i].1);
        }
    }

    /// Chooses the occluders that hid something in the frame before.
    fn choose_again(&mut self) {
        self.chosen.clear();
        self.tree.spread_hits();
        let hits = self.tree.hits.iter().zip(&self.planted);
        self.chosen
            .extend(hits.filter(|(hits, _)| **hits > 0).map(|(_, &o)| (0.0, o)));
    }

    /// Chooses the occluders of the next frame: the best in visible leaves [Bittner02, 4.5].
    fn choose_for_next(&mut self, eye: [f64; 3]) {
        let distance = match self.options.selection {
            Selection::Previous { distance } => distance / self.grid.step(),
            _ => f64::INFINITY,
        };
        self.chosen.clear();
        for &leaf in &self.seen_leaves {
            let occluders = self.hierarchy.nodes[leaf as usize].occluders;
            let cell = Bounds::of(&self.hierarchy.cells[leaf as usize].bounds);
            let middle: [f64; 3] = std::array::from_fn(|k| (cell.low[k] + cell.high[k]) * 0.5);
            let from_eye = super::bound::sub(middle, eye);
            if super::bound::dot(from_eye, from_eye).sqrt() > distance {
                continue;
            }
            for i in occluders.0..occluders.1 {
                let occluder = self.hierarchy.occluders[i as usize].number;
                // Marks of the next frame, which nothing else has set yet.
                let mark = &mut self.tried[occluder as usize];
                if *mark != u32::MAX {
                    *mark = u32::MAX;
                    self.chosen
                        .push((self.occluders.area_angle(occluder, eye), occluder));
                }
            }
        }
        for (_, occluder) in &self.chosen {
            self.tried[*occluder as usize] = 0;
        }
        self.chosen
            .retain(|(angle, _)| *angle >= self.options.min_angle);
        keep_largest(&mut self.chosen, self.options.max_occluders);
    }

    fn insert(&mut self, occluder: u32) {
        let work = &mut self.visible.work;
        let done = self.tree.visits > self.options.max_visits
            || work.occluders_tried >= self.options.max_occluders as u64;
        let owner = self.occluders.owners[occluder as usize];
        if done || owner.is_some_and(|door| self.open[door as usize]) {
            return;
        }
        self.tried[occluder as usize] = self.visible.frame;
        work.occluders_tried += 1;
        if self.tree.insert(&self.occluders.faces.get(occluder)) {
            self.planted.push(occluder);
        }
    }

    fn sweep(&mut self, eye: [f64; 3], occluding: bool, pass: Pass) {
        if self.hierarchy.nodes.is_empty() {
            return;
        }
        let minimum = self.costs.least();
        self.stack.clear();
        self.stack.push((0, ROOT));
        while let Some((number, mut entry)) = self.stack.pop() {
            let node = &self.hierarchy.nodes[number as usize];
            let (children, axis, at) = (node.children, node.axis as usize, f64::from(node.at));
            let tests = self.visible.work.node_tests;
            let state = self.classify(number, eye, (occluding, pass), minimum, &mut entry);
            let before = self.memory[number as usize];
            self.memory[number as usize] = Memory {
                frame: self.visible.frame,
                state: state.0,
                hidden_children: 0,
                propagated: state.1,
                tested: self.visible.work.node_tests > tests,
                ..before.carried(state.0, pass, self.looked, self.visible.frame)
            };
            match (state.0, children) {
                (State::Passed, _) => {}
                (State::Outside | State::Invisible, _) => self.pull_up(number, pass),
                (State::Visible, Some([lower, upper])) => {
                    let (near, far) = if eye[axis] < at {
                        (lower, upper)
                    } else {
                        (upper, lower)
                    };
                    self.stack.push((far, entry));
                    self.stack.push((near, entry));
                }
                (State::Visible, None) => {
                    self.leaf(number, eye, (occluding, pass), minimum, entry, before);
                }
            }
        }
    }

    /// The state of a node, and whether its neighbors told it [Bittner02, Figure 4.4].
    fn classify(
        &mut self,
        number: u32,
        eye: [f64; 3],
        (occluding, pass): (bool, Pass),
        minimum: [f32; 2],
        entry: &mut u32,
    ) -> (State, bool) {
        let node = &self.hierarchy.nodes[number as usize];
        let frame = self.visible.frame;
        let before = self.memory[number as usize];
        let remembered = before.frame + 1 == frame;
        let was_visible = remembered && before.state == State::Visible;
        let propagating = self.propagation.is_some();
        if node.empty && !propagating {
            return (State::Invisible, false);
        }
        // Nothing new can be found in it but occluders.
        let thorough = self.options.thorough && pass == Pass::First;
        if !thorough
            && let Some((first, end)) = node.objects
            && first < end
        {
            let objects = &self.hierarchy.objects[first as usize..end as usize];
            let frames = &self.visible.frames;
            if objects
                .iter()
                .all(|&o| !pass.asks(frames[o as usize], frame))
            {
                return (State::Passed, false);
            }
        }
        // States of cells are needed where they are passed on.
        let bounds = if propagating {
            Bounds::of(&self.hierarchy.cells[number as usize].bounds)
        } else {
            node.bounds.wide()
        };
        let block = bounds.seen_from(eye);
        if self.options.coherence.updating
            && node.children.is_some()
            && before.opened == self.looked
        {
            // A turning head would find it out by all the nodes below.
            if self.tree.is_outside(&block) {
                return (State::Outside, false);
            }
            self.visible.work.nodes_skipped += 1;
            return (State::Visible, false);
        }
        if !occluding || self.costs.of_node(number) < minimum[0] {
            let outside = self.tree.is_outside(&block);
            let state = if outside {
                State::Outside
            } else {
                State::Visible
            };
            self.visible.work.node_tests += u64::from(!occluding);
            return (state, false);
        }
        if was_visible && node.children.is_none() && self.happens(self.skip.value()) {
            self.visible.work.leaves_kept += 1;
            return (State::Visible, false);
        }
        if propagating && !was_visible {
            let succeeded = remembered && before.propagated;
            if (succeeded || self.happens(self.propagate.value())) && self.propagated(number, eye) {
                self.visible.work.nodes_propagated += 1;
                return (State::Invisible, true);
            }
        }
        self.visible.work.node_tests += 1;
        let steps = self.tree.steps;
        let hidden = self.hides(&block, entry);
        self.costs.of_nodes.add(self.tree.steps - steps, hidden);
        self.visible.work.nodes_hidden += u64::from(hidden);
        if was_visible && self.hierarchy.nodes[number as usize].children.is_none() {
            self.skip.learn(!hidden);
        }
        let state = if !hidden {
            State::Visible
        } else if self.tree.is_outside(&block) {
            State::Outside
        } else {
            State::Invisible
        };
        (state, false)
    }

    fn propagated(&mut self, number: u32, eye: [f64; 3]) -> bool {
        let frame = self.visible.frame;
        let Some(propagation) = &mut self.propagation else {
            return false;
        };
        let hidden = propagation.hides(&self.kd, &self.hierarchy, &self.memory, number, eye, frame);
        self.propagate.learn(hidden);
        hidden
    }

    /// Whether nothing of a box can be seen, by the chosen method.
    fn hides(&mut self, block: &Block, entry: &mut u32) -> bool {
        match self.options.method {
            Method::Frustum => false,
            Method::Standard => self.tree.hides_faces(block),
            Method::Modified(test) => self.tree.hides_box(block, test, entry),
            Method::Inner => self.tree.hides_outline(block, LeafTest::Exact),
        }
    }

    /// Visibility of a leaf's objects; its occluders come first.
    fn leaf(
        &mut self,
        number: u32,
        eye: [f64; 3],
        (occluding, pass): (bool, Pass),
        minimum: [f32; 2],
        entry: u32,
        before: Memory,
    ) {
        let node = &self.hierarchy.nodes[number as usize];
        let (items, occluders, bounds) = (node.items, node.occluders, node.bounds.wide());
        let cheap = occluding && self.costs.of_node(number) < minimum[0];
        self.seen_leaves.push(number);
        if occluding && self.options.selection.sweeps() {
            self.insert_of_leaf(occluders, bounds, eye);
        }
        let frame = self.visible.frame;
        let kept = self.options.coherence.skip.is_some() && before.frame + 1 == frame;
        for i in items.0..items.1 {
            let item = self.hierarchy.items[i as usize];
            let last = self.visible.frames[item.object as usize];
            if !pass.asks(last, frame) {
                continue;
            }
            let stays = kept && last + 1 == frame && self.happens(self.skip.value());
            let cheap = cheap || occluding && self.costs.objects[item.object as usize] < minimum[1];
            if stays || cheap || self.asked(i, eye, occluding, entry) {
                self.visible.frames[item.object as usize] = frame;
                self.visible.objects.push(ObjectId(item.object));
            }
        }
    }

    /// As `shows`, and remembers what it costs.
    fn asked(&mut self, item: u32, eye: [f64; 3], occluding: bool, entry: u32) -> bool {
        let steps = self.tree.steps;
        let shown = self.shows(item, eye, occluding, entry);
        self.costs.of_items.add(self.tree.steps - steps, !shown);
        shown
    }

    /// Whether something of an item may be seen.
    fn shows(&mut self, item: u32, eye: [f64; 3], occluding: bool, mut entry: u32) -> bool {
        let item = self.hierarchy.items[item as usize];
        let block = item.bounds.seen_from(eye);
        if !occluding {
            return !self.tree.is_outside(&block);
        }
        self.visible.work.item_tests += 1;
        if self.hides(&block, &mut entry) {
            return false;
        }
        if !self.options.polygons {
            return true;
        }
        for i in item.first..item.first + item.count {
            let LeafFace { face, whole } = self.hierarchy.polygons[i as usize];
            if self.hidden[face as usize] == self.visible.frame {
                continue;
            }
            self.visible.work.polygon_tests += 1;
            let entry = if whole { entry } else { ROOT };
            if !self.tree.hides_polygon(&self.polygons.get(face), entry) {
                return true;
            }
            self.hidden[face as usize] = self.visible.frame;
        }
        false
    }

    /// The smallest area-angle now: what insertion costs is weighed against what is seen. Beyond some
    /// dozens of objects it is not the occluders that are lacking.
    fn min_angle(&self) -> f64 {
        let seen = self.visible.objects.len().min(60) as f64;
        let calm = self.options.calm_visits as f64 * (1.0 + seen / 4.0);
        let excess = ((self.tree.visits - self.given) as f64 / calm).max(1.0);
        self.options.min_angle * excess.powi(5)
    }

    /// Inserts the occluders of a leaf that look large enough and are not hidden, the nearest first.
    fn insert_of_leaf(&mut self, occluders: (u32, u32), bounds: Bounds, eye: [f64; 3]) {
        let min_angle = self.min_angle();
        let smallest = min_angle * bounds.squared_distance(eye);
        self.near.clear();
        for i in occluders.0..occluders.1 {
            let here = &self.hierarchy.occluders[i as usize];
            // The largest come first. Their part in this leaf is no nearer than the leaf.
            if f64::from(here.area) < smallest {
                break;
            }
            let occluder = here.number;
            if self.tried[occluder as usize] == self.visible.frame
                || here.area_angle(eye) < min_angle
            {
                continue;
            }
            self.tried[occluder as usize] = self.visible.frame;
            let distance = self.occluders.bounds[occluder as usize].squared_distance(eye);
            self.near.push((distance, occluder));
        }
        self.near
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for i in 0..self.near.len() {
            let occluder = self.near[i].1;
            let block = self.occluders.bounds[occluder as usize].seen_from(eye);
            if !self.tree.hides_box(&block, LeafTest::Exact, &mut { ROOT }) {
                self.insert(occluder);
            }
        }
    }

    /// Tells the nodes above that one is hidden: with all its children a node is hidden, too.
    fn pull_up(&mut self, mut number: u32, pass: Pass) {
        while number != 0 {
            number = self.hierarchy.nodes[number as usize].parent;
            let memory = &mut self.memory[number as usize];
            memory.hidden_children += 1;
            if memory.hidden_children < 2 {
                return;
            }
            memory.close(pass);
        }
    }

    /// A coin with a probability; xorshift.
    fn happens(&mut self, probability: f64) -> bool {
        if probability <= 0.0 {
            return false;
        }
        let x = &mut self.random;
        *x ^= *x << 13;
        *x ^= *x >> 7;
        *x ^= *x << 17;
        ((*x >> 11) as f64) < probability * (1_u64 << 53) as f64
    }
}
