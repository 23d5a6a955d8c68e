#include "baselines/counted_bvh.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "accel/memory_meter.h"
#include "accel/per_ray_structure.h"
#include "accel/primitive_test.h"
#include "accel/walk_space.h"
#include "baselines/embree_device.h"

namespace raymeter {
namespace {

constexpr unsigned max_branching = 8;
constexpr unsigned max_depth = 128;  // of 32-primitive leaves: no scene comes near it

// ---- The tree as Embree's builder hands it over, node by node, perhaps on several threads. ----

struct BuiltNode {
  unsigned children = 0;    // of an inner node
  unsigned primitives = 0;  // of a leaf: as many numbers follow this struct
};
struct BuiltInner : BuiltNode {
  std::array<BuiltNode*, max_branching> child{};
  std::array<Bounds, max_branching> box;
};
struct BuiltLeaf : BuiltNode {
  std::array<std::uint32_t, RTC_BUILD_MAX_PRIMITIVES_PER_LEAF> primitive;
};

// Where Embree is refused memory these get or give null; the build is then thrown away.
template <class Node>
Node* new_node(RTCThreadLocalAllocator allocator) {
  void* const memory = rtcThreadLocalAlloc(allocator, sizeof(Node), 16);
  return memory ? new (memory) Node : nullptr;
}
void* create_inner(RTCThreadLocalAllocator allocator, unsigned children, void*) {
  auto* const node = new_node<BuiltInner>(allocator);
  if (node) node->children = children;
  return static_cast<BuiltNode*>(node);
}
void set_children(void* node, void** children, unsigned count, void*) {
  auto* const inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
  if (inner)
    for (unsigned i = 0; i < count; ++i) inner->child[i] = static_cast<BuiltNode*>(children[i]);
}
void set_boxes(void* node, const RTCBounds** boxes, unsigned count, void*) {
  auto* const inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
  if (inner)
    for (unsigned i = 0; i < count; ++i) {
      const RTCBounds& box = *boxes[i];
      inner->box[i] = {{box.lower_x, box.lower_y, box.lower_z}, {box.upper_x, box.upper_y, box.upper_z}};
    }
}
void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void*) {
  auto* const leaf = new_node<BuiltLeaf>(allocator);
  if (leaf) {
    leaf->primitives = static_cast<unsigned>(count);
    for (std::size_t i = 0; i < count; ++i) leaf->primitive[i] = primitives[i].primID;
  }
  return static_cast<BuiltNode*>(leaf);
}

std::size_t count_nodes(const BuiltNode& node) {
  std::size_t count = 1;
  for (unsigned i = 0; i < node.children; ++i)
    count += count_nodes(*static_cast<const BuiltInner&>(node).child[i]);
  return count;
}

// ---- The tree as it is walked. ----

struct Node {
  Bounds box;
  std::uint32_t first = 0;     // index of the first child, or of the first reference
  std::uint32_t leaf : 1 = 0;  // whether `first` and `count` are of references
  std::uint32_t count : 31 = 0;
};
static_assert(sizeof(Node) == 32);

class CountedBvh final : public PerRayStructure<CountedBvh> {
 public:
  CountedBvh(const Arguments& arguments, const BuildInput& input)
      : PerRayStructure(input.scene), memory_(input.memory_limit) {
    if (scene().primitive_count() > 0)
      build(static_cast<unsigned>(arguments.integer("branching")), input.threads);
  }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit best;
    if (!is_traceable(ray)) return best;
    const FilterRay filter(ray);
    walk(ray, probe, [&](std::span<const std::uint32_t> primitives, double last) {
      for (const std::uint32_t primitive : primitives) test_closest(scene(), primitive, filter, best, probe);
      return best.found() ? std::min(last, latest(best.t)) : last;
    });
    return best;
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    if (!is_traceable(ray)) return false;
    const FilterRay filter(ray);
    bool hit = false;
    walk(ray, probe, [&](std::span<const std::uint32_t> primitives, double last) {
      for (const std::uint32_t primitive : primitives)
        if (test_any(scene(), primitive, filter, probe)) {
          hit = true;
          return enough;
        }
      return last;
    });
    return hit;
  }

