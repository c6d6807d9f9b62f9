//! How fast rays and solves are, by criterion, and how that stands to the goals: `./dev bench`, or `cargo bench --bench solver`.
//!
//! Imports the library alone, and obvhs to measure it without us.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput};
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::Ray;
use obvhs::triangle::Triangle;
use rayon::{ThreadPool, ThreadPoolBuilder};
use selflink::base::cancel::CancelToken;
use selflink::base::random::hash64;
use selflink::geometry::Occluders;
use selflink::measure::reference::random_points_on;
use selflink::scene::{Scene, builtin::BuiltinScene};
use selflink::solve::{Epsilon, Solver, SolverParams};

/// Segments that are traced in one go.
const SEGMENTS: usize = 100_000;

/// Segments end at this share of their length before the faces that they join.
const BEFORE: f32 = 1e-4;

/// Multiple of the rate of obvhs' own compressed tree that rays through [`Occluders`] shall reach.
const LEAST_OF_OBVHS: f64 = 1.3;

/// How many times as fast two threads shall solve as one.
const LEAST_SPEED_UP: f64 = 1.8;

/// Runs of which the goals' numbers are the median.
const RUNS: usize = 5;

fn main() {
    let seminar = Room::new(BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS });
    let segments = seminar.segments();
    let alone = Alone::new(&seminar.scene, &segments);
    let seen_by_both = (count_occluded(&seminar.occluders, &segments), alone.count_occluded());
    assert_eq!(seen_by_both.0, seen_by_both.1, "both trace the same rays through the same faces");

    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(3))
        .without_plots()
        .configure_from_args();
    rays(&mut criterion, &seminar.occluders, &segments, &alone);
    solves(&mut criterion, &seminar);
    criterion.final_summary();

    // Cargo says `--bench` when times are wanted; `cargo test --benches` only asks whether all of this runs.
    let asks_for = |option: &str| std::env::args().any(|argument| argument == option);
    if asks_for("--bench") && !asks_for("--list") && !asks_for("--test") {
        print_goals(&seminar, &segments, &alone);
    }
}

fn rays(criterion: &mut Criterion, occluders: &Occluders, segments: &[[Vec3; 2]], alone: &Alone) {
    let mut group = criterion.benchmark_group("rays");
    group.throughput(Throughput::Elements(segments.len() as u64));
    // Bounds what a visibility ray costs the solver, which casts ten of them for each link that it keeps.
    group.bench_function("occluded", |bencher| bencher.iter(|| count_occluded(occluders, segments)));
    // What it costs by the same rays, made ready beforehand, in obvhs without us.
    group.bench_function("obvhs alone", |bencher| bencher.iter(|| alone.count_occluded()));
    group.finish();
}

fn solves(criterion: &mut Criterion, seminar: &Room) {
    let (one, two) = (threads(1), threads(2));
    let cornell = Room::new(BuiltinScene::Cornell);
    let mut group = criterion.benchmark_group("solve");
    let mut bench = |name: &str, room: &Room, params: SolverParams, pool: &ThreadPool| {
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter_with_large_drop(|| room.solve(params, pool));
        });
    };
    // Bounds how long a person waits for a first useful picture of a furnished room on the smallest machine.
    bench("seminar 1e-3, one thread", seminar, by_epsilon(), &one);
    // Bounds what is left to one thread while the other waits: the share of the work that does not run in parallel.
    bench("seminar 1e-3, two threads", seminar, by_epsilon(), &two);
    // Bounds how long a furnished room takes to an error that is asked for, with what the final gather adds.
    bench("seminar, error 10 %", seminar, by_error(0.1), &two);
    // Bounds the same where next to nothing stands in the room, and what is left is the final gather.
    bench("cornell, error 5 %", &cornell, by_error(0.05), &two);
    group.finish();
}

fn by_epsilon() -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(1e-3), ..SolverParams::default() }
}

fn by_error(error: f64) -> SolverParams {
    SolverParams { error: Some(error), ..SolverParams::default() }
}

fn threads(count: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(count).build().expect("a pool of few threads")
}

// --- goals ------------------------------------------------------------------------------------------------------------------

/// One line for each goal, from a few runs that take turns, so that other work on the machine slows down all of them alike.
fn print_goals(seminar: &Room, segments: &[[Vec3; 2]], alone: &Alone) {
    let (ours, obvhs) = median_seconds(|| count_occluded(&seminar.occluders, segments), || alone.count_occluded());
    let (one, two) = (threads(1), threads(2));
    let solver = seminar.solve(by_epsilon(), &one);
    let stats = solver.stats();
    let (with_one, with_two) =
        median_seconds(|| seminar.solve(by_epsilon(), &one), || seminar.solve(by_epsilon(), &two));
    let ray = ours / segments.len() as f64;
    let outside_rays = with_one - ray * stats.rays as f64;

    println!(
        "goal: rays reach at least {:.0} % of obvhs' own rate, found {:.0} % ({:.0} ns a ray, obvhs alone {:.0} ns)",
        100.0 * LEAST_OF_OBVHS,
        100.0 * obvhs / ours,
        1e9 * ray,
        1e9 * obvhs / segments.len() as f64
    );
    println!(
        "goal: two threads solve seminar 1e-3 at least {LEAST_SPEED_UP} times as fast as one, found {:.2} times ({with_one:.3} s, {with_two:.3} s)",
        with_one / with_two
    );
    println!(
        "goal: at most 1 µs outside rays per link kept, found {:.2} µs ({:.0} % of {with_one:.3} s; {} rays, {} links; {:.3} s of it for clusters and exposure, whose own rays are not counted)",
        1e6 * outside_rays / stats.links as f64,
        100.0 * outside_rays / with_one,
        stats.rays,
        stats.links,
        stats.seconds.hierarchy
    );
}

