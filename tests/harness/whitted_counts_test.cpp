// Rays that renderings cast: on the SPD scenes, by the SPD's rules, against the counts of an independent
// tracer; on the paper's scenes against the paper's.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <thread>

#include "accel/registry.h"
#include "baselines/register_baselines.h"
#include "harness/rendering.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

struct Expected {
  const char* scene;  ///< generated, or a file
  std::uint32_t width;
  double primary_hits, shadow, reflected, refracted;
  friend std::ostream& operator<<(std::ostream& out, const Expected& expected) {
    return out << expected.scene;
  }
};

class WhittedCounts : public testing::TestWithParam<Expected> {};
class WhittedCountsSlow : public WhittedCounts {};

Rendering render_by_bvh(const Scene& scene, const PictureSize& size, unsigned depth) {
  Registry registry;
  register_baselines(registry);
  const auto structure = registry.build({"counted-bvh", {}}, {scene});
  return render(scene, *structure,
                {.size = size, .depth = depth, .threads = std::thread::hardware_concurrency()});
}

void check(const Expected& expected) {
  std::string scene = expected.scene;
  if (scene.ends_with(".nff")) {
    scene = std::string(RAYMETER_SHARED_DATA) + "/scenes/" + scene;
    if (!std::filesystem::exists(scene)) GTEST_SKIP() << "no shared data";
  }
  const Rendering rendering = render_by_bvh(open_scene(scene), {expected.width, expected.width, true}, 5);
  EXPECT_EQ(rendering.total(RayPurpose::primary).rays, (expected.width + 1) * (expected.width + 1));
  EXPECT_NEAR(double(rendering.total(RayPurpose::primary).hits), expected.primary_hits, 3);
  const auto near = [&](RayPurpose purpose, double rays) {
    EXPECT_NEAR(double(rendering.total(purpose).rays), rays, std::max(3.0, 0.02 * rays));
  };
  near(RayPurpose::shadow, expected.shadow);
  near(RayPurpose::reflection, expected.reflected);
  near(RayPurpose::refraction, expected.refracted);
}

TEST_P(WhittedCounts, AgreeWithAnIndependentTracer) {
  check(GetParam());
}
TEST_P(WhittedCountsSlow, AgreeWithAnIndependentTracer) {
  check(GetParam());
}

/// "balls3" of "spd/balls:size=3" and of "spd/small/balls3.nff".
std::string name_of(const testing::TestParamInfo<Expected>& test) {
  std::string name = std::filesystem::path(test.param.scene).filename().string();
  if (const std::size_t size = name.find(":size="); size != std::string::npos) name.erase(size, 6);
  return name.substr(0, name.find('.'));
}

