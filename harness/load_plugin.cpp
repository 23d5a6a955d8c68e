#include "harness/load_plugin.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <cstring>
#include <exception>
#include <fstream>
#include <string>
#include <utility>

#include "accel/plugin.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// The loader maps what the file's header announces, and dies of a bus error where the file is shorter.
bool is_whole_library(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::uint64_t size = std::filesystem::file_size(path);
  ElfW(Ehdr) header{};
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_type != ET_DYN ||
      header.e_phentsize != sizeof(ElfW(Phdr)))
    return false;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    file.seekg(static_cast<std::streamoff>(header.e_phoff + i * sizeof segment));
    if (!file.read(reinterpret_cast<char*>(&segment), sizeof segment)) return false;
    if (segment.p_offset > size || segment.p_filesz > size - segment.p_offset) return false;
  }
  return true;
}

/// What the loader has to say, in one line and without the path that it often begins with.
std::string loader_message(const std::string& path) {
  const char* message = dlerror();
  std::string text = message ? message : "unknown reason";
  if (text.starts_with(path + ": ")) text.erase(0, path.size() + 2);
  return text;
}

}  // namespace

void load_plugin(const std::filesystem::path& file, Registry& registry) {
  const std::string name = file.string();
  std::error_code status;
  const auto kind = std::filesystem::status(file, status).type();
  if (kind == std::filesystem::file_type::not_found) throw Error(fmt::format("{}: no such plug-in", name));
  if (kind != std::filesystem::file_type::regular || !is_whole_library(file))
    throw Error(fmt::format("{}: not a shared library", name));

  // A name without a slash would be looked for elsewhere.
  const std::string path = std::filesystem::absolute(file).string();
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Error(fmt::format("{}: can't be loaded: {}", name, loader_message(path)));

  const auto* const tag = static_cast<const char*>(dlsym(library, "raymeter_plugin_abi"));
  const auto enter = reinterpret_cast<void (*)(Registry&)>(dlsym(library, "raymeter_plugin_register"));
  if (!tag || !enter)
    throw Error(fmt::format("{}: no plug-in of Raymeter (RAYMETER_PLUGIN is missing)", name));
  constexpr PluginAbi ours = plugin_abi();
  const std::string theirs(tag, strnlen(tag, ours.size()));
  if (theirs != ours.data())
    throw Error(fmt::format("{}: built for {}; this is {}", name, theirs, ours.data()));

  Registry with_plugin = registry;
  try {
    enter(with_plugin);
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: can't be registered: {}", name, error.what()));
  } catch (...) {
    throw Error(fmt::format("{}: can't be registered", name));
  }
  if (with_plugin.kinds().size() == registry.kinds().size())
    throw Error(fmt::format("{}: registers no structure", name));
  registry = std::move(with_plugin);
}

}  // namespace raymeter
