//! Closed rooms as real files have them: every wall doubled or shared with a neighbour, things that
//! stand on the floor, faces drawn twice and cut otherwise.
//!
//! Truth: the matrix of all pairs of the plain room, in which every face is there once.

use std::sync::Arc;

use glam::{Vec3, vec3};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use selflink::geometry::{Occluders, orient};
use selflink::hierarchy::ClusteringMode;
use selflink::measure::stability::matrix::{self, Fineness};
use selflink::measure::stability::measure::of_polygons;
use selflink::measure::stability::scenes::add_box;
use selflink::scene::{GroupId, MaterialId, Scene, Sides};
use selflink::solve::{Epsilon, SolverParams};

use super::random_scenes::{solve, try_on};

/// Rooms tried.
const ROOMS: u32 = 6;
/// Share of the light that reaches all faces of one plane by which solver and matrix may differ.
/// The matrix looks at four points of each part, and is good to some per cent.
const ALLOWED: f64 = 0.04;
/// The parts of the matrix, m², and their points.
const FINENESS: Fineness = Fineness { largest_part: 0.15, points: 4, looks: 4 };

/// What becomes of a room.
#[derive(Clone, Debug)]
struct Recipe {
    size: Vec3,
    reflectance: f32,
    /// A box on the floor: lower corner and size, as shares of the room.
    thing: Option<(Vec3, Vec3)>,
    /// Walls have twins that are bright outside, as quads or triangles.
    twins: Option<bool>,
    /// A dark room behind the wall at the far end, so many times as large.
    neighbour: Option<f32>,
    /// Walls are drawn once more, in triangles.
    drawn_twice: bool,
    clustering: ClusteringMode,
}

fn recipes() -> impl Strategy<Value = Recipe> {
    let share = |from: f32, to: f32| prop::array::uniform3(from..to).prop_map(Vec3::from);
    let thing = prop::option::of((share(0.1, 0.5), share(0.2, 0.4)));
    let modes = [ClusteringMode::None, ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::Adaptive];
    let doubled = (prop::option::of(any::<bool>()), prop::option::of(0.5_f32..1.5), any::<bool>());
    (share(1.0, 2.5), 0.1_f32..0.9, thing, doubled, prop::sample::select(modes.to_vec())).prop_map(
        |(size, reflectance, thing, (twins, neighbour, drawn_twice), clustering)| Recipe {
            size,
            reflectance,
            thing,
            twins,
            neighbour,
            drawn_twice,
            clustering,
        },
    )
}

impl Recipe {
    /// The room with every face once, and a lamp that hangs below its ceiling.
    fn plain(&self) -> Scene {
        let mut scene = Scene::new("room");
        let grey = scene.add_material("grey", Vec3::splat(self.reflectance), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::splat(0.3), Vec3::ONE);
        add_box(&mut scene, (Vec3::ZERO, self.size), true, (grey, GroupId(0)));
        let below_ceiling = |x: f32, z: f32| vec3(x, 0.8, z) * self.size;
        let corners = [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]].map(|[x, z]| below_ceiling(x, z));
        scene.add_quad(corners, lamp, GroupId(0));
        if let Some((lower, size)) = self.thing {
            let lower = (lower * self.size).with_y(0.0);
            let group = scene.add_group("thing", GroupId(0));
            add_box(&mut scene, (lower, lower + size * self.size), false, (grey, group));
        }
        scene
    }

    /// The closed room with every face doubled, as a file may have it.
    fn doubled(&self) -> Scene {
        let mut scene = self.plain();
        for index in 0..6 {
            let polygon = scene.polygons[index];
            let [a, b, c, d] = scene.corner_positions(&polygon).0;
            if self.drawn_twice {
                scene.add_triangle([b, c, d], polygon.material, GroupId(0));
                scene.add_triangle([b, d, a], polygon.material, GroupId(0));
            }
            match self.twins {
                Some(true) => {
                    scene.add_triangle([a, c, b], MaterialId(0), GroupId(0));
                    scene.add_triangle([a, d, c], MaterialId(0), GroupId(0));
                }
                Some(false) => scene.add_quad([a, d, c, b], MaterialId(0), GroupId(0)),
                None => {}
            }
        }
        if let Some(share) = self.neighbour {
            let lower = vec3(self.size.x, 0.0, 0.0);
            add_box(&mut scene, (lower, lower + share * self.size), true, (MaterialId(0), GroupId(0)));
        }
        scene
    }
}

