#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scenes/base/spec.h"
#include "scenes/scene.h"

namespace raymeter {

/// A family of scenes made by a program, named with parameters like a structure.
struct SceneGenerator {
  std::string name;
  std::string summary;
  std::vector<Parameter> parameters;
  std::function<SceneData(const Arguments&)> make;
};

/// All families, in the order of `raymeter list scenes`.
std::span<const SceneGenerator> scene_generators();

}  // namespace raymeter
