//! What holds in every map: adjacency, planarity, Euler's relation.

use super::{FaceKind, HalfEdge, VisibilityMap};

pub(super) fn check(map: &VisibilityMap) -> Result<(), String> {
    half_edges(map)?;
    vertices(map)?;
    let borders = borders(map)?;
    euler(map, borders)
}

fn half_edges(map: &VisibilityMap) -> Result<(), String> {
    if map.next.len() != 2 * map.edges.len() {
        return Err(format!(
            "{} edges have {} half-edges",
            map.edges.len(),
            map.next.len()
        ));
    }
    let mut entered = vec![false; map.next.len()];
    for h in (0..map.next.len() as u32).map(HalfEdge) {
        let after = map.next(h);
        if std::mem::replace(&mut entered[after.0 as usize], true) {
            return Err(format!("two half-edges lead to half-edge {}", after.0));
        }
        if map.face(after) != map.face(h) {
            return Err(format!(
                "half-edges {} and {} are of one border and two faces",
                h.0, after.0
            ));
        }
        if map.origin(after) != map.origin(h.twin()) {
            return Err(format!(
                "half-edge {} does not start where {} ends",
                after.0, h.0
            ));
        }
        if map.origin(h) == map.origin(h.twin()) {
            return Err(format!("edge {} has no length", h.edge()));
        }
    }
    Ok(())
}

fn vertices(map: &VisibilityMap) -> Result<(), String> {
    let mut met = 0;
    for v in 0..map.vertices.len() as u32 {
        let around = map.around(v);
        met += around.len();
        if let Some(h) = around.iter().find(|h| map.origin(**h) != v) {
            return Err(format!("half-edge {} does not start at vertex {v}", h.0));
        }
    }
    if met != map.next.len() {
        return Err(format!(
            "{met} of {} half-edges are met around vertices: a vertex is two",
            map.next.len()
        ));
    }
    Ok(())
}

/// Counts borders; each belongs to the list of its face.
fn borders(map: &VisibilityMap) -> Result<usize, String> {
    let mut visited = vec![false; map.next.len()];
    let mut count = 0;
    for (face, f) in map.faces.iter().zip(0..) {
        for &start in &face.borders {
            count += 1;
            for h in map.border(start) {
                if map.face(h) != f || std::mem::replace(&mut visited[h.0 as usize], true) {
                    return Err(format!(
                        "half-edge {} is on a border of face {f} wrongly",
                        h.0
                    ));
                }
            }
        }
        let empty = face.borders.is_empty() && map.faces.len() > 1;
        if empty && face.kind != FaceKind::Outside {
            return Err(format!("face {f} has no border"));
        }
    }
    match visited.iter().position(|v| !v) {
        Some(h) => Err(format!("half-edge {h} is on no border")),
        None => Ok(count),
    }
}

/// Each component of a planar drawing has V - E + B = 2 with B borders, and B - C + 1 faces.
fn euler(map: &VisibilityMap, borders: usize) -> Result<(), String> {
    let mut parent: Vec<u32> = (0..map.vertices.len() as u32).collect();
    fn root(parent: &[u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            i = parent[i as usize];
        }
        i
    }
    for edge in &map.edges {
        let [a, b] = edge.ends.map(|v| root(&parent, v));
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut sums = vec![0_i64; map.vertices.len()];
    for v in 0..map.vertices.len() as u32 {
        sums[root(&parent, v) as usize] += 1;
    }
    for edge in &map.edges {
        sums[root(&parent, edge.ends[0]) as usize] -= 1;
    }
    for face in &map.faces {
        for &h in &face.borders {
            sums[root(&parent, map.origin(h)) as usize] += 1;
        }
    }
    let mut components = 0;
    for (v, &sum) in sums.iter().enumerate() {
        if parent[v] as usize != v {
            continue;
        }
        components += 1;
        if sum != 2 {
            return Err(format!(
                "the component of vertex {v} has V - E + B = {sum}, not 2"
            ));
        }
    }
    let (v, e, f) = (map.vertices.len(), map.edges.len(), map.faces.len());
    if v + f != e + components + 1 || borders + 1 != f + components {
        return Err(format!(
            "{v} vertices, {e} edges, {f} faces, {components} components, {borders} borders"
        ));
    }
    Ok(())
}