/// The planes of the plain room's faces: where along which axis, and which way the face looks.
fn planes(scene: &Scene) -> Vec<(usize, f32, f32)> {
    let of_polygon = |polygon| {
        let normal: Vec3 = scene.normal(polygon);
        let axis = normal.abs().max_position();
        (axis, scene.corner_positions(polygon).0[0][axis], normal[axis].signum())
    };
    scene.polygons.iter().map(of_polygon).collect()
}

/// Σ A·B of all faces in each of these planes, W, of those that lie within the room.
fn powers(scene: &Scene, size: Vec3, of: &[(usize, f32, f32)], polygons: &[(f64, f64)]) -> Vec<f64> {
    let is_within = |index: usize| {
        let (corners, count) = scene.corner_positions(&scene.polygons[index]);
        corners[..count].iter().all(|corner| corner.cmpge(Vec3::splat(-1e-4)).all() && corner.cmple(size + 1e-4).all())
    };
    let all = planes(scene);
    let is_same = |a: &(usize, f32, f32), b: &(usize, f32, f32)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-4 && a.2 == b.2;
    let power = |plane: &(usize, f32, f32)| {
        let faces = (0..all.len()).filter(|index| is_same(&all[*index], plane) && is_within(*index));
        faces.map(|index| polygons[index].0 * polygons[index].1).sum()
    };
    of.iter().map(power).collect()
}

fn agrees(recipe: Recipe) -> Result<(), TestCaseError> {
    let plain = recipe.plain();
    let truth = matrix::radiosities(&plain, &Occluders::new(&plain), FINENESS);
    let truth: Vec<(f64, f64)> =
        plain.polygons.iter().zip(truth).map(|(polygon, light)| (f64::from(plain.area(polygon)), light.x)).collect();
    let (scene, occluders) = orient::apply(recipe.doubled(), Sides::Front);
    let (scene, occluders) = (Arc::new(scene), Arc::new(occluders));
    let params =
        SolverParams { clustering: recipe.clustering, epsilon: Epsilon::Relative(1e-4), ..SolverParams::default() };
    let solved = solve(&scene, &occluders, params)?;
    let found: Vec<(f64, f64)> = of_polygons(&solved).into_iter().map(|(area, light)| (area, light.x)).collect();
    let of = planes(&plain);
    let (truth, found) = (powers(&plain, recipe.size, &of, &truth), powers(&scene, recipe.size, &of, &found));
    let whole: f64 = truth.iter().sum();
    for ((plane, truth), found) in of.iter().zip(&truth).zip(&found) {
        prop_assert!(
            (truth - found).abs() <= ALLOWED * truth + 1e-3 * whole,
            "{found} W instead of {truth} W leave the faces in {plane:?} (axis, place, side)"
        );
    }
    if recipe.neighbour.is_some() {
        let size = recipe.size.x;
        let is_beyond = |index: &usize| {
            let (corners, count) = scene.corner_positions(&scene.polygons[*index]);
            corners[..count].iter().any(|corner| corner.x > size + 1e-4)
        };
        let leaked: f64 =
            (0..scene.polygons.len()).filter(is_beyond).map(|index| of_polygons(&solved)[index].1.x).sum();
        prop_assert!(leaked == 0.0, "{leaked} W/m² in the dark room");
    }
    Ok(())
}

#[test]
fn doubled_rooms_are_lit_as_plain_ones() {
    try_on(b"selflink: rooms of doubled walls", ROOMS, &recipes(), agrees);
}
