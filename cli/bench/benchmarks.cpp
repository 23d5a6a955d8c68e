#include "cli/bench/benchmarks.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "accel/note.h"
#include "harness/checked_answers.h"
#include "harness/comparison.h"
#include "harness/pinned_thread.h"
#include "harness/tracing.h"

namespace raymeter {
namespace {

std::size_t rays_in(const std::vector<JudgedBatch>& batches) {
  std::size_t rays = 0;
  for (const JudgedBatch& batch : batches) rays += batch.rays.rays.size();
  return rays;
}

}  // namespace

Benchmarks::Benchmarks(std::vector<Scene> scenes, const Registry& registry, ComparisonSettings settings)
    : registry_(registry), settings_(std::move(settings)), scenes_(std::move(scenes)) {
  check(settings_, registry);
  for (const Scene& scene : scenes_)
    for (const Spec& spec : structures_of(settings_, registry))
      subjects_.push_back({scene, registry.find(spec.name), spec, registry.arguments(spec).brief()});
  for (const Arguments& kind : ray_kinds_of(settings_)) rays_.push_back(kind.brief());
  for (const auto& file : settings_.ray_files) rays_.push_back(file.filename().string());
}

void Benchmarks::register_all() {
  const bool one_thread = settings_.race.threads <= 1;
  for (const Subject& subject : subjects_) {
    const std::string& scene = subject.scene.name();
    auto* const build_benchmark =
        benchmark::RegisterBenchmark(fmt::format("{}/build/{}", scene, subject.name).c_str(),
                                     [this, &subject](benchmark::State& state) { build(state, subject); });
    build_benchmark->Unit(benchmark::kMillisecond);
    // A builder may hand work to a thread of its own.
    if (one_thread)
      build_benchmark->MeasureProcessCPUTime();
    else
      build_benchmark->UseRealTime();
    for (std::size_t group = 0; group < rays_.size(); ++group) {
      auto* const trace_benchmark = benchmark::RegisterBenchmark(
          fmt::format("{}/{}/{}/trace", scene, rays_[group], subject.name).c_str(),
          [this, &subject, group](benchmark::State& state) { trace(state, subject, group); });
      trace_benchmark->Unit(benchmark::kMillisecond);
      if (!one_thread) trace_benchmark->UseRealTime();
    }
  }
}

void Benchmarks::build(benchmark::State& state, const Subject& subject) {
  built_subject_ = nullptr;
  verdicts_.clear();
  try {
    for ([[maybe_unused]] auto _ : state) {
      state.PauseTiming();
      built_ = {};  // never two of them at once
      state.ResumeTiming();
      built_.structure = registry_.build(subject.spec, input(subject));
    }
  } catch (const std::exception& error) {
    fail(state, subject, error.what());
    return;
  }
  built_.stats = built_.structure->stats();
  built_subject_ = &subject;
  const StructureStats& stats = built_.stats;
  for (const auto& [name, count] : {std::pair{"primitives", std::uint64_t{subject.scene.primitive_count()}},
                                    {"bytes", stats.bytes},
                                    {"peak_bytes", stats.peak_bytes},
                                    {"cells", stats.cells},
                                    {"references", stats.references}})
    if (count > 0) state.counters[name] = static_cast<double>(count);
  state.SetLabel(stats.note);
}

void Benchmarks::trace(benchmark::State& state, const Subject& subject, std::size_t group) {
  try {
    const std::vector<JudgedBatch>& parts = batches(subject.scene)[group].batches;
    const Built& now = built(subject);
    if (!now.structure) return fail(state, subject, now.failure);
    const std::size_t rays = rays_in(parts);
    if (rays == 0) return state.SkipWithError("no rays");

    std::vector<BatchAnswers> answers(parts.size());
    for (std::size_t i = 0; i < answers.size(); ++i) make_room(answers[i], parts[i].rays.view());
    {
      std::optional<PinnedThread> pin;
      if (settings_.race.threads <= 1) pin.emplace();
      now.structure->prepare(parts[0].rays.view());
      for ([[maybe_unused]] auto _ : state)
        for (std::size_t i = 0; i < answers.size(); ++i) {
          const BatchView batch = parts[i].rays.view();
          if (answers.size() > 1) {  // each has to be laid out anew
            state.PauseTiming();
            now.structure->prepare(batch);
            state.ResumeTiming();
          }
          raymeter::trace(*now.structure, batch, answers[i], settings_.race.threads);
        }
    }

    // Google Benchmark calls this several times for one benchmark: the answers are examined once, and must
    // then stay the same.
    std::optional<Verdict>& verdict = verdicts_[group];
    if (!verdict) verdict = judge(subject, group, answers);
    std::vector<std::uint64_t> hashes;
    for (const BatchAnswers& one : answers) hashes.push_back(hit_hash(one));
    if (hashes != verdict->hit_hashes) verdict->fault = "the answers change from run to run";
    if (!verdict->fault.empty()) {
      all_right_ = false;
      return state.SkipWithError(verdict->fault.c_str());
    }
    for (const auto& [name, value] : verdict->counters) state.counters[name] = value;
    state.counters["rays/s"] =
        benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsIterationInvariantRate);
    state.SetLabel(verdict->remark);
  } catch (const std::exception& error) {
    fail(state, subject, error.what());
  }
}

