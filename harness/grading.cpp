#include "harness/grading.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "accel/primitive_test.h"
#include "harness/dispute.h"

namespace raymeter {
namespace {

struct GradeName {
  std::string_view name;
  std::uint64_t Grades::* count;
};
constexpr std::array<GradeName, grade_count> grade_table = {{
    {"right", &Grades::right},
    {"within_bound", &Grades::within_bound},
    {"tie", &Grades::tie},
    {"edge", &Grades::edge},
    {"grazing", &Grades::grazing},
    {"at_limit", &Grades::at_limit},
    {"degenerate", &Grades::degenerate},
    {"wrong", &Grades::wrong},
    {"not_given", &Grades::not_given},
    {"unexplained", &Grades::unexplained},
}};

/// One primitive's part in an answer: its best explanation, or wrong.
Grade or_wrong(std::optional<Grade> explanation) {
  return explanation.value_or(Grade::wrong);
}

Grade grade_closest(const Scene& scene, const Ray& ray, const Hit& truth, const Hit& answer) {
  const std::vector<Hit> hits = all_hits(scene, ray);
  // The truth was agreed, not proved, and is refuted here: nothing can be said of this ray.
  if ((hits.empty() ? Hit{} : hits.front()) != truth) return Grade::unexplained;
  Grade grade = Grade::right;
  const auto find = [&](Grade part) { grade = std::max(grade, part); };

  // The primitive that the answer names: is it hit, and there?
  double answer_t = no_hit, answer_bound = 0;
  if (answer.found()) {
    if (answer.primitive >= scene.primitive_count()) return Grade::wrong;
    answer_bound = t_bound(scene, ray, answer.primitive, answer.t);
    const auto hit =
        std::find_if(hits.begin(), hits.end(), [&](const Hit& h) { return h.primitive == answer.primitive; });
    if (hit == hits.end()) {
      find(or_wrong(explain_invented(scene, ray, answer.primitive, answer.t)));
      answer_t = answer.t;
    } else {
      answer_t = hit->t;
      if (answer.t == hit->t) {
      } else if (std::abs(double(answer.t) - double(hit->t)) <= t_bound(scene, ray, hit->primitive, hit->t)) {
        find(Grade::within_bound);
      } else {
        find(or_wrong(explain_missed(scene, ray, hit->primitive, hit->t)));
      }
    }
  }

  // Every primitive hit before it must have been overlooked for a reason.
  for (const Hit& hit : hits) {
    if (hit.t > answer_t) break;
    if (hit.primitive == answer.primitive) continue;
    if (answer.found() && within_2_ulp(hit.t, static_cast<float>(answer_t))) {
      find(Grade::tie);
    } else if (answer.found() &&
               answer_t - hit.t <= answer_bound + t_bound(scene, ray, hit.primitive, hit.t)) {
      find(Grade::within_bound);
    } else {
      find(or_wrong(explain_missed(scene, ray, hit.primitive, hit.t)));
    }
  }
  return grade;
}

Grade grade_any(const Scene& scene, const Ray& ray, std::uint8_t truth, std::uint8_t answer) {
  if (answer > 1) return Grade::wrong;
  const std::vector<Hit> hits = all_hits(scene, ray);
  if (hits.empty() == (truth != 0)) return Grade::unexplained;
  if (truth != 0) {
    // Every primitive that occludes the ray must have been overlooked for a reason.
    Grade grade = Grade::right;
    for (const Hit& hit : hits)
      grade = std::max(grade, or_wrong(explain_missed(scene, ray, hit.primitive, hit.t)));
    return grade;
  }
  // One primitive that nearly occludes the ray explains the answer.
  Grade grade = Grade::wrong;
  for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive)
    grade = std::min(grade, or_wrong(explain_invented(scene, ray, primitive, std::nullopt)));
  return grade;
}

}  // namespace

std::string_view name_of(Grade grade) {
  return grade_table[static_cast<std::size_t>(grade)].name;
}

std::uint64_t& Grades::operator[](Grade grade) {
  return this->*grade_table[static_cast<std::size_t>(grade)].count;
}

std::uint64_t Grades::operator[](Grade grade) const {
  return this->*grade_table[static_cast<std::size_t>(grade)].count;
}

std::uint64_t Grades::total() const {
  std::uint64_t sum = 0;
  for (const GradeName& row : grade_table) sum += this->*row.count;
  return sum;
}

Grades grade(const Scene& scene, const RayBatch& batch, const Truth& truth, const Row& row,
             double test_budget) {
  const bool closest = batch.query == QueryKind::closest;
  Grades grades;
  std::vector<std::size_t> disputed;
  for (std::size_t ray = 0; ray < batch.rays.size(); ++ray) {
    const bool equal = closest ? row.answers.hits[ray] == truth.answers.hits[ray]
                               : row.answers.occluded[ray] == truth.answers.occluded[ray];
    const bool given = closest ? row.answers.hits[ray].primitive != not_answered
                               : row.answers.occluded[ray] != occlusion_not_answered;
    if (equal) {
      ++grades.right;
    } else if (row.policy == Answers::exact) {
      // Where brute force did not decide, the reference may be wrong as well as this row.
      ++(truth.proved[ray] ? grades.wrong : grades.unexplained);
    } else if (!given) {
      ++grades.not_given;
    } else if (const auto plain = closest ? explain_hit(scene, batch.rays[ray], truth.answers.hits[ray],
                                                        row.answers.hits[ray])
                                          : std::nullopt) {
      ++grades[*plain];
    } else {
      disputed.push_back(ray);
    }
  }

  // The few that are left cost a pass over the whole scene each.
  const double cost = std::max<double>(1, static_cast<double>(scene.primitive_count()));
  const std::size_t examined = std::min(disputed.size(), static_cast<std::size_t>(test_budget / cost));
  grades.unexplained += disputed.size() - examined;
  std::vector<Grade> found(examined);
  tbb::parallel_for(std::size_t{0}, examined, [&](std::size_t i) {
    const std::size_t ray = disputed[i];
    found[i] =
        closest ? grade_closest(scene, batch.rays[ray], truth.answers.hits[ray], row.answers.hits[ray])
                : grade_any(scene, batch.rays[ray], truth.answers.occluded[ray], row.answers.occluded[ray]);
  });
  for (const Grade grade : found) ++grades[grade];
  return grades;
}

}  // namespace raymeter
