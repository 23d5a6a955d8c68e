#include "reports/picture_file.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "reports/openimageio/picture_module.h"
#include "scenes/base/atomic_file.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// The module lies beside this library (in a build tree), or in a folder of its own there (installed).
void* load_module() {
  Dl_info self{};
  dladdr(reinterpret_cast<const void*>(&load_module), &self);
  const auto folder = std::filesystem::path(self.dli_fname ? self.dli_fname : "").parent_path();
  std::filesystem::path file = folder / "raymeter-pictures.so";
  if (!std::filesystem::exists(file)) file = folder / "raymeter" / "raymeter-pictures.so";
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) throw Error(fmt::format("can't write pictures: {}", dlerror()));
  return module;
}

template <class Function>
Function* from_module(const char* name) {
  static void* const module = load_module();
  void* function = dlsym(module, name);
  if (!function) throw Error(fmt::format("can't write pictures: {}", dlerror()));
  return reinterpret_cast<Function*>(function);
}

template <class Write>
void write_atomically(const std::filesystem::path& file, const Write& write) {
  AtomicFile atomic(file);
  std::string failure;
  write(atomic.temporary().string(), failure);
  if (!failure.empty()) throw Error(fmt::format("{}: can't be written: {}", file.string(), failure));
  atomic.commit();
}

}  // namespace

void write_png(const std::filesystem::path& file, const Canvas& picture, const PictureMetadata& metadata) {
  auto* const write = from_module<WritePng>("raymeter_write_png");
  write_atomically(
      file, [&](const std::string& name, std::string& failure) { write(name, picture, metadata, failure); });
}

void write_exr(const std::filesystem::path& file, const LayeredPicture& picture) {
  auto* const write = from_module<WriteExr>("raymeter_write_exr");
  write_atomically(file,
                   [&](const std::string& name, std::string& failure) { write(name, picture, failure); });
}

}  // namespace raymeter
