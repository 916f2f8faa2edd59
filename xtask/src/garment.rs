//! Writes the example garment: a skirt of denim waistband and cotton panels, as glTF.
//!
//! It has what garments from elsewhere have: two primitives with materials of their own that meet at a seam, panels whose UVs
//! leave off at the sides, a node that is moved and turned, vertex colours, and `_CLOTH_PIN`.

use std::{
    error::Error,
    f32::consts::{FRAC_PI_2, TAU},
    fs,
    path::Path,
};

use serde_json::{Value, json};

/// Vertices around each panel; there are two panels.
const COLUMNS: usize = 56;

/// Rows of cells of the waistband and of the panels.
const BAND_ROWS: usize = 3;
const PANEL_ROWS: usize = 34;

/// Half the waist from side to side and from back to front \[m\].
const WAIST: [f32; 2] = [0.165, 0.125];

/// The height of the waistband and the length of the panels \[m\].
const BAND_HEIGHT: f32 = 0.045;
const PANEL_LENGTH: f32 = 0.55;

/// Distance that the panels go outwards for each metre of their length: this much cloth falls in folds.
const FLARE: f32 = 0.72;

/// The side of one tile of the textures \[m\].
const TILE: f32 = 0.1;

/// One primitive, its vertices as parallel arrays.
#[derive(Default)]
struct Primitive {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
    pins: Vec<f32>,
    indices: Vec<u32>,
}

/// Writes `skirt.gltf` and `skirt.bin` into `folder`.
///
/// # Errors
///
/// When a file cannot be written.
pub fn write(folder: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let mut buffer = Buffer::default();
    let primitives = [(band(), 0), (panels(), 1)].map(|(p, material)| buffer.add(&p, material));
    let texture = |index: usize| json!({ "index": index });
    let material = |name: &str, first: usize, color: [f32; 4]| {
        json!({
            "name": name,
            "doubleSided": true,
            "normalTexture": texture(first + 1),
            "pbrMetallicRoughness": {
                "baseColorFactor": color,
                "baseColorTexture": texture(first),
                "metallicRoughnessTexture": texture(first + 2),
            },
        })
    };
    let kinds = ["albedo", "normal", "metallic_roughness"];
    let images: Vec<Value> = ["denim", "cotton"]
        .iter()
        .flat_map(|fabric| {
            kinds.map(|kind| json!({ "uri": format!("../textures/{fabric}_{kind}.png") }))
        })
        .collect();
    let textures: Vec<Value> = (0..images.len())
        .map(|source| json!({ "sampler": 0, "source": source }))
        .collect();
    // Turned by a quarter about the vertical, and lifted to the height of a waist.
    let turn = [0.0, (0.5 * FRAC_PI_2).sin(), 0.0, (0.5 * FRAC_PI_2).cos()];
    let gltf = json!({
        "asset": { "version": "2.0", "generator": "cargo xtask garment" },
        "scene": 0,
        "scenes": [{ "name": "skirt", "nodes": [0] }],
        "nodes": [{ "name": "skirt", "mesh": 0, "translation": [0.0, 1.0, 0.0], "rotation": turn }],
        "meshes": [{ "name": "skirt", "primitives": primitives }],
        "materials": [
            material("waistband", 0, [1.0; 4]),
            material("panels", 3, [0.78, 0.30, 0.24, 1.0]),
        ],
        "samplers": [{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 }],
        "images": images,
        "textures": textures,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "uri": "skirt.bin", "byteLength": buffer.bytes.len() }],
    });
    let text = serde_json::to_string_pretty(&gltf)? + "\n";
    for (name, bytes) in [
        ("skirt.gltf", text.as_bytes()),
        ("skirt.bin", &buffer.bytes),
    ] {
        let path = folder.join(name);
        fs::write(&path, bytes)?;
        println!("{}", path.display());
    }
    Ok(())
}

/// A place on the skirt, around from 0 to 1, `down` from the lower edge of the waistband \[m\] (negative on it).
fn place(around: f32, down: f32) -> [f32; 3] {
    let (sin, cos) = (TAU * around).sin_cos();
    let out = FLARE * down.max(0.0);
    let drop = if down < 0.0 {
        -down
    } else {
        -down * (1.0 - FLARE * FLARE).sqrt()
    };
    [(WAIST[0] + out) * cos, drop, (WAIST[1] + out) * sin]
}

