#include "baselines/embree.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <type_traits>

#include "accel/primitive_test.h"
#include "baselines/embree_device.h"
#include "scenes/base/error.h"
#include "scenes/base/float_mode.h"

namespace raymeter {
namespace {

constexpr unsigned triangle_geometry = 0, quadric_geometry = 1;

// ---- One lane of an Embree packet. A single ray is a packet of width 1. ----

template <int width, class Packet>
constexpr bool has_hit = std::is_same_v<Packet, typename EmbreePacket<width>::Closest>;

template <class Packet>
RTCRayN* rays_of(Packet& packet) {
  return reinterpret_cast<RTCRayN*>(&packet);
}
template <int width, class Packet>
RTCHitN* hits_of(Packet& packet) {
  return RTCRayHitN_HitN(reinterpret_cast<RTCRayHitN*>(&packet), width);
}

/// Writes what a trace overwrites.
template <int width, class Packet>
void reset_lane(Packet& packet, unsigned lane, float tfar) {
  RTCRayN_tfar(rays_of(packet), width, lane) = tfar;
  if constexpr (has_hit<width, Packet>)
    RTCHitN_geomID(hits_of<width>(packet), width, lane) = RTC_INVALID_GEOMETRY_ID;
}

template <int width, class Packet>
void set_lane(Packet& packet, unsigned lane, const Ray& ray) {
  RTCRayN* const rays = rays_of(packet);
  RTCRayN_org_x(rays, width, lane) = ray.origin.x;
  RTCRayN_org_y(rays, width, lane) = ray.origin.y;
  RTCRayN_org_z(rays, width, lane) = ray.origin.z;
  RTCRayN_dir_x(rays, width, lane) = ray.direction.x;
  RTCRayN_dir_y(rays, width, lane) = ray.direction.y;
  RTCRayN_dir_z(rays, width, lane) = ray.direction.z;
  RTCRayN_tnear(rays, width, lane) = ray.tnear;
  RTCRayN_time(rays, width, lane) = 0;
  RTCRayN_mask(rays, width, lane) = 0xffffffffu;
  RTCRayN_id(rays, width, lane) = 0;
  RTCRayN_flags(rays, width, lane) = 0;
  reset_lane<width>(packet, lane, ray.tfar);
}

Ray ray_of(RTCRayN* rays, unsigned width, unsigned lane) {
  return {
      {RTCRayN_org_x(rays, width, lane), RTCRayN_org_y(rays, width, lane), RTCRayN_org_z(rays, width, lane)},
      RTCRayN_tnear(rays, width, lane),
      {RTCRayN_dir_x(rays, width, lane), RTCRayN_dir_y(rays, width, lane), RTCRayN_dir_z(rays, width, lane)},
      RTCRayN_tfar(rays, width, lane)};
}

// ---- Quadrics, of the special and then of the general kind, as user geometry. ----

std::uint32_t quadric_id(const Scene& scene, unsigned index) {
  return static_cast<std::uint32_t>(scene.triangle_count()) + index;
}

void quadric_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Scene& scene = *static_cast<const Scene*>(arguments->geometryUserPtr);
  const Bounds box = scene.bounds_of(quadric_id(scene, arguments->primID));
  RTCBounds& result = *arguments->bounds_o;
  result.lower_x = box.low.x, result.lower_y = box.low.y, result.lower_z = box.low.z;
  result.upper_x = box.high.x, result.upper_y = box.high.y, result.upper_z = box.high.z;
}

Hit hit_of(const Scene& scene, float t, unsigned geometry, unsigned primitive) {
  if (geometry == RTC_INVALID_GEOMETRY_ID) return {t, no_primitive};
  return {t, geometry == quadric_geometry ? quadric_id(scene, primitive) : primitive};
}

void intersect_quadric(const RTCIntersectFunctionNArguments* arguments) {
  const Scene& scene = *static_cast<const Scene*>(arguments->geometryUserPtr);
  const unsigned width = arguments->N;
  RTCRayN* const rays = RTCRayHitN_RayN(arguments->rayhit, width);
  RTCHitN* const hits = RTCRayHitN_HitN(arguments->rayhit, width);
  for (unsigned lane = 0; lane < width; ++lane) {
    if (!arguments->valid[lane]) continue;
    const Ray ray = ray_of(rays, width, lane);
    // Embree keeps the best hit so far in the ray; ours must beat it in our order, of t and then of number.
    const Hit before =
        hit_of(scene, ray.tfar, RTCHitN_geomID(hits, width, lane), RTCHitN_primID(hits, width, lane));
    Hit best = before;
    NoProbe probe;
    test_closest(scene, quadric_id(scene, arguments->primID), FilterRay(ray), best, probe);
    if (best == before) continue;
    RTCRayN_tfar(rays, width, lane) = best.t;
    RTCHitN_geomID(hits, width, lane) = arguments->geomID;
    RTCHitN_primID(hits, width, lane) = arguments->primID;
    RTCHitN_instID(hits, width, lane, 0) = arguments->context->instID[0];
  }
}

void occlude_with_quadric(const RTCOccludedFunctionNArguments* arguments) {
  const Scene& scene = *static_cast<const Scene*>(arguments->geometryUserPtr);
  for (unsigned lane = 0; lane < arguments->N; ++lane) {
    if (!arguments->valid[lane]) continue;
    const Ray ray = ray_of(arguments->ray, arguments->N, lane);
    NoProbe probe;
    if (test_any(scene, quadric_id(scene, arguments->primID), FilterRay(ray), probe))
      RTCRayN_tfar(arguments->ray, arguments->N, lane) = -std::numeric_limits<float>::infinity();
  }
}

// ---- The BVH. ----

class EmbreeBvh {
 public:
  EmbreeBvh(const Arguments& arguments, const BuildInput& input)
      : scene_(input.scene),
        memory_(input.memory_limit),
        isa_(arguments.text("isa") == "default" ? embree_default_isa() : arguments.text("isa")),
        device_(input.threads, arguments.text("isa"), memory_) {
    if (!embree_accepts(scene_.bounds()))
      throw Error(fmt::format("embree: {}: coordinates beyond {:.4g} are outside what Embree accepts",
                              scene_.name(), embree_largest_coordinate));
    bvh_.reset(rtcNewScene(device_.handle()));
    device_.check();
    const std::string& quality = arguments.text("quality");
    quality_ = quality == "low"      ? RTC_BUILD_QUALITY_LOW
               : quality == "medium" ? RTC_BUILD_QUALITY_MEDIUM
                                     : RTC_BUILD_QUALITY_HIGH;
    rtcSetSceneBuildQuality(bvh_.get(), quality_);
    if (arguments.flag("robust")) rtcSetSceneFlags(bvh_.get(), RTC_SCENE_FLAG_ROBUST);
    if (!scene_.triangles().empty()) attach_triangles();
    if (scene_.primitive_count() > scene_.triangle_count()) attach_quadrics();
    rtcCommitScene(bvh_.get());
    device_.check();
  }

