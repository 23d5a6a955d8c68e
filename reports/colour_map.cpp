#include "reports/colour_map.h"

#include <algorithm>
#include <cmath>

namespace raymeter {
namespace {

/// Oklab to sRGB (Ottosson, "A perceptual color space for image processing", 2020).
Rgb8 from_oklab(double lightness, double a, double b) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {srgb_encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          srgb_encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          srgb_encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

/// A cubic of Bezier's.
double bezier(const std::array<double, 4>& p, double t) {
  const double u = 1 - t;
  return u * u * u * p[0] + 3 * u * u * t * p[1] + 3 * u * t * t * p[2] + t * t * t * p[3];
}

double between(double low, double high, double t) {
  return std::isnan(t) ? low : std::clamp(t, low, high);
}

}  // namespace

std::uint8_t srgb_encoded(double linear) {
  const double x = between(0, 1, linear);
  const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

Rgb8 sequential_colour(double t) {
  // The longest curve inside sRGB whose steps are even, found by random search.
  constexpr std::array<double, 4> a{0.033, -0.088, -0.148, -0.069}, b{-0.096, -0.076, 0.097, 0.189};
  t = between(0, 1, t);
  return from_oklab(0.22 + 0.71 * t, bezier(a, t), bezier(b, t));
}

Rgb8 diverging_colour(double t) {
  t = between(-1, 1, t);
  const double size = std::abs(t), lightness = 0.95 - 0.5 * size;
  return t < 0 ? from_oklab(lightness, -0.025 * size, -0.13 * size)
               : from_oklab(lightness, 0.08 * size, 0.085 * size);
}

}  // namespace raymeter
