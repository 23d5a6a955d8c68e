#include "baselines/embree.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accel/memory_meter.h"
#include "baselines/embree_device.h"
#include "scenes/base/error.h"
#include "tests/baselines/test_rays.h"

namespace raymeter {
namespace {

std::vector<std::string> queries() {
  std::vector<std::string> all{"1", "4", "8", "16"};
  if (EmbreeQuery::has_streams) all.emplace_back("stream");
  return all;
}

/// All that this CPU has.
std::vector<std::string> isas() {
  std::vector<std::string> all{"default"};
  for (const char* isa : {"sse2", "sse4.2", "avx", "avx2", "avx512"}) {
    all.emplace_back(isa);
    if (isa == embree_default_isa()) break;
  }
  return all;
}

/// The part of the rays for which both say the same, last bits of t aside.
double agreement(std::span<const Hit> a, std::span<const Hit> b) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    same += a[i].primitive == b[i].primitive &&
            (!a[i].found() || std::abs(a[i].t - b[i].t) <= 1e-4f * std::abs(a[i].t));
  return static_cast<double>(same) / static_cast<double>(a.size());
}

/// Of two coincident triangles (mixed_scene has such neighbours) the first: which of them Embree names
/// depends on its tree.
std::vector<Hit> first_of_coincident(const Scene& scene, std::vector<Hit> hits) {
  const auto triangles = scene.triangles();
  for (Hit& hit : hits)
    if (hit.primitive > 0 && hit.primitive < triangles.size() &&
        triangles[hit.primitive] == triangles[hit.primitive - 1])
      --hit.primitive;
  return hits;
}

double agreement(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
  return static_cast<double>(same) / static_cast<double>(a.size());
}

struct Round {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> occluded;
  friend bool operator==(const Round&, const Round&) = default;
};

/// As the harness does: prepare the batch, then trace it in chunks.
Round trace_in_chunks(Structure& structure, std::span<const Ray> rays, std::size_t chunk, int rounds) {
  Round last{std::vector<Hit>(rays.size()), std::vector<std::uint8_t>(rays.size())};
  for (const QueryKind query : {QueryKind::closest, QueryKind::any}) {
    structure.prepare({rays, query});
    for (int round = 0; round < rounds; ++round)
      for (std::size_t first = 0; first < rays.size(); first += chunk) {
        const std::size_t count = std::min(chunk, rays.size() - first);
        BatchView view{rays.subspan(first, count), query};
        view.first = first;
        if (query == QueryKind::closest)
          structure.trace_closest(view, std::span(last.hits).subspan(first, count));
        else
          structure.trace_any(view, std::span(last.occluded).subspan(first, count));
      }
  }
  return last;
}

TEST(Embree, AgreesWithBruteForceInEveryForm) {
  for (const Scene& scene : {mixed_scene(1, 300, 60), terrain_scene(2, 14), mixed_scene(3, 300, 0)}) {
    const auto rays = random_rays(4, 1501);
    const auto truth = build("brute-force", scene);
    const auto hits = first_of_coincident(scene, closest(*truth, rays));
    const auto occluded = any(*truth, rays);
    for (const std::string& isa : isas())
      for (const std::string& query : queries())
        for (const char* quality : {"low", "medium", "high"})
          for (const char* robust : {"off", "on"}) {
            const auto spec =
                fmt::format("embree:quality={}:robust={}:isa={}:query={}", quality, robust, isa, query);
            const auto structure = build(spec, scene);
            const auto answers = first_of_coincident(scene, closest(*structure, rays));
            EXPECT_GE(agreement(answers, hits), 0.999) << spec << " of " << scene.name();
            EXPECT_GE(agreement(any(*structure, rays), occluded), 0.999) << spec << " of " << scene.name();
          }
  }
}

TEST(Embree, LowQualityIsTheTreeOfMortonCodes) {
  const Scene scene = terrain_scene(1, 100);
  const auto bytes = [&](const char* spec) { return double(build(spec, scene)->stats().bytes); };
  EXPECT_GT(bytes("embree:quality=low"), 1.2 * bytes("embree"));  // its leaves are not as full
}

TEST(Embree, FindsQuadricsToTheBit) {
  const Scene scene = mixed_scene(5, 0, 90);
  const auto rays = random_rays(6, 5000);
  const auto truth = build("brute-force", scene);
  const auto hits = closest(*truth, rays);
  for (const std::string& query : queries()) {
    const auto structure = build("embree:robust=on:query=" + query, scene);
    EXPECT_EQ(closest(*structure, rays), hits) << query;
    EXPECT_EQ(any(*structure, rays), any(*truth, rays)) << query;
  }
}

TEST(Embree, AnswersTheSameInPlaceAndConvertedInEveryRound) {
  const Scene scene = mixed_scene(7, 200, 40);
  auto rays = random_rays(8, 1000);
  const auto odd = adversarial_rays(9, 1003, scene);  // not a multiple of any packet
  rays.insert(rays.end(), odd.begin(), odd.end());
  for (const std::string& query : queries()) {
    const auto in_place = build("embree:rays=in-place:query=" + query, scene);
    const auto converted = build("embree:rays=converted:query=" + query, scene);
    const Round once = trace_in_chunks(*in_place, rays, rays.size(), 1);
    EXPECT_EQ(trace_in_chunks(*in_place, rays, rays.size(), 3), once) << query;
    EXPECT_EQ(trace_in_chunks(*converted, rays, rays.size(), 2), once) << query;
    EXPECT_EQ(trace_in_chunks(*in_place, rays, 256, 2), once) << query;

    // Chunks that cut packets form other packets, whose last bits may differ.
    const Round cut = trace_in_chunks(*in_place, rays, 101, 2);
    EXPECT_GE(agreement(cut.hits, once.hits), 0.99) << query;
    EXPECT_GE(agreement(cut.occluded, once.occluded), 0.99) << query;
  }
}

TEST(Embree, SurvivesEveryRayAndSaysWhatItDidNotAnswer) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = no_hit;
  const Scene scene = mixed_scene(10, 200, 50);
  const auto adversarial = adversarial_rays(11, 3000, scene);
  const Ray good{{3, 0.1f, 0.2f}, 0, {-1, 0, 0}, infinity};
  std::vector<Ray> misses(8, good), not_given(6, good);
  misses[0].origin.x = nan;
  misses[1].direction.y = infinity;
  misses[2].direction = {};
  misses[3].tnear = nan;
  misses[4].tfar = nan;
  misses[5].tnear = 1, misses[5].tfar = 1;
  misses[6].tnear = infinity;
  misses[7].tnear = -1, misses[7].tfar = -2;
  not_given[0].tnear = -1;
  not_given[1].tnear = -infinity;
  not_given[2].origin.z = 2e18f;
  not_given[3].direction.z = -3e38f;
  not_given[4].origin.x = 1e30f;
  not_given[5].tnear = -3, not_given[5].tfar = -1;
  for (const std::string& query : queries())
    for (const char* layout : {"in-place", "converted"}) {
      const auto structure = build(fmt::format("embree:query={}:rays={}", query, layout), scene);
      trace_in_chunks(*structure, adversarial, adversarial.size(), 1);
      const Round none = trace_in_chunks(*structure, misses, misses.size(), 2);
      EXPECT_EQ(none.hits, std::vector<Hit>(misses.size()));
      EXPECT_EQ(none.occluded, std::vector<std::uint8_t>(misses.size(), 0));
      const Round unknown = trace_in_chunks(*structure, not_given, not_given.size(), 2);
      EXPECT_EQ(unknown.hits, std::vector<Hit>(not_given.size(), Hit{no_hit, not_answered}));
      EXPECT_FALSE(unknown.hits[0].found());
      EXPECT_EQ(unknown.occluded, std::vector<std::uint8_t>(not_given.size(), occlusion_not_answered));
    }
}

