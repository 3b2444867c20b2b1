//! One manifold component out of whatever the sampling gave.
//!
//! Where a shape is thinner than a cell, parts of it may touch in a vertex or an edge only. There the surface is no
//! manifold, and neither a hinge nor a normal is defined; so the smaller of the touching parts are cut back until it is one.

use std::collections::BTreeMap;

use crate::mesh::index32;

/// What was cut back to make the boundary a manifold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Edges in which parts touched without sharing a face.
    pub n_edges: usize,
    /// Vertices in which parts touched without sharing an edge on the surface.
    pub n_vertices: usize,
    /// Tetrahedra removed there.
    pub n_tets_removed: usize,
}

/// Removes tetrahedra until every boundary edge belongs to two boundary faces and the boundary faces at every vertex form
/// one ring. `on_surface` marks the vertices that may lie on the boundary.
pub(super) fn make_manifold(tets: &mut Vec<[u32; 4]>, mut on_surface: Vec<bool>) -> Repairs {
    let mut repairs = Repairs::default();
    loop {
        let boundary = boundary_faces(tets, &on_surface);
        // Rings around vertices mean something only where all edges are sound.
        let edges = singular_edges(&boundary);
        let vertices = if edges.is_empty() { singular_vertices(&boundary) } else { Vec::new() };
        if edges.is_empty() && vertices.is_empty() {
            return repairs;
        }
        repairs.n_edges += edges.len();
        repairs.n_vertices += vertices.len();
        let touched: Vec<Vec<u32>> =
            edges.iter().map(|e| e.to_vec()).chain(vertices.iter().map(|&v| vec![v])).collect();
        let doomed = smaller_parts(tets, &touched);
        for (tet, _) in tets.iter().zip(&doomed).filter(|(_, doomed)| **doomed) {
            tet.iter().for_each(|&v| on_surface[v as usize] = true);
        }
        let before = tets.len();
        let mut index = 0;
        tets.retain(|_| {
            index += 1;
            !doomed[index - 1]
        });
        repairs.n_tets_removed += before - tets.len();
    }
}

/// Keeps the component with the most tetrahedra (the earliest of equals); gives the sizes of the others, largest first.
pub(super) fn keep_largest_component(tets: &mut Vec<[u32; 4]>, n_vertices: usize) -> Vec<usize> {
    let mut sets = DisjointSets::new(n_vertices);
    for tet in tets.iter() {
        for &corner in &tet[1..] {
            sets.join(tet[0], corner);
        }
    }
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    for tet in tets.iter() {
        *sizes.entry(sets.find(tet[0])).or_default() += 1;
    }
    let Some((&largest, _)) = sizes.iter().max_by(|one, other| one.1.cmp(other.1).then(other.0.cmp(one.0)))
    else {
        return Vec::new();
    };
    sizes.remove(&largest);
    if !sizes.is_empty() {
        tets.retain(|tet| sets.find(tet[0]) == largest);
    }
    let mut dropped: Vec<usize> = sizes.into_values().collect();
    dropped.sort_unstable_by(|one, other| other.cmp(one));
    dropped
}

/// Faces of one tetrahedron only, corners ascending.
fn boundary_faces(tets: &[[u32; 4]], on_surface: &[bool]) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for tet in tets {
        let mut corners = *tet;
        corners.sort_unstable();
        let [a, b, c, d] = corners;
        for face in [[b, c, d], [a, c, d], [a, b, d], [a, b, c]] {
            if face.iter().all(|&v| on_surface[v as usize]) {
                faces.push(face);
            }
        }
    }
    faces.sort_unstable();
    faces.chunk_by(|one, other| one == other).filter(|group| group.len() == 1).map(|group| group[0]).collect()
}

/// Edges of more than two boundary faces.
fn singular_edges(boundary: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = boundary.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [a, c]]).collect();
    edges.sort_unstable();
    edges.chunk_by(|one, other| one == other).filter(|group| group.len() > 2).map(|group| group[0]).collect()
}

/// Vertices whose boundary faces form more than one ring, given that all edges are sound.
fn singular_vertices(boundary: &[[u32; 3]]) -> Vec<u32> {
    // Around a vertex, each boundary face is a link between the two other corners.
    let mut links: Vec<(u32, [u32; 2])> =
        boundary.iter().flat_map(|&[a, b, c]| [(a, [b, c]), (b, [a, c]), (c, [a, b])]).collect();
    links.sort_unstable();
    links
        .chunk_by(|one, other| one.0 == other.0)
        .filter(|ring| count_parts(ring, |(_, link)| link.to_vec()) > 1)
        .map(|ring| ring[0].0)
        .collect()
}

/// How many parts a few items form when those with a common name belong together.
fn count_parts<T>(items: &[T], names: impl Fn(&T) -> Vec<u32>) -> usize {
    let part_of = parts(items, names);
    (0..part_of.len()).filter(|&item| part_of[item] == item).count()
}

