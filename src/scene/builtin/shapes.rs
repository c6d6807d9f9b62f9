//! Drawing in code: a scene under construction with a current group and placement, and the solids
//! that furniture is made of.
//!
//! One rule keeps every solid closed and no two faces coincident: a face that lies wholly on
//! another surface (the bottom of a book, the top of a table leg) is left out, and the rim of the
//! opening touches that surface. So no ray from inside a room meets the back of a face.

use glam::{Affine3, Mat3, Quat, Vec3, vec3};

use crate::scene::texture::linear_step;
use crate::scene::{GroupId, MaterialId, Scene, weld};

bitflags::bitflags! {
    /// A set of faces of a cuboid, to be left out.
    #[derive(Clone, Copy)]
    pub(super) struct Faces: u8 {
        const NONE = 0;
        /// The face towards -x.
        const LEFT = 1;
        /// The face towards +x.
        const RIGHT = 2;
        /// The face towards -y.
        const BOTTOM = 4;
        /// The face towards +y.
        const TOP = 8;
        /// The face towards -z.
        const BACK = 16;
        /// The face towards +z.
        const FRONT = 32;
        /// Both faces of an upright post.
        const ENDS = 4 | 8;
    }
}

/// A scene under construction: solids go into the current group, at the current placement.
pub(super) struct Draft {
    scene: Scene,
    group: GroupId,
    world_from_local: Affine3,
}

impl Draft {
    pub(super) fn new(name: &str) -> Self {
        Self { scene: Scene::new(name), group: GroupId(0), world_from_local: Affine3::IDENTITY }
    }

    /// The finished scene: corners at the same place share one vertex, materials that nothing wears
    /// are left out.
    pub(super) fn finish(mut self) -> Scene {
        let (vertices, welded) = weld(&self.scene.vertices);
        self.scene.vertices = vertices;
        self.scene.polygons.iter_mut().for_each(|polygon| polygon.map_corners(|corner| welded[corner as usize]));
        drop_unused_materials(&mut self.scene);
        self.scene
    }

    /// Polygons drawn so far.
    pub(super) fn polygon_count(&self) -> usize {
        self.scene.polygons.len()
    }

    /// A surface that only reflects.
    pub(super) fn paint(&mut self, name: &str, reflectance: Vec3) -> MaterialId {
        self.scene.add_material(name, reflectance, Vec3::ZERO)
    }

    /// A surface that reflects and sends out `radiance` (W/m²sr) in every direction.
    pub(super) fn lamp(&mut self, name: &str, reflectance: Vec3, radiance: Vec3) -> MaterialId {
        self.scene.add_material(name, reflectance, std::f32::consts::PI * radiance)
    }

    /// Draws inside a new group below the current one.
    pub(super) fn group<R>(&mut self, name: &str, draw: impl FnOnce(&mut Self) -> R) -> R {
        let parent = self.group;
        self.group = self.scene.add_group(name, parent);
        let result = draw(self);
        self.group = parent;
        result
    }

    /// Draws in a frame that lies at `origin` and is turned about the vertical by `turn` degrees,
    /// anticlockwise from above.
    pub(super) fn at<R>(&mut self, origin: Vec3, turn: f32, draw: impl FnOnce(&mut Self) -> R) -> R {
        self.placed(Affine3::from_rotation_translation(Quat::from_rotation_y(turn.to_radians()), origin), draw)
    }

    /// A group of its own at a place of its own: most pieces of furniture.
    pub(super) fn piece(&mut self, name: &str, origin: Vec3, turn: f32, draw: impl FnOnce(&mut Self)) {
        self.group(name, |d| d.at(origin, turn, draw));
    }

    /// Draws in a frame given by a rigid transform.
    pub(super) fn placed<R>(&mut self, outer_from_inner: Affine3, draw: impl FnOnce(&mut Self) -> R) -> R {
        let outer = self.world_from_local;
        self.world_from_local = outer * outer_from_inner;
        let result = draw(self);
        self.world_from_local = outer;
        result
    }

    /// A quad, anticlockwise as seen from the bright side.
    pub(super) fn quad(&mut self, corners: [Vec3; 4], material: MaterialId) {
        let corners = corners.map(|corner| self.world(corner));
        self.scene.add_quad(corners, material, self.group);
    }