  RTCScene handle() const { return bvh_.get(); }
  const Scene& scene() const { return scene_; }
  void check() const { device_.check(); }

  StructureStats stats() const {
    StructureStats stats;
    stats.bytes = memory_.bytes();
    stats.peak_bytes = memory_.peak();
    stats.bytes_by_part = {{"bvh", stats.bytes}};
    stats.isa = isa_;
    return stats;
  }

 private:
  void attach_triangles() {
    const EmbreeDevice::GeometryHandle mesh(rtcNewGeometry(device_.handle(), RTC_GEOMETRY_TYPE_TRIANGLE));
    device_.check();
    rtcSetSharedGeometryBuffer(mesh.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               scene_.vertices().data(), 0, sizeof(Vec3), scene_.vertices().size());
    device_.check();
    rtcSetSharedGeometryBuffer(mesh.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               scene_.triangles().data(), 0, sizeof scene_.triangles()[0],
                               scene_.triangles().size());
    device_.check();
    attach(mesh, triangle_geometry);
  }
  void attach_quadrics() {
    const EmbreeDevice::GeometryHandle quadrics(rtcNewGeometry(device_.handle(), RTC_GEOMETRY_TYPE_USER));
    device_.check();
    rtcSetGeometryUserPrimitiveCount(
        quadrics.get(), static_cast<unsigned>(scene_.primitive_count() - scene_.triangle_count()));
    rtcSetGeometryUserData(quadrics.get(), const_cast<Scene*>(&scene_));  // only ever read
    rtcSetGeometryBoundsFunction(quadrics.get(), quadric_bounds, nullptr);
    rtcSetGeometryIntersectFunction(quadrics.get(), intersect_quadric);
    rtcSetGeometryOccludedFunction(quadrics.get(), occlude_with_quadric);
    device_.check();
    attach(quadrics, quadric_geometry);
  }
  void attach(const EmbreeDevice::GeometryHandle& geometry, unsigned id) {
    // A scene of low quality builds a tree for each geometry, of the quality that *this* asks for.
    rtcSetGeometryBuildQuality(geometry.get(), quality_);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(bvh_.get(), geometry.get(), id);
    device_.check();
  }

