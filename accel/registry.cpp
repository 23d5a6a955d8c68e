#include "accel/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

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
  const Arguments arguments(spec, kind.parameters);
  // As many threads as asked for, even where there are fewer CPUs.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, input.threads);
  tbb::task_arena arena(static_cast<int>(input.threads));
  return arena.execute([&] {
    const FlushDenormals mode;
    return kind.build(arguments, input);
  });
}

}  // namespace raymeter
