#pragma once
#include <string>

#include "harness/rendering.h"
#include "reports/picture_file.h"
#include "scenes/scene.h"

namespace raymeter {

/// What the picture shows, in sRGB, lights above 1 cut off.
Canvas colour_picture(const Rendering& rendering);

/// The layers of a rendering, each as EXR viewers know it; channels beyond R, G, B and Z are named by their
/// layer, so that programs that throw parts together keep them apart:
///
/// | part | channels | type | |
/// |---|---|---|---|
/// | colour | R G B | float | linear, not cut off |
/// | depth | Z | float | along the ray, from the eye to the first hit; infinite where there is none |
/// | normal | normal.X .Y .Z | float | that was shaded with there, toward the viewer, unit; 0 where there is
/// none | | primitive | primitive.id | uint | of the first hit; 4294967295 where there is none | | steps,
/// empty_steps, tests, distinct_tests | the part's name .count | float | PixelWork; only when counted |
LayeredPicture rendering_layers(const Rendering& rendering, PictureMetadata metadata);

/// Scene, its hash, the structure's canonical spec, rays and their hash, version and build, each under a name
/// that begins with "raymeter."; "Software" is what made the file.
PictureMetadata rendering_metadata(const Scene& scene, const std::string& spec, const Rendering& rendering);

}  // namespace raymeter