  const Scene& scene_;
  MemoryMeter memory_;
  std::string isa_;
  RTCBuildQuality quality_ = RTC_BUILD_QUALITY_MEDIUM;
  EmbreeDevice device_;
  EmbreeDevice::SceneHandle bvh_;  // after the device: freed before it
};

// ---- Rays. ----

/// A ray that Embree is not given, and what is answered for it.
struct Exception {
  std::size_t index;  // in the batch
  bool miss;          // else not_answered
};

bool is_large(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > embree_largest_coordinate;
}

/// Embree wants finite rays of moderate size with 0 <= tnear; Debian's version 3 aborts on others.
std::vector<Exception> find_exceptions(const BatchView& batch) {
  std::vector<Exception> exceptions;
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Ray& ray = batch.rays[i];
    if (!is_traceable(ray) || !(ray.tnear < ray.tfar))
      exceptions.push_back({batch.first + i, true});
    else if (ray.tnear < 0 || is_large(ray.origin) || is_large(ray.direction))
      exceptions.push_back({batch.first + i, false});
  }
  return exceptions;
}

enum class RayLayout { converted, in_place };

/// `width` rays a query, or a stream of single ones.
template <int width, bool stream = false>
class EmbreeStructure final : public Structure {
 public:
  EmbreeStructure(const Arguments& arguments, const BuildInput& input)
      : bvh_(arguments, input), keep_in_place_(arguments.text("rays") == "in-place") {}

