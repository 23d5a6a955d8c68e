#pragma once
#include <memory>
#include <string>

#include "accel/registry.h"
#include "accel/structure.h"
#include "harness/statistics.h"

namespace raymeter {

/// A structure as built, or why it could not be.
struct Built {
  std::unique_ptr<Structure> structure;  ///< null when it could not be built
  StructureStats stats;
  double seconds = 0;  ///< median of the builds
  unsigned builds = 1;
  Interval range;  ///< shortest and longest build
  std::string failure;
};

/// Builds once. Build time is CPU time of the whole process at one thread (a builder may hand work to a
/// thread of its own), wall time at more. Whatever the registry or the structure throws is the `failure`.
Built build_once(const Registry& registry, const Spec& spec, const BuildInput& input);

/// Builds up to five times, while all builds together take less than 0.2 s: the median says more of a build
/// of milliseconds than one of them, and what is paid once in a process falls out of it.
Built build_timed(const Registry& registry, const Spec& spec, const BuildInput& input);

/// The exact structure that reference answers are taken from, and primary hits from which secondary rays
/// start: the quickest one that can be built here. Throws Error when there is none.
std::unique_ptr<Structure> build_reference(const Registry& registry, const BuildInput& input);

}  // namespace raymeter
