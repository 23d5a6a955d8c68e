#include "harness/truth.h"

#include <gtest/gtest.h>

#include "harness/grading.h"
#include "scenes/geometry/decide.h"
#include "tests/harness/test_scenes.h"

namespace raymeter {
namespace {

TEST(BruteForce, IsDecideOverEveryPrimitive) {
  const Scene scene = random_scene(80);
  const RayBatch batch = random_batch(1500, QueryKind::closest);
  const BatchAnswers closest = brute_force(scene, batch.rays, QueryKind::closest);
  const BatchAnswers any = brute_force(scene, batch.rays, QueryKind::any);
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    std::vector<Hit> hits;
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      const float t = decide(batch.rays[i], scene.triangle(p));
      if (t != no_hit) hits.push_back({t, p});
    }
    std::sort(hits.begin(), hits.end());
    ASSERT_EQ(closest.hits[i], hits.empty() ? Hit{} : hits.front());
    ASSERT_EQ(any.occluded[i], hits.empty() ? 0 : 1);
    ASSERT_EQ(all_hits(scene, batch.rays[i]), hits);
  }
  EXPECT_GT(count_hits(closest), 300u);
}

/// A scene and a batch too large for the budget: 100 rays are sampled, 1000 disputes can be settled.
class LargeBatch : public ::testing::TestWithParam<QueryKind> {
 protected:
  static constexpr std::size_t rays = 6000;
  LargeBatch() {
    settings.sample = 100;
    settings.test_budget = 1000 * 50;
  }

  /// Contradicts the truth.
  void lie(BatchAnswers& answers, std::size_t ray) const {
    if (batch.query == QueryKind::closest)
      answers.hits[ray] = answers.hits[ray].found() ? Hit{} : Hit{0.5f, 3};
    else
      answers.occluded[ray] ^= 1u;
  }
  Grades grade_exact(const Truth& established, const BatchAnswers& answers) const {
    const Grades grades = grade(scene, batch, established, {answers, Answers::exact});
    EXPECT_EQ(grades.total(), rays);
    return grades;
  }
  /// The first ray that is, or is not, in the sample.
  std::size_t first_ray(bool proved) const {
    const Truth plain = establish_truth(scene, batch, truth, settings);
    return static_cast<std::size_t>(std::find(plain.proved.begin(), plain.proved.end(), proved ? 1 : 0) -
                                    plain.proved.begin());
  }

  Scene scene = random_scene(50);
  RayBatch batch = random_batch(rays, GetParam());
  BatchAnswers truth = brute_force(scene, batch.rays, GetParam());
  TruthSettings settings;
};

TEST_P(LargeBatch, TheReferenceIsProvedOnASeededSample) {
  const Truth established = establish_truth(scene, batch, truth, settings);
  EXPECT_EQ(established.answers, truth);
  EXPECT_EQ(established.brute_forced, 100u);
  EXPECT_EQ(std::count(established.proved.begin(), established.proved.end(), 1), 100);
  EXPECT_EQ(grade_exact(established, truth).right, rays);
  EXPECT_EQ(establish_truth(scene, batch, truth, settings).proved, established.proved);
  settings.seed = 2;
  EXPECT_NE(establish_truth(scene, batch, truth, settings).proved, established.proved);
}

TEST_P(LargeBatch, OnlyTheLiarIsWrong) {
  BatchAnswers liar = truth;
  for (std::size_t ray = 0; ray < 500; ++ray) lie(liar, 3 * ray);
  for (const bool liar_first : {true, false}) {
    Truth established = establish_truth(scene, batch, liar_first ? liar : truth, settings);
    const std::size_t refuted =
        settle_disputes(scene, batch, {liar_first ? truth : liar, Answers::exact}, established, settings);
    EXPECT_EQ(refuted > 0, liar_first);
    EXPECT_EQ(established.answers, truth);
    EXPECT_EQ(grade_exact(established, truth).right, rays);
    EXPECT_EQ(grade_exact(established, liar).wrong, 500u);
    EXPECT_EQ(grade_exact(established, liar).right, rays - 500);
  }
}

TEST_P(LargeBatch, AFaultOfTheReferenceIsCaughtInTheSample) {
  BatchAnswers liar = truth;
  lie(liar, first_ray(true));
  const Truth established = establish_truth(scene, batch, liar, settings);
  EXPECT_EQ(established.answers, truth);
  EXPECT_EQ(grade_exact(established, liar).wrong, 1u);
}

TEST_P(LargeBatch, AFaultOfTheReferenceIsCaughtByAForeignRow) {
  BatchAnswers liar = truth;
  lie(liar, first_ray(false));
  Truth established = establish_truth(scene, batch, liar, settings);
  const Row foreign{truth, Answers::within_bound};
  EXPECT_EQ(settle_disputes(scene, batch, foreign, established, settings), 1u);
  EXPECT_EQ(established.answers, truth);
  EXPECT_EQ(established.brute_forced, 101u);
  EXPECT_EQ(grade_exact(established, liar).wrong, 1u);
  EXPECT_EQ(grade(scene, batch, established, foreign).right, rays);
}

TEST_P(LargeBatch, ManyFalseDoubtsTakeNothingFromTheOthers) {
  BatchAnswers liar = truth;
  for (std::size_t ray = 0; ray < rays; ++ray) lie(liar, ray);
  for (const Answers policy : {Answers::exact, Answers::within_bound}) {
    Truth established = establish_truth(scene, batch, truth, settings);
    EXPECT_EQ(settle_disputes(scene, batch, {liar, policy}, established, settings), 0u);
    EXPECT_EQ(established.brute_forced, 1100u) << "the sample, and as many disputes as the budget allows";
    EXPECT_EQ(grade_exact(established, truth).right, rays);
    const Grades grades = grade_exact(established, liar);
    EXPECT_EQ(grades.wrong, 1100u);
    EXPECT_EQ(grades.unexplained, rays - 1100) << "not proved wrong";
  }
}

TEST_P(LargeBatch, SmallOnesAreProvedWhole) {
  const Truth established = establish_truth(scene, batch, {});
  EXPECT_EQ(established.brute_forced, rays);
  EXPECT_EQ(established.answers, truth);
}

INSTANTIATE_TEST_SUITE_P(Truth, LargeBatch, ::testing::Values(QueryKind::closest, QueryKind::any));

TEST(Truth, OfNothing) {
  const Scene scene = random_scene(0);
  for (const std::size_t rays : {0u, 10u}) {
    const RayBatch batch = random_batch(rays, QueryKind::closest);
    const Truth truth = establish_truth(scene, batch, {});
    EXPECT_EQ(truth.brute_forced, rays);
    EXPECT_EQ(count_hits(truth.answers), 0u);
  }
}

}  // namespace
}  // namespace raymeter
