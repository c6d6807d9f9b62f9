// Background, mesh and lines, drawn into one gamma-encoded target with reversed depth (1 at the near plane, 0 at infinity).

struct View {
    clip_from_world: mat4x4f,
    // Width and height of the picture, pixels.
    size: vec2f,
    // Factor on radiosities, m²/W; below 0 the vertices carry colours, which are shown as they are.
    exposure: f32,
    // Nearest distance at which lines are drawn, in the scene's unit.
    line_near: f32,
    reading: Reading,
}

// A quantity as false colours and lines of equal value; all zero where nothing is read.
struct Reading {
    // Its range, as logarithms to base 2 where it is logarithmic.
    ends: vec2f,
    fills: u32,
    is_logarithmic: u32,
    line_count: u32,
    // Colour and value.
    lines: array<vec4f, 8>,
    // Colours of the ramp at even places.
    stops: array<vec4f, 10>,
}

@group(0) @binding(0) var<uniform> view: View;

// Background: a soft vertical gradient, so that a black scene stands out from it.

struct BackgroundVarying {
    @builtin(position) clip: vec4f,
    @location(0) height: f32,
}

@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> BackgroundVarying {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return BackgroundVarying(vec4f(2.0 * corner - 1.0, 0.0, 1.0), corner.y);
}

@fragment
fn background_fragment(in: BackgroundVarying) -> @location(0) vec4f {
    return vec4f(mix(vec3f(0.15, 0.15, 0.16), vec3f(0.24, 0.25, 0.27), in.height), 1.0);
}

// Mesh: radiosity interpolated between vertices, then exposed and encoded at each pixel.

struct MeshVarying {
    @builtin(position) clip: vec4f,
    // Where the rim of a face crosses the pixel, its middle may lie outside the face and would extrapolate to black or white.
    @location(0) @interpolate(perspective, centroid) radiosity: vec3f,
    @location(1) @interpolate(perspective, centroid) measured: f32,
}

@vertex
fn mesh_vertex(
    @location(0) point_in_world: vec3f,
    @location(1) radiosity: vec3f,
    @location(2) measured: f32,
) -> MeshVarying {
    return MeshVarying(view.clip_from_world * vec4f(point_in_world, 1.0), radiosity, measured);
}

@fragment
fn mesh_fragment(in: MeshVarying) -> @location(0) vec4f {
    if view.exposure < 0.0 {
        return vec4f(in.radiosity, 1.0);
    }
    var colour = false_colour(in.measured);
    if view.reading.fills == 0u {
        colour = encode_gamma(tone_curve(view.exposure * max(in.radiosity, vec3f(0.0))));
    }
    let slope = length(vec2f(dpdx(in.measured), dpdy(in.measured)));
    for (var index = 0u; index < view.reading.line_count; index += 1u) {
        colour = with_line(colour, view.reading.lines[index], in.measured, slope);
    }
    return vec4f(colour, 1.0);
}

fn false_colour(value: f32) -> vec3f {
    let ends = view.reading.ends;
    var place = value;
    if view.reading.is_logarithmic != 0u {
        place = log2(max(value, 1e-37));
    }
    let along = 9.0 * clamp((place - ends.x) / (ends.y - ends.x), 0.0, 1.0);
    let lower = min(u32(along), 8u);
    return mix(view.reading.stops[lower].rgb, view.reading.stops[lower + 1u].rgb, along - f32(lower));
}

// Half the width of a line of equal value, and of the shade beside it that sets it off from lit surfaces, pixels.
const ISOLINE_HALF_WIDTH: f32 = 0.75;
const ISOLINE_SHADE: f32 = 1.0;