  StructureStats stats() const override {
    StructureStats stats;
    for (const Node& node : nodes_) ++(node.leaf ? stats.cells : stats.inner_nodes);
    stats.references = references_.size();
    stats.depth = depth_;
    stats.bytes = memory_.bytes();
    stats.peak_bytes = memory_.peak();
    stats.bytes_by_part = {{"nodes", nodes_.size() * sizeof(Node)},
                           {"references", references_.size() * sizeof references_[0]}};
    return stats;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  /// What a visitor of leaves returns to end the walk.
  static constexpr double enough = -infinity;

  void build(unsigned branching, unsigned threads) {
    EmbreeDevice device(threads, "default", memory_);
    MeteredVector<RTCBuildPrimitive> primitives{MeteredAllocator<RTCBuildPrimitive>(memory_)};
    primitives.reserve(scene().primitive_count());
    if (!embree_accepts(scene().bounds())) shrink_ = far_shrink;
    for (std::uint32_t i = 0; i < scene().primitive_count(); ++i) {
      Bounds box = scene().bounds_of(i);
      box.low = shrink_ * box.low;
      box.high = shrink_ * box.high;
      primitives.push_back({box.low.x, box.low.y, box.low.z, 0, box.high.x, box.high.y, box.high.z, i});
    }
    const EmbreeDevice::BvhHandle bvh(rtcNewBVH(device.handle()));
    device.check();
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = branching;
    arguments.maxDepth = max_depth;
    arguments.maxLeafSize = max_leaf_size;
    arguments.traversalCost = traversal_cost;
    arguments.intersectionCost = intersection_cost;
    arguments.bvh = bvh.get();
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = create_inner;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_boxes;
    arguments.createLeaf = create_leaf;
    const auto* const root = static_cast<const BuiltNode*>(rtcBuildBVH(&arguments));
    device.check();

    nodes_.reserve(count_nodes(*root));
    references_.reserve(primitives.size());
    nodes_.emplace_back();
    flatten(*root, scene().bounds(), 0, 0);
  }

  /// Depth first; the children of a node lie side by side.
  void flatten(const BuiltNode& built, const Bounds& box, std::size_t index, std::uint32_t depth) {
    depth_ = std::max(depth_, depth);
    if (depth_ > max_depth) throw std::logic_error("counted-bvh: Embree's tree is deeper than it was told");
    Node node;
    node.box = box;
    if (built.children == 0) {
      const auto& leaf = static_cast<const BuiltLeaf&>(built);
      node.leaf = 1;
      node.first = static_cast<std::uint32_t>(references_.size());
      node.count = leaf.primitives & 0x7fffffffu;
      references_.insert(references_.end(), leaf.primitive.begin(), leaf.primitive.begin() + leaf.primitives);
      nodes_[index] = node;
      return;
    }
    const auto& inner = static_cast<const BuiltInner&>(built);
    node.first = static_cast<std::uint32_t>(nodes_.size());
    node.count = inner.children & 0x7fffffffu;
    nodes_[index] = node;
    nodes_.resize(nodes_.size() + inner.children);
    for (unsigned i = 0; i < inner.children; ++i)
      flatten(*inner.child[i], regrown(inner.box[i]), node.first + i, depth + 1);
  }

  /// A box of the shrunk scene as one of the scene: not smaller, though what was flushed is lost.
  Bounds regrown(Bounds box) const {
    if (shrink_ == 1) return box;
    constexpr float flushed = 0x1p-57f;  // FLT_MIN / far_shrink, and as much again
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = box.low[axis] / shrink_ - flushed;
      box.high[axis] = box.high[axis] / shrink_ + flushed;
    }
    return box;
  }

