//! Wrong files: an error that says what is wrong, never a panic and never a shape that its constructor would not make.

use serde::de::DeserializeOwned;
use tailorbird_cloth::prelude::*;

use crate::read;

/// Error of a RON file.
fn wrong<T: DeserializeOwned>(text: &str) -> String {
    match ron::from_str::<T>(text) {
        Ok(_) => panic!("nothing wrong: {text}"),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn says(error: &str, what: &str) {
    assert!(error.contains(what), "{error}");
}

#[test]
fn measures_that_are_not_above_zero() {
    for radius in ["NaN", "inf", "0", "-1.0"] {
        let shape = format!("Sphere(radius: {radius})");
        let error = wrong::<ClothColliderShape>(&shape);
        says(&error, "ClothCollider radius is");
        says(&error, "must be above 0 and finite [m]");
        says(
            &wrong::<ClothCollider>(&format!("(shape: {shape})")),
            "ClothCollider radius is",
        );
        let place = "(rotation: (0, 0, 0, 1), translation: (0, 0, 0))";
        says(
            &wrong::<ClothColliderShape>(&format!("Compound((parts: [({place}, {shape})]))")),
            "ClothCollider radius is",
        );
    }
    says(
        &wrong::<ClothColliderShape>("Capsule(radius: 1, half_length: NaN)"),
        "ClothCollider half_length is NaN",
    );
    says(
        &wrong::<ClothColliderShape>("Cuboid(size: (1, -1, 1))"),
        "ClothCollider size is -1",
    );
    says(
        &wrong::<ClothCollider>("(shape: HalfSpace, friction: -0.5)"),
        "ClothCollider.friction is -0.5",
    );
    says(
        &wrong::<ClothCollider>("(shape: HalfSpace, margin: NaN)"),
        "ClothCollider.margin is NaN",
    );
}

#[test]
fn a_mesh_with_an_index_out_of_range() {
    let corners = "positions: [(0, 0, 0), (1, 0, 0), (0, 1, 0)]";
    says(
        &wrong::<ClothColliderShape>(&format!("TriMesh(({corners}, triangles: [(0, 1, 3)]))")),
        "triangle mesh indices[2] is 3, must be below the number of positions, 3",
    );
    says(
        &wrong::<ClothColliderShape>(&format!("TriMesh(({corners}, triangles: []))")),
        "triangle mesh has 0 triangles",
    );
    says(
        &wrong::<ClothColliderShape>("TriMesh((positions: [(NaN, 0, 0)], triangles: [(0, 0, 0)]))"),
        "triangle mesh points[0]",
    );
}

#[test]
fn a_hull_of_nothing() {
    says(
        &wrong::<ClothColliderShape>("ConvexHull((points: []))"),
        "convex hull of 0 points has no volume",
    );
    says(
        &wrong::<ClothColliderShape>(
            "ConvexHull((points: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]))",
        ),
        "convex hull of 4 points has no volume",
    );
    says(
        &wrong::<ClothColliderShape>("ConvexHull((points: [(0, 0, inf)]))"),
        "convex hull points[0]",
    );
}

#[test]
fn a_height_field_that_is_no_grid() {
    says(
        &wrong::<ClothColliderShape>("HeightField((heights: [0, 1, 2], columns: 2, size: (1, 1)))"),
        "height field has 3 heights in 2 columns",
    );
    says(
        &wrong::<ClothColliderShape>("HeightField((heights: [], columns: 0, size: (1, 1)))"),
        "height field has 0 heights in 0 columns",
    );
    says(
        &wrong::<ClothColliderShape>(
            "HeightField((heights: [0, 1, NaN, 3], columns: 2, size: (1, 1)))",
        ),
        "HeightField height is NaN",
    );
    says(
        &wrong::<ClothColliderShape>(
            "HeightField((heights: [0, 1, 2, 3], columns: 2, size: (1, 0)))",
        ),
        "HeightField size is 0",
    );
}

#[test]
fn a_compound_of_nothing_or_nowhere() {
    says(
        &wrong::<ClothColliderShape>("Compound((parts: []))"),
        "compound has 0 parts",
    );
    let nowhere = "(rotation: (0, 0, 0, 1), translation: (0, NaN, 0))";
    says(
        &wrong::<ClothColliderShape>(&format!("Compound((parts: [({nowhere}, HalfSpace)]))")),
        "Compound part place is",
    );
}

#[test]
fn the_same_in_json() {
    let hull = serde_json::from_str::<ClothColliderShape>(r#"{"ConvexHull":{"points":[]}}"#);
    says(&hull.unwrap_err().to_string(), "convex hull of 0 points");
    // JSON has no NaN: this is what is written for it.
    let ball = serde_json::from_str::<ClothColliderShape>(r#"{"Sphere":{"radius":null}}"#);
    says(&ball.unwrap_err().to_string(), "null");
}

#[test]
fn fields_that_do_not_exist() {
    macro_rules! unknown {
        ($($type:ty: $text:literal,)*) => {
            $(
                let error = wrong::<$type>($text);
                says(&error, "nonsense");
            )*
        };
    }
    unknown! {
        Cloth: "(shape: Grid(size: (1, 1), resolution: (2, 2)), nonsense: 1)",
        ClothShape: "Grid(size: (1, 1), resolution: (2, 2), nonsense: 1)",
        ClothMaterial: "(nonsense: 0.5)",
        ClothPins: "(nonsense: 0.5)",
        ClothPin: "(selection: Particle(0), nonsense: 0.5)",
        ClothSelection: "Within(center: (0, 0, 0), radius: 1, nonsense: 0.5)",
        ClothWeights: "(nonsense: 0.5)",
        ClothInertia: "(nonsense: 0.5)",
        ClothSleep: "(nonsense: 0.5)",
        ClothSettings: "(nonsense: 0.5)",
        ClothWind: "(nonsense: 0.5)",
        ClothWindZone: "(nonsense: 0.5)",
        ClothWindShape: "Sphere(radius: 1, nonsense: 0.5)",
        ClothGusts: "(nonsense: 0.5)",
        ClothTurbulence: "(nonsense: 0.5)",
        ClothLayers: "(nonsense: 0.5)",
        ClothCollider: "(shape: HalfSpace, nonsense: 0.5)",
        ClothColliderShape: "Sphere(radius: 1, nonsense: 0.5)",
        ClothAttachment: "(nonsense: 0.5)",
        ClothMotionConstraints: "(nonsense: 0.5)",
        ClothMotionTargets: "(nonsense: 0.5)",
    }
    says(
        &wrong::<ClothColliderShape>("TriMesh((positions: [], triangles: [], nonsense: 1))"),
        "nonsense",
    );
}

#[test]
fn a_field_that_must_be_there() {
    says(&wrong::<Cloth>("()"), "shape");
    says(&wrong::<ClothPin>("()"), "selection");
    says(&wrong::<ClothCollider>("(friction: 0.5)"), "shape");
    says(&wrong::<ClothColliderShape>("Sphere()"), "radius");
}

/// Only what has no limit may be none, and only a number may be a limit.
#[test]
fn a_limit_that_is_no_number() {
    says(
        &wrong::<ClothInertia>("(max_speed: \"fast\")"),
        "a number, or none for infinity",
    );
    let speed = serde_json::from_str::<ClothInertia>(r#"{"linear":null}"#);
    says(&speed.unwrap_err().to_string(), "null");
}

/// Values that code can set as well are read, and reported when they are used.
#[test]
fn other_values_are_checked_where_they_are_used() {
    let material: ClothMaterial = read("(friction: NaN)");
    assert_eq!(material.errors().len(), 1);
    let zone: ClothWindZone = read("(shape: Sphere(radius: -1))");
    assert_eq!(zone.errors().len(), 1);
}