/// Median seconds of two pieces of work that take turns.
fn median_seconds<T>(first: impl Fn() -> T, second: impl Fn() -> T) -> (f64, f64) {
    let (mut of_first, mut of_second) = ([0.0; RUNS], [0.0; RUNS]);
    for run in 0..RUNS {
        of_first[run] = seconds(&first);
        of_second[run] = seconds(&second);
    }
    (median(of_first), median(of_second))
}

/// Seconds of one run, without those that its result takes to go.
fn seconds<T>(work: impl Fn() -> T) -> f64 {
    let start = Instant::now();
    let result = black_box(work());
    let seconds = start.elapsed().as_secs_f64();
    drop(result);
    seconds
}

fn median(mut values: [f64; RUNS]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[RUNS / 2]
}

// --- what is measured -------------------------------------------------------------------------------------------------------

/// A scene of our own, ready to be solved.
struct Room {
    scene: Arc<Scene>,
    occluders: Arc<Occluders>,
}

impl Room {
    fn new(scene: BuiltinScene) -> Self {
        let scene = scene.build();
        let sides = scene.sides;
        let (scene, occluders) = selflink::geometry::orient::apply(scene, sides);
        Self { scene: scene.into(), occluders: occluders.into() }
    }

    /// From nothing but the occluders to a finished solution.
    fn solve(&self, params: SolverParams, pool: &ThreadPool) -> Solver {
        pool.install(|| {
            let (scene, occluders) = (self.scene.clone(), self.occluders.clone());
            let mut solver = Solver::new(scene, occluders, params, 0).expect("usable parameters");
            assert!(solver.run(&CancelToken::new()), "nobody cancels");
            solver
        })
    }

    /// Segments from just before random points on faces to just before others. Random points come in the order of the faces: ends are drawn among them.
    fn segments(&self) -> Vec<[Vec3; 2]> {
        let all: Vec<u32> = (0..self.scene.polygons.len() as u32).collect();
        let points = random_points_on(&self.scene, &all, SEGMENTS, 1);
        let draw = |index| points[hash64(2, index) as usize % points.len()].position;
        let pairs = (0..).map(|index| [draw(2 * index), draw(2 * index + 1)]);
        let between = pairs.filter(|[from, to]| from != to).take(SEGMENTS);
        between.map(|[from, to]| [from.lerp(to, BEFORE), to.lerp(from, BEFORE)]).collect()
    }
}

fn count_occluded(occluders: &Occluders, segments: &[[Vec3; 2]]) -> usize {
    segments.iter().filter(|[from, to]| occluders.occluded(*from, *to)).count()
}

/// The faces of a scene in obvhs' compressed tree, and rays that wait to be traced.
struct Alone {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
    rays: Vec<Ray>,
}

impl Alone {
    fn new(scene: &Scene, segments: &[[Vec3; 2]]) -> Self {
        let (lower, upper) = scene.bounds();
        let extent = lower.abs().max(upper.abs()).max_element();
        let scale = 32.0 * (-extent.log2().floor()).exp2();
        let in_bvh = |point: Vec3| Vec3A::from(scale * point);
        let mut triangles = Vec::new();
        for polygon in scene.polygons.iter().filter(|polygon| !polygon.is_back) {
            let ([a, b, c, d], count) = scene.corner_positions(polygon);
            for corners in [[a, b, c], [a, c, d]].into_iter().take(count - 2) {
                let [v0, v1, v2] = corners.map(in_bvh);
                triangles.push(Triangle { v0, v1, v2 });
            }
        }
        let params = BvhBuildParams {
            search_depth_threshold: 0,
            reinsertion_batch_ratio: 0.5,
            ..BvhBuildParams::medium_build()
        };
        let bvh = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|index| triangles[*index as usize]).collect();
        let ray = |[from, to]: &[Vec3; 2]| {
            let from = in_bvh(*from);
            let span = in_bvh(*to) - from;
            let length = span.length();
            // Adding zero makes +0 of −0, at which obvhs errs.
            Ray::new(from, span / length + Vec3A::ZERO, 0.0, length)
        };
        Self { bvh, triangles, rays: segments.iter().map(ray).collect() }
    }

    fn count_occluded(&self) -> usize {
        let misses = |ray: &&Ray| self.bvh.ray_traverse_miss(**ray, |ray, index| self.triangles[index].intersect(ray));
        self.rays.len() - self.rays.iter().filter(misses).count()
    }
}
