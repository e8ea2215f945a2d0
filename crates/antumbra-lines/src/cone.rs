//! A convex cone of lines in Plücker space, and its split by a hyperplane.
//!
//! The blocker polyhedron of [Bittner02, 8.7] as a pointed, full-dimensional cone in R^6, by the
//! double description method: half-spaces and extreme rays with their incidences. Splitting
//! follows the combinatorial adjacency test; new rays are computed directly from five defining
//! rows, never from other rays, so that their size stays bounded.

use std::ops::BitAnd;

use crate::space::{PluckerSpace, RowId, VertexId};
use antumbra_kernel::Sign;

/// One side of a hyperplane: `sign * row . x >= 0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Halfspace {
    /// The hyperplane.
    pub row: RowId,
    /// Whether the side where the row is negative is meant.
    pub negative: bool,
}

impl Halfspace {
    /// The other side of the same hyperplane.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self {
            row: self.row,
            negative: !self.negative,
        }
    }

    fn orient(self, sign: Sign) -> Sign {
        if self.negative { sign.flip() } else { sign }
    }
}

#[derive(Clone, Copy, Debug)]
struct Ray {
    vertex: VertexId,
    /// Bit k: the ray lies on the hyperplane in slot k.
    tight: u128,
}

/// A pointed, full-dimensional convex cone in R^6.
#[derive(Clone, Debug)]
pub struct Cone {
    slots: Vec<Halfspace>,
    live: u128,
    rays: Vec<Ray>,
}

/// The signs of a cone's rays with respect to a half-space.
#[derive(Clone, Debug)]
pub struct RaySigns {
    signs: Vec<Sign>,
    inside: usize,
    outside: usize,
}

impl RaySigns {
    /// No signs yet, in some memory.
    pub(crate) fn within(mut signs: Vec<Sign>, capacity: usize) -> Self {
        signs.clear();
        signs.reserve(capacity);
        Self {
            signs,
            inside: 0,
            outside: 0,
        }
    }

    pub(crate) fn into_memory(self) -> Vec<Sign> {
        self.signs
    }

    fn push(&mut self, sign: Sign) {
        self.inside += usize::from(sign.is_positive());
        self.outside += usize::from(sign.is_negative());
        self.signs.push(sign);
    }

    /// How many rays lie strictly inside.
    #[must_use]
    pub fn inside(&self) -> usize {
        self.inside
    }

    /// How many rays lie strictly outside.
    #[must_use]
    pub fn outside(&self) -> usize {
        self.outside
    }
}

/// What a hyperplane does to a cone.
#[derive(Clone, Debug)]
pub enum Split {
    /// No interior point is outside the half-space.
    Inside,
    /// No interior point is inside.
    Outside,
    /// Both parts, inside first.
    Both(Cone, Cone),
}

/// Why a cone could not be built or split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConeError {
    /// The half-spaces' intersection has no interior.
    Flat,
    /// The half-spaces contain a whole line through the origin of R^6.
    NotPointed,
    /// More than 128 facets at a time.
    TooManyFacets,
}

impl std::fmt::Display for ConeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Flat => "the cone of lines has no interior",
            Self::NotPointed => "the cone of lines is not pointed",
            Self::TooManyFacets => "the cone of lines has more than 128 facets",
        })
    }
}

impl std::error::Error for ConeError {}

impl Cone {
    /// The cone of all points on the given sides of some hyperplanes.
    ///
    /// # Errors
    /// If the cone is flat or contains a line, or has too many facets.
    pub fn new(space: &mut PluckerSpace, halfspaces: &[Halfspace]) -> Result<Self, ConeError> {
        let rows: Vec<RowId> = halfspaces.iter().map(|h| h.row).collect();
        let basis = space.independent(&rows, 6);
        if basis.len() < 6 {
            return Err(ConeError::NotPointed);
        }
        let mut used = vec![false; halfspaces.len()];
        let mut slots = Vec::with_capacity(halfspaces.len() + 8);
        for &row in &basis {
            let i = halfspaces
                .iter()
                .position(|h| h.row == row)
                .ok_or(ConeError::NotPointed)?;
            used[i] = true;
            slots.push(halfspaces[i]);
        }
        let mut rays = Vec::with_capacity(32);
        for i in 0..6 {
            let mut others = [basis[0]; 5];
            let mut n = 0;
            for (k, &row) in basis.iter().enumerate() {
                if k != i {
                    others[n] = row;
                    n += 1;
                }
            }
            let exact = space.meet(others).ok_or(ConeError::NotPointed)?;
            let vertex = space.push_vertex(exact);
            if slots[i].orient(space.sign(basis[i], vertex)).is_negative() {
                space.negate_vertex(vertex);
            }
            rays.push(Ray {
                vertex,
                tight: 0b11_1111 & !(1 << i),
            });
        }
        let mut cone = Self {
            slots,
            live: 0b11_1111,
            rays,
        };
        for (i, &h) in halfspaces.iter().enumerate() {
            if !used[i] {
                cone.cut(space, h)?;
            }
        }
        Ok(cone)
    }

