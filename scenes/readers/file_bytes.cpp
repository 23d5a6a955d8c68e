#include "scenes/readers/file_bytes.h"

#include <fmt/format.h>

#include <fstream>

#include "scenes/base/error.h"

namespace raymeter {

std::string read_file_bytes(const std::filesystem::path& file) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status))
    throw Error(fmt::format("{}: no such file", file.string()));
  const std::uintmax_t size = std::filesystem::file_size(file, status);
  if (status) throw Error(fmt::format("{}: {}", file.string(), status.message()));
  constexpr std::uintmax_t limit = std::uintmax_t{8} << 30;
  if (size > limit) throw Error(fmt::format("{}: {} bytes; the limit is 8 GiB", file.string(), size));

  std::ifstream stream(file, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size())
    throw Error(fmt::format("{}: can't be read", file.string()));
  return bytes;
}

}  // namespace raymeter
