// The SPD families against their counts and, where the shared folder has them, against SPD's own files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

#include "scenes/base/error.h"
#include "scenes/generators/spd/spd.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

Scene spd_scene(const std::string& family, int size) {
  return open_scene(fmt::format("spd/{}:size={}", family, size));
}

struct Counts {
  std::uint64_t shapes, triangles, quadrics;
  friend bool operator==(const Counts&, const Counts&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Counts& counts) {
    return out << counts.shapes << " shapes, " << counts.triangles << " triangles, " << counts.quadrics
               << " quadrics";
  }
};

Counts counts_of(const Scene& scene) {
  return {scene.shape_count(), scene.triangle_count(), scene.primitive_count() - scene.triangle_count()};
}

std::uint64_t power(std::uint64_t base, std::uint64_t exponent) {
  return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

struct Family {
  const char* name;
  std::uint64_t smallest, largest;
  Counts (*counts)(std::uint64_t n);
  std::uint64_t hash_of_size_2;
};

const Family families[] = {
    {"balls", 1, 8,
     [](std::uint64_t n) {
       const std::uint64_t spheres = (power(9, n + 1) - 1) / 8;
       return Counts{spheres + 1, 2, spheres};
     },
     2604244802312721589u},
    {"gears", 1, 44,
     [](std::uint64_t n) { return Counts{n * n * n * 146 + 1, n * n * n * (288 + 284) + 2, 0}; },
     2733718938056932492u},
    {"jacks", 1, 8,
     [](std::uint64_t n) {
       const std::uint64_t quadrics = 9 * (power(8, n) - 1) / 7;
       return Counts{quadrics, 0, quadrics};
     },
     4439529037248281638u},
    {"lattice", 1, 231,
     [](std::uint64_t n) {
       const std::uint64_t quadrics = (n + 1) * (n + 1) * (n + 1) + 3 * n * (n + 1) * (n + 1);
       return Counts{quadrics, 0, quadrics};
     },
     7949803846617485977u},
    {"mount", 1, 12, [](std::uint64_t n) { return Counts{2 * power(4, n) + 4, 2 * power(4, n), 4}; },
     16321586867279718752u},
    {"rings", 1, 135,
     [](std::uint64_t n) {
       const std::uint64_t quadrics = 10 * n * (n + 1) * (2 * n + 1);
       return Counts{quadrics + 1, 2, quadrics};
     },
     7684998864067815387u},
    {"sombrero", 1, 8,
     [](std::uint64_t n) {
       const std::uint64_t side = 16 * power(2, n) - 1;
       return Counts{2 * side * side, 2 * side * side, 0};
     },
     12477492288106154320u},
    {"teapot", 2, 870, [](std::uint64_t n) { return Counts{65 * n * n - 8 * n, 66 * n * n - 8 * n, 0}; },
     5489504280253030406u},
    {"tetra", 1, 12, [](std::uint64_t n) { return Counts{power(4, n), power(4, n), 0}; },
     12670396311779104558u},
    {"tree", 1, 23, [](std::uint64_t n) { return Counts{power(2, n + 2) - 1, 2, power(2, n + 2) - 2}; },
     3318783029777102594u},
};

TEST(Spd, CountsAreThoseOfTheFormulas) {
  for (const Family& family : families)
    for (std::uint64_t size = family.smallest; size <= 20; ++size) {
      const Counts expected = family.counts(size);
      if (expected.shapes > 70000) break;
      const Scene scene = spd_scene(family.name, static_cast<int>(size));
      EXPECT_EQ(counts_of(scene), expected) << family.name << size;
      EXPECT_TRUE(scene.warnings().empty()) << family.name << size << ": " << scene.warnings()[0];
    }
}

TEST(Spd, SizesAreBounded) {
  for (const Family& family : families) {
    const auto primitives = [&](std::uint64_t size) {
      const Counts counts = family.counts(size);
      return counts.triangles + counts.quadrics;
    };
    EXPECT_LE(primitives(family.largest), spd_most_primitives) << family.name;
    EXPECT_GT(primitives(family.largest + 1), spd_most_primitives) << family.name;
    const auto generator =
        std::ranges::find(scene_generators(), std::string("spd/") + family.name, &SceneGenerator::name);
    ASSERT_NE(generator, scene_generators().end()) << family.name;
    EXPECT_EQ(generator->parameters.at(0).minimum, double(family.smallest)) << family.name;
    EXPECT_EQ(generator->parameters.at(0).maximum, double(family.largest)) << family.name;
    for (const char* size : {"-1", "2.5", "x", "", "1e9"})
      EXPECT_THROW(open_scene(fmt::format("spd/{}:size={}", family.name, size)), Error)
          << family.name << size;
    for (const std::uint64_t size : {family.smallest - 1, family.largest + 1})
      EXPECT_THROW(spd_scene(family.name, static_cast<int>(size)), Error) << family.name << size;
  }
}

TEST(Spd, ScenesAreTheSameOnEveryMachine) {
  for (const Family& family : families)
    EXPECT_EQ(spd_scene(family.name, 2).hash(), family.hash_of_size_2) << family.name;
}

/// Equal to what SPD prints, six significant digits of a number that it may have rounded differently.
bool printed(double ours, double theirs) {
  return std::abs(ours - theirs) <= 6e-6 * std::abs(theirs) + 2e-7;
}
bool printed(const Vec3& ours, const Vec3& theirs) {
  return printed(ours.x, theirs.x) && printed(ours.y, theirs.y) && printed(ours.z, theirs.z);
}
std::string text(const Vec3& v) {
  return fmt::format("{} {} {}", v.x, v.y, v.z);
}

void expect_same_view(const Scene& ours, const Scene& theirs) {
  const Camera &a = ours.camera(), &b = theirs.camera();
  EXPECT_TRUE(printed(a.from, b.from) && printed(a.at, b.at) && printed(a.up, b.up));
  EXPECT_EQ(a.angle, b.angle);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(ours.background(), theirs.background());
  ASSERT_EQ(ours.lights().size(), theirs.lights().size());
  for (std::size_t i = 0; i < ours.lights().size(); ++i) {
    EXPECT_TRUE(printed(ours.lights()[i].position, theirs.lights()[i].position)) << i;
    EXPECT_EQ(ours.lights()[i].colour, theirs.lights()[i].colour) << i;
  }
}

void expect_same_material(const Material& ours, const Material& theirs) {
  EXPECT_TRUE(printed(ours.colour, theirs.colour)) << text(ours.colour) << ", not " << text(theirs.colour);
  EXPECT_EQ(ours.diffuse, theirs.diffuse);
  EXPECT_EQ(ours.specular, theirs.specular);
  EXPECT_EQ(ours.shine, theirs.shine);
  EXPECT_EQ(ours.transmittance, theirs.transmittance);
  EXPECT_EQ(ours.refraction_index, theirs.refraction_index);
}

void expect_same_triangle(const Scene& ours, const Scene& theirs, std::uint32_t i) {
  const Triangle a = ours.triangle(i), b = theirs.triangle(i);
  EXPECT_TRUE(printed(a.a, b.a) && printed(a.b, b.b) && printed(a.c, b.c))
      << text(a.a) << ", " << text(a.b) << ", " << text(a.c) << " not " << text(b.a) << ", " << text(b.b)
      << ", " << text(b.c);
  ASSERT_EQ(ours.triangle_normals().empty(), theirs.triangle_normals().empty());
  if (ours.triangle_normals().empty()) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t n = ours.triangle_normals()[i][k], m = theirs.triangle_normals()[i][k];
    ASSERT_EQ(n == SceneData::no_normal, m == SceneData::no_normal);
    if (n == SceneData::no_normal) continue;
    EXPECT_TRUE(printed(ours.normals()[n], theirs.normals()[m]))
        << text(ours.normals()[n]) << ", not " << text(theirs.normals()[m]);
  }
}

