#include "harness/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "accel/note.h"
#include "harness/checked_answers.h"
#include "harness/environment.h"
#include "harness/judged_batches.h"
#include "harness/race.h"
#include "harness/timed_build.h"
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

/// What a row of records is about: a batch, or several together.
struct Subject {
  std::string name;  ///< canonical
  std::uint64_t rays = 0, hash = 0;
  std::string query;
  RayOrder order = RayOrder::tiled;
  bool from_file = false;
};

Subject subject_of(const RayBatch& batch) {
  return {batch.name,  batch.rays.size(), batch.hash, batch.query == QueryKind::any ? "any" : "closest",
          batch.order, batch.from_file};
}

Subject sum_of(const BatchGroup& group) {
  Subject subject{group.sum_name, 0, group.ray_hash(), "closest and any", group.batches[0].rays.order};
  for (const JudgedBatch& batch : group.batches) subject.rays += batch.rays.rays.size();
  return subject;
}

std::string key_of(const Context& context, const Subject& subject, const Arguments& arguments,
                   const std::string& build) {
  const RaceSettings& race = context.settings.race;
  Hasher hasher;
  hasher.value(context.scene.hash());
  hasher.text(context.scene.name());
  hasher.value(subject.hash);
  for (const std::string& text :
       {subject.name, arguments.canonical(), build, context.baseline, context.baseline_build})
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
Record blank_record(const Context& context, const Subject& subject, const Arguments& arguments,
                    const std::string& build) {
  constexpr std::string_view order_names[] = {"tiled", "scanline", "shuffled"};
  Record r;
  r.key = key_of(context, subject, arguments, build);
  r.scene = context.scene.name();
  r.scene_hash = hex(context.scene.hash());
  r.primitives = context.scene.primitive_count();
  r.structure = arguments.name();
  r.spec = arguments.canonical();
  r.baseline = context.baseline;
  r.batch = subject.name;
  r.query = subject.query;
  r.order = order_names[static_cast<std::size_t>(subject.order)];
  r.rays = subject.rays;
  r.ray_hash = hex(subject.hash);
  r.threads = context.settings.race.threads;
  if (!subject.from_file) r.seed = context.settings.batches.seed;
  r.build_id = build;
  r.environment_id = environment_id();
  return r;
}

void add_build(Record& r, const Built& built) {
  const StructureStats& stats = built.stats;
  const auto present = [](std::uint64_t count) { return count ? Record::Count(count) : Record::Count(); };
  r.build_s = built.seconds;
  if (built.builds >= 3) {
    r.build_low_s = built.range.low;
    r.build_high_s = built.range.high;
  }
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
  r.steps_p90 = totals.steps_histogram.percentile(0.9);
  r.steps_p99 = totals.steps_histogram.percentile(0.99);
  r.steps_max = totals.steps_histogram.maximum();
  r.tests_p50 = totals.tests_histogram.percentile(0.5);
  r.tests_p90 = totals.tests_histogram.percentile(0.9);
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

/// What was measured of one structure on one batch, or on several together.
struct Measurement : CheckedAnswers {
  RaceResult race;
  std::uint64_t reference_hash = 0, brute_forced = 0;
};

/// Races and checks one built structure on one batch; the answers are not kept.
Measurement measure(const Context& context, Structure& baseline, Structure& structure, Answers policy,
                    JudgedBatch& batch, ComparisonObserver& observer) {
  Measurement m;
  m.race = race(baseline, structure, batch.rays, context.settings.race);
  m.race.baseline.answers = {};
  const BatchAnswers answers = std::exchange(m.race.structure.answers, {});
  static_cast<CheckedAnswers&>(m) =
      check_answers(context.scene, structure, {answers, policy}, batch,
                    [&](std::string_view name, std::size_t rays) { observer.reference_refuted(name, rays); });
  m.reference_hash = hit_hash(batch.truth.answers);
  m.brute_forced = batch.truth.brute_forced;
  return m;
}

/// The batches of a group one after the other.
Measurement sum_of(std::span<const Measurement> parts, const BatchGroup& group) {
  Measurement sum;
  std::vector<RaceResult> races;
  std::vector<std::size_t> rays;
  Hasher hits, references;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Measurement& part = parts[i];
    races.push_back(part.race);
    rays.push_back(group.batches[i].rays.rays.size());
    sum.counters.add(part.counters);
    for (std::size_t grade = 0; grade < grade_count; ++grade)
      sum.grades[static_cast<Grade>(grade)] += part.grades[static_cast<Grade>(grade)];
    sum.hits += part.hits;
    hits.value(part.hit_hash);
    references.value(part.reference_hash);
    sum.brute_forced += part.brute_forced;
    sum.consistent = sum.consistent && part.consistent;
  }
  sum.race = sum_of_races(races, rays);
  sum.hit_hash = hits.digest();
  sum.reference_hash = references.digest();
  return sum;
}

/// Completes a record. Without a baseline there is a throughput but no ratio.
Record finished_record(const Context& context, Record r, const Built& built, const Measurement& m,
                       const Built& baseline) {
  add_build(r, built);
  add_race(r, m.race, context.settings.race.rounds);
  if (!baseline.structure) {
    r.baseline_mrays_per_s = r.ratio = r.ratio_low = r.ratio_high = {};
    add_note(r.note, "no ratio, the baseline failed: " + baseline.failure);
  }
  add_counters(r, m.counters);
  r.hits = m.hits;
  r.hit_hash = hex(m.hit_hash);
  add_grades(r, m.grades);
  r.reference_hash = hex(m.reference_hash);
  r.brute_forced = m.brute_forced;
  r.status = m.consistent ? "ok" : "inconsistent";
  if (!m.consistent) add_note(r.note, "the counted pass gave other answers than the timed one");
  return r;
}

}  // namespace

