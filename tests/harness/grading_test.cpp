#include "harness/grading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/harness/test_scenes.h"

namespace raymeter {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The lower left half of the unit square at height z, facing rays along +z.
Triangle facing(float z) {
  return {{0, 0, z}, {1, 0, z}, {0, 1, z}};
}

Scene scene_of(const std::vector<Triangle>& triangles, const std::vector<Quadric>& quadrics = {}) {
  SceneData data;
  data.name = "fabricated";
  for (const Triangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(data.vertices.size());
    data.vertices.insert(data.vertices.end(), {t.a, t.b, t.c});
    data.triangles.push_back({first, first + 1, first + 2});
  }
  data.quadrics = quadrics;
  return Scene(std::move(data));
}

/// From z = -1 along +z.
Ray forward(float x, float y, float tnear = 0, float tfar = infinity) {
  return {{x, y, -1}, tnear, {0, 0, 1}, tfar};
}

Grade grade_row(const Scene& scene, const RayBatch& batch, const BatchAnswers& answers, Answers policy) {
  const Truth truth = establish_truth(scene, batch, {});
  EXPECT_EQ(truth.brute_forced, 1u);
  const Grades grades = grade(scene, batch, truth, {answers, policy});
  EXPECT_EQ(grades.total(), 1u);
  for (std::size_t i = 0; i < grade_count; ++i)
    if (grades[static_cast<Grade>(i)]) return static_cast<Grade>(i);
  return Grade::unexplained;
}

/// The grade of a fabricated answer; as an exact row's it must be right or wrong.
Grade grade_of(const Scene& scene, const Ray& ray, const Hit& answer) {
  RayBatch batch;
  batch.rays = {ray};
  BatchAnswers answers;
  answers.hits = {answer};
  const Grade grade = grade_row(scene, batch, answers, Answers::within_bound);
  EXPECT_EQ(grade_row(scene, batch, answers, Answers::exact), grade == Grade::right ? grade : Grade::wrong);
  return grade;
}

Grade grade_of(const Scene& scene, const Ray& ray, std::uint8_t occluded) {
  RayBatch batch;
  batch.query = QueryKind::any;
  batch.rays = {ray};
  BatchAnswers answers;
  answers.occluded = {occluded};
  const Grade grade = grade_row(scene, batch, answers, Answers::within_bound);
  EXPECT_EQ(grade_row(scene, batch, answers, Answers::exact), grade == Grade::right ? grade : Grade::wrong);
  return grade;
}

const Hit miss;
constexpr std::uint8_t clear = 0, blocked = 1;

TEST(Grading, OfTheTruthIsRight) {
  const Scene scene = scene_of({facing(0)});
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), Hit{1, 0}), Grade::right);
  EXPECT_EQ(grade_of(scene, forward(0.75f, 0.75f), miss), Grade::right);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), blocked), Grade::right);
  EXPECT_EQ(grade_of(scene, forward(0.75f, 0.75f), clear), Grade::right);
}

TEST(Grading, AMissIsAMissWhateverItsT) {
  const Scene scene = scene_of({facing(0)});
  RayBatch batch;
  batch.rays = {forward(0.75f, 0.75f)};
  BatchAnswers answers;
  answers.hits = {{7, no_primitive}};
  EXPECT_EQ(grade_row(scene, batch, answers, Answers::within_bound), Grade::right);
  EXPECT_EQ(grade_row(scene, batch, answers, Answers::exact), Grade::wrong);
  // Nor does a large batch take it for a contradiction.
  TruthSettings settings;
  settings.test_budget = 0;
  settings.sample = 0;
  Truth truth = establish_truth(scene, batch, brute_force(scene, batch.rays, batch.query), settings);
  settings.test_budget = 1;
  settle_disputes(scene, batch, {answers, Answers::within_bound}, truth, settings);
  EXPECT_EQ(truth.brute_forced, 0u);
}

TEST(Grading, LastBitsOfTAreWithinBound) {
  const Scene scene = scene_of({facing(0)});
  const Ray ray = forward(0.25f, 0.25f);
  EXPECT_EQ(grade_of(scene, ray, Hit{1 + 0x1p-22f, 0}), Grade::within_bound);
  EXPECT_EQ(grade_of(scene, ray, Hit{1 - 0x1p-23f, 0}), Grade::within_bound);
  EXPECT_EQ(grade_of(scene, ray, Hit{1 + 0x1p-14f, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, Hit{0.5f, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, Hit{std::nanf(""), 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, Hit{infinity, 0}), Grade::wrong);
}

TEST(Grading, AnotherPrimitiveIsATieWithinTwoUlps) {
  for (const float ulps : {0.0f, 1.0f, 2.0f}) {
    const Scene scene = scene_of({facing(0), facing(ulps * 0x1p-23f)});
    EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), Hit{1 + ulps * 0x1p-23f, 1}), Grade::tie) << ulps;
  }
  const Scene close = scene_of({facing(0), facing(4 * 0x1p-23f)}),
              apart = scene_of({facing(0), facing(0x1p-10f)});
  EXPECT_EQ(grade_of(close, forward(0.25f, 0.25f), Hit{1 + 4 * 0x1p-23f, 1}), Grade::within_bound);
  EXPECT_EQ(grade_of(apart, forward(0.25f, 0.25f), Hit{1 + 0x1p-10f, 1}), Grade::wrong);
}

