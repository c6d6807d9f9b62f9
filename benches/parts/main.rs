//! What each part costs, and how that stands to the goals: `./dev bench`, or
//! `cargo bench --bench parts`.
//!
//! Pieces that are compared take turns within one run, so that other work on the machine slows all
//! of them alike. A goal that is missed is said at the end, and the run fails. Imports the library,
//! the program for what is measured whole, and obvhs to measure it without us.

mod alone;
mod control;
mod rooms;
mod whole;

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use selflink::base::cancel::CancelToken;
use selflink::geometry::Occluders;
use selflink::read::picture::{GatheredPicture, Lens, Start};
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Epsilon, Solver, SolverParams};

use alone::Alone;
use rooms::{Room, count_occluded};

/// Runs of which a number is the median.
const RUNS: usize = 3;
/// Pixels of the picture that is measured.
const PICTURE: [u32; 2] = [320, 200];
/// Readings that are measured.
const READINGS: usize = 1000;
/// Threads for which times are projected by Amdahl's law.
const MANY: f64 = 16.0;

fn main() {
    // Cargo says `--bench` when numbers are wanted; `cargo test --benches` only asks whether all of
    // this is built.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("| part | found | goal | |\n| --- | ---: | ---: | --- |");
    let mut table = Table::default();
    rays(&mut table);
    refinement(&mut table);
    two_threads(&mut table);
    reading(&mut table);
    tower(&mut table);
    control::changes(&mut table);
    control::commands(&mut table);
    whole::scenes(&mut table);
    if !table.missed.is_empty() {
        eprintln!("\ngoals that were missed:");
        table.missed.iter().for_each(|missed| eprintln!("  {missed}"));
        std::process::exit(1);
    }
}

/// A goal of a number.
#[derive(Clone, Copy)]
pub enum Goal {
    /// The number shall be this or more.
    AtLeast(f64),
    /// The number shall be this or less.
    AtMost(f64),
    /// The number is told, and nothing asked of it.
    None,
}

/// The table as it is written, and the goals that were missed.
#[derive(Default)]
pub struct Table {
    missed: Vec<String>,
}

impl Table {
    /// Writes a line; `what` says what the number is made of.
    pub fn line(&mut self, part: &str, found: f64, unit: &str, goal: Goal, what: &str) {
        let (is_kept, goal) = match goal {
            Goal::AtLeast(least) => (found >= least, format!("≥ {least} {unit}")),
            Goal::AtMost(most) => (found <= most, format!("≤ {most} {unit}")),
            Goal::None => (true, String::new()),
        };
        let found = format!("{} {unit}", three_digits(found));
        println!("| {part} | {found} | {goal} | {what} |");
        if !is_kept {
            self.missed.push(format!("{part}: {found}, wanted {goal}"));
        }
    }
}

fn three_digits(value: f64) -> String {
    let digits = 2 - (value.abs().max(1e-9).log10().floor() as i32);
    format!("{value:.*}", digits.clamp(0, 6) as usize)
}

fn seminar() -> Room {
    Room::new(BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS })
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

fn rays(table: &mut Table) {
    let room = seminar();
    let segments = room.segments();
    let alone = Alone::new(&room.scene, &segments);
    // Ours close the seams between triangles, which a few rays slip through alone.
    let stopped = [count_occluded(&room.occluders, &segments), alone.count_occluded()];
    assert!(stopped[0].abs_diff(stopped[1]) * 200 <= segments.len(), "both trace the same rays: {stopped:?} stopped");
    let [ours, obvhs] =
        medians([&|| seconds(|| count_occluded(&room.occluders, &segments)), &|| seconds(|| alone.count_occluded())]);
    let each = 1e9 / segments.len() as f64;
    table.line("a ray between random points", each * ours, "ns", Goal::None, "seminar room, one thread");
    table.line("the same in obvhs alone", each * obvhs, "ns", Goal::None, "its compressed wide tree");
    table.line("rate of rays over obvhs' own", obvhs / ours, "×", Goal::AtLeast(1.3), "");
    let fans = room.fans();
    let alone = Alone::of_rays(alone, &fans);
    let [ours, obvhs] =
        medians([&|| seconds(|| rooms::count_met(&room.occluders, &fans)), &|| seconds(|| alone.count_met())]);
    let each = 1e9 / fans.len() as f64;
    let what = "64 from each point, the first face";
    table.line("a cosine-distributed ray", each * ours, "ns", Goal::None, what);
    table.line("the same in obvhs alone", each * obvhs, "ns", Goal::None, "");
    table.line("rate of such rays over obvhs' own", obvhs / ours, "×", Goal::AtLeast(0.8), "");
}

