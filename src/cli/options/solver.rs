//! Options of the solver's parameters, made from [`PARAMETERS`], and their reading.

use anyhow::bail;
use clap::builder::PossibleValue;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches};
use selflink::base::memory::MemoryBudget;
use selflink::solve::{PARAMETERS, Parameter, ParameterId, SolverParams, USUAL_ERROR, ValueKind};

use super::{has, number, whole};

/// More threads than any machine has cores for.
const MOST_THREADS: u32 = 1024;

/// One argument for each of the solver's parameters: help, unit and default from the one place that
/// states them.
pub fn solver_args() -> impl Iterator<Item = Arg> {
    solver_args_where(|_| true).chain([former_arg()])
}

/// An option that is gone; older command lines may name it.
const FORMER_CRITERION: &str = "refine-by";

/// The argument that is read and reported, though it changes nothing.
pub fn former_arg() -> Arg {
    Arg::new(FORMER_CRITERION).long(FORMER_CRITERION).alias("oracle").hide(true)
}

/// The arguments of some of the solver's parameters.
pub fn solver_args_where(wanted: impl Fn(ParameterId) -> bool) -> impl Iterator<Item = Arg> {
    PARAMETERS.iter().filter(move |parameter| wanted(parameter.id)).map(solver_arg)
}

fn solver_arg(parameter: &'static Parameter) -> Arg {
    let default = default_text(parameter);
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" Unit: {}.", parameter.unit) };
    let arg = Arg::new(parameter.flag)
        .long(parameter.flag)
        .help(format!("{}{unit} [default: {default}]", parameter.hint))
        // A negative number is refused with its reason, not taken for an option.
        .allow_hyphen_values(true)
        .help_heading("Solver");
    match &parameter.kind {
        ValueKind::Real { .. } if parameter.id == ParameterId::Memory => {
            arg.value_name("SIZE").value_parser(|text: &str| text.parse::<MemoryBudget>())
        }
        ValueKind::Real { .. } => arg.value_name("NUMBER").value_parser(number),
        ValueKind::Whole { .. } if parameter.id == ParameterId::Seed => arg.value_name("N").value_parser(whole::<u64>),
        ValueKind::Whole { .. } => arg.value_name("N").value_parser(whole::<u32>),
        ValueKind::Choice { names } => {
            let value = |(name, shown): &(&'static str, &'static str)| match name == shown {
                true => PossibleValue::new(*name),
                // Files and older command lines say it so.
                false => PossibleValue::new(*shown).alias(*name),
            };
            let values: Vec<PossibleValue> = names.iter().map(value).collect();
            let arg = arg.value_name("MODE").value_parser(clap::builder::PossibleValuesParser::new(values));
            if parameter.id == ParameterId::Reconstruct { arg.visible_alias("shading") } else { arg }
        }
    }
}

/// A parameter's default as a person would write it.
fn default_text(parameter: &Parameter) -> String {
    let params = SolverParams::default();
    let scientific = |value: f64| format!("{value:e}");
    match parameter.id {
        ParameterId::Error => format!("{USUAL_ERROR}, unless --epsilon or --reconstruct is given"),
        id @ ParameterId::Epsilon => params.real(id).map_or("as --epsilon-watts says".to_owned(), scientific),
        id @ ParameterId::EpsilonWatts => params.real(id).map_or("as --epsilon says".to_owned(), scientific),
        ParameterId::Threads => format!("{}, every core", params.threads),
        ParameterId::Memory => params.memory.to_string(),
        id => {
            let number = || params.real(id).map(|value| value.to_string());
            let whole = || params.whole(id).map(|value| value.to_string());
            let chosen = || params.choice(id).and_then(|name| parameter.shown(&name)).map(str::to_owned);
            number().or_else(whole).or_else(chosen).unwrap_or("as the scene says".to_owned())
        }
    }
}

/// The parameters that the arguments ask for, checked.
pub fn solver_params(matches: &ArgMatches) -> anyhow::Result<SolverParams> {
    solver_params_over(None, matches)
}

/// Parameters of the arguments, completed by a file of settings, checked.
pub fn solver_params_over(filed: Option<SolverParams>, matches: &ArgMatches) -> anyhow::Result<SolverParams> {
    let given = |flag| has(matches, flag) && matches.value_source(flag) == Some(ValueSource::CommandLine);
    let by_threshold = ["epsilon", "epsilon-watts", "reconstruct"].into_iter().find(|flag| given(flag));
    if let Some(flag) = by_threshold.filter(|_| given("error")) {
        bail!("--error chooses what --{flag} would say: give one of them");
    }
    let knows_error = matches.try_contains_id("error").is_ok();
    if has(matches, FORMER_CRITERION) {
        eprintln!("warning: --{FORMER_CRITERION} is gone, links are refined by their power: leave it out.");
    }
    let mut params = match filed {
        Some(filed) if by_threshold.is_none() => filed,
        Some(filed) => SolverParams { error: None, ..filed },
        None if by_threshold.is_none() && knows_error => SolverParams::usual(),
        None => SolverParams::default(),
    };
    for parameter in &PARAMETERS {
        set(&mut params, parameter, matches);
    }
    if given("epsilon") && given("epsilon-watts") {
        bail!("--epsilon and --epsilon-watts state the same threshold: give one of them");
    }
    if params.threads > MOST_THREADS {
        bail!("--threads must be at most {MOST_THREADS} (it is {}); 0 takes every core", params.threads);
    }
    params.validate()?;
    Ok(params)
}

