// The `raymeter` command: arguments, and nothing that a user of the library would miss.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/compare.h"
#include "cli/list.h"
#include "cli/rays.h"
#include "cli/render.h"
#include "cli/report.h"
#include "scenes/base/error.h"
#include "scenes/base/version.h"

namespace {

constexpr int bad_usage = 2;

CLI::App* add_compare(CLI::App& app, raymeter::CompareOptions& o) {
  CLI::App* compare = app.add_subcommand(
      "compare", "Run identical rays through several structures; check, count and time every one");
  raymeter::add_selection(*compare, o);
  // A line break in a description goes on in the same column; lines stay below 100 columns.
  compare->add_option("--baseline", o.baseline, "What ratios are taken against")
      ->type_name("SPEC")
      ->capture_default_str();
  compare
      ->add_option("--out", o.out,
                   "Folder for report.html, records.jsonl, records.csv and\n"
                   "environment.json; with the records of a killed run in it, the run goes\n"
                   "on from there")
      ->type_name("DIR");
  compare->add_flag("--pictures", o.pictures,
                    "Also render each scene with each structure, and write into\n"
                    "DIR/pictures the picture, heat maps of the work, and EXR files of all");
  compare->add_option("--rounds", o.rounds, "Rounds of each race")
      ->check(CLI::Range(3u, 1000u))
      ->capture_default_str();
  compare
      ->add_option("--time-budget", o.time_budget,
                   "Seconds for the rounds of one race: under 3 rounds only where\n"
                   "one pass takes over a second")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  compare->footer(
      "Prints a table per scene. Exit status: 0 every structure but Embree was right; 1 one was wrong,\n"
      "unexplained or could not be built; 2 bad usage or input.\n\n"
      "Examples:\n"
      "  raymeter compare teapot.nff\n"
      "  raymeter compare bunny.ply -s grid:amount=0.25,0.5,1,2 -r primary --out results\n"
      "  raymeter compare soup:triangles=60000 -s tunable-grid:density=1,4,16 -s embree:query=1,16");
  return compare;
}

CLI::App* add_rays(CLI::App& app, raymeter::RaysOptions& o) {
  CLI::App* rays = app.add_subcommand(
      "rays", "Write a batch of rays to a file, for compare --ray-file and for other programs");
  rays->add_option("scene", o.scene, "A file, or a generated scene, as for compare")
      ->required()
      ->type_name("SCENE");
  rays->add_option("-r,--rays", o.kind,
                   "Rays: primary shadow reflection diffuse ao random, or one\n"
                   "generation of whitted")
      ->type_name("KIND")
      ->capture_default_str();
  rays->add_option("-o,--output", o.out, "Replaced when it is there")->required()->type_name("FILE");
  raymeter::add_batch_options(*rays, o.batches);
  rays->footer(
      "The rays are those of compare with the same options, bit by bit. Exit status: 0; 1 the hits\n"
      "that they start from are in doubt; 2 bad usage or input.\n\n"
      "Examples:\n"
      "  raymeter rays teapot.nff -r diffuse:samples=4 -o teapot.rays\n"
      "  raymeter compare teapot.nff --ray-file teapot.rays");
  return rays;
}

CLI::App* add_render(CLI::App& app, raymeter::RenderOptions& o) {
  CLI::App* render = app.add_subcommand(
      "render", "Render a scene with one structure: a picture, its layers, or a heat map of the work");
  render->add_option("scene", o.scene, "A file, or a generated scene, as for compare")
      ->required()
      ->type_name("SCENE");
  render->add_option("-s,--structure", o.structure, "What traces the rays")
      ->type_name("SPEC")
      ->capture_default_str();
  render
      ->add_option("-o,--output", o.out,
                   "Picture: .png in sRGB, or .exr with the layers colour, depth, normal,\n"
                   "primitive, steps, empty_steps, tests, distinct_tests [none]")
      ->type_name("FILE");
  render
      ->add_option("--heat", o.heat,
                   "Instead of the picture a false-colour map of the work per pixel:\n"
                   "steps, empty-steps, tests or distinct-tests; given several times: the\n"
                   "picture, and beside it a row of maps for each")
      ->type_name("MEASURE")
      ->allow_extra_args(false);
  render
      ->add_option("--compare", o.compare,
                   "With --heat: the map of another structure beside the first, on the\n"
                   "same scale, and their difference; may be given several times")
      ->type_name("SPEC")
      ->allow_extra_args(false);
  render->add_option("--size", o.size, "Picture, in pixels [the scene's, or 320x240]")->type_name("WxH");
  render->add_option("--depth", o.depth, "Deepest generation of rays; eye rays are the first")
      ->check(CLI::Range(1u, 64u))
      ->capture_default_str();
  render->add_option("--rays", o.rays, "Whose work is counted: all rays of a pixel, or only its primary ray")
      ->check(CLI::IsMember({"all", "primary"}))
      ->capture_default_str();
  render
      ->add_option("--pixels", o.pixels,
                   "Rays through pixel centres, or through the (W+1)x(H+1) corners\n"
                   "as the SPD counts them")
      ->check(CLI::IsMember({"centres", "corners"}))
      ->capture_default_str();
  render->add_option("--camera", o.camera, "As from=0x-5x2:at=0x0x0:up=0x0x1:angle=45 [the scene's]")
      ->type_name("CAMERA");
  render->add_option("--threads", o.threads, "Threads that build and render; 0: one for each CPU")
      ->check(CLI::Range(0u, 1024u))
      ->capture_default_str();
  render->add_option("--memory-limit", o.memory_limit, "Bytes that a structure may use")
      ->transform(CLI::AsSizeValue(true))
      ->type_name("BYTES")
      ->capture_default_str();
  render->footer(
      "Prints how many rays were cast in each generation. Exit status: 0, or 2 for bad usage or input.\n\n"
      "Examples:\n"
      "  raymeter render balls4.nff -o balls.png\n"
      "  raymeter render balls4.nff -s grid --size 640x480 -o balls.exr\n"
      "  raymeter render balls4.nff -s grid --compare octree --heat tests -o tests.png\n"
      "  raymeter render balls4.nff -s grid --compare octree --heat steps --heat tests -o both.png\n"
      "  raymeter render balls4.nff --size 512x512 --pixels corners     (the SPD's ray counts)");
  return render;
}

CLI::App* add_report(CLI::App& app, raymeter::ReportOptions& o) {
  CLI::App* report = app.add_subcommand("report", "Make a page, or tables, of the records of comparisons");
  report->add_option("folder", o.folders, "What compare --out wrote")->required()->type_name("DIR");
  report
      ->add_option("-o,--output", o.out,
                   "report.html: one page that needs nothing else; .md: tables in\n"
                   "Markdown; .tex: tables for LaTeX with booktabs; .csv: all records\n"
                   "[report.html]")
      ->type_name("FILE");
  report->add_flag("--diff", o.diff,
                   "Say what changed from the first folder to the second: counters, memory\n"
                   "and grades exactly, times where their intervals lie apart");
  report
      ->add_option("--tolerance", o.tolerance, "With --diff: percent by which a ratio must change, at least")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  report->footer(
      "Exit status: 0; 1 something got worse (--diff); 2 bad usage or input.\n\n"
      "Examples:\n"
      "  raymeter report results                       (compare --out writes this page, too)\n"
      "  raymeter report monday tuesday -o both.html\n"
      "  raymeter report results -o tables.tex\n"
      "  raymeter report --diff before after           (in the CI of a project, say)");
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Raymeter compares ray-tracing acceleration structures: identical rays, proved hits, exact counts,\n"
      "fair times, Embree as the baseline.");
  app.set_version_flag("--version", RAYMETER_VERSION);
  app.require_subcommand(1);
  std::vector<std::string> plugins;
  raymeter::CompareOptions compare;
  raymeter::add_plugins(*add_compare(app, compare), plugins);
  raymeter::RenderOptions render;
  CLI::App* render_command = add_render(app, render);
  raymeter::add_plugins(*render_command, plugins);
  raymeter::RaysOptions rays;
  const CLI::App* const rays_command = add_rays(app, rays);
  raymeter::ReportOptions report;
  CLI::App* report_command = add_report(app, report);
  raymeter::add_plugins(*report_command, plugins);
  std::string what;
  CLI::App* list = app.add_subcommand("list", "Show what can be named: scenes, structures, rays, columns");
  list->add_option("what", what, "scenes, structures, rays or columns")
      ->required()
      ->check(CLI::IsMember({"scenes", "structures", "rays", "columns"}));
  raymeter::add_plugins(*list, plugins);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "raymeter: {} (see raymeter {}--help)\n", error.what(),
               app.get_subcommands().empty() ? "" : app.get_subcommands().front()->get_name() + " ");
    return bad_usage;
  }

  try {
    const raymeter::Registry registry = raymeter::registry_with(plugins);
    if (list->parsed()) {
      raymeter::run_list(what, registry);
      return 0;
    }
    if (render_command->parsed()) return raymeter::run_render(render, registry);
    if (rays_command->parsed()) return raymeter::run_rays(rays, registry);
    if (report_command->parsed()) return raymeter::run_report(report, registry);
    return raymeter::run_compare(compare, registry);
  } catch (const raymeter::Error& error) {
    fmt::print(stderr, "raymeter: {}\n", error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "raymeter: {}\n", error.what());
  }
  return bad_usage;
}
