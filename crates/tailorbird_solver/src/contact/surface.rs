//! A triangle mesh at the scale of its entity, ready to be searched.

use std::collections::BTreeSet;

use bevy_math::Vec3;
use parry3d::{
    bounding_volume::Aabb,
    query::{PointQueryWithLocation, Ray, RayCast},
    shape::{TriMesh as SearchMesh, TriMeshFlags},
};

use crate::{fingerprint, kernels::patches::Patches};

/// A triangle mesh at the scale of its entity.
pub struct Surface {
    /// Equal for equal triangles at equal scales.
    pub fingerprint: u64,
    mesh: SearchMesh,
    /// True if it has an inside.
    solid: bool,
    /// Tenth of the usual length of an edge \[m\].
    detail: f32,
}

impl Surface {
    /// Returns `None` where nothing is left of the triangles at this scale.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], scale: Vec3) -> Option<Self> {
        let positions: Vec<Vec3> = positions.iter().map(|p| *p * scale).collect();
        let mirrored = scale.x * scale.y * scale.z < 0.0;
        let turn = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles: Vec<_> = triangles.iter().copied().map(turn).collect();
        let fingerprint = fingerprint::of_triangles(&positions, &triangles);
        let flags = TriMeshFlags::MERGE_DUPLICATE_VERTICES
            | TriMeshFlags::DELETE_DEGENERATE_TRIANGLES
            | TriMeshFlags::DELETE_DUPLICATE_TRIANGLES;
        let mut mesh = SearchMesh::with_flags(positions, triangles, flags).ok()?;
        let solid = is_solid(&mesh);
        if solid {
            mesh.set_flags(flags | TriMeshFlags::ORIENTED).ok()?;
        }
        let lengths = mesh.triangles().map(|t| t.a.distance(t.b));
        let edge = lengths.sum::<f32>() / mesh.num_triangles().max(1) as f32;
        Some(Self {
            fingerprint,
            solid,
            detail: 0.1 * edge,
            mesh,
        })
    }

    /// Box around it: lowest and highest coordinates \[m\].
    pub fn range(&self) -> (Vec3, Vec3) {
        let Aabb { mins, maxs } = self.mesh.local_aabb();
        (mins, maxs)
    }

    /// Finds the contact plane of particle `i`, which took this path in the axes of the mesh and keeps `margin` \[m\].
    pub fn find_plane(&self, patches: &mut Patches, i: usize, [from, to]: [Vec3; 2], margin: f32) {
        let slack = (0.5 * margin).max(self.detail);
        if let Some((point, normal)) = self.crossing(from, to) {
            let above = to - normal * (normal.dot(to - point) - margin);
            patches.set(i, point, normal, above, slack);
            return;
        }
        let reach = margin + 4.0 * slack.max(from.distance(to));
        let mesh = &self.mesh;
        let Some((near, (triangle, _))) =
            mesh.project_local_point_and_get_location_with_max_dist(to, false, reach)
        else {
            patches.set(i, to - Vec3::Y * reach, Vec3::Y, to, reach - margin);
            return;
        };
        let away = to - near.point;
        let distance = away.length();
        let face = mesh.triangle(triangle).normal().unwrap_or(Vec3::Y);
        let inside = self.solid && near.is_inside;
        let mut normal = if distance > 1e-3 * slack {
            if inside {
                -away / distance
            } else {
                away / distance
            }
        } else {
            face
        };
        if !self.solid {
            // The particle stays on the side where it was; the first time, where it is.
            let seen = patches.holds[i] >= 0.0 && patches.height(i, from).abs() < reach;
            let before = patches.normal.get(i);
            if seen && distance < margin && normal.dot(before) < -0.5 {
                normal = -normal;
            }
        }
        let clear = if inside { 0.0 } else { distance - margin };
        patches.set(i, near.point, normal, to, clear.max(slack));
    }

    /// Point at which a path enters the surface, and the normal on the side from which it comes.
    fn crossing(&self, from: Vec3, to: Vec3) -> Option<(Vec3, Vec3)> {
        let ray = Ray::new(from, to - from);
        let hit = self.mesh.cast_local_ray_and_get_normal(&ray, 1.0, false)?;
        let normal = hit.normal.normalize_or_zero();
        let enters = normal.dot(ray.dir) < 0.0 && normal != Vec3::ZERO;
        let from_back = self.solid && self.mesh.is_backface(hit.feature);
        (enters && !from_back).then(|| (ray.point_at(hit.time_of_impact), normal))
    }
}

/// Returns whether triangles form a closed surface that is seen from outside: each edge has a triangle on either side, and the volume is
/// positive.
fn is_solid(mesh: &SearchMesh) -> bool {
    let mut edges = BTreeSet::new();
    let corners = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let all = || mesh.indices().iter().copied().flat_map(corners);
    let once = all().all(|edge| edges.insert(edge));
    if !once || !all().all(|[a, b]| edges.contains(&[b, a])) {
        return false;
    }
    let center = mesh.local_aabb().center();
    let volume = mesh.triangles().map(|t| {
        let [a, b, c] = [t.a - center, t.b - center, t.c - center];
        a.dot(b.cross(c))
    });
    volume.sum::<f32>() > 0.0
}