  void prepare(const BatchView& batch) override {
    prepared_ = batch;
    exceptions_ = find_exceptions(batch);
    tfar_.clear();
    closest_.reset();
    any_.reset();
    if (!keep_in_place_) return;
    for (const Ray& ray : batch.rays) tfar_.push_back(ray.tfar);
    if (batch.query == QueryKind::closest)
      closest_ = lay_out<Closest>(batch.rays);
    else
      any_ = lay_out<Any>(batch.rays);
  }

  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    trace(batch, hits, QueryKind::closest, closest_.get());
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    trace(batch, occluded, QueryKind::any, any_.get());
  }
  void count_closest(const BatchView&, std::span<Hit>, std::span<RayCounters>) const override {
    throw std::logic_error("embree can't count");
  }
  void count_any(const BatchView&, std::span<std::uint8_t>, std::span<RayCounters>) const override {
    throw std::logic_error("embree can't count");
  }
  bool counts() const override { return false; }
  StructureStats stats() const override { return bvh_.stats(); }

 private:
  using Closest = typename EmbreePacket<width>::Closest;
  using Any = typename EmbreePacket<width>::Any;

  template <class Packet>
  static std::unique_ptr<Packet[]> lay_out(std::span<const Ray> rays) {
    auto packets = std::make_unique<Packet[]>((rays.size() + width - 1) / width);
    for (std::size_t i = 0; i < rays.size(); ++i)
      set_lane<width>(packets[i / width], static_cast<unsigned>(i % width), rays[i]);
    return packets;
  }

  template <class Answer, class Packet>
  void trace(const BatchView& batch, std::span<Answer> answers, QueryKind query, Packet* packets) const {
    const FlushDenormals mode;
    const std::size_t end = batch.first + batch.rays.size();
    const bool prepared = prepared_.query == query && end <= prepared_.rays.size() &&
                          batch.rays.data() == prepared_.rays.data() + batch.first;
    std::vector<Exception> found_here;
    if (!prepared) found_here = find_exceptions(batch);
    const auto by_index = [](const Exception& e, std::size_t index) { return e.index < index; };
    const auto& all = prepared ? exceptions_ : found_here;
    const auto first_exception = std::lower_bound(all.begin(), all.end(), batch.first, by_index);
    const std::span<const Exception> exceptions(first_exception,
                                                std::lower_bound(first_exception, all.end(), end, by_index));

    // A packet that two chunks share is never traced in place: two threads would write to it.
    const bool whole_packets = batch.first % width == 0 && (end % width == 0 || end == prepared_.rays.size());
    if (prepared && packets && whole_packets)
      trace_rays<RayLayout::in_place>(batch, answers, exceptions, packets);
    else
      trace_rays<RayLayout::converted>(batch, answers, exceptions, packets);
    for (const Exception& exception : exceptions)
      answers[exception.index - batch.first] = exceptional_answer<Answer>(exception);
    bvh_.check();
  }

  template <RayLayout layout, class Answer, class Packet>
  void trace_rays(const BatchView& batch, std::span<Answer> answers, std::span<const Exception> exceptions,
                  Packet* packets) const {
    if constexpr (stream)
      trace_streams<layout>(batch, answers, exceptions, packets);
    else
      trace_packets<layout>(batch, answers, exceptions, packets);
  }

  template <RayLayout layout, class Answer, class Packet>
  void trace_packets(const BatchView& batch, std::span<Answer> answers, std::span<const Exception> exceptions,
                     Packet* packets) const {
    EmbreeQuery query(batch.coherent);
    alignas(64) int all_lanes[width], some_lanes[width];
    std::fill_n(all_lanes, width, -1);
    Packet converted{};
    for (std::size_t i = 0; i < batch.rays.size(); i += width) {
      // Lanes beyond the last ray and lanes of exceptional rays stay out.
      const auto lanes = static_cast<unsigned>(std::min<std::size_t>(width, batch.rays.size() - i));
      const int* valid = all_lanes;
      if (lanes < width || (!exceptions.empty() && exceptions[0].index < batch.first + i + width)) {
        for (unsigned lane = 0; lane < width; ++lane) some_lanes[lane] = lane < lanes ? -1 : 0;
        for (; !exceptions.empty() && exceptions[0].index < batch.first + i + width;
             exceptions = exceptions.subspan(1))
          some_lanes[exceptions[0].index - batch.first - i] = 0;
        valid = some_lanes;
      }
      Packet& packet = layout == RayLayout::in_place ? packets[(batch.first + i) / width] : converted;
      for (unsigned lane = 0; lane < lanes; ++lane) make_ready<layout>(packet, lane, batch, i + lane);
      query.trace(bvh_.handle(), valid, packet);
      for (unsigned lane = 0; lane < lanes; ++lane) read_answer(packet, lane, answers[i + lane]);
    }
  }

  template <RayLayout layout, class Answer, class Packet>
  void trace_streams(const BatchView& batch, std::span<Answer> answers, std::span<const Exception> exceptions,
                     Packet* packets) const {
    EmbreeQuery query(batch.coherent);
    std::vector<Packet> converted(layout == RayLayout::converted ? rays_per_stream : 0);
    for (std::size_t i = 0; i < batch.rays.size();) {
      // A stream ends before the next exceptional ray.
      const std::size_t stop = exceptions.empty() ? batch.rays.size() : exceptions[0].index - batch.first;
      if (i == stop) {
        exceptions = exceptions.subspan(1);
        ++i;
        continue;
      }
      const std::size_t count = std::min(rays_per_stream, stop - i);
      Packet* const rays = layout == RayLayout::in_place ? packets + batch.first + i : converted.data();
      for (std::size_t k = 0; k < count; ++k) make_ready<layout>(rays[k], 0, batch, i + k);
      query.trace_stream(bvh_.handle(), rays, static_cast<unsigned>(count));
      for (std::size_t k = 0; k < count; ++k) read_answer(rays[k], 0, answers[i + k]);
      i += count;
    }
  }

  template <RayLayout layout, class Packet>
  void make_ready(Packet& packet, unsigned lane, const BatchView& batch, std::size_t i) const {
    if constexpr (layout == RayLayout::in_place)
      reset_lane<width>(packet, lane, tfar_[batch.first + i]);
    else
      set_lane<width>(packet, lane, batch.rays[i]);
  }

  void read_answer(Closest& packet, unsigned lane, Hit& hit) const {
    const unsigned geometry = RTCHitN_geomID(hits_of<width>(packet), width, lane);
    const unsigned primitive = RTCHitN_primID(hits_of<width>(packet), width, lane);
    hit = geometry == RTC_INVALID_GEOMETRY_ID
              ? Hit{}
              : hit_of(bvh_.scene(), RTCRayN_tfar(rays_of(packet), width, lane), geometry, primitive);
  }
  /// Embree sets tfar of an occluded ray to -inf; ours were all above 0.
  void read_answer(Any& packet, unsigned lane, std::uint8_t& occluded) const {
    occluded = RTCRayN_tfar(rays_of(packet), width, lane) < 0;
  }

  template <class Answer>
  static Answer exceptional_answer(const Exception& exception) {
    if constexpr (std::is_same_v<Answer, Hit>)
      return exception.miss ? Hit{} : Hit{no_hit, not_answered};
    else
      return exception.miss ? Answer{0} : occlusion_not_answered;
  }

  /// Enough for Embree to sort, few enough to stay in the first-level caches.
  static constexpr std::size_t rays_per_stream = 256;

  EmbreeBvh bvh_;
  bool keep_in_place_;

  // What `prepare` made. Tracing writes hits into the packets, each chunk into its own.
  BatchView prepared_;
  std::vector<Exception> exceptions_;
  std::vector<float> tfar_;
  std::unique_ptr<Closest[]> closest_;
  std::unique_ptr<Any[]> any_;
};

