#pragma once
// The functions beyond + - * / and sqrt that scenes and rays are made with. Unlike the standard library's
// they use nothing else, so that their results are the same, bit for bit, on every machine. They are within 4
// ulp of the exact value, the sine and cosine near their zeros within 1e-15.

namespace raymeter {

inline constexpr double pi = 3.14159265358979323846;

struct SineCosine {
  double sine, cosine;
};

/// Of an angle in radians, |angle| <= 1e5.
SineCosine sine_cosine(double angle);

/// Of an angle in turns, 1 the full circle: multiples of a quarter are exact. |turns| <= 1e15.
SineCosine sine_cosine_of_turns(double turns);

/// e^x: infinite where that is beyond the range of double, 0 where it is below 1e-307.
double exponential(double x);

/// The natural logarithm of a normal x > 0.
double natural_log(double x);

}  // namespace raymeter
