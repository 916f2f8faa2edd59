//! Inertia, limits, springs to anchors, frames that move, and normals.

use crate::properties::*;
use bevy_math::{DMat3, DVec3, Mat3, Quat, Vec3};
use fearless_simd::Level;

use super::{cases, vector};
use crate::{
    kernels::{
        lanes::{Shared, SharedPoints},
        limit::{self, Backstop, Limits},
        normals, rigid,
        rigid_motion::RigidMotion,
        spring,
        verlet::Verlet,
    },
    points::Points,
};

fn points(all: &[Vec3]) -> Points {
    all.iter().copied().collect()
}

proptest! {
    #![proptest_config(cases(500))]

    /// x' = x + (x − x⁻ + lost) e^(−damping h) h/h⁻ + a h², of which what is lost to rounding is told.
    #[test]
    fn inertia_is_as_stated(
        places in prop::collection::vec([vector(30.0), vector(0.5), vector(1e-6), vector(50.0)], 1..40),
        seconds in 1e-3_f32..0.1, before in prop::option::of(1e-3_f32..0.1), damping in 0.0_f32..10.0,
        gravity in vector(10.0), pushed in any::<bool>(), held in 0_usize..40,
    ) {
        let column = |k: usize| places.iter().map(|p| p[k]).collect::<Vec<_>>();
        let start = column(0);
        let earlier: Vec<_> = places.iter().map(|p| p[0] - p[1]).collect();
        let inv_mass: Vec<f32> = (0..places.len()).map(|i| if i == held { 0.0 } else { 1.0 }).collect();
        let (mut position, mut previous, mut lost) = (points(&start), points(&earlier), points(&column(2)));
        let acceleration = pushed.then(|| points(&column(3)));
        let verlet = Verlet { seconds, seconds_before: before.unwrap_or(0.0), damping, gravity };
        verlet.step(Level::new(), &mut position, &mut previous, &mut lost, acceleration.as_ref(), &inv_mass, 0..inv_mass.len());
        let h = f64::from(seconds);
        let kept = (-f64::from(damping) * h).exp() * before.map_or(1.0, |before| h / f64::from(before));
        for i in 0..places.len() {
            if i == held {
                prop_assert_eq!([position.get(i), previous.get(i)], [start[i], earlier[i]]);
                continue;
            }
            let velocity = start[i].as_dvec3() - earlier[i].as_dvec3() + places[i][2].as_dvec3();
            let air = if pushed { places[i][3] } else { Vec3::ZERO };
            let wanted = kept * velocity + (gravity.as_dvec3() + air.as_dvec3()) * h * h;
            let moved = position.get(i).as_dvec3() - start[i].as_dvec3() + lost.get(i).as_dvec3();
            // Six operations, each to half a unit of what is summed.
            let size = kept * 1.0 + 60.0 * h * h;
            prop_assert!(moved.distance(wanted) < 1e-6 * size, "{i}: {moved} {wanted}");
            prop_assert_eq!(previous.get(i), start[i]);
        }
    }

    /// Out of the ball behind, then into the ball around, and away from them no faster than the target goes.
    #[test]
    fn limits_are_as_stated(
        targets in [vector(2.0), vector(2.0)], normals in [vector(1.0), vector(1.0)], fractions in [0.0_f32..1.0, 0.0_f32..1.0],
        most in 0.05_f32..2.0, backstop in prop::option::of([0.0_f32..1.0, 0.05_f32..3.0]), place in vector(3.0), before in vector(3.0),
    ) {
        let [from, to] = targets.map(|p| points(&[p]));
        let [first, last] = normals.map(|p| points(&[p]));
        let [distance, radius] = backstop.unwrap_or([f32::INFINITY, 1.0]);
        let (mut position, mut previous) = (points(&[place]), points(&[before]));
        let limits = Limits {
            targets: [&from, &to],
            fractions: fractions.into(),
            max_distance: &[most],
            backstop: Some(Backstop { normals: [&first, &last], distance: &[distance], radius: &[radius] }),
        };
        let (p, q) = (SharedPoints::new(&mut position), SharedPoints::new(&mut previous));
        limit::hold(Level::new(), limits, p, q, Shared::new(&mut [1.0]), 0..1);

        let at = |ends: [Vec3; 2], k: usize| {
            ends[0].as_dvec3().lerp(ends[1].as_dvec3(), f64::from(fractions[k]))
        };
        let (target, start) = (at(targets, 1), place.as_dvec3());
        let normal = at(normals, 1);
        prop_assume!(normal.length() > 0.05);
        let (mut wanted, mut pushed) = (start, None);
        if backstop.is_some() {
            let center = target - normal.normalize() * f64::from(distance + radius);
            let off = start - center;
            prop_assume!((off.length() - f64::from(radius)).abs() > 1e-4 && off.length() > 0.02);
            if off.length() < f64::from(radius) {
                wanted = center + off.normalize() * f64::from(radius);
                pushed = Some(off.normalize());
            }
        }
        let off = wanted - target;
        prop_assume!((off.length() - f64::from(most)).abs() > 1e-4);
        if off.length() > f64::from(most) {
            wanted = target + off.normalize() * f64::from(most);
            pushed = Some(-off.normalize());
        }
        let is = position.get(0).as_dvec3();
        // The distance from the middle of a ball is 0.02 at least, so that its direction is off by 10⁻⁶/0.02, times a radius of 3.
        prop_assert!(is.distance(wanted) < 3e-4, "{is} {wanted}");
        let mut kept = before.as_dvec3();
        if let Some(pushed) = pushed {
            let moved = wanted - kept - (target - at(targets, 0));
            kept += moved.dot(pushed).max(0.0) * pushed;
        }
        let is = previous.get(0).as_dvec3();
        prop_assert!(is.distance(kept) < 2e-3, "{is} {kept}");
    }

    /// A spring that is solved together with a rod: the two equations of both multipliers, by Cramer's rule.
    #[test]
    fn a_spring_and_a_rod_at_one_particle_are_solved_together(
        w in 0.1_f64..10.0, alpha in 0.1_f64..10.0, from_anchor in -1.0_f64..1.0, rod in -1.0_f64..1.0,
    ) {
        // The spring: (w + α̃) λ + w μ = −C; the rod to something that is held: w λ + w μ = −(C + r).
        let (c, r) = (from_anchor, rod);
        let determinant = (w + alpha) * w - w * w;
        let lambda = (-c * w + (c + r) * w) / determinant;
        let mu = (-(c + r) * (w + alpha) + c * w) / determinant;
        let wanted = c + w * (lambda + mu);
        // With the spring eliminated: C and w are what is left of them, and the rod alone is solved.
        let left = f64::from(spring::left(w as f32, alpha as f32));
        let (c_left, w_left) = (c * left, w * left);
        let is = c_left + w_left * (-(c_left + r) / w_left);
        prop_assert!((is - wanted).abs() < 1e-5, "{is} {wanted}");
        // What pulls at the anchor, C/α̃, is the spring's multiplier.
        let of_rod = -(c_left + r) / w_left;
        prop_assert!((of_rod - mu).abs() < 2e-5 * (1.0 + mu.abs()), "{of_rod} {mu}");
    }

    /// In the frame that moves, where a particle was is x' = R x + t; held ones keep their coordinates.
    #[test]
    fn what_is_free_stays_in_the_world(
        turn in vector(2.0), shift in vector(3.0), place in vector(5.0), before in vector(5.0), held in any::<bool>(),
    ) {
        let rotation = Quat::from_scaled_axis(turn);
        let (mut position, mut previous) = (points(&[place]), points(&[before]));
        let w = if held { 0.0 } else { 2.0 };
        rigid::change_frame(Mat3::from_quat(rotation), shift, &[w], &mut position, &mut previous);
        // Rodrigues' formula.
        let (axis, angle) = (turn.as_dvec3().normalize_or_zero(), turn.as_dvec3().length());
        let moved = |x: Vec3| {
            let x = x.as_dvec3();
            x * angle.cos() + axis.cross(x) * angle.sin() + axis * axis.dot(x) * (1.0 - angle.cos()) + shift.as_dvec3()
        };
        let wanted = if held { [place.as_dvec3(), moved(place)] } else { [moved(place), moved(before)] };
        for (is, wanted) in [position.get(0), previous.get(0)].into_iter().zip(wanted) {
            prop_assert!(is.as_dvec3().distance(wanted) < 1e-5, "{is} {wanted}");
        }
        let mut vectors = points(&[place]);
        rigid::rotate(Mat3::from_quat(rotation), &mut vectors);
        prop_assert!(vectors.get(0).as_dvec3().distance(moved(place) - shift.as_dvec3()) < 1e-5);
    }

    /// Whatever the shape and its axes: the motion that all particles have is that of the whole.
    #[test]
    fn the_motion_of_a_rigid_whole_is_found(
        places in prop::collection::vec((vector(1.0), 0.1_f32..2.0), 8..30), size in [0.2_f32..2.0, 0.2_f32..2.0, 0.2_f32..2.0],
        axes in vector(3.0), shift in vector(5.0), displacement in vector(0.1), rotation in vector(0.1),
    ) {
        let axes = Quat::from_scaled_axis(axes);
        let position: Points = places.iter().map(|(p, _)| axes * (*p * Vec3::from(size)) + shift).collect();
        let mass: Vec<f32> = places.iter().map(|(_, mass)| *mass).collect();
        let total: f64 = mass.iter().map(|m| f64::from(*m)).sum();
        let center = position.iter().zip(&mass).map(|(p, m)| p.as_dvec3() * f64::from(*m)).sum::<DVec3>() / total;
        let moved = |p: Vec3| displacement.as_dvec3() + rotation.as_dvec3().cross(p.as_dvec3() - center);
        let previous: Points = position.iter().map(|p| (p.as_dvec3() - moved(p)).as_vec3()).collect();
        let found = RigidMotion::of_all(&mass, &position, &previous);
        // Places are rounded to 5 · 10⁻⁷, against an extent of 0.05 at least.
        prop_assert!(found.center.as_dvec3().distance(center) < 1e-6);
        prop_assert!(found.displacement.distance(displacement) < 1e-6, "{found:?}");
        prop_assert!(found.rotation.distance(rotation) < 2e-5, "{found:?} {rotation}");
        for p in position.iter() {
            prop_assert!(found.at(p).as_dvec3().distance(moved(p)) < 1e-4);
        }
    }

    /// ω² r away from the axis.
    #[test]
    fn what_turns_is_flung_from_its_axis(turn in vector(0.3), place in vector(5.0)) {
        let mut position = points(&[place, place]);
        rigid::add_centrifugal(turn, &[1.0, 0.0], &mut position);
        prop_assert_eq!(position.get(1), place);
        let (phi, x) = (turn.as_dvec3(), place.as_dvec3());
        let from_axis = x - phi.normalize_or_zero() * phi.normalize_or_zero().dot(x);
        let wanted = x + from_axis * phi.length_squared();
        prop_assert!(position.get(0).as_dvec3().distance(wanted) < 2e-6, "{} {wanted}", position.get(0));
    }

    /// A closed surface has vector areas that add up to nothing: those of a tetrahedron's faces, each towards the outside.
    #[test]
    fn normals_are_vector_areas(corners in [vector(2.0), vector(2.0), vector(2.0), vector(2.0)]) {
        let [a, b, c, d] = corners.map(Vec3::as_dvec3);
        let volume = DMat3::from_cols(b - a, c - a, d - a).determinant();
        prop_assume!(volume.abs() > 0.1);
        // Against the clock as seen from outside.
        let triangles: [[u32; 3]; 4] = if volume > 0.0 {
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        } else {
            [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
        };
        let position = points(&corners);
        let mut flat = Points::zeroed(4);
        normals::flat(triangles.into_iter(), &position, &mut flat);
        let middle = (a + b + c + d) / 4.0;
        let area = |t: [u32; 3]| {
            let [p, q, r] = t.map(|i| corners[i as usize].as_dvec3());
            // Heron's formula.
            let [x, y, z] = [p.distance(q), q.distance(r), r.distance(p)];
            let s = 0.5 * (x + y + z);
            (s * (s - x) * (s - y) * (s - z)).max(0.0).sqrt()
        };
        let mut sum = DVec3::ZERO;
        let mut around = [DVec3::ZERO; 4];
        for (k, triangle) in triangles.into_iter().enumerate() {
            let (normal, area) = (flat.get(k).as_dvec3(), area(triangle));
            prop_assert!((normal.length() - 1.0).abs() < 1e-6);
            prop_assert!(normal.dot(corners[triangle[0] as usize].as_dvec3() - middle) > 0.0);
            sum += normal * area;
            for i in triangle {
                around[i as usize] += normal * area;
            }
        }
        prop_assert!(sum.length() < 1e-4, "{sum}");
        let mut smooth = Points::zeroed(4);
        normals::smooth(&triangles, &position, &mut smooth);
        for (is, wanted) in smooth.iter().zip(around) {
            prop_assume!(wanted.length() > 0.1);
            prop_assert!(is.as_dvec3().distance(wanted.normalize()) < 1e-4, "{is} {wanted}");
        }
    }
}

/// One without area keeps its normal; a particle without a triangle, or whose triangles cancel, has +z.
#[test]
fn what_has_no_normal_keeps_one() {
    let position = points(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y]);
    let mut flat = points(&[Vec3::Y]);
    normals::flat([[0, 1, 2]].into_iter(), &position, &mut flat);
    assert_eq!(flat.get(0), Vec3::Y);
    let mut smooth = points(&[Vec3::Y; 4]);
    normals::smooth(&[[0, 1, 3], [1, 0, 3]], &position, &mut smooth);
    assert!(smooth.iter().all(|n| n == Vec3::Z));
}
