#pragma once
#include <filesystem>
#include <string>

namespace raymeter {

/// The whole file. Throws Error when it can't be read or is larger than 8 GiB: below that no format can
/// hold more vertices than 32 bits number.
std::string read_file_bytes(const std::filesystem::path& file);

}  // namespace raymeter
