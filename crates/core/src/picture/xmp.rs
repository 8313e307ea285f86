//! Metadata that mark panoramas for viewers: Google's "Photo Sphere XMP Metadata" (GPano).

use super::Recipe;
use crate::camera::{Panorama, Projection, StereoKind};
use std::f64::consts::PI;

/// The keyword of XMP in a PNG ("XMP Specification Part 3", Adobe, 2020).
pub(super) const KEYWORD: &str = "XML:com.adobe.xmp";

/// Says that the upper half is the left eye's: Google's "Spherical Video RDF", which viewers of pictures read too.
const TOP_BOTTOM: &str = " xmlns:GSpherical=\"http://ns.google.com/videos/1.0/spherical/\" \
     GSpherical:Spherical=\"true\" GSpherical:Stitched=\"true\" \
     GSpherical:ProjectionType=\"equirectangular\" GSpherical:StereoMode=\"top-bottom\"";

/// The XMP packet of an equirectangular picture that is no larger than the full panorama, or of a full panorama for
/// two eyes; `None` for any other picture.
pub(super) fn packet(recipe: &Recipe) -> Option<String> {
    let camera = &recipe.camera;
    let plane = camera.plane();
    let pixel = plane.step / camera.distance();
    let (width, height) = ((2.0 * PI / pixel).round(), (PI / pixel).round());
    let (columns, rows) = (f64::from(plane.columns), f64::from(plane.rows));
    let is_one = camera.projection() == Projection::Panoramic(Panorama::Equirectangular);
    let (height, stereo) = match camera.stereo().map(|stereo| stereo.kind) {
        None => (height, ""),
        // Only a full panorama: GPano's crop describes one rectangle, not two pictures.
        Some(StereoKind::Ods) if columns == width && rows == 2.0 * height => {
            (2.0 * height, TOP_BOTTOM)
        }
        Some(_) => return None,
    };
    if !is_one || columns > width || rows > height {
        return None;
    }
    // The picture's middle is that of the full panorama.
    let left = ((width - columns) * 0.5).floor();
    let top = ((height - rows) * 0.5).floor();
    Some(format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\
         <x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\
         <rdf:Description rdf:about=\"\" xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\" \
         GPano:ProjectionType=\"equirectangular\" GPano:UsePanoramaViewer=\"True\" \
         GPano:CroppedAreaImageWidthPixels=\"{columns}\" \
         GPano:CroppedAreaImageHeightPixels=\"{rows}\" \
         GPano:FullPanoWidthPixels=\"{width}\" GPano:FullPanoHeightPixels=\"{height}\" \
         GPano:CroppedAreaLeftPixels=\"{left}\" GPano:CroppedAreaTopPixels=\"{top}\"{stereo}/>\
         </rdf:RDF></x:xmpmeta><?xpacket end=\"r\"?>"
    ))
}
