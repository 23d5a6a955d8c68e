#include "scenes/base/spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

const std::vector<Parameter> table{
    {"cells", ParameterType::vector, "0", "cells along an axis", 1, 4096},
    {"amount", ParameterType::number, "1", "relative subdivision amount", 1e-3, 1e3},
    {"mailbox", ParameterType::flag, "off", "remember tests"},
    {"rule", ParameterType::choice, "paper", "which rule", 0, 0, {"paper", "woo"}},
    {"label", ParameterType::text, "", "anything"},
};

std::string canonical(std::string_view text) {
  return Arguments(parse_spec(text), table).canonical();
}

std::string complaint(std::string_view text) {
  try {
    canonical(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Spec, ListsFormTheProductLastFastest) {
  const auto specs = parse_specs("grid:cells=4,8:mailbox=on,off");
  ASSERT_EQ(specs.size(), 4u);
  EXPECT_EQ(specs[1].parameters[0].second, "4");
  EXPECT_EQ(specs[1].parameters[1].second, "off");
  EXPECT_EQ(specs[2].parameters[0].second, "8");
}

TEST(Spec, CanonicalFormHasEveryParameterInTableOrder) {
  EXPECT_EQ(canonical("grid:mailbox=on:cells=8x8.0x4"),
            "grid:cells=8x8x4:amount=1:mailbox=on:rule=paper:label=");
  EXPECT_EQ(canonical("grid:amount=1e0"), canonical("grid"));
}

TEST(Spec, BriefFormLeavesDefaultsOut) {
  EXPECT_EQ(Arguments(parse_spec("grid:mailbox=off:cells=8"), table).brief(), "grid:cells=8");
  EXPECT_EQ(Arguments(parse_spec("grid"), table).brief(), "grid");
}

TEST(Spec, EscapesReturn) {
  EXPECT_EQ(canonical("grid:label=a%2Cb%3Ac%3Dd%25"),
            "grid:cells=0:amount=1:mailbox=off:rule=paper:label=a%2Cb%3Ac%3Dd%25");
  EXPECT_EQ(Arguments(parse_spec("grid:label=a%2Cb"), table).text("label"), "a,b");
}

TEST(Spec, ComplaintsSayWhatWouldBeRight) {
  EXPECT_THAT(complaint("grid:cell=4"), testing::HasSubstr("there are: cells, amount"));
  EXPECT_THAT(complaint("grid:cells=4x4"), testing::HasSubstr("three joined by x"));
  EXPECT_THAT(complaint("grid:cells=4097"), testing::HasSubstr("1..4096"));
  EXPECT_THAT(complaint("grid:amount=nan"), testing::HasSubstr("0.001..1000"));
  EXPECT_THAT(complaint("grid:rule=wald"), testing::HasSubstr("paper, woo"));
  EXPECT_THAT(complaint("grid:cells=4,8"), testing::HasSubstr("not a list"));
  EXPECT_THAT(complaint("grid:cells=4:cells=8"), testing::HasSubstr("twice"));
  EXPECT_THAT(complaint("grid:cells"), testing::HasSubstr("parameter=value"));
  EXPECT_THAT(complaint(":cells=4"), testing::HasSubstr("begins with a name"));
}

}  // namespace
}  // namespace raymeter
