#include "accel/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "scenes/base/error.h"
#include "scenes/base/float_mode.h"

namespace raymeter {

void Registry::add(StructureKind kind) {
  for (const auto& known : kinds_)
    if (known.name == kind.name)
      throw std::logic_error(fmt::format("structure '{}' is registered twice", kind.name));
  kinds_.push_back(std::move(kind));
}

const StructureKind& Registry::find(std::string_view name) const {
  std::vector<std::string_view> names;
  for (const auto& kind : kinds_) {
    if (kind.name == name) return kind;
    names.push_back(kind.name);
  }
  throw Error(fmt::format("no structure '{}'; there are: {}", name, fmt::join(names, ", ")));
}

Arguments Registry::arguments(const Spec& spec) const {
  return Arguments(spec, find(spec.name).parameters);
}

std::unique_ptr<Structure> Registry::build(const Spec& spec, const BuildInput& input) const {
  const StructureKind& kind = find(spec.name);
  const FlushDenormals mode;
  return kind.build(Arguments(spec, kind.parameters), input);
}

}  // namespace raymeter
