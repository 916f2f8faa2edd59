// Reads texels of a depth texture into a buffer that the CPU can map: copies out of depth textures are whole or none.

struct Probe {
    texel: vec2<u32>,
    /// Of the sample that at least half of the samples are not behind.
    median: f32,
    /// Of all samples on average.
    mean: f32,
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
    let samples = i32(textureNumSamples(depth_texture));
    var median = 0.0;
    var sum = 0.0;
    for (var sample = 0; sample < samples; sample += 1) {
        let depth = textureLoad(depth_texture, texel, sample);
        // Reversed z: what is nearer is larger.
        var in_front = 0;
        for (var other = 0; other < samples; other += 1) {
            in_front += i32(textureLoad(depth_texture, texel, other) >= depth);
        }
        if 2 * in_front >= samples {
            median = max(median, depth);
        }
        sum += depth;
    }
    probes[i].median = median;
    probes[i].mean = sum / f32(samples);
#else
    let depth = textureLoad(depth_texture, texel, 0);
    probes[i].median = depth;
    probes[i].mean = depth;
#endif
}