TEST(Grading, AHitDroppedOrInventedAtAnEdge) {
  const Scene scene = scene_of({facing(0)});
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0), miss), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0), clear), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(0, 0), miss), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(0.25f, -0x1p-22f), Hit{1, 0}), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(0.25f, -0x1p-22f), blocked), Grade::edge);
  // Not at that t, and not so far from the edge.
  EXPECT_EQ(grade_of(scene, forward(0.25f, -0x1p-22f), Hit{2, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, -0x1p-10f), Hit{1, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, -0x1p-10f), blocked), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0x1p-10f), miss), Grade::wrong);
}

TEST(Grading, EveryPrimitiveInFrontOfTheAnswerMustBeExplained) {
  // The ray meets the first at its edge, and the other two well inside.
  const Triangle shifted{{0, -0.5f, 1}, {1, -0.5f, 1}, {0, 1, 1}},
      behind{{0, -0.5f, 2}, {1, -0.5f, 2}, {0, 1, 2}};
  const Scene scene = scene_of({facing(0), shifted, behind});
  const Ray ray = forward(0.25f, 0);
  EXPECT_EQ(grade_of(scene, ray, Hit{2, 1}), Grade::edge);
  EXPECT_EQ(grade_of(scene, ray, Hit{3, 2}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, miss), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, clear), Grade::wrong);
}

TEST(Grading, ADroppedOrInventedSolidHitIsWrong) {
  const Scene scene = scene_of({facing(0), facing(1)});
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), miss), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), Hit{2, 1}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), clear), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.9f, 0.9f), Hit{1, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.9f, 0.9f), blocked), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), Hit{1, 77}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), std::uint8_t{3}), Grade::wrong);
}

TEST(Grading, AHitAtTheEndsOfTheInterval) {
  const Scene scene = scene_of({facing(0)});
  const float below = std::nextafter(1.0f, 0.0f);
  const Ray ends_at = forward(0.25f, 0.25f, 0, 1), begins_at = forward(0.25f, 0.25f, 1),
            ends_before = forward(0.25f, 0.25f, 0, below);
  EXPECT_EQ(grade_of(scene, ends_at, miss), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, ends_at, clear), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, begins_at, Hit{1, 0}), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, begins_at, blocked), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, ends_before, Hit{below, 0}), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, ends_before, blocked), Grade::at_limit);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f, 0, 0.9f), Hit{1, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f, 0, 0.9f), blocked), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f, 0, 1.1f), miss), Grade::wrong);
}

