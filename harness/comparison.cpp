#include "harness/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>

#include "accel/note.h"
#include "harness/environment.h"
#include "harness/grading.h"
#include "harness/ray_kinds.h"
#include "harness/timed_build.h"
#include "harness/truth.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

/// What the compiler was told to compile our own structures for.
const char* build_isa() {
#if defined(__AVX512F__)
  return "avx512";
#elif defined(__AVX2__)
  return "avx2";
#elif defined(__SSE4_2__)
  return "sse4.2";
#elif defined(__SSE2__)
  return "sse2";
#else
  return "unknown";
#endif
}

std::string hex(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

/// For what is not timed.
unsigned all_cpus() {
  return std::max(1u, std::thread::hardware_concurrency());
}

/// A batch with what is known to be true of it.
struct JudgedBatch {
  RayBatch rays;
  Truth truth;
};

Truth reference_truth(const Scene& scene, Structure& reference, const RayBatch& batch,
                      ComparisonObserver& observer) {
  reference.prepare(batch.view());
  BatchAnswers answers;
  trace(reference, batch.view(), answers, all_cpus());
  Truth truth = establish_truth(scene, batch, answers, {.seed = batch.hash});
  std::size_t refuted = 0;
  for (std::size_t i = 0; i < batch.rays.size(); ++i)
    refuted += batch.query == QueryKind::closest ? truth.answers.hits[i] != answers.hits[i]
                                                 : truth.answers.occluded[i] != answers.occluded[i];
  if (refuted) observer.reference_refuted(batch.name, refuted);
  return truth;
}

std::vector<JudgedBatch> make_batches(const Scene& scene, const Registry& registry,
                                      const ComparisonSettings& settings, std::span<const Arguments> kinds,
                                      ComparisonObserver& observer) {
  const auto reference = build_reference(registry, {scene, settings.race.threads});
  JudgedBatch primary{make_primary(scene, settings.batches), {}};
  primary.truth = reference_truth(scene, *reference, primary.rays, observer);
  std::vector<JudgedBatch> batches;
  for (const Arguments& kind : kinds) {
    if (kind.name() == "primary") {
      batches.push_back(primary);
      continue;
    }
    JudgedBatch batch{make_batch(scene, kind, settings.batches, primary.rays, primary.truth.answers.hits),
                      {}};
    batch.truth = reference_truth(scene, *reference, batch.rays, observer);
    batches.push_back(std::move(batch));
  }
  return batches;
}

/// What is the same in all rows of a comparison.
struct Context {
  const Scene& scene;
  const ComparisonSettings& settings;
  std::string baseline;        ///< canonical
  std::string baseline_build;  ///< id
};

/// Identifies the code of a structure: this library, and the plug-in or program that it comes from, if it
/// does.
std::string build_id_of(const StructureKind& kind) {
  // The builder's function; or the type of the function object, which lies in the file where it was compiled.
  using Function = std::unique_ptr<Structure> (*)(const Arguments&, const BuildInput&);
  const Function* function = kind.build.target<Function>();
  const std::uint64_t own = build_id();
  const std::uint64_t id = code_id(function ? reinterpret_cast<const void*>(*function)
                                            : static_cast<const void*>(&kind.build.target_type()));
  return hex(own) + (id == own ? "" : "+" + hex(id));
}

std::string key_of(const Context& context, const RayBatch& batch, const Arguments& arguments,
                   const std::string& build) {
  const RaceSettings& race = context.settings.race;
  Hasher hasher;
  hasher.value(context.scene.hash());
  hasher.text(context.scene.name());
  hasher.value(batch.hash);
  for (const std::string& text :
       {batch.name, arguments.canonical(), build, context.baseline, context.baseline_build})
    hasher.text(text);
  hasher.text(environment_id());
  hasher.value(race.rounds);
  hasher.value(race.threads);
  hasher.value(race.min_round_seconds);
  hasher.value(race.time_budget);
  hasher.value(context.settings.memory_limit);
  hasher.value(context.settings.batches.seed);
  return hex(hasher.digest());
}

/// The part of a record that is known before anything was built.
Record blank_record(const Context& context, const JudgedBatch& batch, const Arguments& arguments,
                    const std::string& build) {
  constexpr std::string_view order_names[] = {"tiled", "scanline", "shuffled"};
  Record r;
  r.key = key_of(context, batch.rays, arguments, build);
  r.scene = context.scene.name();
  r.scene_hash = hex(context.scene.hash());
  r.primitives = context.scene.primitive_count();
  r.structure = arguments.name();
  r.spec = arguments.canonical();
  r.baseline = context.baseline;
  r.batch = batch.rays.name;
  r.query = batch.rays.query == QueryKind::any ? "any" : "closest";
  r.order = order_names[static_cast<std::size_t>(batch.rays.order)];
  r.rays = batch.rays.rays.size();
  r.ray_hash = hex(batch.rays.hash);
  r.threads = context.settings.race.threads;
  r.seed = context.settings.batches.seed;
  r.build_id = build;
  r.environment_id = environment_id();
  return r;
}

void add_build(Record& r, const Built& built) {
  const StructureStats& stats = built.stats;
  const auto present = [](std::uint64_t count) { return count ? Record::Count(count) : Record::Count(); };
  r.build_s = built.seconds;
  r.bytes = stats.bytes;
  r.peak_bytes = stats.peak_bytes;
  for (const auto& [part, bytes] : stats.bytes_by_part)
    r.bytes_by_part += fmt::format("{}{}={}", r.bytes_by_part.empty() ? "" : " ", part, bytes);
  r.nx = present(stats.resolution[0]);
  r.ny = present(stats.resolution[1]);
  r.nz = present(stats.resolution[2]);
  r.cells = present(stats.cells);
  if (r.cells) {
    r.empty_cells = stats.empty_cells;
    r.references = stats.references;
    r.inner_nodes = stats.inner_nodes;
    r.depth = stats.depth;
  }
  r.isa = stats.isa.empty() ? build_isa() : stats.isa;
  r.note = stats.note;
}

void add_counters(Record& r, const CounterTotals& totals) {
  if (totals.rays == 0) return;
  r.steps_per_ray = totals.per_ray(totals.steps);
  r.cell_steps_per_ray = totals.per_ray(totals.cell_steps);
  r.empty_cell_steps_per_ray = totals.per_ray(totals.empty_cell_steps);
  r.tests_per_ray = totals.per_ray(totals.tests);
  r.test_blocks_per_ray = totals.per_ray(totals.test_blocks);
  r.distinct_tests_per_ray = totals.per_ray(totals.distinct_tests);
  r.decides_per_ray = totals.per_ray(totals.decides);
  r.point_locations_per_ray = totals.per_ray(totals.point_locations);
  r.subgrids_entered_per_ray = totals.per_ray(totals.subgrids_entered);
  r.steps_p50 = totals.steps_histogram.percentile(0.5);
  r.steps_p99 = totals.steps_histogram.percentile(0.99);
  r.steps_max = totals.steps_histogram.maximum();
  r.tests_p50 = totals.tests_histogram.percentile(0.5);
  r.tests_p99 = totals.tests_histogram.percentile(0.99);
  r.tests_max = totals.tests_histogram.maximum();
}

void add_race(Record& r, const RaceResult& result, unsigned wanted_rounds) {
  r.rounds = result.rounds();
  if (result.rounds() == 0) return;  // no rays: nothing to time
  if (result.threads == 1) r.pinned = result.pinned ? "yes" : "no";
  r.mrays_per_s = result.structure.median_rays_per_second / 1e6;
  r.baseline_mrays_per_s = result.baseline.median_rays_per_second / 1e6;
  r.ratio = result.ratio;
  if (result.rounds() < 3) {
    add_note(r.note,
             fmt::format("{} of {} rounds fit the time budget: no interval", result.rounds(), wanted_rounds));
    return;
  }
  r.ratio_low = result.ratio_interval.low;
  r.ratio_high = result.ratio_interval.high;
  r.spread = result.spread;
  if (result.noisy) r.noisy = "yes";
}

void add_grades(Record& r, const Grades& grades) {
  r.right = grades.right;
  r.within_bound = grades.within_bound;
  r.tie = grades.tie;
  r.edge = grades.edge;
  r.grazing = grades.grazing;
  r.at_limit = grades.at_limit;
  r.degenerate = grades.degenerate;
  r.wrong = grades.wrong;
  r.not_given = grades.not_given;
  r.unexplained = grades.unexplained;
}

/// Races, counts and grades one built structure on one batch. Without a baseline there is a throughput but no
/// ratio.
Record measure(const Context& context, Structure* baseline, const Built& built, Answers policy,
               JudgedBatch& batch, Record r, ComparisonObserver& observer) {
  const RayBatch& rays = batch.rays;
  add_build(r, built);
  const RaceResult result =
      race(baseline ? *baseline : *built.structure, *built.structure, rays, context.settings.race);
  const BatchAnswers& answers = result.structure.answers;
  bool consistent = true;
  add_race(r, result, context.settings.race.rounds);
  if (!baseline) r.baseline_mrays_per_s = r.ratio = r.ratio_low = r.ratio_high = {};
  r.hits = count_hits(answers);
  r.hit_hash = hex(hit_hash(answers));
  if (built.structure->counts()) {
    BatchAnswers counted;
    add_counters(r, count(*built.structure, rays.view(), counted, all_cpus()));
    if (counted != answers) consistent = false;
  }
  const Row row{answers, policy};
  if (const std::size_t refuted = settle_disputes(context.scene, rays, row, batch.truth))
    observer.reference_refuted(rays.name, refuted);
  add_grades(r, grade(context.scene, rays, batch.truth, row));
  r.reference_hash = hex(hit_hash(batch.truth.answers));
  r.brute_forced = batch.truth.brute_forced;
  r.status = consistent ? "ok" : "inconsistent";
  if (!consistent) add_note(r.note, "the counted pass gave other answers than the timed one");
  return r;
}

std::vector<Spec> structures_of(const ComparisonSettings& settings, const Registry& registry) {
  std::vector<Spec> specs = settings.structures;
  if (specs.empty())
    for (const StructureKind& kind : registry.kinds())
      if (kind.name != "brute-force") specs.push_back({kind.name, {}});
  return specs;
}

std::vector<Arguments> ray_kinds_of(const ComparisonSettings& settings) {
  std::vector<Spec> specs = settings.ray_kinds;
  if (specs.empty()) specs = {{"primary", {}}, {"shadow", {}}, {"reflection", {}}, {"diffuse", {}}};
  std::vector<Arguments> kinds;
  for (const Spec& spec : specs) kinds.push_back(ray_arguments(spec));
  return kinds;
}

}  // namespace