    /// A triangle, anticlockwise as seen from the bright side.
    pub(super) fn triangle(&mut self, corners: [Vec3; 3], material: MaterialId) {
        let corners = corners.map(|corner| self.world(corner));
        self.scene.add_triangle(corners, material, self.group);
    }

    /// Positions are rounded to micrometres: neighbours then share corners bit for bit, and files
    /// stay short.
    fn world(&self, local: Vec3) -> Vec3 {
        let position = self.world_from_local.transform_point3(local);
        let rounded = (position.as_dvec3() * 1e6).round() / 1e6;
        rounded.as_vec3() + Vec3::ZERO // no negative zeros
    }

    /// A box between two corners, without the faces `left_out`.
    pub(super) fn cuboid(&mut self, lower: Vec3, upper: Vec3, left_out: Faces, material: MaterialId) {
        let corner = |x: bool, y: bool, z: bool| {
            vec3(
                if x { upper.x } else { lower.x },
                if y { upper.y } else { lower.y },
                if z { upper.z } else { lower.z },
            )
        };
        const O: bool = false;
        const I: bool = true;
        let faces = [
            (Faces::LEFT, [(O, O, O), (O, O, I), (O, I, I), (O, I, O)]),
            (Faces::RIGHT, [(I, O, I), (I, O, O), (I, I, O), (I, I, I)]),
            (Faces::BOTTOM, [(O, O, O), (I, O, O), (I, O, I), (O, O, I)]),
            (Faces::TOP, [(O, I, I), (I, I, I), (I, I, O), (O, I, O)]),
            (Faces::BACK, [(I, O, O), (O, O, O), (O, I, O), (I, I, O)]),
            (Faces::FRONT, [(O, O, I), (I, O, I), (I, I, I), (O, I, I)]),
        ];
        for (face, corners) in faces {
            if !left_out.contains(face) {
                self.quad(corners.map(|(x, y, z)| corner(x, y, z)), material);
            }
        }
    }

    /// A box by the middle of its bottom and its size.
    pub(super) fn block(&mut self, bottom: Vec3, size: Vec3, left_out: Faces, material: MaterialId) {
        let half = vec3(0.5 * size.x, 0.0, 0.5 * size.z);
        self.cuboid(bottom - half, bottom + half + vec3(0.0, size.y, 0.0), left_out, material);
    }

    /// A straight bar from `from` ([`Faces::BACK`]) to `to` ([`Faces::FRONT`]), `width` across and
    /// `height` thick.
    pub(super) fn bar(
        &mut self,
        [from, to]: [Vec3; 2],
        [width, height]: [f32; 2],
        left_out: Faces,
        material: MaterialId,
    ) {
        let forward = (to - from).normalize();
        let hint = if forward.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
        let right = hint.cross(forward).normalize();
        let frame = Affine3::from_mat3_translation(Mat3::from_cols(right, forward.cross(right), forward), from);
        let half = vec3(0.5 * width, 0.5 * height, 0.0);
        let length = (to - from).length();
        self.placed(frame, |d| d.cuboid(-half, half + vec3(0.0, 0.0, length), left_out, material));
    }

    /// A solid of revolution about the vertical: `profile` lists (radius, height) from the bottom,
    /// the outside on its right as it rises; `sides` must be even. Radius 0 closes an end, by quads
    /// where the end is flat.
    pub(super) fn lathe(&mut self, profile: &[(f32, f32)], sides: usize, material: MaterialId) {
        debug_assert!(sides >= 4 && sides.is_multiple_of(2));
        let point = |(radius, height): (f32, f32), side: usize| {
            let angle = std::f32::consts::TAU * (side % sides) as f32 / sides as f32;
            vec3(radius * angle.sin(), height, radius * angle.cos())
        };
        for step in profile.windows(2) {
            let (low, high) = (step[0], step[1]);
            if low.1 == high.1 && (low.0 == 0.0 || high.0 == 0.0) {
                self.disc(low.0.max(high.0), low.1, low.0 == 0.0, sides, material);
                continue;
            }
            for side in 0..sides {
                let [a, b] = [point(low, side), point(low, side + 1)];
                let [c, d] = [point(high, side + 1), point(high, side)];
                if low.0 == 0.0 {
                    self.triangle([a, c, d], material);
                } else if high.0 == 0.0 {
                    self.triangle([a, b, c], material);
                } else {
                    self.quad([a, b, c, d], material);
                }
            }
        }
    }

