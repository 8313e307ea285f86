//! How the window looks: dark, calm, tight.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Visuals, vec2};

/// What is chosen, and what moves.
pub const ACCENT: Color32 = Color32::from_rgb(0x5a, 0xa9, 0xff);
/// What went wrong.
pub const ERROR: Color32 = Color32::from_rgb(0xff, 0x8a, 0x7a);
/// What is done.
pub const DONE: Color32 = Color32::from_rgb(0x7f, 0xd6, 0x9a);
/// Behind the picture.
pub const BACKDROP: Color32 = Color32::from_rgb(0x10, 0x12, 0x16);
/// Panels.
pub const PANEL: Color32 = Color32::from_rgb(0x1b, 0x1e, 0x24);
/// Lines between parts.
pub const LINE: Color32 = Color32::from_rgb(0x2c, 0x31, 0x3a);
/// Names and units.
pub const QUIET: Color32 = Color32::from_rgb(0x98, 0xa2, 0xb0);
/// Text.
pub const TEXT: Color32 = Color32::from_rgb(0xd7, 0xdc, 0xe3);

/// Sets the style of everything.
pub fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let font = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Heading, font(15.0)),
            (TextStyle::Body, font(13.0)),
            (TextStyle::Button, font(13.0)),
            (TextStyle::Small, font(11.0)),
            (
                TextStyle::Monospace,
                FontId::new(12.0, FontFamily::Monospace),
            ),
        ]
        .into();
        style.visuals = visuals();
        style.spacing.item_spacing = vec2(6.0, 4.0);
        style.spacing.button_padding = vec2(7.0, 2.0);
        style.spacing.interact_size = vec2(28.0, 20.0);
        style.spacing.indent = 12.0;
        style.spacing.slider_width = 120.0;
        style.spacing.combo_width = 90.0;
        style.spacing.window_margin = Margin::same(14);
        style.spacing.icon_width = 13.0;
        style.spacing.icon_width_inner = 8.0;
        style.spacing.scroll = egui::style::ScrollStyle::thin();
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.4;
        style.animation_time = 0.08;
        style.number_formatter = egui::style::NumberFormatter::new(|value, decimals| {
            super::format::group(&egui::emath::format_with_decimals_in_range(value, decimals))
        });
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.override_text_color = None;
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(0x20, 0x24, 0x2b);
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = Color32::from_rgb(0x12, 0x15, 0x1a);
    visuals.faint_bg_color = Color32::from_rgb(0x20, 0x24, 0x2b);
    visuals.weak_text_color = Some(QUIET);
    visuals.hyperlink_color = ACCENT;
    visuals.error_fg_color = ERROR;
    visuals.selection.bg_fill = Color32::from_rgb(0x24, 0x4e, 0x82);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(0xe6, 0xf1, 0xff));
    visuals.slider_trailing_fill = true;
    visuals.indent_has_left_vline = false;
    visuals.button_frame = true;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, PANEL, TEXT),
        (
            &mut widgets.inactive,
            Color32::from_rgb(0x2a, 0x2f, 0x38),
            TEXT,
        ),
        (
            &mut widgets.hovered,
            Color32::from_rgb(0x36, 0x3d, 0x48),
            Color32::WHITE,
        ),
        (
            &mut widgets.active,
            Color32::from_rgb(0x41, 0x4a, 0x58),
            Color32::WHITE,
        ),
        (
            &mut widgets.open,
            Color32::from_rgb(0x30, 0x36, 0x40),
            Color32::WHITE,
        ),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.bg_stroke = Stroke::NONE;
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    widgets.hovered.bg_stroke = Stroke::new(1.0, Color32::from_rgb(0x4a, 0x54, 0x62));
    visuals
}