fn refinement(table: &mut Table) {
    for (name, room) in [("seminar", seminar()), ("office", Room::new(BuiltinScene::Office))] {
        let segments = room.segments();
        let one = threads(1);
        let [ray, refine] =
            medians([&|| seconds(|| count_occluded(&room.occluders, &segments)) / segments.len() as f64, &|| {
                room.solve(by_epsilon(), &one).stats().seconds.refine
            }]);
        let stats = room.solve(by_epsilon(), &one).stats();
        let outside = (refine - ray * stats.rays as f64) / stats.links as f64;
        let what = format!("{name}, ε = 1e-3, one thread: {} links, {} rays", stats.links, stats.rays);
        table.line("refinement, a link kept, outside of rays", 1e6 * outside, "µs", Goal::AtMost(1.0), &what);
        table.line("refinement, a pair tested", 1e6 * refine / stats.pairs_judged as f64, "µs", Goal::None, name);
    }
}

/// A part by name, and the seconds that it takes on some threads.
type Part<'a> = (&'a str, &'a dyn Fn(&ThreadPool) -> f64);

/// What two threads gain in each part, and what sixteen would by the share that does not run in
/// parallel.
fn two_threads(table: &mut Table) {
    let office = Room::new(BuiltinScene::Office);
    let pools = [threads(1), threads(2)];
    let tower = BuiltinScene::Tower { polygons: 100_000 }.build();
    let prepare = |pool: &ThreadPool| {
        let (scene, sides) = (tower.clone(), tower.sides);
        seconds(|| pool.install(|| selflink::geometry::orient::apply(scene, sides)))
    };
    let (prepared, occluders) = selflink::geometry::orient::apply(tower.clone(), tower.sides);
    let (prepared, occluders) = (Arc::new(prepared), Arc::new(occluders));
    let unsolved = || Solver::new(prepared.clone(), occluders.clone(), by_epsilon(), 0).expect("usable parameters");
    let clusters = |pool: &ThreadPool| pool.install(|| seconds(unsolved));
    let mesh = |pool: &ThreadPool| {
        let mut solver = unsolved();
        pool.install(|| seconds(|| solver.snapshot()))
    };
    let fine = SolverParams { epsilon: Epsilon::Relative(1e-4), ..SolverParams::default() };
    let parts: [Part; 6] = [
        ("preparing a tower of 100,000 polygons", &prepare),
        ("its clusters", &clusters),
        ("its first mesh and picture", &mesh),
        ("refinement of the office, ε = 1e-4", &|pool| office.solve(fine, pool).stats().seconds.refine),
        ("light over its links", &|pool| office.solve(fine, pool).stats().seconds.gather),
        ("final gather of the office, 10 %", &|pool| office.solve(by_error(0.1), pool).stats().seconds.reconstruct),
    ];
    for (name, part) in parts {
        let [one, two] = medians([&|| part(&pools[0]), &|| part(&pools[1])]);
        let serial = (2.0 * two / one - 1.0).clamp(0.0, 1.0);
        let many = 1.0 / (serial + (1.0 - serial) / MANY);
        let what = format!("{:.3} s with one; {MANY} threads would give {many:.1}×", one);
        table.line(&format!("two threads over one: {name}"), one / two, "×", Goal::AtLeast(1.8), &what);
    }
}

