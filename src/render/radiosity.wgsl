// The radiosity that each pixel sees, W/m², neither exposed nor bent; reversed depth as in scene.wgsl.

@group(0) @binding(0) var<uniform> clip_from_world: mat4x4f;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(perspective, centroid) radiosity: vec3f,
}

@vertex
fn radiosity_vertex(@location(0) point_in_world: vec3f, @location(1) radiosity: vec3f) -> Varying {
    return Varying(clip_from_world * vec4f(point_in_world, 1.0), radiosity);
}

@fragment
fn radiosity_fragment(in: Varying) -> @location(0) vec4f {
    return vec4f(max(in.radiosity, vec3f(0.0)), 1.0);
}
