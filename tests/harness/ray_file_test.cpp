#include "harness/ray_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "scenes/base/error.h"
#include "scenes/base/hash.h"
#include "tests/harness/test_scenes.h"

namespace raymeter {
namespace {

using testing::HasSubstr;

/// Bit by bit: NaN included.
std::string raw(const std::vector<Ray>& rays) {
  return {reinterpret_cast<const char*>(rays.data()), rays.size() * sizeof(Ray)};
}

class RayFile : public testing::Test {
 protected:
  RayFile() {
    folder_ = std::filesystem::path(testing::TempDir()) / ("ray_file_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    file_ = folder_ / "some.rays";
    batch_.name = "ao:length=0.05:samples=1";
    batch_.order = RayOrder::scanline;
    batch_.coherent = true;
    batch_.hash = ray_hash(batch_.rays);
  }
  ~RayFile() override { std::filesystem::remove_all(folder_); }

  std::string bytes() const {
    std::ostringstream bytes;
    bytes << std::ifstream(file_, std::ios::binary).rdbuf();
    return bytes.str();
  }
  void put(std::string_view content) const {
    std::ofstream(file_, std::ios::binary)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  /// With the checksum that the content should have.
  void put_sealed(std::string content) const {
    content.resize(content.size() - 8);
    Hasher hasher;
    hasher.bytes(content.data(), content.size());
    const std::uint64_t checksum = hasher.digest();
    put(content + std::string(reinterpret_cast<const char*>(&checksum), 8));
  }
  /// What is said of the file; empty when it is read.
  std::string complaint(const Scene& scene) const {
    try {
      read_ray_file(file_, scene);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::StartsWith(file_.string() + ": "));
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
    return "";
  }
  std::string complaint() const { return complaint(scene_); }

  std::filesystem::path folder_, file_;
  Scene scene_ = random_scene(10);
  RayBatch batch_ = random_batch(100, QueryKind::any);
};

TEST_F(RayFile, GivesBackTheBatch) {
  write_ray_file(file_, batch_, scene_);
  const RayBatch read = read_ray_file(file_, scene_);
  EXPECT_EQ(read.name, "ao:length=0.05:samples=1 from some.rays");
  EXPECT_TRUE(read.from_file);
  EXPECT_EQ(read.query, QueryKind::any);
  EXPECT_EQ(read.order, RayOrder::scanline);
  EXPECT_TRUE(read.coherent);
  EXPECT_EQ(read.hash, batch_.hash);
  ASSERT_EQ(read.rays.size(), 100u);
  EXPECT_EQ(raw(read.rays), raw(batch_.rays));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "leaves nothing beside it";
}

TEST_F(RayFile, KeepsRaysThatHitNothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  batch_.rays = {{{nan, 0, 0}, 0, {1, 0, 0}},   {{0, 0, 0}, 0, {inf, 0, 0}},
                 {{0, 0, 0}, 0, {0, 0, 0}},     {{0, 0, 0}, nan, {1, 0, 0}},
                 {{0, 0, 0}, 0, {1, 0, 0}, -1}, {{1e-40f, -0.0f, 0}, 0, {1, 0, 0}}};
  write_ray_file(file_, batch_, scene_);
  const RayBatch read = read_ray_file(file_, scene_);
  ASSERT_EQ(read.rays.size(), batch_.rays.size());
  EXPECT_EQ(raw(read.rays), raw(batch_.rays));
  std::vector<std::uint8_t> occluded(read.rays.size());
  build_brute_force(scene_)->trace_any(read.view(), occluded);
  EXPECT_EQ(std::vector<std::uint8_t>(occluded.begin(), occluded.begin() + 5), std::vector<std::uint8_t>(5));
}

TEST_F(RayFile, MayBeEmpty) {
  batch_.rays.clear();
  write_ray_file(file_, batch_, scene_);
  EXPECT_TRUE(read_ray_file(file_, scene_).rays.empty());
}

TEST_F(RayFile, LiesInTheFileAsDocumented) {
  write_ray_file(file_, batch_, scene_);
  const std::string content = bytes();
  EXPECT_EQ(content.substr(0, 20), std::string("RAYS\r\n\x1a\0\4\3\2\1\1\0\0\0\1\1\1\0", 20));
  EXPECT_EQ(content.substr(20, 12), std::string("\x18\0\0\0\6\0\0\0\0\0\0\0", 12));
  std::uint64_t hash = 0, rays = 0;
  std::memcpy(&hash, content.data() + 32, 8);
  std::memcpy(&rays, content.data() + 40, 8);
  EXPECT_EQ(hash, scene_.hash());
  EXPECT_EQ(rays, 100u);
  EXPECT_EQ(content.substr(48, 30), "ao:length=0.05:samples=1random");
  EXPECT_EQ(content.size(), 78 + 100 * 32 + 8);
  const auto number_at = [&](std::size_t at) {
    float number = 0;
    std::memcpy(&number, content.data() + at, sizeof number);
    return number;
  };
  const Ray& ray = batch_.rays[1];
  EXPECT_EQ(number_at(78 + 32), ray.origin.x);
  EXPECT_EQ(number_at(78 + 32 + 12), ray.tnear);
  EXPECT_EQ(number_at(78 + 32 + 24), ray.direction.z);
  EXPECT_EQ(number_at(78 + 32 + 28), ray.tfar);
}

TEST_F(RayFile, SaysWhatIsWrong) {
  write_ray_file(file_, batch_, scene_);
  const std::string good = bytes();
  const auto changed = [&](std::size_t at, std::string_view by) {
    return std::string(good).replace(at, by.size(), by);
  };
  put("");
  EXPECT_THAT(complaint(), HasSubstr("not a ray file: it has only 0 bytes"));
  put(changed(0, "RAYZ"));
  EXPECT_THAT(complaint(), HasSubstr("not a ray file"));
  put(changed(8, "\1\2\3\4"));
  EXPECT_THAT(complaint(), HasSubstr("not in little-endian order"));
  put_sealed(changed(12, "\2"));
  EXPECT_THAT(complaint(), HasSubstr("ray file of version 2; 1 can be read"));
  for (const std::size_t at : {16u, 17u, 18u, 19u, 28u}) {
    put_sealed(changed(at, "\3"));
    EXPECT_THAT(complaint(), HasSubstr("its header has values that mean nothing")) << at;
  }
  put_sealed(changed(23, "\x7f"));  // a kind of 2 GB
  EXPECT_THAT(complaint(), HasSubstr("its header has values that mean nothing"));
  put_sealed(changed(40, "\x63"));
  EXPECT_THAT(
      complaint(),
      HasSubstr("too long: its header counts 99 rays, which makes 3254 bytes, but the file has 3286"));
  put_sealed(changed(40, "\xff\xff\xff\x0f"));  // 2^28 - 1: 8 GiB that are not there
  EXPECT_THAT(complaint(), HasSubstr("cut short: its header counts 268435455 rays"));
  put_sealed(changed(47, "\x80"));
  EXPECT_THAT(complaint(), HasSubstr("268435456 are the most"));
  put(good.substr(0, good.size() - 1));
  EXPECT_THAT(complaint(), HasSubstr("cut short"));
  put(good + '\0');
  EXPECT_THAT(complaint(), HasSubstr("too long"));
  put(changed(100, "x"));
  EXPECT_THAT(complaint(), HasSubstr("damaged: its checksum"));
  put_sealed(changed(50, "\x1b"));
  EXPECT_THAT(complaint(), HasSubstr("the kind of its rays is no text"));
  std::filesystem::remove(file_);
  EXPECT_THAT(complaint(), HasSubstr("no such file"));
  std::filesystem::create_directory(file_);
  EXPECT_THAT(complaint(), HasSubstr("not a file"));
}

TEST_F(RayFile, IsForOneScene) {
  write_ray_file(file_, batch_, scene_);
  SceneData data;
  data.name = "another";
  const Scene other{std::move(data)};
  EXPECT_THAT(complaint(other),
              testing::ContainsRegex("made for the scene random .hash [0-9a-f]{16}., not for "
                                     "another .hash [0-9a-f]{16}."));
}

TEST_F(RayFile, NoBitIsChangedUnseen) {
  batch_.rays.resize(4);
  write_ray_file(file_, batch_, scene_);
  const std::string good = bytes();
  ASSERT_EQ(complaint(), "");
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    put(bad);
    EXPECT_NE(complaint(), "") << "bit " << bit;
  }
  for (std::size_t length = 0; length < good.size(); ++length) {
    put(good.substr(0, length));
    EXPECT_NE(complaint(), "") << length << " bytes";
  }
}

TEST_F(RayFile, ReplacesAFileWholeAndNothingElse) {
  put("an older one");
  write_ray_file(file_, batch_, scene_);
  EXPECT_EQ(complaint(), "");
  EXPECT_THROW(write_ray_file(folder_, batch_, scene_), Error);
  EXPECT_THROW(write_ray_file("/dev/null", batch_, scene_), Error);
  EXPECT_THROW(write_ray_file(folder_ / "nowhere/some.rays", batch_, scene_), Error);
  EXPECT_THROW(write_ray_file("/dev/full/some.rays", batch_, scene_), Error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace raymeter
