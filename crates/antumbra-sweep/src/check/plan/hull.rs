//! Pieces in nested boxes: halves of halves by their middles.

use antumbra_kernel::Point2;

#[derive(Default)]
pub(super) struct Hull {
    boxes: Vec<Node>,
    order: Vec<u32>,
}

struct Node {
    low: Point2,
    high: Point2,
    range: std::ops::Range<usize>,
    children: Option<[usize; 2]>,
}

const LEAF: usize = 6;

impl Hull {
    pub(super) fn new(pieces: &[[Point2; 2]]) -> Self {
        let mut hull = Self {
            boxes: Vec::new(),
            order: (0..pieces.len() as u32).collect(),
        };
        if !pieces.is_empty() {
            hull.grow(pieces, 0..pieces.len());
        }
        hull
    }

    fn grow(&mut self, pieces: &[[Point2; 2]], range: std::ops::Range<usize>) -> usize {
        let ends = || {
            self.order[range.clone()]
                .iter()
                .flat_map(|&i| pieces[i as usize])
        };
        let pick = |f: fn(i32, i32) -> i32, of: fn(Point2) -> i32| ends().map(of).reduce(f);
        let (x, y) = (|p: Point2| p.x, |p: Point2| p.y);
        let low = Point2::new(
            pick(i32::min, x).unwrap_or(0),
            pick(i32::min, y).unwrap_or(0),
        );
        let high = Point2::new(
            pick(i32::max, x).unwrap_or(0),
            pick(i32::max, y).unwrap_or(0),
        );
        let index = self.boxes.len();
        let count = range.len();
        self.boxes.push(Node {
            low,
            high,
            range: range.clone(),
            children: None,
        });
        if count > LEAF {
            let wide = high.x - low.x > high.y - low.y;
            let middle = |i: &u32| {
                let [p, q] = pieces[*i as usize];
                if wide { p.x + q.x } else { p.y + q.y }
            };
            self.order[range.clone()].select_nth_unstable_by_key(count / 2, middle);
            let cut = range.start + count / 2;
            let first = self.grow(pieces, range.start..cut);
            let second = self.grow(pieces, cut..range.end);
            self.boxes[index].children = Some([first, second]);
        }
        index
    }

    pub(super) fn root(&self) -> usize {
        0
    }

    pub(super) fn corners(&self, node: usize) -> [Point2; 4] {
        let Some(Node { low, high, .. }) = self.boxes.get(node) else {
            return [Point2::default(); 4];
        };
        [
            *low,
            Point2::new(high.x, low.y),
            *high,
            Point2::new(low.x, high.y),
        ]
    }

    pub(super) fn children(&self, node: usize) -> Option<[usize; 2]> {
        self.boxes.get(node)?.children
    }

    pub(super) fn items(&self, node: usize) -> &[u32] {
        match self.boxes.get(node) {
            Some(n) => &self.order[n.range.clone()],
            None => &[],
        }
    }

    pub(super) fn count(&self, node: usize) -> usize {
        self.items(node).len()
    }

    /// Visits the pieces of all boxes that pass a test.
    pub(super) fn visit(&self, pass: impl Fn(&[Point2]) -> bool, mut piece: impl FnMut(u32)) {
        if self.boxes.is_empty() {
            return;
        }
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            if !pass(&self.corners(node)) {
                continue;
            }
            match self.children(node) {
                Some(children) => stack.extend(children),
                None => self.items(node).iter().for_each(|&id| piece(id)),
            }
        }
    }
}
