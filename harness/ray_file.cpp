#include "harness/ray_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include "scenes/base/atomic_file.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

static_assert(std::endian::native == std::endian::little,
              "headers and rays are written as they lie in memory");

// The carriage return and the zero show files that were taken for text on their way.
constexpr std::array<char, 8> magic{'R', 'A', 'Y', 'S', '\r', '\n', '\x1a', '\0'};
constexpr std::uint32_t byte_order_mark = 0x01020304, version = 1;
constexpr std::uint32_t most_text_bytes = 4096;

/// The first bytes of a file; kind, scene name, rays and checksum follow.
struct Header {
  std::array<char, 8> magic = raymeter::magic;
  std::uint32_t byte_order = byte_order_mark;
  std::uint32_t version = raymeter::version;
  std::uint8_t query = 0, order = 0, coherent = 0, reserved = 0;
  std::uint32_t kind_bytes = 0, scene_bytes = 0, reserved_too = 0;
  std::uint64_t scene_hash = 0;
  std::uint64_t rays = 0;
};
static_assert(sizeof(Header) == 48 && std::has_unique_object_representations_v<Header>);

[[noreturn]] void fail(const std::filesystem::path& file, std::string_view what) {
  throw Error(fmt::format("{}: {}", file.string(), what));
}

/// Writes, and remembers the checksum of what was written.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& file) : stream_(file, std::ios::binary | std::ios::trunc) {}

  void bytes(const void* data, std::size_t size) {
    stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    hasher_.bytes(data, size);
  }
  /// Whether all is on its way to the disk.
  bool close() {
    const std::uint64_t checksum = hasher_.digest();
    stream_.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    stream_.close();
    return !stream_.fail();
  }

 private:
  std::ofstream stream_;
  Hasher hasher_;
};

/// Reads, and remembers the checksum of what was read.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary) {}

  void bytes(void* data, std::size_t size) {
    raw(data, size);
    hasher_.bytes(data, size);
  }
  std::string text(std::size_t size) {
    std::string text(size, '\0');
    bytes(text.data(), size);
    return text;
  }
  bool checksum_is_right() {
    std::uint64_t given = 0;
    raw(&given, sizeof given);
    return given == hasher_.digest();
  }

 private:
  void raw(void* data, std::size_t size) {
    stream_.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(stream_.gcount()) != size) fail(file_, "can't be read");
  }

  const std::filesystem::path& file_;
  std::ifstream stream_;
  Hasher hasher_;
};

bool is_printable(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
}

/// What is wrong with a header, in a file of so many bytes; empty when nothing is.
std::string complaint(const Header& header, std::uintmax_t size) {
  if (header.magic != magic) return "not a ray file";
  if (header.byte_order != byte_order_mark) return "its numbers are not in little-endian order";
  if (header.version != version)
    return fmt::format("ray file of version {}; {} can be read", header.version, version);
  if (header.query > 1 || header.order > 2 || header.coherent > 1 || header.reserved || header.reserved_too ||
      header.kind_bytes == 0 || std::max(header.kind_bytes, header.scene_bytes) > most_text_bytes)
    return "damaged: its header has values that mean nothing";
  if (header.rays > most_rays)
    return fmt::format("its header counts {} rays; {} are the most", header.rays, most_rays);
  const std::uint64_t right = sizeof(Header) + header.kind_bytes + header.scene_bytes +
                              header.rays * sizeof(Ray) + sizeof(std::uint64_t);
  if (size != right)
    return fmt::format("{}: its header counts {} rays, which makes {} bytes, but the file has {}",
                       size < right ? "cut short" : "too long", header.rays, right, size);
  return "";
}

}  // namespace

void write_ray_file(const std::filesystem::path& file, const RayBatch& batch, const Scene& scene) {
  std::error_code status;
  if (std::filesystem::exists(file, status) && !std::filesystem::is_regular_file(file, status))
    fail(file, "can't be written: it is there and not a file");
  const std::string kind = batch.name.substr(0, most_text_bytes),
                    scene_name = scene.name().substr(0, most_text_bytes);
  Header header;
  header.query = static_cast<std::uint8_t>(batch.query);
  header.order = static_cast<std::uint8_t>(batch.order);
  header.coherent = batch.coherent;
  header.kind_bytes = static_cast<std::uint32_t>(kind.size());
  header.scene_bytes = static_cast<std::uint32_t>(scene_name.size());
  header.scene_hash = scene.hash();
  header.rays = batch.rays.size();

  AtomicFile atomic(file);
  Writer writer(atomic.temporary());
  writer.bytes(&header, sizeof header);
  writer.bytes(kind.data(), kind.size());
  writer.bytes(scene_name.data(), scene_name.size());
  writer.bytes(batch.rays.data(), batch.rays.size() * sizeof(Ray));
  if (!writer.close()) fail(file, fmt::format("can't be written: {}", std::strerror(errno)));
  atomic.commit();
}

RayBatch read_ray_file(const std::filesystem::path& file, const Scene& scene) {
  std::error_code status;
  if (!std::filesystem::exists(file, status)) fail(file, "no such file");
  if (!std::filesystem::is_regular_file(file, status)) fail(file, "not a file");
  const std::uintmax_t size = std::filesystem::file_size(file, status);
  if (status) fail(file, status.message());
  if (size < sizeof(Header)) fail(file, fmt::format("not a ray file: it has only {} bytes", size));

  Reader reader(file);
  Header header;
  reader.bytes(&header, sizeof header);
  if (const std::string what = complaint(header, size); !what.empty()) fail(file, what);
  RayBatch batch;
  const std::string kind = reader.text(header.kind_bytes), scene_name = reader.text(header.scene_bytes);
  batch.rays.resize(header.rays);
  reader.bytes(batch.rays.data(), batch.rays.size() * sizeof(Ray));
  if (!reader.checksum_is_right()) fail(file, "damaged: its checksum is not that of its content");
  if (!is_printable(kind)) fail(file, "the kind of its rays is no text");
  if (header.scene_hash != scene.hash())
    fail(file, fmt::format("its rays were made for the scene {} (hash {:016x}), not for {} (hash {:016x})",
                           is_printable(scene_name) ? scene_name : "?", header.scene_hash, scene.name(),
                           scene.hash()));

  batch.name = fmt::format("{} from {}", kind, file.filename().string());
  batch.from_file = true;
  batch.query = static_cast<QueryKind>(header.query);
  batch.order = static_cast<RayOrder>(header.order);
  batch.coherent = header.coherent;
  batch.hash = ray_hash(batch.rays);
  return batch;
}

}  // namespace raymeter
