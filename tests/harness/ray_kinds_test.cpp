#include "harness/ray_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

std::string complaint(std::string_view text) {
  try {
    ray_arguments(parse_spec(text));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(RayKinds, DefaultsAreValidAndWrittenOut) {
  for (const RayKind& kind : ray_kinds()) {
    const Arguments arguments = ray_arguments({kind.name, {}});
    // Read again, the canonical form is checked against the limits: so are the defaults in it.
    EXPECT_EQ(ray_arguments(parse_spec(arguments.canonical())).canonical(), arguments.canonical());
  }
  EXPECT_EQ(ray_arguments(parse_spec("ao:length=5e-2")).canonical(), "ao:length=0.05:samples=1");
}

TEST(RayKinds, ComplaintsSayWhatThereIs) {
  EXPECT_THAT(complaint("caustic"), testing::HasSubstr("primary, shadow, reflection, diffuse, ao, random"));
  EXPECT_THAT(complaint("whitted:depth=0"), testing::HasSubstr("1..64"));
  EXPECT_THAT(complaint("ao:length=0"), testing::HasSubstr("length"));
  EXPECT_THAT(complaint("diffuse:samples=0"), testing::HasSubstr("1..4096"));
  EXPECT_THAT(complaint("shadow:samples=2"), testing::HasSubstr("takes no parameters"));
}

}  // namespace
}  // namespace raymeter