  /// The t at which the ray enters the box, or +inf where it misses it or enters later than `last`.
  /// `earliest` is where the ray begins.
  ///
  /// Boxes and origins are floats, so that a plane's t computed here is the exact one but for three roundings
  /// of 2^-53, relative, from however far the ray comes. The interval is widened by more than that (Ize,
  /// "Robust BVH Ray Traversal", 2013), so that no box is missed in which the exact ray has a point.
  static double entry(const Bounds& box, const WalkRay& ray, double earliest, double last) {
    double enter = earliest, leave = last;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = box.low[axis], high = box.high[axis];
      if (ray.direction[axis] == 0) {
        if (ray.origin[axis] < low || ray.origin[axis] > high) return infinity;
        continue;
      }
      const double t0 = (low - ray.origin[axis]) * ray.inverse[axis];
      const double t1 = (high - ray.origin[axis]) * ray.inverse[axis];
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    enter -= std::abs(enter) * 0x1p-50;
    leave += std::abs(leave) * 0x1p-50;
    return enter <= leave ? enter : infinity;
  }

  /// Calls visit(primitives, last) for the leaves that the ray enters, front to back by their boxes. `last`
  /// is the t beyond which no node is of interest; visit returns the new one.
  template <class Probe, class Visit>
  void walk(const Ray& ray, Probe& probe, const Visit& visit) const {
    if (nodes_.empty()) return;
    struct Entry {
      double enter;
      std::uint32_t node;
    };
    std::array<Entry, max_depth*(max_branching - 1) + 1> stack;
    const WalkRay walk_ray(ray);
    const double earliest = double(ray.tnear) - double(std::numeric_limits<float>::min());
    double last = latest(ray.tfar);
    std::size_t size = 0;
    stack[size++] = {entry(nodes_[0].box, walk_ray, earliest, last), 0};
    while (size > 0) {
      const Entry next = stack[--size];
      // Drop a node that the ray enters beyond what was found since it was put aside.
      if (!(next.enter <= last) || next.enter == infinity) continue;
      const Node& node = nodes_[next.node];
      if (node.leaf) {
        probe.cell_step(false);
        last = visit(std::span(references_.data() + node.first, node.count), last);
        if (last == enough) return;
        continue;
      }
      // Put aside the children that the ray enters, the nearest on top.
      probe.inner_step();
      const std::size_t bottom = size;
      for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
        const double enter = entry(nodes_[child].box, walk_ray, earliest, last);
        if (enter == infinity) continue;
        std::size_t at = size++;
        for (; at > bottom && stack[at - 1].enter < enter; --at) stack[at] = stack[at - 1];
        stack[at] = {enter, child};
      }
    }
  }

  static constexpr unsigned max_leaf_size = 8;
  static constexpr float traversal_cost = 1, intersection_cost = 1;

  MemoryMeter memory_;
  MeteredVector<Node> nodes_{MeteredAllocator<Node>(memory_)};
  MeteredVector<std::uint32_t> references_{MeteredAllocator<std::uint32_t>(memory_)};
  std::uint32_t depth_ = 0;
  /// What the scene is scaled by for Embree's builder, which drops primitives beyond its range.
  float shrink_ = 1;
  static constexpr float far_shrink = 0x1p-68f;  // every float is then below 2^60
};

}  // namespace

StructureKind counted_bvh_kind() {
  return {"counted-bvh",
          "a BVH by Embree's builder, walked and counted by us",
          "Embree's rtcBuildBVH (Wald et al. 2014); Ize 2013",
          Answers::exact,
          {{"branching", ParameterType::integer, "8", "children of a node", 2, max_branching}},
          [](const Arguments& arguments, const BuildInput& input) {
            return std::make_unique<CountedBvh>(arguments, input);
          }};
}

}  // namespace raymeter
