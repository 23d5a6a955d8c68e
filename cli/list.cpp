#include "cli/list.h"

#include <fmt/format.h>

#include <string>

#include "harness/ray_kinds.h"
#include "harness/record.h"
#include "reports/text.h"
#include "scenes/generators/generators.h"

namespace raymeter {
namespace {

void print_wrapped(std::string_view head, std::string_view text, std::size_t indent) {
  fmt::print("{}", wrapped(head, text, indent));
}

void print_parameters(std::span<const Parameter> parameters) {
  for (const Parameter& p : parameters)
    print_wrapped(fmt::format("    {:<12} ", p.name), fmt::format("{} ({})", p.meaning, describe(p)), 17);
}

}  // namespace

void run_list(std::string_view what, const Registry& registry) {
  if (what == "structures") {
    fmt::print("A structure is named `name:parameter=value:...`; a comma list sweeps: grid:amount=0.5,1,2\n");
    for (const StructureKind& kind : registry.kinds()) {
      fmt::print("\n");
      print_wrapped(kind.name + ": ", kind.summary, 0);
      print_wrapped("    from ", kind.source, 9);
      print_parameters(kind.parameters);
    }
  } else if (what == "scenes") {
    fmt::print("A scene is a file (.nff .obj .ply .stl .gltf .glb) or one of these, by name:\n");
    for (const SceneGenerator& generator : scene_generators()) {
      fmt::print("\n");
      print_wrapped(generator.name + ": ", generator.summary, 0);
      print_parameters(generator.parameters);
    }
  } else if (what == "rays") {
    for (const RayKind& kind : ray_kinds()) {
      fmt::print("{}: {} ({} hit)\n", kind.name, kind.summary,
                 !kind.query                    ? "closest and any"
                 : kind.query == QueryKind::any ? "any"
                                                : "closest");
      print_parameters(kind.parameters);
    }
  } else {
    fmt::print(
        "The columns of records.csv and the keys of records.jsonl. What could not be had is an empty "
        "field.\n\n");
    for (const Column& column : columns())
      print_wrapped(fmt::format("{:<26} {:<7} ", column.name, column.unit), column.meaning, 35);
  }
}

}  // namespace raymeter
