//! Colliders in files: what they are made from. What is read goes through the constructors and checks that code goes through.

use std::borrow::Cow;

use bevy_math::{Isometry3d, Vec2, Vec3};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use super::{ClothCollider, ClothColliderShape, Compound, ConvexHull, HeightField, TriMesh};
use crate::error::ClothErrorKind;

#[derive(Serialize, Deserialize)]
#[serde(
    remote = "ClothCollider",
    rename = "ClothCollider",
    deny_unknown_fields
)]
struct ColliderDescription {
    shape: ClothColliderShape,
    #[serde(default = "friction")]
    friction: f32,
    #[serde(default)]
    margin: f32,
}

/// Default for a file without the field.
fn friction() -> f32 {
    ClothCollider::FRICTION
}

#[derive(Serialize, Deserialize)]
#[serde(
    remote = "ClothColliderShape",
    rename = "ClothColliderShape",
    deny_unknown_fields
)]
enum ShapeDescription {
    Sphere {
        radius: f32,
    },
    Capsule {
        radius: f32,
        half_length: f32,
    },
    TaperedCapsule {
        bottom_radius: f32,
        top_radius: f32,
        half_length: f32,
    },
    HalfSpace,
    Cuboid {
        size: Vec3,
    },
    Cylinder {
        radius: f32,
        half_height: f32,
    },
    ConvexHull(ConvexHull),
    TriMesh(TriMesh),
    HeightField(HeightField),
    Compound(Compound),
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "ConvexHull", deny_unknown_fields)]
struct HullDescription<'a> {
    points: Cow<'a, [Vec3]>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "TriMesh", deny_unknown_fields)]
struct MeshDescription<'a> {
    positions: Cow<'a, [Vec3]>,
    triangles: Cow<'a, [[u32; 3]]>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "HeightField", deny_unknown_fields)]
struct HeightFieldDescription<'a> {
    heights: Cow<'a, [f32]>,
    columns: u32,
    size: Vec2,
}

#[derive(Serialize, Deserialize)]
#[serde(rename = "Compound", deny_unknown_fields)]
struct CompoundDescription<'a> {
    parts: Cow<'a, [(Isometry3d, ClothColliderShape)]>,
}

/// The value, unless something is wrong with it.
fn checked<T, E: Error>(value: T, errors: Vec<ClothErrorKind>) -> Result<T, E> {
    errors
        .into_iter()
        .next()
        .map_or(Ok(value), |error| Err(E::custom(error)))
}

impl Serialize for ClothCollider {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ColliderDescription::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for ClothCollider {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let collider = ColliderDescription::deserialize(deserializer)?;
        let errors = collider.errors();
        checked(collider, errors)
    }
}

impl Serialize for ClothColliderShape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ShapeDescription::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for ClothColliderShape {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let shape = ShapeDescription::deserialize(deserializer)?;
        let errors = shape.errors();
        checked(shape, errors)
    }
}

impl Serialize for ConvexHull {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let points = self.points().into();
        HullDescription { points }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ConvexHull {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let HullDescription { points } = Deserialize::deserialize(deserializer)?;
        Self::new(&points).map_err(Error::custom)
    }
}

impl Serialize for TriMesh {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let description = MeshDescription {
            positions: self.positions().into(),
            triangles: self.triangles().into(),
        };
        description.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for TriMesh {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let MeshDescription {
            positions,
            triangles,
        } = Deserialize::deserialize(deserializer)?;
        Self::new(positions, triangles).map_err(Error::custom)
    }
}

impl Serialize for HeightField {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let description = HeightFieldDescription {
            heights: self.heights().into(),
            columns: self.resolution().x,
            size: self.size(),
        };
        description.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for HeightField {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let HeightFieldDescription {
            heights,
            columns,
            size,
        } = Deserialize::deserialize(deserializer)?;
        Self::new(heights, columns, size).map_err(Error::custom)
    }
}

impl Serialize for Compound {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parts = self.parts().into();
        CompoundDescription { parts }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Compound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let CompoundDescription { parts } = Deserialize::deserialize(deserializer)?;
        Self::new(parts.into_owned()).map_err(Error::custom)
    }
}