void expect_same_quadric(const Quadric& ours, const Quadric& theirs) {
  EXPECT_EQ(ours.kind, theirs.kind);
  EXPECT_TRUE(printed(ours.base, theirs.base)) << text(ours.base) << ", not " << text(theirs.base);
  EXPECT_TRUE(printed(ours.apex, theirs.apex)) << text(ours.apex) << ", not " << text(theirs.apex);
  EXPECT_TRUE(printed(ours.base_radius, theirs.base_radius));
  EXPECT_TRUE(printed(ours.apex_radius, theirs.apex_radius));
}

struct File {
  const char* set;
  const char* family;
  int size;
  friend std::ostream& operator<<(std::ostream& out, const File& file) {
    return out << file.set << "/" << file.family << file.size;
  }
};

class SpdFiles : public testing::TestWithParam<File> {};

TEST_P(SpdFiles, AreWhatTheGeneratorMakes) {
  const auto& [set, family, size] = GetParam();
  const std::string path = fmt::format("{}/scenes/spd/{}/{}{}.nff", RAYMETER_SHARED_DATA, set, family, size);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
  const Scene theirs = open_scene(path), ours = spd_scene(family, size);
  ASSERT_EQ(counts_of(ours), counts_of(theirs));
  expect_same_view(ours, theirs);
  for (std::uint32_t i = 0; i < ours.primitive_count(); ++i) {
    SCOPED_TRACE(i);
    if (ours.is_triangle(i))
      expect_same_triangle(ours, theirs, i);
    else
      expect_same_quadric(ours.quadric(i), theirs.quadric(i));
    expect_same_material(ours.material_of(i), theirs.material_of(i));
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SpdFiles,
    testing::Values(File{"small", "balls", 3}, File{"small", "gears", 2}, File{"small", "jacks", 3},
                    File{"small", "lattice", 6}, File{"small", "mount", 4}, File{"small", "rings", 3},
                    File{"small", "sombrero", 1}, File{"small", "teapot", 4}, File{"small", "tetra", 5},
                    File{"small", "tree", 8}, File{"standard", "balls", 4}, File{"standard", "gears", 4},
                    File{"standard", "jacks", 4}, File{"standard", "lattice", 12},
                    File{"standard", "mount", 6}, File{"standard", "rings", 7},
                    File{"standard", "sombrero", 2}, File{"standard", "teapot", 12},
                    File{"standard", "tetra", 6}, File{"standard", "tree", 11}, File{"paper", "balls", 2},
                    File{"paper", "jacks", 2}, File{"paper", "lattice", 2}, File{"paper", "mount", 7},
                    File{"paper", "rings", 1}, File{"paper", "teapot", 15}, File{"paper", "teapot", 30},
                    File{"paper", "tetra", 7}, File{"paper", "tree", 4}),
    [](const auto& test) {
      return fmt::format("{}_{}{}", test.param.set, test.param.family, test.param.size);
    });

}  // namespace
}  // namespace raymeter
