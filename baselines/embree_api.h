#pragma once
// The one place that knows that there are two Embrees. Version 3 takes a context with every query and has
// ray streams; version 4 takes arguments and has none. All else that is used here is the same in both.
#include <stdexcept>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace raymeter {

/// Embree's rays for `width` at a time: with room for a hit, and without.
template <int width>
struct EmbreePacket;
template <>
struct EmbreePacket<1> {
  using Closest = RTCRayHit;
  using Any = RTCRay;
};
template <>
struct EmbreePacket<4> {
  using Closest = RTCRayHit4;
  using Any = RTCRay4;
};
template <>
struct EmbreePacket<8> {
  using Closest = RTCRayHit8;
  using Any = RTCRay8;
};
template <>
struct EmbreePacket<16> {
  using Closest = RTCRayHit16;
  using Any = RTCRay16;
};

/// Asks Embree about rays or packets of rays. `valid` has a lane's -1 where its ray is to be traced, else 0.
class EmbreeQuery {
 public:
#if RTC_VERSION_MAJOR >= 4
  static constexpr bool has_streams = false;

  explicit EmbreeQuery(bool coherent) {
    rtcInitIntersectArguments(&closest_);
    rtcInitOccludedArguments(&any_);
    closest_.flags = any_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit& ray) {
    if (*valid) rtcIntersect1(scene, &ray, &closest_);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit4& rays) {
    rtcIntersect4(valid, scene, &rays, &closest_);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &rays, &closest_);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &rays, &closest_);
  }
  void trace(RTCScene scene, const int* valid, RTCRay& ray) {
    if (*valid) rtcOccluded1(scene, &ray, &any_);
  }
  void trace(RTCScene scene, const int* valid, RTCRay4& rays) { rtcOccluded4(valid, scene, &rays, &any_); }
  void trace(RTCScene scene, const int* valid, RTCRay8& rays) { rtcOccluded8(valid, scene, &rays, &any_); }
  void trace(RTCScene scene, const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene, &rays, &any_); }

  template <class Rays>
  void trace_stream(RTCScene, Rays*, unsigned) {
    throw std::logic_error("Embree 4 has no streams");
  }

 private:
  RTCIntersectArguments closest_;
  RTCOccludedArguments any_;
#else
  static constexpr bool has_streams = true;

  explicit EmbreeQuery(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit& ray) {
    if (*valid) rtcIntersect1(scene, &context_, &ray);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit4& rays) {
    rtcIntersect4(valid, scene, &context_, &rays);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &context_, &rays);
  }
  void trace(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &context_, &rays);
  }
  void trace(RTCScene scene, const int* valid, RTCRay& ray) {
    if (*valid) rtcOccluded1(scene, &context_, &ray);
  }
  void trace(RTCScene scene, const int* valid, RTCRay4& rays) {
    rtcOccluded4(valid, scene, &context_, &rays);
  }
  void trace(RTCScene scene, const int* valid, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &context_, &rays);
  }
  void trace(RTCScene scene, const int* valid, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &context_, &rays);
  }
  void trace_stream(RTCScene scene, RTCRayHit* rays, unsigned count) {
    rtcIntersect1M(scene, &context_, rays, count, sizeof *rays);
  }
  void trace_stream(RTCScene scene, RTCRay* rays, unsigned count) {
    rtcOccluded1M(scene, &context_, rays, count, sizeof *rays);
  }

 private:
  RTCIntersectContext context_;
#endif
};

/// Coordinates of scenes and rays beyond this (FLT_LARGE in its sources, whose square is still a float)
/// are invalid to Embree: it drops such primitives without a word, and may abort on such rays.
inline constexpr float embree_largest_coordinate = 1.844e18f;

}  // namespace raymeter
