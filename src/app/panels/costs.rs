//! Cost of a change of a parameter: a sentence in its tooltip, and a mark beside it.

use egui::{Rect, Ui, pos2, vec2};

use crate::app::widgets::theme;
use crate::solve::{ChangeCost, Parameter, ValueKind};

/// Bars of the mark.
const MOST_BARS: usize = 3;

/// Room that the mark takes, points.
const WIDTH: f32 = 14.0;

/// Work that a change to a lower and to a higher value asks of the solver, in one sentence or two.
pub fn sentence(parameter: &Parameter) -> String {
    let [lower, higher] = parameter.costs.map(ChangeCost::in_words);
    match parameter.kind {
        _ if lower == higher => format!("A change {lower}."),
        ValueKind::Choice { .. } => format!("A change {lower}, or {higher}."),
        ValueKind::Real { .. } | ValueKind::Whole { .. } => format!("Lower {lower}; higher {higher}."),
    }
}

/// How many bars a cost has: light is gathered again at most, links are judged again, all begins
/// anew.
fn bars(cost: ChangeCost) -> usize {
    match cost {
        ChangeCost::Nothing | ChangeCost::Picture | ChangeCost::Radiosities => 1,
        ChangeCost::Verdicts | ChangeCost::Refinement => 2,
        ChangeCost::Links | ChangeCost::Hierarchy | ChangeCost::Scene => 3,
    }
}

/// Draws a mark at the right end of the parameter's row: the more bars, the more work.
pub fn show_mark(ui: &Ui, row: Rect, parameter: &Parameter) {
    let lit = parameter.costs.map(bars).into_iter().max().unwrap_or(0);
    let right = ui.max_rect().right() - 1.0;
    if right - WIDTH < row.right() {
        // Somebody made the panel narrow.
        return;
    }
    for bar in 0..MOST_BARS {
        let height = 4.0 + 3.0 * bar as f32;
        let left = right - 4.0 * (MOST_BARS - bar) as f32;
        let rect = Rect::from_min_size(pos2(left, row.center().y + 5.0 - height), vec2(2.5, height));
        let colour = if bar < lit { theme::TEXT_WEAK } else { theme::WELL };
        ui.painter().rect_filled(rect, 0.5, colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::PARAMETERS;

    /// Truth: the parameter's row of costs, which a test of the solver holds to what it does.
    #[test]
    fn tooltips_say_what_the_solver_will_do() {
        for parameter in &PARAMETERS {
            let sentence = sentence(parameter);
            for cost in ChangeCost::ALL {
                let is_said = sentence.contains(cost.in_words());
                assert_eq!(is_said, parameter.costs.contains(&cost), "{}: {sentence}", parameter.flag);
            }
        }
        assert!(bars(ChangeCost::Radiosities) < bars(ChangeCost::Refinement));
        assert!(ChangeCost::ALL.map(bars).is_sorted());
    }
}