/// For each of a few items, the first item of its part: those with a common name belong together.
fn parts<T>(items: &[T], names: impl Fn(&T) -> Vec<u32>) -> Vec<usize> {
    let mut sets = DisjointSets::new(items.len());
    let mut first_with: BTreeMap<u32, u32> = BTreeMap::new();
    for (item, content) in items.iter().enumerate() {
        for name in names(content) {
            sets.join(*first_with.entry(name).or_insert(index32(item)), index32(item));
        }
    }
    (0..items.len()).map(|item| sets.find(index32(item)) as usize).collect()
}

/// Around each singular vertex or edge: all tetrahedra except those of the largest part that is connected through faces
/// there. If there is just one part (the surface touches itself from the outside), all of them.
fn smaller_parts(tets: &[[u32; 4]], touched: &[Vec<u32>]) -> Vec<bool> {
    let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for vertices in touched {
        around.insert(vertices[0], Vec::new());
    }
    for (index, tet) in tets.iter().enumerate() {
        for corner in tet {
            if let Some(star) = around.get_mut(corner) {
                star.push(index);
            }
        }
    }
    let mut doomed = vec![false; tets.len()];
    for vertices in touched {
        let star: Vec<usize> = around[&vertices[0]]
            .iter()
            .copied()
            .filter(|&index| vertices.iter().all(|v| tets[index].contains(v)))
            .collect();
        // Around an edge, two tetrahedra with one more vertex in common share a face; around a vertex they share an edge
        // with one and a face with two, so there the name of a face is what counts.
        let part_of = if vertices.len() == 2 {
            parts(&star, |&index| tets[index].into_iter().filter(|v| !vertices.contains(v)).collect())
        } else {
            parts_by_faces(tets, &star, vertices[0])
        };
        let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
        for &part in &part_of {
            *sizes.entry(part).or_default() += 1;
        }
        let largest = sizes.iter().max_by(|one, other| one.1.cmp(other.1).then(other.0.cmp(one.0)));
        let kept = largest.filter(|_| sizes.len() > 1).map(|(&part, _)| part);
        for (&index, part) in star.iter().zip(part_of) {
            doomed[index] |= Some(part) != kept;
        }
    }
    doomed
}

/// As [`parts`], for the tetrahedra around `vertex` that share faces there.
fn parts_by_faces(tets: &[[u32; 4]], star: &[usize], vertex: u32) -> Vec<usize> {
    let mut names: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let faces: Vec<Vec<u32>> = star
        .iter()
        .map(|&index| {
            let mut others: Vec<u32> = tets[index].into_iter().filter(|&v| v != vertex).collect();
            others.sort_unstable();
            let pairs = [[others[0], others[1]], [others[0], others[2]], [others[1], others[2]]];
            pairs
                .map(|pair| {
                    let next = index32(names.len());
                    *names.entry(pair).or_insert(next)
                })
                .to_vec()
        })
        .collect();
    parts(&faces, Clone::clone)
}

/// Union-find; the representative of a set is its least member.
struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    fn new(n: usize) -> Self {
        Self { parent: (0..n).map(index32).collect() }
    }

    fn find(&mut self, mut item: u32) -> u32 {
        while self.parent[item as usize] != item {
            let grandparent = self.parent[self.parent[item as usize] as usize];
            self.parent[item as usize] = grandparent;
            item = grandparent;
        }
        item
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.find(one), self.find(other));
        self.parent[one.max(other) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repaired(tets: &[[u32; 4]]) -> (Vec<[u32; 4]>, Repairs) {
        let mut kept = tets.to_vec();
        let n_vertices = tets.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        let repairs = make_manifold(&mut kept, vec![true; n_vertices]);
        (kept, repairs)
    }

    #[test]
    fn sound_meshes_stay_as_they_are() {
        for tets in [&[[0, 1, 2, 3]][..], &[[0, 1, 2, 3], [1, 2, 3, 4]], &[[0, 1, 2, 3], [4, 5, 6, 7]]] {
            assert_eq!(repaired(tets), (tets.to_vec(), Repairs::default()));
        }
    }

    #[test]
    fn the_smaller_part_at_a_vertex_goes() {
        let (kept, repairs) = repaired(&[[0, 1, 2, 3], [3, 4, 5, 6], [4, 5, 6, 3 + 4], [4, 5, 3, 8]]);
        assert_eq!(kept, [[3, 4, 5, 6], [4, 5, 6, 7], [4, 5, 3, 8]]);
        assert_eq!(repairs, Repairs { n_edges: 0, n_vertices: 1, n_tets_removed: 1 });
    }

    #[test]
    fn the_smaller_part_at_an_edge_goes() {
        let (kept, repairs) = repaired(&[[0, 1, 2, 3], [0, 1, 4, 5], [0, 1, 5, 6]]);
        assert_eq!(kept, [[0, 1, 4, 5], [0, 1, 5, 6]]);
        assert_eq!(repairs, Repairs { n_edges: 1, n_vertices: 0, n_tets_removed: 1 });
    }

    #[test]
    fn the_largest_component_stays() {
        let mut tets = vec![[0, 1, 2, 3], [4, 5, 6, 7], [5, 6, 7, 8], [9, 10, 11, 12], [9, 10, 11, 13]];
        assert_eq!(keep_largest_component(&mut tets, 14), [2, 1]);
        assert_eq!(tets, [[4, 5, 6, 7], [5, 6, 7, 8]]);
    }
}