fn reading(table: &mut Table) {
    let office = Room::new(BuiltinScene::Office);
    let pool = threads(2);
    let mut solver = office.solve(by_error(0.05), &pool);
    let snapshot = pool.install(|| solver.snapshot());
    let field = snapshot.field.expect("a gathered solution");
    let points = office.points(READINGS, 5);
    let error = 0.5 * 0.05;
    let read = || {
        pool.install(|| {
            use rayon::prelude::*;
            points.par_iter().map(|point| field.read(point.polygon, point.position, error).mean.x).sum::<f32>()
        })
    };
    let what = "office at 5 %, points by area, standard error half of that, two threads";
    table.line("1,000 readings", median(&|| seconds(read)), "s", Goal::AtMost(0.3), what);
    let pose = office.scene.camera.expect("ours has a view");
    let picture = || {
        pool.install(|| {
            let lens = Lens::of_pose(&pose, PICTURE[0] as f32 / PICTURE[1] as f32);
            let mut picture = GatheredPicture::new(field.clone(), lens, PICTURE, 0.05, Start::Fine, false);
            while !picture.is_done() {
                picture.advance(&CancelToken::new()).expect("nobody cancels");
            }
        })
    };
    let pixels = f64::from(PICTURE[0] * PICTURE[1]);
    let what = "office, noise 5 %, four samples each, two threads";
    table.line("a gathered pixel", 1e6 * median(&|| seconds(picture)) / pixels, "µs", Goal::None, what);
}

/// Costs of a polygon in a scene that grows, and the exponents of its time.
fn tower(table: &mut Table) {
    let pool = threads(2);
    let mut before: Option<[f64; 4]> = None;
    for polygons in [10_000, 100_000, 1_000_000] {
        let scene = BuiltinScene::Tower { polygons }.build();
        let count = scene.polygons.len() as f64;
        let sides = scene.sides;
        let begun = Instant::now();
        let (scene, occluders) = pool.install(|| selflink::geometry::orient::apply(scene, sides));
        let prepared = begun.elapsed().as_secs_f64();
        let (scene, occluders): (_, Arc<Occluders>) = (Arc::new(scene), Arc::new(occluders));
        let (clusters, first, solve, bytes) = pool.install(|| {
            let begun = Instant::now();
            let mut solver = Solver::new(scene, occluders, by_epsilon(), 0).expect("usable parameters");
            let clusters = begun.elapsed().as_secs_f64();
            black_box(solver.snapshot());
            let first = begun.elapsed().as_secs_f64();
            assert!(solver.run(&CancelToken::new()), "nobody cancels");
            (clusters, first, begun.elapsed().as_secs_f64(), solver.stats().bytes.counted)
        });
        let named = |part: &str| format!("tower of {count:.0} polygons: {part}");
        let now = [prepared, clusters, first, solve];
        for (part, seconds) in ["preparing", "clusters", "first picture", "ε = 1e-3"].into_iter().zip(now) {
            table.line(&named(part), 1e6 * seconds / count, "µs", Goal::None, &format!("a polygon; {seconds:.2} s"));
        }
        table.line(&named("memory"), bytes as f64 / count, "B", Goal::None, "a polygon, as counted");
        if let Some(before) = before {
            let exponent = (now[3] / before[3]).ln() / 10.0_f64.ln();
            table.line(&named("exponent"), exponent, "", Goal::AtMost(1.1), "of the time to ε = 1e-3, from a tenth");
        }
        before = Some(now);
    }
}

/// Medians of some pieces of work that take turns.
fn medians<const N: usize>(work: [&dyn Fn() -> f64; N]) -> [f64; N] {
    let mut found = [[0.0; RUNS]; N];
    for run in 0..RUNS {
        for (work, found) in work.iter().zip(&mut found) {
            found[run] = work();
        }
    }
    found.map(|mut values| {
        values.sort_by(f64::total_cmp);
        values[RUNS / 2]
    })
}

fn median(work: &dyn Fn() -> f64) -> f64 {
    medians([work])[0]
}

/// Seconds of one run, without those that its result takes to go.
fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = black_box(work());
    let seconds = start.elapsed().as_secs_f64();
    drop(result);
    seconds
}