TEST(Grading, AlongTheSurfaceIsGrazing) {
  const Scene scene = scene_of({facing(0)});
  Ray ray{{-1, 0.25f, -1.25f * 0x1p-14f}, 0, {1, 0, 0x1p-14f}, infinity};  // meets (0.25, 0.25, 0)
  EXPECT_EQ(grade_of(scene, ray, miss), Grade::grazing);
  EXPECT_EQ(grade_of(scene, ray, clear), Grade::grazing);
  ray.origin.z = -3 * 0x1p-14f;  // meets the plane at x = 2, beyond the triangle
  EXPECT_EQ(grade_of(scene, ray, Hit{1.25f, 0}), Grade::grazing);
  EXPECT_EQ(grade_of(scene, ray, Hit{9, 0}), Grade::wrong);
  ray.origin.z = -0.25f;  // as flat, but far above
  EXPECT_EQ(grade_of(scene, ray, Hit{1.25f, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, blocked), Grade::wrong);
}

TEST(Grading, ASliverIsDegenerate) {
  const Scene scene = scene_of({{{0, 0, 0}, {1, 0, 0}, {0.5f, 0x1p-22f, 0}}});
  EXPECT_EQ(grade_of(scene, forward(0.5f, 0x1p-23f), miss), Grade::degenerate);
  EXPECT_EQ(grade_of(scene, forward(0.5f, 0x1p-23f), clear), Grade::degenerate);
  EXPECT_EQ(grade_of(scene, forward(0.5f, 0x1p-16f), Hit{1, 0}), Grade::degenerate);
  EXPECT_EQ(grade_of(scene, forward(0.5f, 0.1f), Hit{1, 0}), Grade::wrong);
  // Without any area it is never hit; a kernel may think otherwise.
  const Scene line = scene_of({{{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0}}, facing(3)});
  EXPECT_EQ(grade_of(line, forward(0.25f, 0), Hit{1, 0}), Grade::degenerate);
  EXPECT_EQ(grade_of(line, forward(0.25f, 0.25f), Hit{1, 0}), Grade::wrong);
}

TEST(Grading, OfQuadrics) {
  const Quadric ball{QuadricKind::sphere, {0, 0, 4}, 1, {}, 0};
  const Quadric tube{QuadricKind::cylinder, {4, -1, 4}, 1, {4, 1, 4}, 1};
  const Scene scene = scene_of({}, {ball, tube});
  EXPECT_EQ(grade_of(scene, forward(0, 0), Hit{4, 0}), Grade::right);
  EXPECT_EQ(grade_of(scene, forward(0, 0), Hit{4 + 0x1p-21f, 0}), Grade::within_bound);
  EXPECT_EQ(grade_of(scene, forward(0, 0), Hit{6, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(0, 0), miss), Grade::wrong);
  // The silhouette, touched and just not.
  EXPECT_EQ(grade_of(scene, forward(1, 0), miss), Grade::grazing);
  EXPECT_EQ(grade_of(scene, forward(1 + 0x1p-23f, 0), Hit{5, 0}), Grade::grazing);
  EXPECT_EQ(grade_of(scene, forward(1 + 0x1p-23f, 0), blocked), Grade::grazing);
  EXPECT_EQ(grade_of(scene, forward(1.01f, 0), Hit{5, 0}), Grade::wrong);
  // The rim of the tube, on it and just above.
  EXPECT_EQ(grade_of(scene, forward(4, 1), miss), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(4, 1 + 0x1p-22f), Hit{4, 1}), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(4, 1 + 0x1p-22f), blocked), Grade::edge);
  EXPECT_EQ(grade_of(scene, forward(4, 1.01f), Hit{4, 1}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(4, 0), miss), Grade::wrong);
  EXPECT_EQ(grade_of(scene, forward(4, 0, 0, 4), miss), Grade::at_limit);
}

TEST(Grading, WithheldAnswersAreNotGiven) {
  const Scene scene = scene_of({facing(0)});
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), Hit{no_hit, not_answered}), Grade::not_given);
  EXPECT_EQ(grade_of(scene, forward(0.25f, 0.25f), occlusion_not_answered), Grade::not_given);
  EXPECT_EQ(grade_of(scene, forward(0.75f, 0.75f), occlusion_not_answered), Grade::not_given);
}

TEST(Grading, RaysThatMissByDefinition) {
  const Scene scene = scene_of({facing(0)});
  const Ray ray{{0.25f, 0.25f, -1}, 0, {0, 0, std::nanf("")}, infinity};
  EXPECT_EQ(grade_of(scene, ray, miss), Grade::right);
  EXPECT_EQ(grade_of(scene, ray, Hit{1, 0}), Grade::wrong);
  EXPECT_EQ(grade_of(scene, ray, blocked), Grade::wrong);
}

TEST(Grading, WhatIsNotExaminedIsUnexplained) {
  const Scene scene = random_scene(50);
  const RayBatch batch = random_batch(1000, QueryKind::closest);
  const Truth truth = establish_truth(scene, batch, {});
  BatchAnswers blind;
  blind.hits.resize(1000);
  const auto misses = 1000 - count_hits(truth.answers);
  // The budget suffices for ten rays.
  const Grades grades = grade(scene, batch, truth, {blind, Answers::within_bound}, 500);
  EXPECT_EQ(grades.total(), 1000u);
  EXPECT_EQ(grades.right, misses);
  EXPECT_EQ(grades.wrong + grades.edge + grades.grazing, 10u);
  EXPECT_EQ(grades.unexplained, 1000 - misses - 10);
  EXPECT_FALSE(grades.faultless());
}

TEST(Grading, NamesEveryGrade) {
  EXPECT_EQ(name_of(Grade::right), "right");
  EXPECT_EQ(name_of(Grade::unexplained), "unexplained");
  Grades grades;
  for (std::size_t i = 0; i < grade_count; ++i) grades[static_cast<Grade>(i)] = i + 1;
  EXPECT_EQ(grades.right, 1u);
  EXPECT_EQ(grades.at_limit, 6u);
  EXPECT_EQ(grades.unexplained, 10u);
  EXPECT_EQ(grades.total(), 55u);
}

}  // namespace
}  // namespace raymeter
