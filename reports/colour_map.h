#pragma once
#include <array>
#include <cstdint>

namespace raymeter {

/// Red, green, blue in the encoding of sRGB.
using Rgb8 = std::array<std::uint8_t, 3>;

/// A linear light in 0..1 as sRGB encodes it (IEC 61966-2-1); clamped, NaN is 0.
std::uint8_t srgb_encoded(double linear);

/// Dark blue over green to yellow for t in 0..1 (clamped): a curve in Oklab (Ottosson 2020) along which
/// lightness rises evenly and every step looks as large as every other (within 1%), so that it is read right
/// in grey and by the colour-blind.
Rgb8 sequential_colour(double t);

/// Blue below 0, nearly white at 0, orange above, for t in -1..1 (clamped). Both sides darken evenly and
/// alike.
Rgb8 diverging_colour(double t);

}  // namespace raymeter
