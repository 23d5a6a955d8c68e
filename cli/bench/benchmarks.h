#pragma once
#include <benchmark/benchmark.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/registry.h"
#include "harness/comparison_settings.h"
#include "harness/judged_batches.h"
#include "harness/timed_build.h"
#include "scenes/scene.h"

namespace raymeter {

/// What `compare` would race, as benchmarks of Google Benchmark:
///
/// - SCENE/build/STRUCTURE builds;
/// - SCENE/RAYS/STRUCTURE/trace traces these rays, by the harness's `trace`.
///
/// They come scene by scene and structure by structure: one structure is alive at a time, and built once for
/// all of its rays. What it answers is counted and graded outside of the timed loop.
class Benchmarks {
 public:
  /// `registry` must outlive it. Throws Error as `check` does.
  Benchmarks(std::vector<Scene> scenes, const Registry& registry, ComparisonSettings settings);

  Benchmarks(const Benchmarks&) = delete;
  Benchmarks& operator=(const Benchmarks&) = delete;

  /// Names them to Google Benchmark. They keep pointing to this object.
  void register_all();

  /// Whether every structure that has run, but those of a tolerated kind, was built and right.
  bool all_right() const { return all_right_; }

 private:
  /// One structure on one scene.
  struct Subject {
    const Scene& scene;
    const StructureKind& kind;
    Spec spec;
    std::string name;  ///< of the spec, brief
  };
  /// What a structure's answers to a group of batches turned out to be.
  struct Verdict {
    std::vector<std::uint64_t> hit_hashes;
    std::string fault;  ///< empty: none
    std::string remark;
    std::vector<std::pair<std::string, double>> counters;
  };

  void build(benchmark::State& state, const Subject& subject);
  void trace(benchmark::State& state, const Subject& subject, std::size_t group);

  BuildInput input(const Subject& subject) const;
  std::vector<BatchGroup>& batches(const Scene& scene);
  Built& built(const Subject& subject);
  Verdict judge(const Subject& subject, std::size_t group, const std::vector<BatchAnswers>& answers);
  void report_refuted(std::string_view batch, std::size_t rays);
  void fail(benchmark::State& state, const Subject& subject, const std::string& reason);

  const Registry& registry_;
  ComparisonSettings settings_;
  std::vector<Scene> scenes_;
  std::vector<Subject> subjects_;
  std::vector<std::string> rays_;  ///< names of the groups of batches

  const Scene* batches_scene_ = nullptr;
  std::vector<BatchGroup> batches_;
  const Subject* built_subject_ = nullptr;
  Built built_;
  std::vector<std::optional<Verdict>> verdicts_;  ///< on built_, by group
  bool all_right_ = true;
};

}  // namespace raymeter
