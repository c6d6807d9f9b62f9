//! Options that read a quantity off the surfaces of a picture: false colours, their range, isolux
//! lines.

use anyhow::bail;
use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgMatches, Command};
use selflink::base::photometry::{CONVENTION, Unit};
use selflink::render::{IsolinesWanted, MOST_ISOLINES, Ramp, ReadingSettings, Show, Spacing};

use super::clusters::PREFIX;
use super::options::{flag_arg, numbers, value_arg};

/// Adds the options to a command.
pub fn with_options(command: Command) -> Command {
    let choice = |name: &'static str, values: &'static [&'static str], help: String| {
        Arg::new(name)
            .long(name)
            .value_name("MODE")
            .value_parser(PossibleValuesParser::new(values))
            .default_value(values[0])
            .help(help)
    };
    let options = [
        value_arg("show", "lit|irradiance|radiosity|daylight-factor|clusters:LEVEL")
            .default_value("lit")
            .help("The light, false colours of irradiance E, of radiosity B or of the daylight factor (E over that of open ground, in %, where a sky shines and neither sun nor lamps do), or a colour for each cluster of a level (0 is the root)"),
        choice("scale", &["linear", "log"], "How false colours follow values".into()),
        choice("ramp", &["viridis", "cividis"], "False colours; both can be read by the colour-blind".into()),
        value_arg("range", "A:B")
            .allow_hyphen_values(true)
            .help("Values at the ends of the false colours [default: round numbers around 97 % of the area]"),
        value_arg("isolux", "V,V,…")
            .num_args(0..=1)
            .default_missing_value("")
            .help(format!("Draw lines of equal value, {MOST_ISOLINES} at most [default: at round values]; over the lit picture, those of E")),
        flag_arg("no-legend").help("Leave the legend out of the picture"),
    ];
    let command = command.args(options.map(|option| option.help_heading("Readings")));
    // The scene's own unit has the same name; each is known by its values.
    let of_length = super::options::unit_arg();
    let units = ["lux", "watts"].into_iter().chain(selflink::scene::Unit::ALL.map(selflink::scene::Unit::symbol));
    let unit = of_length.value_parser(PossibleValuesParser::new(units)).value_name("lux|watts|m|cm|mm|in|ft");
    let unit = unit.help(format!("Unit of false colours, --range and --isolux: lx (lm/m² of B), or W/m² [default: lux]; daylight factors are in %. {CONVENTION} Also the unit of the file's lengths [default: as the file says, or guessed by the size of a room]. May be given once for each"));
    if command.get_arguments().any(|arg| arg.get_id() == "unit") {
        command.mut_arg("unit", move |_| unit)
    } else {
        command.arg(unit)
    }
}

/// The reading that the arguments ask for.
pub fn settings(matches: &ArgMatches) -> anyhow::Result<ReadingSettings> {
    let text = |name: &str| matches.get_one::<String>(name).map(String::as_str);
    let mut units = matches.get_many::<String>("unit").into_iter().flatten();
    let unit = if units.any(|unit| unit == "watts") { Unit::Watts } else { Unit::Lumens };
    let spacing = if text("scale") == Some("log") { Spacing::Logarithmic } else { Spacing::Linear };
    let show = match text("show") {
        Some("irradiance") => Show::Irradiance,
        Some("radiosity") => Show::Radiosity,
        Some("daylight-factor") => Show::DaylightFactor,
        None | Some("lit") => Show::Lit,
        // Colours of clusters stand in place of the light.
        Some(text) if text.starts_with(PREFIX) => Show::Lit,
        Some(text) => {
            bail!("--show must be lit, irradiance, radiosity, daylight-factor or clusters:LEVEL (it is `{text}`)")
        }
    };
    let ramp = if text("ramp") == Some("cividis") { Ramp::Cividis } else { Ramp::Viridis };
    let read_in = ReadingSettings { show, unit, spacing, ramp, ..ReadingSettings::default() };
    let (factor, _) = read_in.factor_and_sign();
    let range = text("range").map(|text| range(text, spacing, factor)).transpose()?;
    let isolines = text("isolux").map_or(Ok(IsolinesWanted::None), |text| isolines(text, factor))?;
    Ok(ReadingSettings { range, isolines, ..read_in })
}

fn range(text: &str, spacing: Spacing, factor: f32) -> anyhow::Result<[f32; 2]> {
    match numbers::<2>(text, ':') {
        Some([low, high]) if low < high && low >= 0.0 && (low > 0.0 || spacing == Spacing::Linear) => {
            Ok([low, high].map(|value| value / factor))
        }
        Some([low, high]) if low < high && low >= 0.0 => {
            bail!("--range must start above 0 where --scale is log (it is `{text}`)")
        }
        _ => bail!("--range must be LOW:HIGH, two numbers from 0 with the lower one first (it is `{text}`)"),
    }
}

fn isolines(text: &str, factor: f32) -> anyhow::Result<IsolinesWanted> {
    if text.is_empty() {
        return Ok(IsolinesWanted::Round);
    }
    let values: Vec<f32> = text.split(',').filter_map(|part| numbers::<1>(part, ',')).map(|[value]| value).collect();
    let is_good = values.len() == text.split(',').count() && values.len() <= MOST_ISOLINES;
    if !is_good || values.iter().any(|value| *value <= 0.0) {
        bail!("--isolux must be 1 to {MOST_ISOLINES} numbers above 0, such as 100,200,500 (it is `{text}`)");
    }
    Ok(IsolinesWanted::At(values.into_iter().map(|value| value / factor).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(args: &[&str]) -> anyhow::Result<ReadingSettings> {
        let matches = with_options(Command::new("test")).try_get_matches_from([&["test"], args].concat())?;
        settings(&matches)
    }

    #[test]
    fn each_option_sets_its_field() {
        assert_eq!(parsed(&[]).expect("defaults"), ReadingSettings::default());
        let set = parsed(&[
            "--show",
            "radiosity",
            "--unit",
            "watts",
            "--scale",
            "log",
            "--ramp",
            "cividis",
            "--range",
            "0.1:10",
            "--isolux",
            "2,1",
        ]);
        let expected = ReadingSettings {
            show: Show::Radiosity,
            unit: Unit::Watts,
            spacing: Spacing::Logarithmic,
            ramp: Ramp::Cividis,
            range: Some([0.1, 10.0]),
            isolines: IsolinesWanted::At(vec![2.0, 1.0]),
        };
        assert_eq!(set.expect("good options"), expected);
        // Lux are 179 to the watt.
        assert_eq!(parsed(&["--range", "0:358"]).expect("good").range, Some([0.0, 2.0]));
        // A daylight factor of 5 % is a twentieth of the light outside.
        let factor = parsed(&["--show", "daylight-factor", "--range", "0:5", "--isolux", "2"]).expect("good");
        assert_eq!((factor.range, factor.isolines), (Some([0.0, 0.05]), IsolinesWanted::At(vec![0.02])));
        assert_eq!(parsed(&["--isolux"]).expect("good").isolines, IsolinesWanted::Round);
    }

    #[test]
    fn bad_ranges_and_lines_are_refused() {
        for args in [
            &["--range", "5"][..],
            &["--range", "5:1"],
            &["--range", "-1:1"],
            &["--range", "0:1", "--scale", "log"],
            &["--range", "a:b"],
            &["--isolux", "0"],
            &["--isolux", "1,x"],
            &["--isolux", "1,2,3,4,5,6,7,8,9"],
        ] {
            assert!(parsed(args).is_err(), "{args:?}");
        }
    }
}
