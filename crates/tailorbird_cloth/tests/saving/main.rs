//! Settings of a game go into files and come back, and a wrong file is an error.

#![cfg(test)]
#![cfg(feature = "serialize")]

mod colliders;
mod plain;
mod random;
mod world;
mod wrong;

use std::fmt::Debug;

use serde::{Serialize, de::DeserializeOwned};

/// Value after it was written to RON and read.
fn through_ron<T: Serialize + DeserializeOwned>(value: &T) -> T {
    let text = ron::to_string(value).unwrap();
    ron::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Value after it was written to JSON and read.
fn through_json<T: Serialize + DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Checks that a value comes back as it was.
fn comes_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    assert_eq!(&through_ron(value), value, "through RON");
    assert_eq!(&through_json(value), value, "through JSON");
}

/// Reads RON.
fn read<T: DeserializeOwned>(text: &str) -> T {
    ron::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}
