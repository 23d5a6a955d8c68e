#pragma once
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace raymeter {

/// While it lives, this thread flushes denormal results to zero and reads denormal operands as zero
/// (FTZ and DAZ), as Embree asks of its callers: every build and every trace runs under it, so that
/// all structures are compared in the same mode.
class FlushDenormals {
 public:
#if defined(__SSE__)
  static constexpr bool available = true;
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | ftz_daz); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
#else
  static constexpr bool available = false;
  FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE__)
  static constexpr unsigned ftz_daz = 0x8040;
  unsigned saved_;
#endif
};

}  // namespace raymeter
