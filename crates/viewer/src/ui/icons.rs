//! Icons of the Lucide font (<https://lucide.dev>).

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{Align2, Color32, FontData, FontFamily, FontId, Painter, Pos2};
pub use lucide_icons::Icon;
use lucide_icons::LUCIDE_FONT_BYTES;

fn family() -> FontFamily {
    FontFamily::Name("icons".into())
}

/// Installs the icon font. Icons can be drawn from the next frame on.
pub fn install(context: &egui::Context) {
    let alone = InsertFontFamily {
        family: family(),
        priority: FontPriority::Highest,
    };
    let font = FontData::from_static(LUCIDE_FONT_BYTES);
    context.add_font(FontInsert::new("lucide", font, vec![alone]));
}

/// Draws an icon about a point, `size` points high. The widget below it must give its meaning to screen readers.
pub fn paint(painter: &Painter, center: Pos2, icon: Icon, size: f32, color: Color32) {
    let font = FontId::new(size, family());
    painter.text(center, Align2::CENTER_CENTER, char::from(icon), font, color);
}