Benchmarks::Verdict Benchmarks::judge(const Subject& subject, std::size_t group,
                                      const std::vector<BatchAnswers>& answers) {
  std::vector<JudgedBatch>& parts = batches_[group].batches;
  Verdict verdict;
  CounterTotals totals;
  Grades grades;
  std::uint64_t hits = 0;
  bool consistent = true;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    JudgedBatch& batch = parts[i];
    built_.structure->prepare(batch.rays.view());
    const CheckedAnswers checked =
        check_answers(subject.scene, *built_.structure, {answers[i], subject.kind.answers}, batch,
                      [this](std::string_view name, std::size_t rays) { report_refuted(name, rays); });
    verdict.hit_hashes.push_back(checked.hit_hash);
    totals.add(checked.counters);
    for (std::size_t grade = 0; grade < grade_count; ++grade)
      grades[static_cast<Grade>(grade)] += checked.grades[static_cast<Grade>(grade)];
    hits += checked.hits;
    consistent = consistent && checked.consistent;
  }
  const std::string faulty = fmt::format("{} answers wrong, {} not given, {} unexplained", grades.wrong,
                                         grades.not_given, grades.unexplained);
  if (!consistent)
    verdict.fault = "the counted pass gave other answers than the timed one";
  else if (is_fault(grades, subject.kind))
    verdict.fault = faulty;
  verdict.remark = built_.stats.note;
  if (!grades.faultless()) add_note(verdict.remark, faulty);

  const auto add = [&](const char* name, double value) { verdict.counters.emplace_back(name, value); };
  add("primitives", static_cast<double>(subject.scene.primitive_count()));
  add("rays", static_cast<double>(rays_in(parts)));
  add("hits", static_cast<double>(hits));
  if (totals.rays > 0) {
    add("steps_per_ray", totals.per_ray(totals.steps));
    add("tests_per_ray", totals.per_ray(totals.tests));
  }
  return verdict;
}

BuildInput Benchmarks::input(const Subject& subject) const {
  return {subject.scene, settings_.race.threads, settings_.memory_limit};
}

std::vector<BatchGroup>& Benchmarks::batches(const Scene& scene) {
  if (batches_scene_ != &scene) {
    batches_scene_ = nullptr;
    built_subject_ = nullptr;
    built_ = {};
    batches_ = make_batches(scene, registry_, settings_,
                            [this](std::string_view name, std::size_t rays) { report_refuted(name, rays); });
    batches_scene_ = &scene;
  }
  return batches_;
}

Built& Benchmarks::built(const Subject& subject) {
  if (built_subject_ != &subject) {
    built_subject_ = nullptr;
    built_ = {};  // never two of them at once
    built_ = build_once(registry_, subject.spec, input(subject));
    built_subject_ = &subject;
    verdicts_.clear();
  }
  verdicts_.resize(rays_.size());
  return built_;
}

void Benchmarks::fail(benchmark::State& state, const Subject& subject, const std::string& reason) {
  if (!subject.kind.tolerated) all_right_ = false;
  state.SkipWithError(reason.c_str());
}

void Benchmarks::report_refuted(std::string_view batch, std::size_t rays) {
  all_right_ = false;
  fmt::print(stderr,
             "raymeter_bench: {}: brute force refutes the reference hits on {} rays; please report this\n",
             batch, rays);
}

}  // namespace raymeter
