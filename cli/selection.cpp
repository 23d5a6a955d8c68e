#include "cli/selection.h"

#include <CLI/CLI.hpp>
#include <utility>

namespace raymeter {
namespace {

std::vector<Spec> parse_all(const std::vector<std::string>& texts) {
  std::vector<Spec> specs;
  for (const std::string& text : texts)
    for (Spec& spec : parse_specs(text)) specs.push_back(std::move(spec));
  return specs;
}

}  // namespace

void add_selection(CLI::App& command, Selection& o) {
  // A line break in a description goes on in the same column; lines stay below 100 columns.
  command
      .add_option("scene", o.scenes,
                  "Files (.nff .obj .ply .stl .gltf .glb), or generated scenes,\n"
                  "as soup:triangles=60000")
      ->required()
      ->type_name("SCENE");
  command
      .add_option("-s,--structure", o.structures,
                  "Structure, as grid:amount=0.5,1,2; may be given several times\n"
                  "[all of `raymeter list structures` but brute-force]")
      ->type_name("SPEC")
      ->allow_extra_args(false);
  command
      .add_option("-r,--rays", o.rays,
                  "Rays: primary shadow reflection diffuse ao random whitted; several\n"
                  "times "
                  "[primary shadow reflection diffuse]")
      ->type_name("KIND")
      ->allow_extra_args(false);
  command
      .add_option("--ray-file", o.ray_files,
                  "Rays from a file that `raymeter rays` wrote; several times. Without\n"
                  "-r these are the only rays")
      ->type_name("FILE")
      ->allow_extra_args(false);
  add_batch_options(command, o.batches);
  command.add_option("--threads", o.threads, "Threads that build and trace")
      ->check(CLI::Range(1u, 1024u))
      ->capture_default_str();
  command
      .add_option("--memory-limit", o.memory_limit,
                  "Bytes that a structure may use; 500MB and 2GB are understood")
      ->transform(CLI::AsSizeValue(true))
      ->type_name("BYTES")
      ->capture_default_str();
}

ComparisonSettings settings_of(const Selection& selection) {
  ComparisonSettings settings;
  settings.structures = parse_all(selection.structures);
  settings.ray_kinds = parse_all(selection.rays);
  settings.ray_files.assign(selection.ray_files.begin(), selection.ray_files.end());
  settings.batches = batch_settings(selection.batches);
  settings.race.threads = selection.threads;
  settings.memory_limit = selection.memory_limit;
  return settings;
}

}  // namespace raymeter