    /// The half-spaces that may bound the cone (facets and a few redundant ones).
    pub fn halfspaces(&self) -> impl Iterator<Item = Halfspace> + '_ {
        self.slots
            .iter()
            .enumerate()
            .filter(|(k, _)| self.live >> k & 1 == 1)
            .map(|(_, h)| *h)
    }

    /// The extreme rays.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + Clone + '_ {
        self.rays.iter().map(|r| r.vertex)
    }

    /// How many extreme rays there are.
    #[must_use]
    pub fn ray_count(&self) -> usize {
        self.rays.len()
    }

    /// Sets of three half-spaces that are tight on a common 2-face of the polytope (a 3-face of
    /// the cone), each with the other live half-spaces.
    pub(crate) fn faces_on_three(&self) -> Vec<([Halfspace; 3], Vec<Halfspace>)> {
        let live: Vec<usize> = (0..self.slots.len())
            .filter(|k| self.live >> k & 1 == 1)
            .collect();
        let mut out = Vec::new();
        for (x, &i) in live.iter().enumerate() {
            for (y, &j) in live.iter().enumerate().skip(x + 1) {
                for &k in &live[y + 1..] {
                    let set = 1_u128 << i | 1_u128 << j | 1_u128 << k;
                    let on: Vec<&Ray> = self.rays.iter().filter(|r| r.tight & set == set).collect();
                    if on.len() < 3 {
                        continue;
                    }
                    let common = on.iter().fold(u128::MAX, |c, r| c & r.tight) & self.live;
                    let others = live
                        .iter()
                        .filter(|&&l| common >> l & 1 == 0)
                        .map(|&l| self.slots[l])
                        .collect();
                    out.push(([self.slots[i], self.slots[j], self.slots[k]], others));
                }
            }
        }
        out
    }

    /// The signs of all rays with respect to a half-space.
    #[must_use]
    pub fn signs(&self, space: &mut PluckerSpace, h: Halfspace) -> RaySigns {
        let slot = self.slot_of(h.row);
        let mut out = space.ray_signs(self.rays.len());
        for ray in &self.rays {
            out.push(match slot {
                Some(k) if ray.tight >> k & 1 == 1 => Sign::Zero,
                _ => h.orient(space.sign(h.row, ray.vertex)),
            });
        }
        out
    }

    /// The signs with respect to a half-space of the part of a cone inside another one: those of
    /// the rays that were kept are known, `whole` being the signs on the cone and `cut` those by
    /// which the part was split off.
    #[must_use]
    pub fn inherited_signs(
        &self,
        space: &mut PluckerSpace,
        h: Halfspace,
        whole: &RaySigns,
        cut: &RaySigns,
    ) -> RaySigns {
        let mut out = space.ray_signs(self.rays.len());
        for (&s, c) in whole.signs.iter().zip(&cut.signs) {
            if !c.is_negative() {
                out.push(s);
            }
        }
        for ray in &self.rays[out.signs.len()..] {
            out.push(h.orient(space.sign(h.row, ray.vertex)));
        }
        out
    }

    fn slot_of(&self, row: RowId) -> Option<usize> {
        (0..self.slots.len()).find(|&k| self.live >> k & 1 == 1 && self.slots[k].row == row)
    }

    /// Where the cone's interior lies: only inside, only outside, or on both sides (`None`).
    #[must_use]
    pub fn position(&self, space: &mut PluckerSpace, h: Halfspace) -> Option<Sign> {
        let (mut inside, mut outside) = (false, false);
        for ray in &self.rays {
            match h.orient(space.sign(h.row, ray.vertex)) {
                Sign::Positive => inside = true,
                Sign::Negative => outside = true,
                Sign::Zero => {}
            }
            if inside && outside {
                return None;
            }
        }
        Some(if outside {
            Sign::Negative
        } else {
            Sign::Positive
        })
    }

    /// Splits the cone by a hyperplane.
    ///
    /// # Errors
    /// If a part would have more than 128 facets.
    pub fn split(&self, space: &mut PluckerSpace, h: Halfspace) -> Result<Split, ConeError> {
        let signs = self.signs(space, h);
        self.split_by(space, h, &signs)
    }

    /// Splits the cone by a hyperplane whose signs on it are known. The rays of the inner part are
    /// those kept, in order, and then new ones.
    ///
    /// # Errors
    /// If a part would have more than 128 facets.
    pub fn split_by(
        &self,
        space: &mut PluckerSpace,
        h: Halfspace,
        signs: &RaySigns,
    ) -> Result<Split, ConeError> {
        match (signs.inside > 0, signs.outside > 0) {
            (_, false) => Ok(Split::Inside),
            (false, true) => Ok(Split::Outside),
            (true, true) => {
                let fresh = self.crossings(space, h, &signs.signs);
                let inside = self.part(h, &signs.signs, Sign::Positive, &fresh)?;
                let outside = self.part(h.opposite(), &signs.signs, Sign::Negative, &fresh)?;
                Ok(Split::Both(inside, outside))
            }
        }
    }

    /// Keeps only the part inside a half-space.
    ///
    /// # Errors
    /// [`ConeError::Flat`] if nothing is left.
    pub fn cut(&mut self, space: &mut PluckerSpace, h: Halfspace) -> Result<(), ConeError> {
        let signs = self.signs(space, h);
        match (signs.inside > 0, signs.outside > 0) {
            (false, _) => Err(ConeError::Flat),
            (true, false) => {
                // Redundant or touching: keep it where it is a facet, since faces may need it.
                if signs.signs.len() - signs.inside >= 5 {
                    *self = self.part(h, &signs.signs, Sign::Positive, &[])?;
                }
                Ok(())
            }
            (true, true) => {
                let fresh = self.crossings(space, h, &signs.signs);
                *self = self.part(h, &signs.signs, Sign::Positive, &fresh)?;
                Ok(())
            }
        }
    }

    /// The new rays: one on each 2-face between a ray inside and one outside.
    ///
    /// Two rays are adjacent if no third one lies on all the hyperplanes that both lie on: the
    /// sets of rays on each of these hyperplanes have just the two in common.
    fn crossings(&self, space: &mut PluckerSpace, h: Halfspace, signs: &[Sign]) -> Vec<Ray> {
        // Nearly all cones have fewer than 64 facets: half of the bits then need no look.
        if self.slots.len() <= 64 {
            self.crossings_by(space, h, signs, |tight| tight as u64)
        } else {
            self.crossings_by(space, h, signs, |tight| tight)
        }
    }

    fn crossings_by<S: Set>(
        &self,
        space: &mut PluckerSpace,
        h: Halfspace,
        signs: &[Sign],
        tight: impl Fn(u128) -> S,
    ) -> Vec<Ray> {
        let on = Incidence::new(&self.rays, self.slots.len());
        let outside: Vec<(S, u32)> = (self.rays.iter().zip(signs).zip(0..))
            .filter(|((_, s), _)| s.is_negative())
            .map(|((ray, _), j)| (tight(ray.tight), j))
            .collect();
        let mut fresh = Vec::with_capacity(outside.len());
        for (p, sign) in self.rays.iter().zip(signs) {
            if !sign.is_positive() {
                continue;
            }
            let own = tight(p.tight);
            for &(other, j) in &outside {
                if (own & other).at_least_four() {
                    let n = &self.rays[j as usize];
                    let common = p.tight & n.tight;
                    if on.only_two_share(common) {
                        fresh.push(self.crossing(space, h, p, n, common));
                    }
                }
            }
        }
        fresh
    }

    fn crossing(
        &self,
        space: &mut PluckerSpace,
        h: Halfspace,
        p: &Ray,
        n: &Ray,
        common: u128,
    ) -> Ray {
        let mut on = bits(common).map(|k| self.slots[k].row);
        let rows = match (on.next(), on.next(), on.next(), on.next(), on.next()) {
            (Some(a), Some(b), Some(c), Some(d), None) => Some([a, b, c, d]),
            _ => {
                let all: Vec<RowId> = bits(common).map(|k| self.slots[k].row).collect();
                space.independent(&all, 4).try_into().ok()
            }
        };
        let vertex = match rows {
            Some([a, b, c, d]) => space.cut_edge([a, b, c, d, h.row], p.vertex, n.vertex),
            // The residues failed (never seen): a combination is always right, only wider.
            _ => {
                let exact = space.combination(h.row, [p.vertex, n.vertex]);
                space.push_vertex(exact)
            }
        };
        Ray {
            vertex,
            tight: common,
        }
    }

    fn part(
        &self,
        h: Halfspace,
        signs: &[Sign],
        keep: Sign,
        fresh: &[Ray],
    ) -> Result<Self, ConeError> {
        let mut slots = self.slots.clone();
        let mut live = self.live;
        let slot = match self.slot_of(h.row) {
            Some(k) => k,
            None => {
                let free = (!live).trailing_zeros() as usize;
                if free >= 128 {
                    return Err(ConeError::TooManyFacets);
                }
                if free == slots.len() {
                    slots.push(h)
                } else {
                    slots[free] = h
                }
                live |= 1 << free;
                free
            }
        };
        slots[slot] = h;
        let bit = 1_u128 << slot;
        let mut rays = Vec::with_capacity(self.rays.len() + fresh.len());
        for (ray, &s) in self.rays.iter().zip(signs) {
            if s == keep {
                rays.push(*ray);
            } else if s.is_zero() {
                rays.push(Ray {
                    tight: ray.tight | bit,
                    ..*ray
                });
            }
        }
        rays.extend(fresh.iter().map(|r| Ray {
            tight: r.tight | bit,
            ..*r
        }));
        let mut cone = Self { slots, live, rays };
        cone.drop_redundant();
        Ok(cone)
    }

    /// Drops half-spaces that fewer than five rays lie on: they are no facets.
    fn drop_redundant(&mut self) {
        // Counts of all half-spaces side by side, a binary digit a word; what exceeds seven sticks.
        let [mut ones, mut twos, mut fours, mut more] = [0_u128; 4];
        for ray in &self.rays {
            let carry = ones & ray.tight;
            ones ^= ray.tight;
            let next = twos & carry;
            twos ^= carry;
            more |= fours & next;
            fours ^= next;
        }
        let five = more | fours & (ones | twos);
        let dead = self.live & !five;
        if dead != 0 {
            self.live &= !dead;
            for ray in &mut self.rays {
                ray.tight &= !dead;
            }
        }
    }

    /// Checks every invariant: rays inside all half-spaces, tight exactly where recorded, each on
    /// five independent rows at least.
    ///
    /// # Errors
    /// A sentence that names the broken invariant.
    pub fn sanity_check(&self, space: &mut PluckerSpace) -> Result<(), String> {
        for (i, ray) in self.rays.iter().enumerate() {
            for k in bits(self.live) {
                let s = self.slots[k].orient(space.sign(self.slots[k].row, ray.vertex));
                let tight = ray.tight >> k & 1 == 1;
                if s.is_negative() || s.is_zero() != tight {
                    return Err(format!(
                        "ray {i} on slot {k}: sign {s:?}, recorded tight {tight}"
                    ));
                }
            }
            let rows: Vec<RowId> = bits(ray.tight).map(|k| self.slots[k].row).collect();
            if space.independent(&rows, 5).len() < 5 {
                return Err(format!(
                    "ray {i} is not extreme: its {} tight rows have rank < 5",
                    rows.len()
                ));
            }
        }
        for (i, a) in self.rays.iter().enumerate() {
            if self.rays[i + 1..].iter().any(|b| b.tight == a.tight) {
                return Err(format!("ray {i} occurs twice"));
            }
        }
        Ok(())
    }
}

