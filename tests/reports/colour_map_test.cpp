#include "reports/colour_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace raymeter {
namespace {

double linear(std::uint8_t encoded) {
  const double x = encoded / 255.0;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

/// CIE L*: what looks evenly lighter; without regard to Oklab, in which the maps are made.
double lightness(Rgb8 c) {
  const double y = 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

/// As who lacks the cones for long or for middle waves sees it (Vienot, Brettel, Mollon 1999).
Rgb8 without_red_green(Rgb8 c, bool protan) {
  const double r = linear(c[0]), g = linear(c[1]), b = linear(c[2]);
  const double yellow = protan ? 0.11238 * r + 0.88762 * g : 0.29275 * r + 0.70725 * g;
  const double blue = protan ? 0.00401 * r - 0.00401 * g + b : -0.02234 * r + 0.02234 * g + b;
  return {srgb_encoded(yellow), srgb_encoded(yellow), srgb_encoded(blue)};
}

TEST(ColourMap, EncodesLinearLightAsSrgb) {
  EXPECT_EQ(srgb_encoded(0), 0);
  EXPECT_EQ(srgb_encoded(1), 255);
  EXPECT_EQ(srgb_encoded(0.2140), 127);  // half of the encoded range is 21.4% of the light
  EXPECT_EQ(srgb_encoded(0.003), 10);    // in the linear foot
  EXPECT_EQ(srgb_encoded(-1), 0);
  EXPECT_EQ(srgb_encoded(1e30), 255);
  EXPECT_EQ(srgb_encoded(NAN), 0);
}

TEST(ColourMap, SequentialLightnessRisesEvenlyForEveryEye) {
  constexpr int steps = 32;
  const auto at = [](int i) { return sequential_colour(double(i) / steps); };
  for (int i = 0; i < steps; ++i) {
    const double step = lightness(at(i + 1)) - lightness(at(i));
    EXPECT_GT(step, 1.0) << i;
    EXPECT_LT(step, 4.5) << i;
    for (const bool protan : {true, false})
      EXPECT_GT(lightness(without_red_green(at(i + 1), protan)), lightness(without_red_green(at(i), protan)));
  }
  EXPECT_EQ(sequential_colour(-3), sequential_colour(0));
  EXPECT_EQ(sequential_colour(7), sequential_colour(1));
  EXPECT_EQ(sequential_colour(NAN), sequential_colour(0));
}

TEST(ColourMap, DivergingSidesDarkenAlikeAndDifferInHueForEveryEye) {
  for (int i = 1; i <= 16; ++i) {
    const Rgb8 less = diverging_colour(-i / 16.0), more = diverging_colour(i / 16.0);
    EXPECT_LT(lightness(less), lightness(diverging_colour(-(i - 1) / 16.0)));
    EXPECT_LT(lightness(more), lightness(diverging_colour((i - 1) / 16.0)));
    EXPECT_NEAR(lightness(less), lightness(more), 6);
    for (const bool protan : {true, false}) {
      const Rgb8 a = without_red_green(less, protan), b = without_red_green(more, protan);
      EXPECT_GT(a[2] - a[0], b[2] - b[0]) << "blue stays bluer, " << i;
    }
  }
  const Rgb8 middle = diverging_colour(0);
  EXPECT_LE(*std::max_element(middle.begin(), middle.end()) - *std::min_element(middle.begin(), middle.end()),
            1);
}

}  // namespace
}  // namespace raymeter
