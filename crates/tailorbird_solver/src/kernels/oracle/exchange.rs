//! Viscosity of a mesh.

use bevy_math::{DVec3, Vec3};

use crate::{
    kernels::{mesh::exchange, rigid_motion::RigidMotion},
    points::Points,
    shape::ClothShape,
    topology::{Topology, test_meshes::delaunay},
};

/// In a mesh x⁻ moves by −w c times the difference to each neighbour, c = σ · weight · min(viscosity, limit of the edge).
#[test]
fn neighbours_of_a_mesh_exchange_momentum_as_stated() {
    let (positions, triangles) = delaunay(12, 3);
    let topology = Topology::build(&ClothShape::mesh(positions, triangles.concat()), Vec3::ONE);
    let topology = topology.expect("a mesh");
    let fabric = topology.fabric().expect("no grid");
    let n = topology.particles();
    let point = |i: usize, seed: u64| {
        let axis = |k: u64| crate::topology::test_meshes::random(i, seed + k) - 0.5;
        Vec3::new(axis(0), axis(1), axis(2))
    };
    let limits = fabric
        .exchanges
        .iter()
        .map(|exchange| f64::from(exchange.limit));
    let middle = limits.sum::<f64>() / fabric.exchanges.len() as f64;
    // So far away that x⁻ is rounded to 6 · 10⁻⁵, and velocities are not.
    let far = Vec3::splat(1000.0);
    // Viscosities at which none, some and all of the edges are at their limit.
    for viscosity in [1e-2, 1.0, 1e3].map(|part| (part * middle) as f32) {
        for rigid in [
            RigidMotion::default(),
            RigidMotion {
                center: far + Vec3::new(0.5, 0.25, 0.125),
                displacement: Vec3::new(0.01, 0.02, -0.03),
                rotation: Vec3::new(0.02, -0.01, 0.03),
            },
        ] {
            let position: Points = topology.rest_positions.iter().map(|p| far + p).collect();
            let start: Points = position
                .iter()
                .enumerate()
                .map(|(i, p)| p - 0.1 * point(i, 1))
                .collect();
            let inv_mass: Vec<f32> = (0..n)
                .map(|i| if i % 7 == 0 { 0.0 } else { 50.0 + i as f32 })
                .collect();
            let (mut previous, mut lost) = (start.clone(), Points::zeroed(n));
            exchange(
                fabric,
                &position,
                &mut previous,
                &mut lost,
                &inv_mass,
                rigid,
                viscosity,
                0.2,
            );
            let velocity = |i: usize| {
                let x = position.get(i).as_dvec3();
                let turned = rigid.rotation.as_dvec3().cross(x - rigid.center.as_dvec3());
                x - start.get(i).as_dvec3() - (rigid.displacement.as_dvec3() + turned)
            };
            let mut gained = vec![DVec3::ZERO; n];
            for exchange in &fabric.exchanges {
                let [a, b] = exchange.ends.map(|i| i as usize);
                let c = 0.2 * f64::from(exchange.weight) * f64::from(viscosity.min(exchange.limit));
                let flow = c * (velocity(b) - velocity(a));
                gained[a] += flow;
                gained[b] -= flow;
            }
            let mut largest = 0.0_f64;
            for i in 0..n {
                let wanted = gained[i] * f64::from(inv_mass[i]);
                largest = largest.max(wanted.length());
                // What x⁻ moves by, with what rounding took from it.
                let moved = start.get(i).as_dvec3() - previous.get(i).as_dvec3();
                let is = moved + lost.get(i).as_dvec3();
                assert!(moved.distance(wanted) < 2e-4, "{i}: {moved} {wanted}");
                assert!(is.distance(wanted) < 2e-6, "{i}: {is} {wanted}");
            }
            assert!(largest > 1e-4, "{viscosity}: {largest}");
        }
    }
}
