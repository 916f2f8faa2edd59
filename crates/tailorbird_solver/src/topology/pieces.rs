//! Pieces: particles that hang together.

/// For each of so many particles the lowest one that triangles join it to (union–find with path halving).
pub(super) fn pieces(particles: usize, triangles: impl Iterator<Item = [u32; 3]>) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..particles as u32).collect();
    for [a, b, c] in triangles {
        for (a, b) in [(a, b), (b, c)] {
            let [a, b] = [a, b].map(|i| root(&mut parent, i));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    (0..parent.len() as u32)
        .map(|i| root(&mut parent, i))
        .collect()
}

/// The root of a particle's tree; halves the path to it.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let above = parent[parent[i as usize] as usize];
        parent[i as usize] = above;
        i = above;
    }
    i
}
