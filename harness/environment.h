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

/// Identifies compiled code: a hash of the bytes of the file, program or shared library, from which the
/// function or constant at `address` was loaded. So a rebuilt file never passes for the old one. 0 when it
/// can't be read.
std::uint64_t code_id(const void* address);

/// The code_id of Raymeter's library.
std::uint64_t build_id();

}  // namespace raymeter
