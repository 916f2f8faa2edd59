//! Memory of cloths.

use bevy_math::UVec2;
use tailorbird_cloth::{prelude::*, tethers::ClothTethers};
use tailorbird_test::{Scene, Sheet};

#[test]
fn a_particle_of_a_grid_takes_94_bytes_and_none_for_tethers() {
    for side in [100, 128] {
        let mut sheet = Sheet::new(&Scene::hang(UVec2::splat(side)));
        sheet.steps(3);
        let bytes = sheet.particles().memory_bytes()
            + sheet.get::<ClothNormals>().memory_bytes()
            + sheet.get::<ClothTopology>().memory_bytes();
        let each = bytes as f64 / f64::from(side * side);
        let tethers = sheet.get::<ClothTethers>().memory_bytes() as f64 / f64::from(side * side);
        println!("{side}²: {each:.2} bytes for each particle, and {tethers:.2} for tethers");
        // Three times position, what rounding took, two masses; two normals; the place at rest. Beyond that the pins, and
        // what makes arrays start at cache lines.
        assert!(each < 94.0 && tethers < 0.01);
    }
}

#[test]
fn sheets_of_one_shape_share_what_follows_from_it() {
    let mut sheet = Sheet::new(&Scene {
        sheets: 5,
        ..Scene::hang(UVec2::splat(8))
    });
    let mut cloths = sheet.sim.app.world_mut().query::<&ClothTopology>();
    let all: Vec<u64> = cloths
        .iter(sheet.sim.app.world())
        .map(|topology| topology.revision)
        .collect();
    assert_eq!(all, [all[0]; 5]);

    sheet.change::<Cloth>(|cloth| *cloth = Cloth::grid(bevy_math::Vec2::ONE, UVec2::splat(9)));
    sheet.step();
    let after = sheet.get::<ClothTopology>().revision;
    assert!(after > all[0]);
    let kept = cloths
        .iter(sheet.sim.app.world())
        .filter(|topology| topology.revision == all[0]);
    assert_eq!(kept.count(), 4);

    sheet.change::<ClothSolver>(|solver| *solver = ClothSolver::GaussSeidel);
    let bytes = sheet.get::<ClothTopology>().memory_bytes();
    sheet.step();
    // The springs of Gauss-Seidel are made when they are needed.
    let springs = sheet.get::<ClothTopology>().constraint_count();
    assert!(sheet.get::<ClothTopology>().memory_bytes() >= bytes + 12 * springs);
}
