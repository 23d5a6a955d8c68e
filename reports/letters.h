#pragma once
#include <array>
#include <cstdint>

namespace raymeter {

/// Eight rows of five dots, the leftmost in bit 4; the last row is for the tails of letters.
using Letter = std::array<std::uint8_t, 8>;

/// Of a printable ASCII character; of any other one a box.
const Letter& letter_of(char character);

}  // namespace raymeter
