//! Survey of the squeezed and strained edges of a sheet, and damping at squeezed ones.

use crate::properties::*;
use bevy_math::{DVec3, Vec2, Vec3};
use fearless_simd::Level;

use super::{Cloth, cases, cloths, vector};
use crate::{
    kernels::{
        lanes::SharedPoints,
        rigid_motion::RigidMotion,
        squeeze::{stop, survey},
    },
    points::Points,
};

const SPACING: Vec2 = Vec2::new(0.9, 1.1);

/// The edges along rows and columns, by their ends, and how long each is relative to its length at rest.
fn edges(cloth: &Cloth) -> Vec<([usize; 2], f64)> {
    let Cloth { columns, rows, .. } = *cloth;
    let along = |from: usize, to: usize, length: f32| {
        let d = cloth.position[to].as_dvec3() - cloth.position[from].as_dvec3();
        ([from, to], d.length() / f64::from(length))
    };
    let mut all = Vec::new();
    for i in 0..columns * rows {
        if (i + 1) % columns != 0 {
            all.push(along(i, i + 1, SPACING.x));
        }
        if i + columns < columns * rows {
            all.push(along(i, i + columns, SPACING.y));
        }
    }
    all
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn a_survey_counts_what_is_strained(cloth in cloths(0.25, false, false), allowed in 0.9_f32..1.4) {
        let edges = edges(&cloth);
        let limits = [f64::from(allowed), 0.5_f64.sqrt()];
        prop_assume!(edges.iter().all(|(_, part)| limits.iter().all(|limit| (part - limit).abs() > 1e-5)));
        let mut is = None;
        cloth.solved(|sheet| is = Some(survey(Level::new(), sheet, SPACING, allowed)));
        let is = is.expect("a survey");
        let strained = edges.iter().map(|(_, part)| *part).filter(|part| *part > f64::from(allowed));
        let strained: Vec<f64> = strained.collect();
        let part = strained.len() as f64 / edges.len() as f64;
        prop_assert!((f64::from(is.strained) - part).abs() < 1e-6, "{is:?} {part}");
        let longest = strained.into_iter().fold(0.0, f64::max);
        prop_assert!((f64::from(is.longest) - longest).abs() < 1e-5, "{is:?} {longest}");
        // With fewer columns than lanes, the missing edges count as squeezed.
        let squeezed = edges.iter().any(|(_, part)| *part < limits[1]);
        prop_assert!(is.squeezed == squeezed || (is.squeezed && cloth.columns <= 16), "{is:?}");
    }

    /// Free ends of edges below √½ of their length move as the whole does: by its displacement, and around its centre.
    #[test]
    fn ends_of_squeezed_edges_move_as_the_whole(
        cloth in cloths(0.25, false, false), motion in [vector(0.1), vector(0.1), vector(5.0)],
    ) {
        let edges = edges(&cloth);
        prop_assume!(edges.iter().all(|(_, part)| (part - 0.5_f64.sqrt()).abs() > 1e-5));
        let whole = RigidMotion { displacement: motion[0], rotation: motion[1], center: motion[2] };
        let start: Points = cloth.position.iter().map(|p| p - Vec3::Z).collect();
        let mut previous = start.clone();
        let points = SharedPoints::new(&mut previous);
        cloth.solved(|sheet| stop(Level::new(), sheet, points, SPACING, whole));
        for (i, w) in cloth.inv_mass.iter().enumerate() {
            let squeezed = edges.iter().any(|(ends, part)| *part < 0.5_f64.sqrt() && ends.contains(&i));
            if squeezed && *w > 0.0 {
                let x = cloth.position[i].as_dvec3();
                let turned = motion[1].as_dvec3().cross(x - motion[2].as_dvec3());
                let wanted: DVec3 = x - motion[0].as_dvec3() - turned;
                let is = previous.get(i).as_dvec3();
                prop_assert!(is.distance(wanted) < 1e-5, "{i}: {is} {wanted}");
            } else {
                prop_assert_eq!(previous.get(i), start.get(i));
            }
        }
    }
}

/// With as many columns as the widest vector has lanes, and more.
#[test]
fn a_squeezed_edge_is_seen_and_none_where_there_is_none() {
    for (moved, squeezed) in [(0.2, false), (0.4, true)] {
        for at in [0, 25, 136] {
            let place = |i: usize| {
                Vec3::new((i % 23) as f32, -((i / 23) as f32), 0.0) * SPACING.extend(1.0)
            };
            let mut cloth = Cloth {
                columns: 23,
                rows: 7,
                position: (0..23 * 7).map(place).collect(),
                inv_mass: vec![1.0; 23 * 7],
                normal: Vec::new(),
                lengths: [const { Vec::new() }; 2],
            };
            cloth.position[at].x += moved * SPACING.x;
            let mut is = None;
            cloth.solved(|sheet| is = Some(survey(Level::new(), sheet, SPACING, 10.0)));
            assert_eq!(is.map(|is| is.squeezed), Some(squeezed), "{at} by {moved}");
        }
    }
}
