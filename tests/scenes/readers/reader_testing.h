#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/base/error.h"
#include "scenes/base/random.h"
#include "scenes/readers/readers.h"
#include "scenes/scene.h"

namespace raymeter {

using Reader = SceneData (*)(const std::filesystem::path&);

inline std::filesystem::path hostile_file(std::string_view name) {
  return std::filesystem::path(RAYMETER_TEST_DATA) / "hostile" / name;
}
inline std::filesystem::path shared_file(std::string_view name) {
  return std::filesystem::path(RAYMETER_SHARED_DATA) / name;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

/// A file in the temporary folder, gone with its object.
class TemporaryFile {
 public:
  TemporaryFile(std::string_view name, std::string_view content)
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::to_string(getpid()) + "_" + std::string(name))) {
    write(content);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }

  void write(std::string_view content) const {
    std::filesystem::remove(path_);  // some file systems wait for the disk when a file is cut to nothing
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Reads a text as if it were a file. The name's extension is for the reader, which is `read`.
inline SceneData read_text(Reader read, std::string_view content) {
  return read(TemporaryFile("scene", content).path());
}

inline Scene scene_of(SceneData data) {
  data.name = "test";
  return Scene(std::move(data));
}

/// What is said of a file that is refused; empty when it is read.
inline std::string complaint(Reader read, const std::filesystem::path& file) {
  try {
    read(file);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}
inline std::string complaint_about_text(Reader read, std::string_view content) {
  return complaint(read, TemporaryFile("scene", content).path());
}

/// Twice the area of all triangles, exact for small whole coordinates in an axis plane.
inline double doubled_area(const SceneData& data) {
  double sum = 0;
  for (const auto& [a, b, c] : data.triangles)
    sum += length(cross(to_double(data.vertices[b]) - to_double(data.vertices[a]),
                        to_double(data.vertices[c]) - to_double(data.vertices[a])));
  return sum;
}

/// Every beginning of a valid file, and copies of it with random bytes overwritten, removed or doubled, are
/// read or refused with an Error of one line; nothing else may happen. What is read makes a Scene.
inline void survive_damage(Reader read, std::string_view content, int rounds) {
  const TemporaryFile file("damaged", content);
  const auto attempt = [&](std::string_view bytes) {
    file.write(bytes);
    try {
      scene_of(read(file.path()));
    } catch (const Error& error) {
      EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
      EXPECT_LT(std::string_view(error.what()).size(), 600u);
    }
  };
  for (std::size_t length = 0; length < content.size(); ++length) attempt(content.substr(0, length));

  Random random(content.size());
  for (int round = 0; round < rounds; ++round) {
    std::string bytes(content);
    for (std::uint32_t edits = 1 + random.below(3); edits > 0 && !bytes.empty(); --edits) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size()));
      switch (random.below(4)) {
        case 0:
          bytes[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
          break;
        case 2:
          bytes.erase(at, 1 + random.below(8));
          break;
        default:
          bytes.insert(at, bytes.substr(at, 1 + random.below(16)));
      }
    }
    attempt(bytes);
  }
}

/// A hostile file: refused with a message that matches `refused`, or read with so many primitives.
struct HostileCase {
  const char* file;
  std::size_t primitives = 0;
  const char* refused = nullptr;
};

inline void expect_treated_as(Reader read, const HostileCase& expected) {
  std::filesystem::path path = hostile_file(expected.file);
  if (!std::filesystem::exists(path))  // the large ones are not copied into the project
    path = shared_file(std::string("hostile/") + expected.file);
  if (!std::filesystem::exists(path)) return;
  SCOPED_TRACE(expected.file);
  if (expected.refused) {
    EXPECT_THAT(complaint(read, path),
                testing::ContainsRegex(path.filename().string() + ": ?" + expected.refused));
  } else {
    SceneData data;
    ASSERT_NO_THROW(data = read(path));
    EXPECT_EQ(data.triangles.size() + data.quadrics.size(), expected.primitives);
    EXPECT_NO_THROW(scene_of(std::move(data)));
  }
}

/// A third party's NFF scene: how many triangles, quadrics and objects it has.
struct SharedCase {
  const char* file;
  std::size_t triangles, quadrics, shapes;
};

/// A third party's mesh: how many triangles, vertices (0: not said) and faces it has.
struct MeshCase {
  const char* file;
  std::size_t triangles, vertices, faces;
};

inline void expect_mesh(Reader read, const MeshCase& expected) {
  SCOPED_TRACE(expected.file);
  const SceneData data = read(shared_file(std::string("scenes/meshes/") + expected.file));
  EXPECT_EQ(data.triangles.size(), expected.triangles);
  if (expected.vertices) {
    EXPECT_EQ(data.vertices.size(), expected.vertices);
  }
  const Scene scene = scene_of(data);
  EXPECT_EQ(scene.shape_count(), expected.faces);
}

}  // namespace raymeter
