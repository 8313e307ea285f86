//! The window's theme, dark or light, with one accent colour for what is active or differs.

use super::icons;
use crate::state::preferences::Theme;
use egui::{
    Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Ui, Visuals, vec2,
};

/// Behind the picture, the same in both themes: colours are judged against their surroundings.
pub const BACKDROP: Color32 = Color32::from_rgb(0x10, 0x12, 0x16);

/// The colours of a theme.
#[derive(Debug)]
pub struct Colors {
    /// The accent.
    pub accent: Color32,
    /// The background of selected widgets.
    pub chosen: Color32,
    /// Text on that background.
    pub on_chosen: Color32,
    /// Errors.
    pub error: Color32,
    /// Completed work.
    pub done: Color32,
    /// Panels.
    pub panel: Color32,
    /// Menus, cards and the help.
    pub card: Color32,
    /// Text fields.
    pub field: Color32,
    /// Separators.
    pub line: Color32,
    /// Labels and units.
    pub quiet: Color32,
    /// Text.
    pub text: Color32,
    /// Emphasised text.
    pub strong: Color32,
    /// Buttons: at rest, hovered, pressed.
    pub buttons: [Color32; 3],
}

const DARK: Colors = Colors {
    accent: Color32::from_rgb(0x5a, 0xa9, 0xff),
    chosen: Color32::from_rgb(0x24, 0x4e, 0x82),
    on_chosen: Color32::from_rgb(0xe6, 0xf1, 0xff),
    error: Color32::from_rgb(0xff, 0x8a, 0x7a),
    done: Color32::from_rgb(0x7f, 0xd6, 0x9a),
    panel: Color32::from_rgb(0x1b, 0x1e, 0x24),
    card: Color32::from_rgb(0x20, 0x24, 0x2b),
    field: Color32::from_rgb(0x12, 0x15, 0x1a),
    line: Color32::from_rgb(0x2c, 0x31, 0x3a),
    quiet: Color32::from_rgb(0x98, 0xa2, 0xb0),
    text: Color32::from_rgb(0xd7, 0xdc, 0xe3),
    strong: Color32::WHITE,
    buttons: [
        Color32::from_rgb(0x2a, 0x2f, 0x38),
        Color32::from_rgb(0x36, 0x3d, 0x48),
        Color32::from_rgb(0x41, 0x4a, 0x58),
    ],
};

const LIGHT: Colors = Colors {
    accent: Color32::from_rgb(0x12, 0x63, 0xc6),
    chosen: Color32::from_rgb(0xbf, 0xd9, 0xf8),
    on_chosen: Color32::from_rgb(0x08, 0x2a, 0x55),
    error: Color32::from_rgb(0xb3, 0x26, 0x1a),
    done: Color32::from_rgb(0x1b, 0x75, 0x3c),
    panel: Color32::from_rgb(0xf3, 0xf4, 0xf6),
    card: Color32::from_rgb(0xfc, 0xfc, 0xfd),
    field: Color32::WHITE,
    line: Color32::from_rgb(0xd2, 0xd6, 0xdc),
    quiet: Color32::from_rgb(0x5a, 0x63, 0x70),
    text: Color32::from_rgb(0x22, 0x27, 0x2e),
    strong: Color32::BLACK,
    buttons: [
        Color32::from_rgb(0xe2, 0xe5, 0xe9),
        Color32::from_rgb(0xd5, 0xda, 0xe0),
        Color32::from_rgb(0xc6, 0xcd, 0xd6),
    ],
};

/// The colours for these visuals.
pub fn of(visuals: &Visuals) -> &'static Colors {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// The colours for this part of the window.
pub fn colors(ui: &Ui) -> &'static Colors {
    of(ui.visuals())
}

/// Applies the preferred theme and scale.
pub fn prefer(context: &egui::Context, theme: Theme, scale: f32) {
    let theme = match theme {
        Theme::System => egui::ThemePreference::System,
        Theme::Dark => egui::ThemePreference::Dark,
        Theme::Light => egui::ThemePreference::Light,
    };
    if context.options(|options| options.theme_preference) != theme {
        context.set_theme(theme);
    }
    if context.zoom_factor() != scale {
        context.set_zoom_factor(scale);
    }
}

/// Sets the style of both themes.
pub fn apply(context: &egui::Context) {
    // The registry's keys for zooming would collide with egui's.
    context.options_mut(|options| options.zoom_with_keyboard = false);
    icons::install(context);
    for (theme, colors) in [(egui::Theme::Dark, &DARK), (egui::Theme::Light, &LIGHT)] {
        context.style_mut_of(theme, |style| style.visuals = visuals(theme, colors));
    }
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
        style.spacing.item_spacing = vec2(6.0, 4.0);
        style.spacing.button_padding = vec2(7.0, 2.0);
        style.spacing.interact_size = vec2(28.0, 20.0);
        style.spacing.indent = 12.0;
        style.spacing.slider_width = 120.0;
        style.spacing.combo_width = 90.0;
        style.spacing.window_margin = Margin::same(14);
        style.spacing.icon_width = 13.0;
        style.spacing.icon_width_inner = 8.0;
        // As wide as its place: a bar under the pointer covers nothing. In the color of text, to be seen on both themes.
        style.spacing.scroll = egui::style::ScrollStyle {
            bar_width: 8.0,
            floating_allocated_width: 8.0,
            foreground_color: true,
            dormant_handle_opacity: 0.4,
            active_handle_opacity: 0.4,
            interact_handle_opacity: 0.6,
            ..egui::style::ScrollStyle::thin()
        };
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.4;
        style.animation_time = 0.08;
        style.number_formatter = egui::style::NumberFormatter::new(|value, decimals| {
            super::format::group(&egui::emath::format_with_decimals_in_range(value, decimals))
        });
    });
}

fn visuals(theme: egui::Theme, colors: &Colors) -> Visuals {
    let mut visuals = theme.default_visuals();
    visuals.override_text_color = None;
    visuals.panel_fill = colors.panel;
    visuals.window_fill = colors.card;
    visuals.window_stroke = Stroke::new(1.0, colors.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = colors.field;
    visuals.faint_bg_color = colors.card;
    visuals.weak_text_color = Some(colors.quiet);
    visuals.hyperlink_color = colors.accent;
    visuals.error_fg_color = colors.error;
    visuals.selection.bg_fill = colors.chosen;
    visuals.selection.stroke = Stroke::new(1.0, colors.on_chosen);
    visuals.slider_trailing_fill = true;
    visuals.indent_has_left_vline = false;
    visuals.button_frame = true;
    let [rest, hovered, active] = colors.buttons;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, colors.panel, colors.text),
        (&mut widgets.inactive, rest, colors.text),
        (&mut widgets.hovered, hovered, colors.strong),
        (&mut widgets.active, active, colors.strong),
        (&mut widgets.open, hovered, colors.strong),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.bg_stroke = Stroke::NONE;
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, colors.line);
    widgets.hovered.bg_stroke = Stroke::new(1.0, active);
    visuals
}