TEST(Embree, TakesScenesOfAnySizeAndRefusesHugeCoordinates) {
  const auto rays = random_rays(12, 50);
  for (const auto& scene : {mixed_scene(1, 0, 0), mixed_scene(2, 1, 0), mixed_scene(3, 0, 1)}) {
    const auto structure = build("embree", scene);
    EXPECT_EQ(agreement(closest(*structure, rays), closest(*build("brute-force", scene), rays)), 1);
  }
  SceneData data;
  data.vertices = {{0, 0, 0}, {2e18f, 0, 0}, {0, 1, 0}};
  data.triangles = {{0, 1, 2}};
  const Scene huge{std::move(data)};
  EXPECT_THROW(build("embree", huge), Error);
}

TEST(Embree, KeepsToItsMemoryLimitAndReportsItsMemory) {
  const Scene scene = mixed_scene(13, 20000, 100);
  Registry registry;
  register_baselines(registry);
  EXPECT_THROW(registry.build(parse_spec("embree"), {scene, 1, 100000}), MemoryLimitExceeded);
  EXPECT_THROW(registry.build(parse_spec("embree"), {scene, 2, 0}), MemoryLimitExceeded);

  const auto stats = registry.build(parse_spec("embree"), {scene, 1})->stats();
  EXPECT_GT(stats.bytes, 20000u * 30);
  EXPECT_LT(stats.bytes, 20000u * 300);
  EXPECT_GE(stats.peak_bytes, stats.bytes);
  ASSERT_EQ(stats.bytes_by_part.size(), 1u);
  EXPECT_EQ(stats.bytes_by_part[0].second, stats.bytes);
}

TEST(Embree, SaysWhichVersionIsLoaded) {
  const std::string version = embree_version();
  EXPECT_TRUE(version.starts_with(std::to_string(RTC_VERSION_MAJOR) + ".")) << version;
  EXPECT_EQ(std::count(version.begin(), version.end(), '.'), 2) << version;
}

TEST(Embree, RefusesWhatItDoesNotHave) {
  const Scene scene = mixed_scene(14, 5, 0);
  EXPECT_THROW(build("embree:isa=avx1024", scene), Error);
  EXPECT_THROW(build("embree:query=2", scene), Error);
  EXPECT_FALSE(build("embree", scene)->counts());
}

TEST(Embree, RefusesAnInstructionSetThatTheCpuLacks) {
  if (embree_default_isa() == "avx512") GTEST_SKIP() << "this CPU has them all";
  const Scene scene = mixed_scene(14, 5, 0);
  EXPECT_THROW(build("embree:isa=avx512", scene), Error);
}

}  // namespace
}  // namespace raymeter
