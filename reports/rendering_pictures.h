#pragma once
#include <string>

#include "harness/rendering.h"
#include "reports/picture_file.h"
#include "scenes/scene.h"

namespace raymeter {

/// What the picture shows, in sRGB, lights above 1 cut off.
Canvas colour_picture(const Rendering& rendering);

/// The layers of a rendering, each as EXR viewers know it: docs/whitted.md lists them. Channels beyond R, G,
/// B and Z are named by their layer, so that programs that throw parts together keep them apart.
LayeredPicture rendering_layers(const Rendering& rendering, PictureMetadata metadata);

/// Scene, its hash, the structure's canonical spec, rays and their hash, version and build, each under a name
/// that begins with "raymeter."; "Software" is what made the file.
PictureMetadata rendering_metadata(const Scene& scene, const std::string& spec, const Rendering& rendering);

}  // namespace raymeter
