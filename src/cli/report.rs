//! The statistics of a solve: as JSON for programs, as a few lines for people.

use std::fmt::Write as _;
use std::time::Instant;

use selflink::base::format::{bytes, count, number, percent, quantity, seconds};
use selflink::export::settings::Settings;
use selflink::gather::Quantiles;
use selflink::scene::{FileLight, Scene, Sides, Skipped};
use selflink::solve::{
    Bytes, ClusteringMode, ErrorFound, MemoryStop, PowerBalance, Reconstruct, Seconds, name_of, power_balance,
};
use selflink::transport::Push;
use serde::Serialize;

use super::job::{Job, Solution};

/// Rays that measure what escapes and what backs stop: about 0.3 % of the power either way.
const BALANCE_RAYS: u32 = 100_000;

/// Everything that is reported about a solve; the keys of the statistics file.
#[derive(Serialize)]
pub struct Report<'a> {
    scene: &'a str,
    clustering: ClusteringMode,
    octree_depth: u32,
    epsilon_relative: f64,
    epsilon_watts: f64,
    /// Local error within which nine tenths of the area are to be read, and the bound that the
    /// certificate found.
    error_asked: Option<f64>,
    error_estimate: Option<f64>,
    /// Quantiles of what is read and of the bare mesh.
    error: Option<ErrorFound>,
    reconstruct: Reconstruct,
    vertices: usize,
    partial_factor: f64,
    visibility_factor: f64,
    rays_min: u32,
    rays_max: u32,
    push: Push,
    sides: Sides,
    seed: u64,
    /// All that the solution was made with, as `--settings` takes it.
    settings: &'a Settings,
    initial_patches: usize,
    clusters: usize,
    patches: usize,
    links: usize,
    pairs_judged: u64,
    rays: u64,
    iterations: u32,
    converged: bool,
    /// The part that the memory limit kept coarser than was asked for.
    memory_stop: Option<MemoryStop>,
    threads: usize,
    seconds: Times,
    bytes: Bytes,
    /// Highest resident memory of the process; `None` where the system does not tell.
    peak_rss_bytes: Option<u64>,
    emitted_watts: f64,
    /// From outside, on reflecting sides: measured like the balance, or by a few thousand rays
    /// where that is not.
    entered_watts: f64,
    absorbed_watts: f64,
    /// Measured by rays; `None` for a solution that is not finished.
    stopped_by_backs_watts: Option<f64>,
    escaped_watts: Option<f64>,
    /// Share of the emitted and entered power that is missing (positive) or too much.
    balance_gap: Option<f64>,
    depth_guard_struck: u64,
    clamped_leaves: usize,
    /// Points and spots of light that the scene's file holds.
    lights: &'a [FileLight],
    skipped: &'a Skipped,
}

#[derive(Serialize)]
struct Times {
    #[serde(flatten)]
    solve: Seconds,
    /// From the process's start, loading included.
    since_process_start_first_snapshot: f64,
}

impl<'a> Report<'a> {
    /// Gathers what is known of a solution; `started` is when the process was.
    pub fn new(job: &'a Job, solution: &Solution, started: Instant) -> Self {
        let (stats, params, scene) = (&solution.stats, solution.solver.params(), &job.scene);
        let measure = || job.pool.install(|| power_balance(&solution.solver, BALANCE_RAYS, params.seed));
        let balance: Option<PowerBalance> = stats.converged.then(measure);
        let since_start = solution.first_snapshot_at.saturating_duration_since(started);
        Self {
            scene: &scene.name,
            clustering: params.clustering,
            octree_depth: params.octree_depth,
            epsilon_relative: stats.epsilon_relative,
            epsilon_watts: stats.epsilon_watts,
            error_asked: stats.error_asked,
            error_estimate: stats.error_estimate,
            error: stats.error,
            reconstruct: params.shown_by(),
            vertices: solution.snapshot.mesh.positions.len(),
            partial_factor: params.partial_factor,
            visibility_factor: params.visibility_factor,
            rays_min: params.rays_min,
            rays_max: params.rays_max,
            push: params.push,
            sides: scene.sides,
            seed: params.seed,
            settings: &job.settings,
            initial_patches: stats.initial_patches,
            clusters: stats.clusters,
            patches: stats.patches,
            links: stats.links,
            pairs_judged: stats.pairs_judged,
            rays: stats.rays,
            iterations: stats.iterations,
            converged: stats.converged,
            memory_stop: stats.memory_stop,
            threads: solution.threads,
            seconds: Times { solve: stats.seconds, since_process_start_first_snapshot: since_start.as_secs_f64() },
            bytes: stats.bytes,
            peak_rss_bytes: peak_memory(),
            emitted_watts: stats.emitted_watts,
            entered_watts: balance.map_or(stats.entering_watts, |balance| balance.entered.element_sum()),
            absorbed_watts: balance.map_or_else(|| absorbed(scene, solution), |balance| balance.absorbed.element_sum()),
            stopped_by_backs_watts: balance.map(|balance| balance.stopped_by_backs.element_sum()),
            escaped_watts: balance.map(|balance| balance.escaped.element_sum()),
            balance_gap: balance.map(|balance| balance.relative_gap()),
            depth_guard_struck: stats.depth_guard_struck,
            clamped_leaves: stats.clamped_leaves,
            lights: &scene.lights,
            skipped: &scene.skipped,
        }
    }

