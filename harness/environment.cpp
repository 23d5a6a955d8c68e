#include "harness/environment.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/utsname.h>
#include <tbb/version.h>
#include <unistd.h>

#include <array>
#include <boost/version.hpp>
#include <ctime>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <thread>

#include "baselines/embree.h"
#include "scenes/base/float_mode.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

const std::string unknown = "unknown";

/// The first line of a file.
std::string line_of(const char* path) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) && !line.empty() ? line : unknown;
}

/// The value of the first line "KEY<blanks>SEPARATOR VALUE".
std::string value_in(const char* path, std::string_view key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t at = line.find(separator);
    if (at == std::string::npos || !line.starts_with(key)) continue;
    if (line.find_first_not_of(" \t", key.size()) != at) continue;
    const std::size_t value = line.find_first_not_of(" \t\"", at + 1);
    if (value == std::string::npos) return unknown;
    return line.substr(value, line.find_last_not_of('"') + 1 - value);
  }
  return unknown;
}

/// Of the processor's features, those that decide which ray-tracing kernels it can run.
std::string isa_of(const std::string& flags) {
  constexpr std::array<std::string_view, 12> of_interest = {
      "sse4_2",  "avx",      "avx2",     "fma",      "bmi2",        "f16c",
      "avx512f", "avx512dq", "avx512bw", "avx512vl", "avx512_vbmi", "avx512_fp16"};
  std::string found;
  std::istringstream words(flags);
  for (std::string word; words >> word;)
    for (const std::string_view flag : of_interest)
      if (word == flag) found += (found.empty() ? "" : " ") + word;
  return found.empty() ? unknown : found;
}

/// The choice in brackets, as in "always [madvise] never".
std::string chosen(const std::string& line) {
  const std::size_t open = line.find('['), close = line.find(']');
  return open == std::string::npos || close == std::string::npos ? line
                                                                 : line.substr(open + 1, close - open - 1);
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

}  // namespace

Environment environment() {
  const char* cpu = "/proc/cpuinfo";
  const std::string flags = value_in(cpu, "flags", ':');
  utsname system{};
  uname(&system);
  return {
      {"time", utc_time()},
      {"cpu", value_in(cpu, "model name", ':')},
      {"cpus", std::to_string(std::thread::hardware_concurrency())},
      {"cpu_features", isa_of(flags)},
      {"cache", value_in(cpu, "cache size", ':')},
      {"virtual_machine", flags == unknown                                                ? unknown
                          : (" " + flags + " ").find(" hypervisor ") != std::string::npos ? "yes"
                                                                                          : "no"},
      {"memory", value_in("/proc/meminfo", "MemTotal", ':')},
      {"load_average", line_of("/proc/loadavg")},
      {"transparent_huge_pages", chosen(line_of("/sys/kernel/mm/transparent_hugepage/enabled"))},
      {"system", value_in("/etc/os-release", "PRETTY_NAME", '=')},
      {"kernel", fmt::format("{} {}", system.sysname, system.release)},
      {"compiler", compiler()},
      {"build_type", RAYMETER_BUILD_TYPE},
      {"build_flags", RAYMETER_BUILD_FLAGS},
      {"build_id", fmt::format("{:016x}", build_id())},
      {"embree", embree_version()},
      {"tbb", TBB_runtime_version()},
      {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"boost",
       fmt::format("{}.{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
      {"nlohmann_json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                    NLOHMANN_JSON_VERSION_PATCH)},
      {"denormals", FlushDenormals::available ? "flushed in every build and trace (FTZ and DAZ)" : "kept"},
  };
}

std::string environment_id() {
  static const std::string id = [] {
    Hasher hasher;
    for (const auto& [name, value] : environment()) {
      // What differs from run to run on the same machine, or may.
      if (name == "time" || name == "load_average" || name == "memory") continue;
      hasher.text(name);
      hasher.text(value);
    }
    return fmt::format("{:016x}", hasher.digest());
  }();
  return id;
}

std::uint64_t code_id(const void* address) {
  Dl_info object{};
  void* map = nullptr;
  if (dladdr1(address, &object, &map, RTLD_DL_LINKMAP) == 0 || !map) return 0;
  // The running program has no name there, and its argv[0] need not be a path.
  const std::string name = static_cast<const link_map*>(map)->l_name;
  const std::string path = name.empty() ? "/proc/self/exe" : name;

  static std::mutex mutex;
  static std::map<std::string, std::uint64_t> known;  // hashed when first asked for
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(path); found != known.end()) return found->second;
  std::ifstream file(path, std::ios::binary);
  if (!file) return 0;
  Hasher hasher;
  std::vector<char> block(std::size_t{1} << 20u);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
    hasher.bytes(block.data(), static_cast<std::size_t>(file.gcount()));
  return known[path] = hasher.digest();
}

std::uint64_t build_id() {
  return code_id(reinterpret_cast<const void*>(&build_id));
}

}  // namespace raymeter