/// The rays on each hyperplane, as sets of bits.
struct Incidence {
    words: usize,
    sets: Vec<u64>,
}

impl Incidence {
    fn new(rays: &[Ray], slots: usize) -> Self {
        let words = rays.len().div_ceil(64);
        let mut sets = vec![0_u64; slots * words];
        for (i, ray) in rays.iter().enumerate() {
            for k in bits(ray.tight) {
                sets[k * words + i / 64] |= 1 << (i % 64);
            }
        }
        Self { words, sets }
    }

    /// Whether exactly two rays lie on all of some hyperplanes, of which two are known to.
    fn only_two_share(&self, hyperplanes: u128) -> bool {
        let mut count = 0;
        for word in 0..self.words {
            let mut set = u64::MAX;
            for k in bits(hyperplanes) {
                set &= self.sets[k * self.words + word];
            }
            while set != 0 && count < 3 {
                set &= set - 1;
                count += 1;
            }
        }
        count == 2
    }
}

/// A set of hyperplanes as bits.
trait Set: Copy + Default + PartialEq + BitAnd<Output = Self> {
    /// The set without its least member.
    fn without_least(self) -> Self;

    /// Whether the set has four members; spares a count of bits where processors lack the
    /// instruction.
    #[inline]
    fn at_least_four(self) -> bool {
        self.without_least().without_least().without_least() != Self::default()
    }
}

impl Set for u64 {
    #[inline]
    fn without_least(self) -> Self {
        self & self.wrapping_sub(1)
    }
}

impl Set for u128 {
    #[inline]
    fn without_least(self) -> Self {
        self & self.wrapping_sub(1)
    }
}

fn bits(mut set: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if set == 0 {
            return None;
        }
        let k = set.trailing_zeros() as usize;
        set &= set - 1;
        Some(k)
    })
}