    /// A regular polygon with an even number of `sides`, as quads that run across it like floor
    /// boards.
    pub(super) fn disc(&mut self, radius: f32, height: f32, faces_down: bool, sides: usize, material: MaterialId) {
        let point = |side: usize| {
            let angle = std::f32::consts::TAU * side as f32 / sides as f32;
            vec3(radius * angle.sin(), height, radius * angle.cos())
        };
        for board in 0..sides / 2 - 1 {
            let [a, b, c, d] = [board, board + 1, sides - 2 - board, sides - 1 - board].map(point);
            self.quad(if faces_down { [d, c, b, a] } else { [a, b, c, d] }, material);
        }
    }

    /// A thin strip along `spine`, as wide as `widths` says across `side` and `thickness` thick
    /// downwards: a leaf, a folded sheet. Closed on every side; `side` × the spine points up.
    pub(super) fn blade(&mut self, spine: &[Vec3], widths: &[f32], side: Vec3, thickness: f32, material: MaterialId) {
        let down = vec3(0.0, -thickness, 0.0);
        let edge = |index: usize, sign: f32| spine[index] + 0.5 * sign * widths[index] * side;
        for index in 0..spine.len() - 1 {
            let [l0, r0] = [edge(index, -1.0), edge(index, 1.0)];
            let [l1, r1] = [edge(index + 1, -1.0), edge(index + 1, 1.0)];
            self.quad([l0, r0, r1, l1], material);
            self.quad([l0 + down, l1 + down, r1 + down, r0 + down], material);
            self.quad([l0 + down, l0, l1, l1 + down], material);
            self.quad([r0, r0 + down, r1 + down, r1], material);
        }
        let last = spine.len() - 1;
        let [l, r] = [edge(0, -1.0), edge(0, 1.0)];
        self.quad([l, l + down, r + down, r], material);
        let [l, r] = [edge(last, -1.0), edge(last, 1.0)];
        self.quad([r, r + down, l + down, l], material);
    }

    /// A wall of rectangles between the lines `across` (m along `u`) and `up` (m along `v`) from
    /// `origin`, facing `u`×`v`; `open(column, row)` leaves an opening. Neighbours share full
    /// edges.
    pub(super) fn wall(
        &mut self,
        (origin, u, v): (Vec3, Vec3, Vec3),
        across: &[f32],
        up: &[f32],
        open: impl Fn(usize, usize) -> bool,
        material: MaterialId,
    ) {
        for (row, v_range) in up.windows(2).enumerate() {
            for (column, u_range) in across.windows(2).enumerate() {
                if !open(column, row) {
                    let point = |u_index: usize, v_index: usize| origin + u * u_range[u_index] + v * v_range[v_index];
                    self.quad([point(0, 0), point(1, 0), point(1, 1), point(0, 1)], material);
                }
            }
        }
    }
}

fn drop_unused_materials(scene: &mut Scene) {
    let mut used = vec![false; scene.materials.len()];
    for polygon in &scene.polygons {
        used[polygon.material.0 as usize] = true;
    }
    let kept_before = |index: u32| used[..index as usize].iter().filter(|used| **used).count() as u32;
    let new_ids: Vec<u32> = (0..used.len() as u32).map(kept_before).collect();
    for polygon in &mut scene.polygons {
        polygon.material = MaterialId(new_ids[polygon.material.0 as usize]);
    }
    let mut used = used.iter();
    scene.materials.retain(|_| *used.next().expect("one flag for each material"));
}

/// A reflectance from a colour as painters and screens name it (sRGB, `0xRRGGBB`), rounded to three
/// digits.
pub(super) fn srgb(hex: u32) -> Vec3 {
    let channel = |shift: u32| (linear_step((hex >> shift) as u8) * 1000.0).round() / 1000.0;
    vec3(channel(16), channel(8), channel(0))
}

/// Repeatable variety (which book is how high): a small mixing generator, the same on every
/// machine.
#[derive(Clone, Debug)]
pub(super) struct Dice(u32);

impl Dice {
    pub(super) fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995)
    }

    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        let mut bits = self.0;
        bits = (bits ^ bits >> 16).wrapping_mul(0x85eb_ca6b);
        bits = (bits ^ bits >> 13).wrapping_mul(0xc2b2_ae35);
        bits ^ bits >> 16
    }

    /// A number between two bounds.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.next() >> 8) as f32 / (1u32 << 24) as f32
    }

    /// One of several.
    pub(super) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.next() as usize % choices.len()]
    }
}
