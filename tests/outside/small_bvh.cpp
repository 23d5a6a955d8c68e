#include "small_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "accel/memory_meter.h"
#include "accel/per_ray_structure.h"
#include "scenes/geometry/decide.h"

namespace {

using raymeter::Bounds;
using raymeter::Hit;
using raymeter::Ray;
using raymeter::Vec3;

float half_area(const Bounds& box) {
  if (box.empty()) return 0;
  const Vec3 d = box.high - box.low;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

class SmallBvh final : public raymeter::PerRayStructure<SmallBvh> {
 public:
  SmallBvh(const raymeter::Scene& scene, std::uint32_t leaf_size, std::uint64_t memory_limit)
      : PerRayStructure(scene), meter_(memory_limit), leaf_size_(leaf_size) {
    const auto count = static_cast<std::uint32_t>(scene.primitive_count());
    if (count == 0) return;
    raymeter::MeteredVector<Item> items{raymeter::MeteredAllocator<Item>(meter_)};
    items.reserve(count);
    for (std::uint32_t primitive = 0; primitive < count; ++primitive) {
      const Bounds box = scene.bounds_of(primitive);
      items.push_back({box, 0.5f * box.low + 0.5f * box.high, primitive});
    }
    nodes_.reserve(std::size_t{2} * count);
    leaves_.reserve(count);
    nodes_.emplace_back();
    build(0, items.data(), items.data() + count, 0);
  }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit best;
    walk(ray, probe, [&](const LeafItem& item, float& last) {
      const float t = intersect(ray, item);
      if (t != raymeter::no_hit && Hit{t, item.primitive} < best) best = {t, item.primitive};
      last = std::min(last, best.t);
      return false;
    });
    return best;
  }

  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return walk(ray, probe,
                [&](const LeafItem& item, float&) { return intersect(ray, item) != raymeter::no_hit; });
  }

  raymeter::StructureStats stats() const override {
    raymeter::StructureStats stats;
    for (const Node& node : nodes_) ++(node.count ? stats.cells : stats.inner_nodes);
    stats.references = leaves_.size();
    stats.depth = depth_;
    stats.bytes = meter_.bytes();
    stats.peak_bytes = meter_.peak();
    return stats;
  }

 private:
  struct Node {
    Bounds box;
    std::uint32_t first = 0;  // of the primitives of a leaf, or the left child: the right one is beside it
    std::uint32_t count = 0;  // of a leaf's primitives; 0 in an inner node
  };
  struct Item {
    Bounds box;
    Vec3 centre;
    std::uint32_t primitive;
  };
  struct LeafItem {
    Vec3 a, e1, e2;  // of a triangle
    std::uint32_t primitive;
  };

  static constexpr std::uint32_t sah_depth = 40;              // below it nodes are halved, which ends soon
  static constexpr std::uint32_t max_depth = sah_depth + 32;  // since there are less than 2^32 primitives
  static constexpr int bins = 16;

