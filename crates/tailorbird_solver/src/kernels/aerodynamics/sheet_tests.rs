use std::iter::once;

use bevy_math::{UVec2, Vec2};

use super::*;
use crate::{
    kernels::{
        aerodynamics::{classic, drag_and_lift},
        lanes::levels,
    },
    shape::ClothShape,
    topology::Topology,
};

const WIND: Vec3 = Vec3::new(3.0, -1.0, 7.0);

/// A wavy sheet that moves, with two pins.
struct Wavy {
    triangles: Vec<[u32; 3]>,
    rest_areas: Vec<f32>,
    lattice: Lattice,
    position: Points,
    previous: Points,
    inv_mass: Vec<f32>,
}

impl Wavy {
    fn new(columns: u32, rows: u32) -> Self {
        let cloth = ClothShape::grid(Vec2::new(2.0, 1.0), UVec2::new(columns, rows));
        let topology = Topology::build(&cloth, Vec3::ONE).expect("valid");
        let rest = topology.rest_positions.iter();
        let position: Points = rest
            .map(|p| *p + Vec3::Z * (7.0 * p.x + 3.0 * p.y * p.y).sin() * 0.2)
            .collect();
        let previous = position
            .iter()
            .map(|p| p - 1e-3 * Vec3::new((9.0 * p.y).sin(), p.x, (5.0 * p.x).cos()))
            .collect();
        let mut inv_mass: Vec<f32> = topology.areas().map(|a| 1.0 / (0.1 * a)).collect();
        inv_mass[0] = 0.0;
        inv_mass[columns as usize - 1] = 0.0;
        Self {
            lattice: *topology.lattice().expect("a grid"),
            triangles: topology.triangles().iter().collect(),
            rest_areas: topology.triangle_areas().collect(),
            position,
            previous,
            inv_mass,
        }
    }

    fn sheet<'a>(&'a self, acceleration: &'a mut Points) -> AirSheet<'a> {
        AirSheet {
            lattice: &self.lattice,
            position: &self.position,
            previous: &self.previous,
            inv_mass: &self.inv_mass,
            acceleration: SharedPoints::new(acceleration),
        }
    }

    /// Two accelerations to start from, after the scalar kernels.
    fn one_by_one(&self, air: Air) -> [Points; 2] {
        let [mut drag, mut old] = [(); 2].map(|()| self.start());
        drag_and_lift(
            &self.triangles,
            &self.rest_areas,
            air,
            &self.position,
            &self.previous,
            600.0,
            &self.inv_mass,
            &mut drag,
        );
        classic(
            &self.triangles,
            air.wind,
            &self.position,
            &self.inv_mass,
            &mut old,
        );
        [drag, old]
    }

    fn start(&self) -> Points {
        let n = self.position.len();
        (0..n).map(|i| Vec3::splat(0.01 * i as f32)).collect()
    }

    fn side_by_side(
        &self,
        level: Level,
        air: Air,
        parts: impl IntoIterator<Item = Range<usize>>,
    ) -> [Points; 2] {
        let [mut drag, mut old] = [(); 2].map(|()| self.start());
        for rows in parts {
            drag_and_lift_on_sheet(level, self.sheet(&mut drag), air, 600.0, rows.clone());
            classic_on_sheet(level, self.sheet(&mut old), air.wind, rows.clone());
        }
        [drag, old]
    }
}

fn air(drag: f32, lift: f32) -> Air {
    Air {
        wind: WIND,
        density: 1.225,
        areal_density: 0.1,
        drag,
        lift,
        seconds: 1.0 / 60.0,
    }
}

#[test]
fn side_by_side_agrees_with_one_by_one() {
    for (columns, rows) in [(2, 2), (3, 2), (5, 7), (17, 4), (33, 34), (64, 50)] {
        let sheet = Wavy::new(columns, rows);
        for air in [air(1.2, 0.7), air(0.3, 0.9), air(0.8, 0.8)] {
            let expected = sheet.one_by_one(air);
            let mut first = None;
            for level in levels() {
                let found = sheet.side_by_side(level, air, once(0..rows as usize));
                for (found, expected) in found.iter().zip(&expected) {
                    for (a, b) in found.iter().zip(expected.iter()) {
                        let far = a.distance(b) > 1e-4 * (1.0 + b.length());
                        assert!(!far, "{columns}x{rows} {level:?}: {a} {b}");
                    }
                }
                assert_eq!(first.get_or_insert_with(|| found.clone()), &found);
            }
        }
    }
}

#[test]
fn rows_can_be_done_in_any_parts() {
    let sheet = Wavy::new(19, 23);
    let level = Level::new();
    let air = air(1.2, 0.7);
    let whole = sheet.side_by_side(level, air, once(0..23));
    let parts = sheet.side_by_side(level, air, [11..12, 12..23, 0..0, 0..11]);
    assert_eq!(whole, parts);
}

#[test]
fn a_triangle_without_area_and_still_air_do_nothing() {
    let mut sheet = Wavy::new(4, 4);
    sheet.position.fill(Vec3::ONE);
    for level in levels() {
        let [drag, old] = sheet.side_by_side(level, air(1.2, 0.7), once(0..4));
        assert_eq!([&drag, &old], [&sheet.start(), &sheet.start()]);
    }
    let mut sheet = Wavy::new(4, 4);
    sheet.previous = sheet.position.clone();
    for level in levels() {
        let still = Air {
            wind: Vec3::ZERO,
            ..air(1.2, 0.7)
        };
        let [drag, old] = sheet.side_by_side(level, still, once(0..4));
        assert_eq!([&drag, &old], [&sheet.start(), &sheet.start()]);
    }
}

/// Computes nothing where a mass is missing.
#[test]
#[should_panic(expected = "a sheet of 4 x 5 particles")]
fn a_sheet_that_lacks_a_mass_is_refused() {
    let mut sheet = Wavy::new(4, 5);
    sheet.inv_mass.pop();
    sheet.side_by_side(Level::new(), air(1.2, 0.7), once(0..5));
}
