//! Merging bursts of commands: of several that set the same thing, only the newest counts.

use super::Command;

/// Drops every command that a later one makes pointless; the order of the others stays.
pub(super) fn merge(commands: Vec<Command>) -> Vec<Command> {
    let mut kept: Vec<Command> = Vec::with_capacity(commands.len());
    for command in commands.into_iter().rev() {
        if !kept.iter().any(|later| supersedes(later, &command)) {
            kept.push(command);
        }
    }
    kept.reverse();
    kept
}

/// Whether `earlier` has no effect when `later` follows it.
fn supersedes(later: &Command, earlier: &Command) -> bool {
    use Command::{
        AnchorEpsilon, CancelLoad, Load, Pause, Restart, Resume, SetDaylight, SetEmission, SetGroups, SetLuminaires,
        SetParams, SetReflectance, Show, Shutdown, StepWave,
    };
    match (later, earlier) {
        (Shutdown, Command::SaveSidecar(_)) => false,
        (Shutdown, _)
        | (Load(..) | CancelLoad, Load(..) | CancelLoad)
        | (SetParams(_), SetParams(_))
        | (Show(_), Show(_))
        | (SetGroups(_), SetGroups(_))
        | (SetDaylight(_), SetDaylight(_))
        | (SetLuminaires(_), SetLuminaires(_))
        | (Restart, Restart)
        | (AnchorEpsilon, AnchorEpsilon)
        | (Pause | Resume, Pause | Resume | StepWave) => true,
        (SetEmission { material: new, .. }, SetEmission { material: old, .. })
        | (SetReflectance { material: new, .. }, SetReflectance { material: old, .. }) => new == old,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::{Kept, MaterialId};
    use crate::solve::SolverParams;

    fn params(epsilon: f64) -> Command {
        Command::SetParams(SolverParams::with_epsilon(epsilon))
    }

    fn emission(material: u32, watts: f32) -> Command {
        Command::SetEmission { material: MaterialId(material), emission: Vec3::splat(watts) }
    }

    /// A dragged slider sends a burst; the order between different kinds must survive.
    #[test]
    fn newest_settings_win_and_order_stays() {
        let burst =
            vec![params(1e-2), emission(0, 1.0), params(1e-3), emission(1, 2.0), emission(0, 3.0), params(1e-4)];
        let merged = merge(burst);
        let expected = [emission(1, 2.0), emission(0, 3.0), params(1e-4)];
        assert_eq!(format!("{merged:?}"), format!("{expected:?}"));
    }

    /// Steps are counted by a person, so each of them stays; a shutdown still lets a file be
    /// written.
    #[test]
    fn steps_add_up_and_saving_survives_a_shutdown() {
        let steps = merge(vec![Command::StepWave, Command::StepWave]);
        assert_eq!(steps.len(), 2);
        let last = merge(vec![Command::Resume, Command::SaveSidecar(Kept::default()), Command::Shutdown]);
        assert!(matches!(last[..], [Command::SaveSidecar(_), Command::Shutdown]), "{last:?}");
    }
}
