//! The timeline below the view: every step of the solve, from the single self-link to the present,
//! to scrub through and to play.

use egui::{Align, Layout, Rect, Response, Sense, Ui, pos2, vec2};

use crate::app::state::playback::Playback;
use crate::app::widgets::theme;
use crate::app::{Shown, format, words};
use crate::solve::{TimelineStep, TimelineStepKind};

/// Height of the bar, points.
const HEIGHT: f32 = 30.0;
/// Room for the words at the right, points.
const WORDS: f32 = 318.0;
/// Share of a narrow bar that they get at most.
const SHARE_OF_WORDS: f32 = 0.6;
/// Half the height of a tick, points, by what ended with it.
const TICKS: [(TimelineStepKind, f32); 4] = [
    (TimelineStepKind::Start, 6.0),
    (TimelineStepKind::Wave, 3.0),
    (TimelineStepKind::Round, 6.0),
    (TimelineStepKind::Pass, 6.0),
];

/// Draws it along the lower edge of the view; nothing before there is a step to be seen.
pub fn show(ui: &mut Ui, shown: &Shown, playback: &mut Playback) {
    let steps = shown.status.steps.clone();
    if steps.len() < 2 || shown.snapshot.is_none() {
        return;
    }
    let now = ui.input(|input| input.time);
    if let Some(wait) = playback.play(now, shown.snapshot.as_deref(), steps.len()) {
        ui.ctx().request_repaint_after(wait);
    }
    egui::Panel::bottom("timeline").exact_size(HEIGHT).show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            let (label, hint) = match playback.is_playing() {
                true => ("Stop", "Stop playing"),
                false => (words::PLAY, "Play the refinement from the root's self-link, step by step"),
            };
            let play = ui.button(label).on_hover_text(hint);
            if play.clicked() {
                playback.play_or_stop(now);
            }
            let is_live = playback.step.is_none();
            if ui.selectable_label(is_live, words::LATEST).on_hover_text("Jump to latest").clicked() {
                playback.show(None);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                // Of the picture that is there, while that of a chosen step is still being made.
                let in_view = shown.snapshot.as_ref().and_then(|snapshot| snapshot.former_step);
                let at = in_view.unwrap_or(steps.len() - 1).min(steps.len() - 1);
                let words = WORDS.min(SHARE_OF_WORDS * ui.available_width());
                ui.allocate_ui_with_layout(vec2(words, 20.0), Layout::left_to_right(Align::Center), |ui| {
                    ui.set_width(words);
                    ui.add(egui::Label::new(theme::value(in_words(&steps, at))).truncate());
                });
                if let Some(step) = track(ui, &steps, playback.step) {
                    playback.show(step);
                }
            });
        });
    });
}

/// Description of a step: its number, its kind, and the counts after it.
fn in_words(steps: &[TimelineStep], at: usize) -> String {
    let info = &steps[at];
    let kind = match info.kind {
        TimelineStepKind::Start => "self-link".to_owned(),
        TimelineStepKind::Wave => format!("wave {}", info.stats.wave),
        TimelineStepKind::Round => format!("iteration {}", info.stats.iterations),
        TimelineStepKind::Pass => "final gather".to_owned(),
    };
    let links = info.stats.all_links();
    format!("{}/{} {kind} · {}", at + 1, steps.len(), format::things(links, "link", "links"))
}

/// The ticks, with the present one marked; a click or drag chooses another: the last one is the
/// present.
fn track(ui: &mut Ui, steps: &[TimelineStep], shown: Option<usize>) -> Option<Option<usize>> {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::click_and_drag());
    let last = steps.len() - 1;
    response.widget_info(|| {
        let at = shown.unwrap_or(last) as f64 + 1.0;
        egui::WidgetInfo::slider(true, at, words::STEP_OF_THE_SOLVE)
    });
    let inner = rect.shrink2(vec2(8.0, 0.0));
    let x = |step: usize| inner.left() + inner.width() * step as f32 / last as f32;
    let painter = ui.painter_at(rect);
    let middle = inner.center().y;
    painter.hline(inner.x_range(), middle, (1.0, theme::TEXT_WEAK));
    for (step, info) in steps.iter().enumerate() {
        let half = TICKS.iter().find(|(kind, _)| *kind == info.kind).map_or(3.0, |(_, half)| *half);
        painter.vline(x(step), middle - half..=middle + half, (1.0, theme::TEXT_WEAK));
    }
    let at = pos2(x(shown.unwrap_or(last)), middle);
    painter.circle_filled(at, 5.5, if shown.is_some() { theme::ACCENT } else { theme::DONE });
    let response = response.on_hover_text_at_pointer(match hovered(ui, inner, last) {
        Some(step) => described(&steps[step]),
        None => "Every step of the solve: drag to see an earlier one".to_owned(),
    });
    chosen(ui, &response, inner, last, shown)
}

fn hovered(ui: &Ui, inner: Rect, last: usize) -> Option<usize> {
    let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|at| inner.expand(8.0).contains(*at))?;
    let along = ((pointer.x - inner.left()) / inner.width()).clamp(0.0, 1.0);
    Some((along * last as f32).round() as usize)
}

fn chosen(ui: &Ui, response: &Response, inner: Rect, last: usize, shown: Option<usize>) -> Option<Option<usize>> {
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    // Arrows step, and do not carry the focus to another widget.
    let arrows = egui::EventFilter { horizontal_arrows: true, ..egui::EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let by_key = response.has_focus().then(|| {
        ui.input_mut(|input| {
            // Several presses may come in one frame.
            let mut presses = |key| input.count_and_consume_key(egui::Modifiers::NONE, key) as i64;
            presses(egui::Key::ArrowRight) - presses(egui::Key::ArrowLeft)
        })
    });
    let step = match by_key.filter(|step| *step != 0) {
        Some(step) => (shown.unwrap_or(last) as i64 + step).clamp(0, last as i64) as usize,
        None => {
            // A short click is over within a frame, in which no button is down any longer.
            let is_pressed = response.is_pointer_button_down_on() || response.clicked();
            let at = response.interact_pointer_pos().filter(|_| is_pressed)?;
            let along = ((at.x - inner.left()) / inner.width()).clamp(0.0, 1.0);
            (along * last as f32).round() as usize
        }
    };
    Some((step < last).then_some(step))
}

fn described(info: &TimelineStep) -> String {
    let kind = match info.kind {
        TimelineStepKind::Start => "The root's self-link, with which everything starts".to_owned(),
        TimelineStepKind::Wave => format!("Wave {} of refinement, pass {}", info.stats.wave, info.stats.iterations + 1),
        TimelineStepKind::Round => {
            format!("End of iteration {}: light was gathered to convergence", info.stats.iterations)
        }
        TimelineStepKind::Pass => "A pass of the final gather".to_owned(),
    };
    let stats = &info.stats;
    let waiting = match stats.candidates_left {
        0 => String::new(),
        waiting => format!(" ({} to test)", format::count(waiting as u64)),
    };
    format!(
        "{kind}\n{}{waiting}, {}, {} rays, after {}",
        format::things(stats.all_links(), "link", "links"),
        format::things(stats.patches, "patch", "patches"),
        format::count(stats.rays),
        format::seconds(stats.seconds.total)
    )
}