bool is_fault(const Grades& grades, const StructureKind& kind) {
  return !kind.tolerated && (grades.wrong > 0 || grades.unexplained > 0 ||
                             (kind.answers == Answers::exact && grades.not_given > 0));
}

bool is_fault(const Record& record, const StructureKind& kind) {
  if (record.status == "inconsistent") return true;
  Grades grades;
  grades.wrong = record.wrong.value_or(0);
  grades.unexplained = record.unexplained.value_or(0);
  grades.not_given = record.not_given.value_or(0);
  return (record.status != "ok" && !kind.tolerated) || is_fault(grades, kind);
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

  observer.progress(0, 1, fmt::format("{}: rays and their true hits", scene.name()));
  std::vector<BatchGroup> groups = make_batches(
      scene, registry, settings,
      [&](std::string_view batch, std::size_t rays) { observer.reference_refuted(batch, rays); });

  const BuildInput input{scene, settings.race.threads, settings.memory_limit};
  std::size_t total = 0;
  for (const BatchGroup& group : groups) total += specs.size() * group.batches.size();
  std::size_t done = 0;
  std::optional<Built> baseline;  // built when first needed: a resumed run may need nothing at all
  for (const Spec& spec : specs) {
    const Arguments arguments = registry.arguments(spec);
    const StructureKind& kind = registry.find(spec.name);
    const std::string build = build_id_of(kind);
    std::optional<Built> built;  // only the baseline and this one are alive during its races
    const auto record_failure = [&](Record record) {
      record.status = "failed";
      record.note = built->failure;
      observer.record(record);
    };
    for (BatchGroup& group : groups) {
      // A row of the sum needs the rounds of all its batches: they are raced again where it is missing.
      std::optional<Record> sum;
      const Record* earlier_sum = nullptr;
      if (!group.sum_name.empty()) {
        sum = blank_record(context, sum_of(group), arguments, build);
        earlier_sum = observer.finished(sum->key);
      }
      std::vector<Measurement> parts;
      for (JudgedBatch& batch : group.batches) {
        Record blank = blank_record(context, subject_of(batch.rays), arguments, build);
        observer.progress(done++, total,
                          fmt::format("{} {} {}", scene.name(), arguments.brief(), batch.rays.name));
        const Record* earlier = observer.finished(blank.key);
        if (earlier) observer.record(*earlier);
        if (earlier && (!sum || earlier_sum)) continue;
        if (!baseline) baseline = build_once(registry, settings.baseline, input);
        if (!built) built = build_timed(registry, spec, input);
        if (!built->structure) {
          if (!earlier) record_failure(std::move(blank));
          continue;
        }
        Structure& opponent = baseline->structure ? *baseline->structure : *built->structure;
        parts.push_back(measure(context, opponent, *built->structure, kind.answers, batch, observer));
        if (!earlier)
          observer.record(finished_record(context, std::move(blank), *built, parts.back(), *baseline));
      }
      if (!sum) continue;
      if (earlier_sum)
        observer.record(*earlier_sum);
      else if (built->structure)
        observer.record(finished_record(context, *sum, *built, sum_of(parts, group), *baseline));
      else
        record_failure(*sum);
    }
  }
}

}  // namespace raymeter