void check(const ComparisonSettings& settings, const Registry& registry) {
  for (const Spec& spec : settings.structures) registry.arguments(spec);
  registry.arguments(settings.baseline);
  for (const Spec& kind : settings.ray_kinds) ray_arguments(kind);
}

bool is_fault(const Record& record, const StructureKind& kind) {
  if (record.status == "inconsistent") return true;
  if (kind.tolerated) return false;
  const auto some = [](const Record::Count& count) { return count.value_or(0) > 0; };
  return record.status != "ok" || some(record.wrong) || some(record.unexplained) ||
         (kind.answers == Answers::exact && some(record.not_given));
}

void compare_structures(const Scene& scene, const Registry& registry, const ComparisonSettings& settings,
                        ComparisonObserver& observer) {
  const Context context{scene, settings, registry.arguments(settings.baseline).canonical(),
                        build_id_of(registry.find(settings.baseline.name))};
  std::vector<Spec> specs = structures_of(settings, registry);
  const auto is_baseline = [&](const Spec& spec) {
    return registry.arguments(spec).canonical() == context.baseline;
  };
  if (std::ranges::none_of(specs, is_baseline)) specs.push_back(settings.baseline);
  const std::vector<Arguments> kinds = ray_kinds_of(settings);

  observer.progress(0, 1, fmt::format("{}: rays and their true hits", scene.name()));
  std::vector<JudgedBatch> batches = make_batches(scene, registry, settings, kinds, observer);

  const BuildInput input{scene, settings.race.threads, settings.memory_limit};
  const std::size_t total = specs.size() * batches.size();
  std::size_t done = 0;
  std::optional<Built> baseline;  // built when first needed: a resumed run may need nothing at all
  for (const Spec& spec : specs) {
    const Arguments arguments = registry.arguments(spec);
    const StructureKind& kind = registry.find(spec.name);
    const std::string build = build_id_of(kind);
    std::optional<Built> built;  // only the baseline and this one are alive during its races
    for (JudgedBatch& batch : batches) {
      Record blank = blank_record(context, batch, arguments, build);
      observer.progress(done++, total,
                        fmt::format("{} {} {}", scene.name(), arguments.brief(), batch.rays.name));
      if (const Record* earlier = observer.finished(blank.key)) {
        observer.record(*earlier);
        continue;
      }
      if (!baseline) baseline = build_once(registry, settings.baseline, input);
      if (!built) built = build_timed(registry, spec, input);
      if (built->structure) {
        Record record = measure(context, baseline->structure.get(), *built, kind.answers, batch,
                                std::move(blank), observer);
        if (!baseline->structure)
          add_note(record.note, "no ratio, the baseline failed: " + baseline->failure);
        observer.record(record);
      } else {
        blank.status = "failed";
        blank.note = built->failure;
        observer.record(blank);
      }
    }
  }
}

}  // namespace raymeter
