// Reads texels of a depth texture into a buffer that the CPU can map: copies out of depth textures are whole or none.

struct Probe {
    texel: vec2<u32>,
    depth: f32,
    unused: u32,
}

#ifdef MULTISAMPLED
@group(0) @binding(0) var depth_texture: texture_depth_multisampled_2d;
#else
@group(0) @binding(0) var depth_texture: texture_depth_2d;
#endif
@group(0) @binding(1) var<storage, read_write> probes: array<Probe, 16>;

@compute @workgroup_size(16)
fn read_depth(@builtin(local_invocation_index) i: u32) {
    let texel = min(probes[i].texel, textureDimensions(depth_texture) - 1u);
#ifdef MULTISAMPLED
    // Reversed z: the nearest sample has the largest depth.
    var depth = 0.0;
    for (var sample = 0; sample < i32(textureNumSamples(depth_texture)); sample += 1) {
        depth = max(depth, textureLoad(depth_texture, texel, sample));
    }
    probes[i].depth = depth;
#else
    probes[i].depth = textureLoad(depth_texture, texel, 0);
#endif
}