  void build(std::uint32_t index, Item* begin, Item* end, std::uint32_t depth) {
    depth_ = std::max(depth_, depth);
    Bounds box, centres;
    for (const Item* item = begin; item != end; ++item) {
      box.extend(item->box);
      centres.extend(item->centre);
    }
    nodes_[index].box = box;
    Item* middle = static_cast<std::uint32_t>(end - begin) <= leaf_size_ ? nullptr
                   : depth < sah_depth                                   ? split(begin, end, centres)
                                                                         : begin + (end - begin) / 2;
    if (!middle) {
      nodes_[index].first = static_cast<std::uint32_t>(leaves_.size());
      nodes_[index].count = static_cast<std::uint32_t>(end - begin);
      for (const Item* item = begin; item != end; ++item) leaves_.push_back(leaf_item(item->primitive));
      return;
    }
    const auto left = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index].first = left;
    nodes_.resize(nodes_.size() + 2);
    build(left, begin, middle, depth + 1);
    build(left + 1, middle, end, depth + 1);
  }

  // Divides the items at the border of two bins where the surface area heuristic is least; in the middle,
  // where all of them are in one bin.
  static Item* split(Item* begin, Item* end, const Bounds& centres) {
    const Vec3 extent = centres.high - centres.low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    if (!(extent[axis] > 0) || !std::isfinite(extent[axis])) return begin + (end - begin) / 2;
    const float scale = static_cast<float>(bins) / extent[axis];
    const auto bin_of = [&](const Item& item) {
      return std::min(bins - 1, static_cast<int>((item.centre[axis] - centres.low[axis]) * scale));
    };
    std::array<Bounds, bins> box;
    std::array<float, bins> count{};
    for (const Item* item = begin; item != end; ++item) {
      box[bin_of(*item)].extend(item->box);
      ++count[bin_of(*item)];
    }
    std::array<float, bins> cost_right{};  // of the bins from here on
    Bounds side;
    float on_side = 0;
    for (int bin = bins - 1; bin > 0; --bin) {
      side.extend(box[bin]);
      on_side += count[bin];
      cost_right[bin] = on_side * half_area(side);
    }
    side = {};
    on_side = 0;
    int best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (int bin = 1; bin < bins; ++bin) {
      side.extend(box[bin - 1]);
      on_side += count[bin - 1];
      const float cost = on_side * half_area(side) + cost_right[bin];
      if (cost < least) {
        least = cost;
        best = bin;
      }
    }
    Item* const middle = std::partition(begin, end, [&](const Item& item) { return bin_of(item) < best; });
    return middle == begin || middle == end ? begin + (end - begin) / 2 : middle;
  }

  LeafItem leaf_item(std::uint32_t primitive) const {
    if (!scene().is_triangle(primitive)) return {{}, {}, {}, primitive};
    const raymeter::Triangle triangle = scene().triangle(primitive);
    return {triangle.a, triangle.b - triangle.a, triangle.c - triangle.a, primitive};
  }

  // The t of the hit in the ray's interval, or no_hit. Quadrics are left to Raymeter.
  float intersect(const Ray& ray, const LeafItem& item) const {
    if (!scene().is_triangle(item.primitive))
      return scene().visit(item.primitive, [&](const auto& shape) { return raymeter::decide(ray, shape); });
    const Vec3 p = cross(ray.direction, item.e2);
    const float determinant = dot(item.e1, p);
    if (determinant == 0) return raymeter::no_hit;
    const float inverse = 1 / determinant;
    const Vec3 s = ray.origin - item.a;
    const float u = dot(s, p) * inverse;
    if (!(u >= 0 && u <= 1)) return raymeter::no_hit;
    const Vec3 q = cross(s, item.e1);
    const float v = dot(ray.direction, q) * inverse;
    if (!(v >= 0 && u + v <= 1)) return raymeter::no_hit;
    const float t = dot(item.e2, q) * inverse;
    return t > ray.tnear && t <= ray.tfar ? t : raymeter::no_hit;
  }

  // The t at which the ray enters the box before `last`, or +inf. The interval is widened by more than the
  // rounding of its ends (Ize, "Robust BVH Ray Traversal", 2013).
  static float entry(const Bounds& box, const Ray& ray, const Vec3& inverse, float last) {
    float enter = ray.tnear, leave = last;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray.direction[axis] == 0) {
        if (ray.origin[axis] < box.low[axis] || ray.origin[axis] > box.high[axis]) return raymeter::no_hit;
        continue;
      }
      const float t0 = (box.low[axis] - ray.origin[axis]) * inverse[axis];
      const float t1 = (box.high[axis] - ray.origin[axis]) * inverse[axis];
      enter = std::max(enter, std::min(t0, t1) - std::abs(std::min(t0, t1)) * 0x1p-21f);
      leave = std::min(leave, std::max(t0, t1) + std::abs(std::max(t0, t1)) * 0x1p-21f);
    }
    return enter <= leave ? enter : raymeter::no_hit;
  }

  // Calls test(item, last) for the primitives of the leaves that the ray enters before `last`, front to back,
  // until it returns true.
  template <class Probe, class Test>
  bool walk(const Ray& ray, Probe& probe, Test test) const {
    if (nodes_.empty() || !raymeter::is_traceable(ray)) return false;
    const Vec3 inverse{1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z};
    struct Entry {
      float enter;
      std::uint32_t node;
    };
    std::array<Entry, max_depth + 2> stack;
    std::size_t size = 0;
    float last = ray.tfar;
    const auto put_aside = [&](std::uint32_t node) {
      const float enter = entry(nodes_[node].box, ray, inverse, last);
      if (enter < raymeter::no_hit) stack[size++] = {enter, node};
    };
    put_aside(0);
    while (size > 0) {
      const Entry next = stack[--size];
      if (next.enter > last) continue;
      const Node& node = nodes_[next.node];
      if (node.count) {
        probe.cell_step(false);
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          probe.test(leaves_[i].primitive);
          if (test(leaves_[i], last)) return true;
        }
        continue;
      }
      probe.inner_step();
      const std::size_t bottom = size;
      put_aside(node.first);
      put_aside(node.first + 1);
      if (size == bottom + 2 && stack[bottom].enter < stack[bottom + 1].enter)
        std::swap(stack[bottom], stack[bottom + 1]);  // the nearer one on top
    }
    return false;
  }

  raymeter::MemoryMeter meter_;
  raymeter::MeteredVector<Node> nodes_{raymeter::MeteredAllocator<Node>(meter_)};
  raymeter::MeteredVector<LeafItem> leaves_{raymeter::MeteredAllocator<LeafItem>(meter_)};
  std::uint32_t leaf_size_;
  std::uint32_t depth_ = 0;
};

}  // namespace

void register_small_bvh(raymeter::Registry& registry) {
  using raymeter::ParameterType;
  registry.add({.name = "small-bvh",
                .summary = "a binary BVH with a float kernel of its own",
                .source = "Wald 2007; Moeller and Trumbore 1997",
                .answers = raymeter::Answers::within_bound,
                .parameters = {{"leaf", ParameterType::integer, "4", "most primitives in a leaf", 1, 64}},
                .build = [](const raymeter::Arguments& arguments, const raymeter::BuildInput& input) {
                  return std::make_unique<SmallBvh>(
                      input.scene, static_cast<std::uint32_t>(arguments.integer("leaf")), input.memory_limit);
                }});
}
