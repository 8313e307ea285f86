//! Icons of the Lucide font (<https://lucide.dev>).

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{Align2, Color32, FontData, FontFamily, FontId, Painter, Pos2};
pub use lucide_icons::Icon;
use lucide_icons::LUCIDE_FONT_BYTES;

fn family() -> FontFamily {
    FontFamily::Name("icons".into())
}

/// Makes the icons known. Before the next frame begins, or any text of this one is laid out, none can be drawn.
pub fn install(context: &egui::Context) {
    let alone = InsertFontFamily {
        family: family(),
        priority: FontPriority::Highest,
    };
    let font = FontData::from_static(LUCIDE_FONT_BYTES);
    context.add_font(FontInsert::new("lucide", font, vec![alone]));
}

/// Draws an icon about a point, `size` points high. What it stands for is to be said to screen readers by what it
/// is drawn on.
pub fn paint(painter: &Painter, center: Pos2, icon: Icon, size: f32, color: Color32) {
    let font = FontId::new(size, family());
    painter.text(center, Align2::CENTER_CENTER, char::from(icon), font, color);
}
