#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace raymeter {

/// What a measurement ran on and with: (name, value) in a fixed order. What can't be found out is "unknown".
using Environment = std::vector<std::pair<std::string, std::string>>;

/// The processor, operating system, compiler, flags, library versions, float mode, huge pages, load and time
/// of this process. Embree and TBB are those that are loaded, the other libraries those it was compiled with.
Environment environment();

/// Identifies machine, system and build together: a hash of the entries of `environment` that are the same
/// in every run (all but time, load and memory), in hexadecimal.
std::string environment_id();

/// Identifies this build: a hash of the bytes of the loaded Raymeter library, so that a rebuilt library never
/// passes for the old one. 0 when its file can't be read.
std::uint64_t build_id();

}  // namespace raymeter
