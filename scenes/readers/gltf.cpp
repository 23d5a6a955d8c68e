#include "scenes/base/error.h"
#include "scenes/readers/readers.h"

namespace raymeter {

SceneData read_gltf(const std::filesystem::path& file) {
  throw Error(file.string() + ": no reader yet");
}

}  // namespace raymeter