INSTANTIATE_TEST_SUITE_P(Spd, WhittedCounts,
                         testing::Values(Expected{"spd/balls:size=3", 512, 263169, 918297, 148743, 0},
                                         Expected{"spd/gears:size=2", 512, 243148, 2769239, 447618, 296961},
                                         Expected{"spd/jacks:size=3", 256, 18112, 24360, 29851, 0},
                                         Expected{"spd/lattice:size=6", 512, 250612, 1122201, 212227, 0},
                                         Expected{"spd/mount:size=4", 512, 173250, 411518, 356178, 356178},
                                         // The table says 7: in this file the normals of the patches are
                                         // opposite to their winding, and its tracer shades the side that the
                                         // winding calls the back with the normal reversed.
                                         Expected{"spd/small/nurbtst.nff", 256, 27739, 27739 - 7, 0, 0},
                                         Expected{"spd/rings:size=3", 512, 263169, 942809, 179452, 0},
                                         Expected{"spd/small/sample.nff", 512, 229225, 223226, 0, 0},
                                         Expected{"spd/sombrero:size=1", 512, 112209, 110241, 0, 0},
                                         Expected{"spd/teapot:size=4", 512, 161203, 414724, 228924, 0},
                                         Expected{"spd/tetra:size=5", 512, 53807, 50135, 0, 0},
                                         Expected{"spd/tree:size=8", 512, 166903, 1088877, 0, 0},
                                         Expected{"spd/balls:size=2", 512, 263169, 874391, 113455, 0},
                                         Expected{"spd/jacks:size=2", 256, 10490, 11958, 13546, 0},
                                         Expected{"spd/lattice:size=2", 512, 144389, 602597, 106296, 0},
                                         Expected{"spd/rings:size=1", 512, 263169, 820739, 49862, 0},
                                         Expected{"spd/tree:size=4", 512, 160573, 1069822, 0, 0}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(
    Spd, WhittedCountsSlow,
    testing::Values(Expected{"spd/standard/balls4.nff", 512, 263169, 954971, 175921, 0},
                    Expected{"spd/standard/gears4.nff", 512, 245332, 2253528, 305430, 200952},
                    Expected{"spd/standard/jacks4.nff", 256, 24589, 40812, 51759, 0},
                    Expected{"spd/standard/lattice12.nff", 512, 261170, 1163406, 237005, 0},
                    Expected{"spd/standard/mount6.nff", 512, 173686, 414445, 356178, 356178},
                    Expected{"spd/standard/rings7.nff", 512, 263169, 1084962, 315863, 0},
                    Expected{"spd/standard/sombrero2.nff", 512, 112239, 110608, 0, 0},
                    Expected{"spd/standard/teapot12.nff", 512, 161546, 409139, 226182, 0},
                    Expected{"spd/standard/tetra6.nff", 512, 49950, 46261, 0, 0},
                    Expected{"spd/standard/tree11.nff", 512, 169909, 1097835, 0, 0},
                    Expected{"spd/paper/mount7.nff", 512, 173635, 403845, 356178, 356178},
                    Expected{"spd/paper/teapot15.nff", 512, 161548, 409007, 226078, 0},
                    Expected{"spd/paper/teapot30.nff", 512, 161579, 408882, 226020, 0},
                    Expected{"spd/paper/tetra7.nff", 512, 46596, 42959, 0, 0},
                    Expected{"quadrics/il2_ballstick.nff", 512, 33388, 68902, 28256, 0},
                    Expected{"quadrics/teapot12_stadium500.nff", 512, 263169, 641241, 342186, 0},
                    Expected{"quadrics/waterbox_ballstick.nff", 512, 39339, 74419, 27905, 0}),
    name_of);

/// What the paper says of a scene's rendering at 320x240, and what ours casts.
struct PaperRendering {
  const char* scene;
  unsigned depth;
  double papers_rays;
  std::uint64_t hits, shadow, reflected, refracted;
};

TEST(PaperScenes, CastThePapersNumberOfRays) {
  for (const PaperRendering& paper : {PaperRendering{"paper/1", 4, 274255, 40710, 86157, 84324, 30827},
                                      PaperRendering{"paper/2", 1, 137353, 67514, 59409, 0, 0},
                                      PaperRendering{"paper/3", 2, 157928, 54139, 59802, 20481, 0}}) {
    SCOPED_TRACE(paper.scene);
    const Rendering rendering = render_by_bvh(open_scene(paper.scene), {320, 240}, paper.depth);
    EXPECT_EQ(rendering.total(RayPurpose::primary).hits, paper.hits);
    EXPECT_EQ(rendering.total(RayPurpose::shadow).rays, paper.shadow);
    EXPECT_EQ(rendering.total(RayPurpose::reflection).rays, paper.reflected);
    EXPECT_EQ(rendering.total(RayPurpose::refraction).rays, paper.refracted);
    double rays = 0;
    for (const RayCount& count : rendering.rays) rays += static_cast<double>(count.rays);
    EXPECT_NEAR(rays, paper.papers_rays, 0.1 * paper.papers_rays);
  }
}

}  // namespace
}  // namespace raymeter
