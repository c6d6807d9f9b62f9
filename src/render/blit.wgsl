// Copies the finished picture into the viewport of a window's pass.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var nearest: sampler;

// 1 where the target encodes gamma itself, so that the picture's must be taken off first.
override target_encodes: u32 = 0u;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn blit_vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Varying(vec4f(2.0 * corner - 1.0, 0.0, 1.0), vec2f(corner.x, 1.0 - corner.y));
}

@fragment
fn blit_fragment(in: Varying) -> @location(0) vec4f {
    let colour = textureSample(picture, nearest, in.uv).rgb;
    if target_encodes == 1u {
        let linear = select(pow((colour + 0.055) / 1.055, vec3f(2.4)), colour / 12.92, colour <= vec3f(0.04045));
        return vec4f(linear, 1.0);
    }
    return vec4f(colour, 1.0);
}
