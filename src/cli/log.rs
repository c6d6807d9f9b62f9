//! `--log LEVEL`: what the program is about, as lines on stderr.

use std::str::FromStr as _;

use anyhow::anyhow;
use clap::{Arg, ArgMatches};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::fmt::time;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Name of the option.
pub const LOG: &str = "log";
/// The variable that counts where the option is not given.
const VARIABLE: &str = "RUST_LOG";
/// Events of this program; a bare level speaks of them alone.
const OURS: &str = env!("CARGO_PKG_NAME");

/// The option, of all commands.
pub fn arg() -> Arg {
    Arg::new(LOG)
        .long(LOG)
        .global(true)
        .value_name("LEVEL")
        .value_parser(|text: &str| filter(text).map(|_| text.to_owned()))
        .help(
            "Log to stderr: error, warn, info or debug; or a filter by module, such as selflink::solve=debug,wgpu_core=warn [default: as RUST_LOG says, else off]",
        )
}

/// Starts logging where the option or the variable asks for it.
///
/// # Errors
/// The variable holds no level and no filter.
pub fn start(matches: &ArgMatches) -> anyhow::Result<()> {
    let filter = match matches.get_one::<String>(LOG) {
        Some(text) => filter(text),
        None => match std::env::var(VARIABLE) {
            Ok(text) if !text.is_empty() => filter(&text),
            _ => return Ok(()),
        },
    };
    let filter = filter.map_err(|reason| anyhow!("{VARIABLE} cannot be used: {reason}"))?;
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .with_thread_names(true)
        .with_timer(time::uptime());
    tracing_subscriber::registry().with(lines).with(filter).try_init()?;
    Ok(())
}

fn filter(text: &str) -> Result<Targets, String> {
    // An empty text is a level to the library.
    let level_of = |word: &str| LevelFilter::from_str(word).ok().filter(|_| !word.is_empty());
    if let Some(level) = level_of(text) {
        return Ok(Targets::new().with_target(OURS, level));
    }
    let advice = "it must be error, warn, info or debug, or a filter such as selflink::solve=debug";
    // A word that is no level would be the name of a module.
    let has_levels = text.split(',').all(|part| part.contains('=') || level_of(part.trim()).is_some());
    text.parse().ok().filter(|_| has_levels).ok_or_else(|| advice.to_owned())
}

#[cfg(test)]
mod tests {
    use tracing::Level;

    use super::*;

    /// Truth: a level speaks of this program's events, a filter of the modules it names.
    #[test]
    fn levels_and_filters() {
        let info = filter("info").expect("a level");
        assert!(info.would_enable("selflink::solve", &Level::INFO) && !info.would_enable("wgpu_core", &Level::ERROR));
        assert!(!info.would_enable("selflink::solve", &Level::DEBUG));
        let both = filter("warn,selflink::gather=debug").expect("a filter");
        assert!(both.would_enable("selflink::gather", &Level::DEBUG) && both.would_enable("wgpu_core", &Level::WARN));
        assert!(!both.would_enable("selflink::solve", &Level::INFO));
        for text in ["", "loud", "selflink=loud", "loud,info"] {
            assert!(filter(text).is_err(), "{text}");
        }
    }
}