    /// A few lines for people.
    pub fn summary(&self) -> String {
        let times = &self.seconds.solve;
        let state = match (self.converged, self.memory_stop, self.error_asked.zip(self.error_estimate)) {
            (true, _, Some((asked, found))) if found <= asked => "target reached",
            (true, _, Some(_)) => "stopped above the target error",
            (true, _, None) if self.error_estimate.is_some() => "links settled",
            (true, _, None) => "links settled; error not measured",
            (false, Some(_), _) => "stopped",
            (false, None, _) => "not finished",
        };
        let depth = match self.clustering {
            ClusteringMode::Octree => format!(" of depth {}", self.octree_depth),
            ClusteringMode::None | ClusteringMode::Groups | ClusteringMode::Adaptive => String::new(),
        };
        let mut lines = vec![
            format!(
                "{}: {} polygons, clustering {}{depth}, ε = {} Φ = {}, {state}",
                self.scene,
                count(self.initial_patches),
                name_of(&self.clustering),
                number(self.epsilon_relative),
                quantity(self.epsilon_watts, "W"),
            ),
            format!(
                "elements   {} clusters, {} patches, {} links ({}), elements {}",
                count(self.clusters),
                count(self.patches),
                count(self.links),
                bytes(self.bytes.links),
                bytes(self.bytes.elements),
            ),
            format!(
                "work       {} links tested, {} rays, passes: {}, threads: {}",
                count(self.pairs_judged),
                count(self.rays),
                self.iterations,
                self.threads
            ),
            format!(
                "time       {} in all: clusters {}, refining {}, gathering {}, final gather {}; first picture after {}; loading took {}",
                seconds(times.total),
                seconds(times.hierarchy),
                seconds(times.refine),
                seconds(times.gather),
                seconds(times.reconstruct),
                seconds(times.first_snapshot),
                seconds(times.load),
            ),
        ];
        if let Some(stop) = self.memory_stop {
            let more = if self.error_asked.is_some() { "a larger --error" } else { "a larger --epsilon" };
            lines.insert(1, format!("stopped    {}", stopped_at(stop, self.bytes.budget, more)));
        }
        if let Some(asked) = self.error_asked {
            lines.insert(1, format!("error      {}", reached(asked, self.error.as_ref())));
            if let Some(found) = &self.error {
                lines.insert(2, format!("local      {}", quantiles(found)));
            }
        }
        let entered = match self.entered_watts {
            0.0 => String::new(),
            watts => format!("{} entered, ", quantity(watts, "W")),
        };
        let mut power = format!(
            "power      {} emitted, {entered}{} absorbed",
            quantity(self.emitted_watts, "W"),
            quantity(self.absorbed_watts, "W")
        );
        if let (Some(backs), Some(escaped), Some(gap)) =
            (self.stopped_by_backs_watts, self.escaped_watts, self.balance_gap)
        {
            let (backs, escaped) = (quantity(backs, "W"), quantity(escaped, "W"));
            // A String takes any text.
            let _ = write!(power, ", {backs} stopped by backs, {escaped} escaped; missing {:.1} %", 100.0 * gap);
        }
        lines.push(power);
        if let Some(peak) = self.peak_rss_bytes {
            let (peak, counted) = (bytes(peak as usize), bytes(self.bytes.counted));
            lines.push(format!(
                "memory     {peak} at most; {counted} counted, of a budget of {}",
                bytes(self.bytes.budget)
            ));
        }
        lines.join("\n") + "\n"
    }
}

/// Why a solve ended before it was finished, and what helps.
fn stopped_at(stop: MemoryStop, budget: usize, ask_for: &str) -> String {
    format!(
        "at the memory budget of {}: {}; give more with --memory or ask for {ask_for}",
        bytes(budget),
        stop.in_words()
    )
}

/// The target error beside what the certificate found.
fn reached(target: f64, found: Option<&ErrorFound>) -> String {
    let Some(found) = found else { return format!("target {}, not certified yet", percent(target)) };
    let only = if found.bound <= target { "" } else { "only " };
    format!(
        "target {}: 9 of 10 surfaces are read within {only}{} ({:.0} % sure); RMS of B {}",
        percent(target),
        percent(found.bound),
        100.0 * found.confidence,
        percent(found.radiosity_rms),
    )
}

/// Quantiles over the area of the local error, of readings and of the bare mesh.
fn quantiles(found: &ErrorFound) -> String {
    let of = |of: &Quantiles| format!("p50 {}, p90 {}, p95 {}", percent(of.p50), percent(of.p90), percent(of.p95));
    format!("readings: {}; bare mesh: {}", of(&found.read), of(&found.mesh))
}

/// Power absorbed by bright sides in what is there to be seen, W (all colours summed): a solution
/// that is not finished has it in its picture alone.
fn absorbed(scene: &Scene, solution: &Solution) -> f64 {
    let snapshot = &solution.snapshot;
    let leaves = snapshot.mesh.leaves.iter().zip(&snapshot.leaf_irradiance);
    let power = leaves.map(|(leaf, irradiance)| {
        let reflectance = scene.surface(&scene.polygons[leaf.polygon as usize]).reflectance.to_array();
        let absorbed = irradiance.iter().zip(reflectance).map(|(received, rho)| f64::from(received * (1.0 - rho)));
        f64::from(leaf.reachable_area) * absorbed.sum::<f64>()
    });
    power.sum()
}

/// Highest resident memory of this process, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib << 10)
}
