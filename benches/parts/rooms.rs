//! Scenes and rays that are measured.

use std::sync::Arc;

use glam::Vec3;
use rayon::ThreadPool;
use selflink::base::cancel::CancelToken;
use selflink::base::random::{cosine_direction, hash64, r2_sequence};
use selflink::geometry::Occluders;
use selflink::measure::reference::{SurfacePoint, random_points_on};
use selflink::scene::{Scene, builtin::BuiltinScene};
use selflink::solve::{Solver, SolverParams};

/// Segments that are traced in one go.
const SEGMENTS: usize = 100_000;

/// Rays that leave one point.
const FAN: u32 = 64;

/// A ray from a face: a point of it, its unit normal there, and a unit direction.
pub type FaceRay = [Vec3; 3];

/// Segments end at this share of their length before the faces that they join.
const BEFORE: f32 = 1e-4;

/// A scene of our own, ready to be solved.
pub struct Room {
    pub scene: Arc<Scene>,
    pub occluders: Arc<Occluders>,
}

impl Room {
    /// One of our scenes, its faces turned and cut.
    pub fn new(scene: BuiltinScene) -> Self {
        let scene = scene.build();
        let sides = scene.sides;
        let (scene, occluders) = selflink::geometry::orient::apply(scene, sides);
        Self { scene: scene.into(), occluders: occluders.into() }
    }

    /// From nothing but the occluders to a finished solution.
    pub fn solve(&self, params: SolverParams, pool: &ThreadPool) -> Solver {
        pool.install(|| {
            let (scene, occluders) = (self.scene.clone(), self.occluders.clone());
            let mut solver = Solver::new(scene, occluders, params, 0).expect("usable parameters");
            assert!(solver.run(&CancelToken::new()), "nobody cancels");
            solver
        })
    }

    /// Random points on all faces, evenly by area, in the order of the faces.
    pub fn points(&self, count: usize, seed: u64) -> Vec<SurfacePoint> {
        let all: Vec<u32> = (0..self.scene.polygons.len() as u32).collect();
        random_points_on(&self.scene, &all, count, seed)
    }

    /// Cosine-distributed rays from random points on faces, those of a point one after another.
    pub fn fans(&self) -> Vec<FaceRay> {
        let points = self.points(SEGMENTS / FAN as usize, 3);
        let fan = |point: &SurfacePoint| {
            let (position, normal) = (point.position, self.scene.normal(&self.scene.polygons[point.polygon as usize]));
            let seed = hash64(4, position.to_array().iter().fold(0, |seed, x| hash64(seed, x.to_bits().into())));
            (0..FAN).map(move |ray| {
                let [u, v] = r2_sequence(seed, ray);
                [position, normal, cosine_direction(normal, u, v)]
            })
        };
        points.iter().flat_map(fan).collect()
    }

    /// Segments from just before random points on faces to just before others; ends are drawn among
    /// the points.
    pub fn segments(&self) -> Vec<[Vec3; 2]> {
        let points = self.points(SEGMENTS, 1);
        let draw = |index| points[hash64(2, index) as usize % points.len()].position;
        let pairs = (0..).map(|index| [draw(2 * index), draw(2 * index + 1)]);
        let between = pairs.filter(|[from, to]| from != to).take(SEGMENTS);
        between.map(|[from, to]| [from.lerp(to, BEFORE), to.lerp(from, BEFORE)]).collect()
    }
}

/// How many of some rays meet a face.
pub fn count_met(occluders: &Occluders, rays: &[FaceRay]) -> usize {
    rays.iter().filter(|[point, normal, direction]| occluders.ray_from(*point, *normal, *direction).is_some()).count()
}

/// How many of some segments meet a face.
pub fn count_occluded(occluders: &Occluders, segments: &[[Vec3; 2]]) -> usize {
    segments.iter().filter(|[from, to]| occluders.occluded(*from, *to)).count()
}