fn set(params: &mut SolverParams, parameter: &Parameter, matches: &ArgMatches) {
    let flag = parameter.flag;
    if !has(matches, flag) {
        return;
    }
    match (&parameter.kind, parameter.id) {
        (_, ParameterId::Memory) => params.memory = matches.get_one(flag).copied().unwrap_or(params.memory),
        (_, ParameterId::Seed) => params.seed = matches.get_one::<u64>(flag).copied().unwrap_or(params.seed),
        (ValueKind::Real { .. }, id) => {
            if let Some(value) = matches.get_one::<f64>(flag) {
                params.set_real(id, *value);
            }
        }
        (ValueKind::Whole { .. }, id) => {
            if let Some(value) = matches.get_one::<u32>(flag) {
                params.set_whole(id, (*value).into());
            }
        }
        (ValueKind::Choice { .. }, id) => {
            params.choose(id, matches.get_one::<String>(flag).and_then(|name| parameter.in_files(name)));
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Command;
    use selflink::scene::Sides;
    use selflink::solve::{ClusteringMode, Epsilon, Reconstruct};
    use selflink::transport::{ClusterModel, Push};

    use super::super::solving;
    use super::*;

    fn params(args: &[&str]) -> anyhow::Result<SolverParams> {
        let command = solving(Command::new("test"));
        solver_params(&command.try_get_matches_from([&["test", "office"], args].concat())?)
    }

    #[test]
    fn no_option_gives_the_defaults() {
        assert_eq!(params(&[]).expect("no options"), SolverParams::usual());
        // Whoever speaks of ε, or of how light is shown, asks for no error.
        assert_eq!(params(&["--epsilon", "1e-4"]).expect("ε"), SolverParams::default());
        assert_eq!(params(&["--reconstruct", "vertex"]).expect("vertices"), SolverParams::default());
    }

    /// Truth: each option sets the one field of its name.
    #[test]
    fn each_option_sets_its_field() {
        let (defaults, by_threshold) = (SolverParams::usual(), SolverParams::default());
        let constant = SolverParams { reconstruct: Reconstruct::Constant, ..by_threshold };
        let cases: [(&[&str], SolverParams); 20] = [
            (&["--error", "0.1"], SolverParams { error: Some(0.1), ..defaults }),
            (&["--reconstruct", "constant"], constant),
            (&["--reconstruct", "flat"], constant),
            (&["--epsilon", "0.01"], SolverParams { epsilon: Epsilon::Relative(0.01), ..by_threshold }),
            (&["--epsilon-watts", "3"], SolverParams { epsilon: Epsilon::Watts(3.0), ..by_threshold }),
            // Of older command lines; reported.
            (&["--oracle", "error"], defaults),
            (&["--refine-by", "link-error"], defaults),
            (&["--shading", "flat"], SolverParams { reconstruct: Reconstruct::Constant, error: None, ..defaults }),
            (&["--partial-factor", "0.5"], SolverParams { partial_factor: 0.5, ..defaults }),
            (&["--visibility-factor", "2"], SolverParams { visibility_factor: 2.0, ..defaults }),
            (&["--rays-min", "2"], SolverParams { rays_min: 2, ..defaults }),
            (&["--rays-max", "99"], SolverParams { rays_max: 99, ..defaults }),
            (&["--clustering", "octree"], SolverParams { clustering: ClusteringMode::Octree, ..defaults }),
            (&["--octree-depth", "3"], SolverParams { octree_depth: 3, ..defaults }),
            (&["--cluster-model", "isotropic"], SolverParams { cluster_model: ClusterModel::Isotropic, ..defaults }),
            (&["--push", "deferred"], SolverParams { push: Push::Deferred, ..defaults }),
            (&["--sides", "both"], SolverParams { sides: Some(Sides::Both), ..defaults }),
            (&["--threads", "2"], SolverParams { threads: 2, ..defaults }),
            (&["--seed", "77"], SolverParams { seed: 77, ..defaults }),
            (&["--memory", "4GiB"], SolverParams { memory: MemoryBudget::Bytes(4 << 30), ..defaults }),
        ];
        for (args, expected) in cases {
            assert_eq!(params(args).expect("a good option"), expected, "{args:?}");
        }
    }

    #[test]
    fn options_that_cannot_be_used() {
        for args in [
            ["--epsilon", "0"],
            ["--epsilon", "-1"],
            ["--epsilon", "NaN"],
            ["--error", "0"],
            ["--error", "1"],
            ["--error", "NaN"],
            ["--threads", "4096"],
            ["--rays-min", "500"],
            ["--memory", "0%"],
            ["--memory", "200%"],
            ["--memory", "lots"],
        ] {
            assert!(params(&args).is_err(), "{args:?}");
        }
        assert!(params(&["--epsilon", "1e-3", "--epsilon-watts", "1"]).is_err());
        assert!(params(&["--epsilon", "1e-3", "--error", "0.1"]).is_err());
        assert!(params(&["--reconstruct", "vertex", "--error", "0.1"]).is_err());
    }
}