// A line where the value is that of the line, as wide everywhere: the slope tells how far away, in pixels, that is.
fn with_line(colour: vec3f, line: vec4f, value: f32, slope: f32) -> vec3f {
    if slope <= 1e-6 * line.w {
        // A plain has no lines, even at their height.
        return colour;
    }
    let distance = abs(value - line.w) / slope;
    let shade = clamp(ISOLINE_HALF_WIDTH + ISOLINE_SHADE + 0.5 - distance, 0.0, 1.0);
    let coverage = clamp(ISOLINE_HALF_WIDTH + 0.5 - distance, 0.0, 1.0);
    var below = colour;
    if view.reading.fills == 0u {
        below = mix(colour, vec3f(0.0), 0.5 * shade);
    }
    return mix(below, line.rgb, coverage);
}

// The same formulas as `tone_curve` and `encode_gamma` in tone.rs, which say where they come from.

fn tone_curve(exposed: vec3f) -> vec3f {
    // Far beyond white the curve is flat, and its square must stay finite.
    let x = min(exposed, vec3f(1e4));
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
}

fn encode_gamma(linear: vec3f) -> vec3f {
    return select(1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055, 12.92 * linear, linear <= vec3f(0.0031308));
}

// Lines: quads of constant width on the screen with round ends and soft edges; a line of no length is a dot.

// Factor on the opacity of all lines.
override line_opacity: f32 = 1.0;
// Lines are drawn as if nearer by this share of their distance, so that those in a surface are not half hidden by it: across
// half the width of a line the depth of a surface that is seen aslant, at 60°, changes by so much.
const LINE_BIAS: f32 = 3e-3;

struct LineInstance {
    @location(0) start: vec3f,
    @location(1) end: vec3f,
    @location(2) width: f32,
    @location(3) colour: vec4f,
}

struct LineVarying {
    @builtin(position) clip: vec4f,
    // Position along and across the line, pixels; 0 at its start.
    @location(0) along_across: vec2f,
    // Length and half width, pixels.
    @location(1) @interpolate(flat) extent: vec2f,
    @location(2) @interpolate(flat) colour: vec4f,
}

@vertex
fn line_vertex(@builtin(vertex_index) index: u32, line: LineInstance) -> LineVarying {
    var start = view.clip_from_world * vec4f(line.start, 1.0);
    var end = view.clip_from_world * vec4f(line.end, 1.0);
    let near = view.line_near;
    var out: LineVarying;
    if max(start.w, end.w) < near {
        // Behind the eye: outside the clip volume.
        out.clip = vec4f(0.0, 0.0, 2.0, 1.0);
        return out;
    }
    if start.w < near {
        start = mix(start, end, (near - start.w) / (end.w - start.w));
    } else if end.w < near {
        end = mix(end, start, (near - end.w) / (start.w - end.w));
    }
    let start_ndc = start.xyz / start.w;
    let end_ndc = end.xyz / end.w;
    let span = 0.5 * view.size * (end_ndc.xy - start_ndc.xy);
    let length = length(span);
    var along = vec2f(1.0, 0.0);
    if length > 1e-3 {
        along = span / length;
    }
    let across = vec2f(-along.y, along.x);
    let half_width = 0.5 * line.width;
    // Half a pixel more, for the soft edge.
    let reach = half_width + 0.5;
    let at_end = (index & 1u) == 1u;
    let side = select(-reach, reach, (index & 2u) == 2u);
    let cap = select(-reach, reach, at_end);
    let ndc = select(start_ndc, end_ndc, at_end);
    let offset = (cap * along + side * across) / (0.5 * view.size);
    // Divided by w already, so that the pixel distances below are interpolated straight across the screen.
    out.clip = vec4f(ndc.xy + offset, min(ndc.z * (1.0 + LINE_BIAS), 1.0), 1.0);
    out.along_across = vec2f(select(0.0, length, at_end) + cap, side);
    out.extent = vec2f(length, half_width);
    out.colour = line.colour;
    return out;
}

@fragment
fn line_fragment(in: LineVarying) -> @location(0) vec4f {
    let beyond = in.along_across.x - clamp(in.along_across.x, 0.0, in.extent.x);
    let distance = length(vec2f(beyond, in.along_across.y));
    let coverage = clamp(in.extent.y + 0.5 - distance, 0.0, 1.0);
    return vec4f(in.colour.rgb, in.colour.a * coverage * line_opacity);
}