std::vector<Parameter> parameters() {
  std::vector<std::string> widths{"1", "4", "8", "16"};
  if (EmbreeQuery::has_streams) widths.emplace_back("stream");
  return {
      {.name = "quality",
       .type = ParameterType::choice,
       .default_value = "medium",
       .meaning = "of the BVH: Morton codes, binned SAH, or SAH with spatial splits",
       .choices = {"low", "medium", "high"}},
      {.name = "robust",
       .type = ParameterType::flag,
       .default_value = "off",
       .meaning = "Embree's flag against missed edges"},
      {.name = "isa",
       .type = ParameterType::choice,
       .default_value = "default",
       .meaning = "newest instruction set it may use; default: what the CPU has",
       .choices = {"default", "sse2", "sse4.2", "avx", "avx2", "avx512"}},
      {.name = "query",
       .type = ParameterType::choice,
       .default_value = "1",
       .meaning = "rays in one call; stream: many single rays, sorted by Embree 3",
       .choices = widths},
      {.name = "rays",
       .type = ParameterType::choice,
       .default_value = "in-place",
       .meaning = "laid out for Embree before the clock starts, or made from ours while it runs",
       .choices = {"in-place", "converted"}},
  };
}

std::unique_ptr<Structure> build(const Arguments& arguments, const BuildInput& input) {
  const std::string& query = arguments.text("query");
  if (query == "1") return std::make_unique<EmbreeStructure<1>>(arguments, input);
  if (query == "4") return std::make_unique<EmbreeStructure<4>>(arguments, input);
  if (query == "8") return std::make_unique<EmbreeStructure<8>>(arguments, input);
  if (query == "16") return std::make_unique<EmbreeStructure<16>>(arguments, input);
  return std::make_unique<EmbreeStructure<1, true>>(arguments, input);
}

}  // namespace

StructureKind embree_kind() {
  return {.name = "embree",
          .summary = "Embree's own BVH and traversal: the baseline",
          .source = "Wald, Woop, Benthin, Johnson, Ernst 2014",
          .answers = Answers::within_bound,
          .parameters = parameters(),
          .build = build,
          .tolerated = true};
}

std::string embree_version() {
  const RTCDevice device = rtcNewDevice("threads=1");
  if (!device) return "unknown";
  const auto number = [&](RTCDeviceProperty part) { return rtcGetDeviceProperty(device, part); };
  std::string version =
      fmt::format("{}.{}.{}", number(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                  number(RTC_DEVICE_PROPERTY_VERSION_MINOR), number(RTC_DEVICE_PROPERTY_VERSION_PATCH));
  rtcReleaseDevice(device);
  return version;
}

}  // namespace raymeter