/// One panel, or one half of the waistband: a sheet from `around.0` to `around.1` and from `down.0` to `down.1`.
fn sheet(primitive: &mut Primitive, around: [f32; 2], down: [f32; 2], rows: usize) {
    let first = primitive.positions.len() as u32;
    let lerp = |[from, to]: [f32; 2], part: f32| from + (to - from) * part;
    for row in 0..=rows {
        let v = lerp(down, row as f32 / rows as f32);
        for column in 0..=COLUMNS {
            let part = column as f32 / COLUMNS as f32;
            // Both panels end at the same numbers, so that the seams are at one place.
            let angle = if column == COLUMNS {
                around[1] % 1.0
            } else {
                lerp(around, part)
            };
            let p = place(angle, v);
            let width = 0.5 * TAU * (0.5 * (WAIST[0] + WAIST[1]) + FLARE * v.max(0.0));
            let (sin, cos) = (TAU * angle).sin_cos();
            let up = if v < 0.0 { 0.0 } else { FLARE };
            let flat = (1.0 - up * up).sqrt();
            primitive.positions.push(p);
            primitive.normals.push([flat * cos, up, flat * sin]);
            primitive
                .uvs
                .push([(0.5 - part) * width / TILE, (v + BAND_HEIGHT) / TILE]);
            // Darker at the hem; alpha is the pin, for those who read no attributes.
            let shade = 1.0 - 0.35 * (v.max(0.0) / PANEL_LENGTH).powi(2);
            let pin = (-v / BAND_HEIGHT).clamp(0.0, 1.0);
            primitive.colors.push([shade, shade, shade, pin]);
            primitive.pins.push(pin);
        }
    }
    let columns = COLUMNS as u32 + 1;
    for row in 0..rows as u32 {
        for column in 0..COLUMNS as u32 {
            let a = first + row * columns + column;
            let [b, c, d] = [a + 1, a + columns, a + columns + 1];
            primitive.indices.extend([a, b, d, a, d, c]);
        }
    }
}

fn band() -> Primitive {
    let mut band = Primitive::default();
    for around in [[0.0, 0.5], [0.5, 1.0]] {
        sheet(&mut band, around, [-BAND_HEIGHT, 0.0], BAND_ROWS);
    }
    band
}

fn panels() -> Primitive {
    let mut panels = Primitive::default();
    for around in [[0.0, 0.5], [0.5, 1.0]] {
        sheet(&mut panels, around, [0.0, PANEL_LENGTH], PANEL_ROWS);
    }
    panels
}

/// The binary file, and what describes it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn add(&mut self, primitive: &Primitive, material: usize) -> Value {
        const ARRAY: u32 = 34962;
        const ELEMENTS: u32 = 34963;
        let bound = |pick: fn(f32, f32) -> f32| {
            let fold = |a: [f32; 3], b: &[f32; 3]| [0, 1, 2].map(|k| pick(a[k], b[k]));
            primitive
                .positions
                .iter()
                .fold(primitive.positions[0], fold)
        };
        let mut bounds = json!({ "min": bound(f32::min), "max": bound(f32::max) });
        let mut position = self.floats(primitive.positions.as_flattened(), "VEC3", 3, ARRAY);
        if let (Some(accessor), Some(bounds)) = (
            self.accessors.last_mut().and_then(Value::as_object_mut),
            bounds.as_object_mut(),
        ) {
            accessor.append(bounds);
        }
        let indices: Vec<u8> = primitive
            .indices
            .iter()
            .flat_map(|i| i.to_le_bytes())
            .collect();
        let attributes = json!({
            "POSITION": position.take(),
            "NORMAL": self.floats(primitive.normals.as_flattened(), "VEC3", 3, ARRAY),
            "TEXCOORD_0": self.floats(primitive.uvs.as_flattened(), "VEC2", 2, ARRAY),
            "COLOR_0": self.floats(primitive.colors.as_flattened(), "VEC4", 4, ARRAY),
            "_CLOTH_PIN": self.floats(&primitive.pins, "SCALAR", 1, ARRAY),
        });
        json!({
            "attributes": attributes,
            "indices": self.push(&indices, "SCALAR", 5125, primitive.indices.len(), ELEMENTS),
            "material": material,
        })
    }

    fn floats(&mut self, values: &[f32], kind: &str, size: usize, target: u32) -> Value {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.push(&bytes, kind, 5126, values.len() / size, target)
    }

    /// Appends bytes with a view and an accessor of their own; returns the number of the accessor.
    fn push(
        &mut self,
        bytes: &[u8],
        kind: &str,
        component: u32,
        count: usize,
        target: u32,
    ) -> Value {
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
            "target": target,
        }));
        self.bytes.extend_from_slice(bytes);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1,
            "componentType": component,
            "count": count,
            "type": kind,
        }));
        json!(self.accessors.len() - 1)
    }
}
