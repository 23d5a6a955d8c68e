#include "accel/brick_build.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "accel/brick_part.h"
#include "accel/brick_rules.h"
#include "accel/local_primitives.h"
#include "accel/parallel.h"
#include "accel/sparse_lists.h"

namespace raymeter {
namespace {

/// A node of more primitives is made by all threads together; what is smaller goes to a thread in parts of
/// about so many primitives.
constexpr std::size_t large_node = 16384, part_size = 4096;
/// A scene's triangles and vertices of more bytes are far, where one has to wait for them: on a mesh of so
/// many, fetching each only once begins to pay.
constexpr std::size_t far_bytes = 4 << 20;

/// A node to be made of the primitives in its cell; or, of the primitives near a block of 4x4x4 cells of the
/// grid, a stand-in for a node whose children are the roots there.
struct Task {
  std::span<const std::uint32_t> primitives;
  std::optional<std::uint32_t> block;
  std::uint32_t place = 0;  ///< of the node among the upper ones
  std::uint32_t level = 0;
  double duplication = 1;  ///< references to a primitive, by the splits above
  Box cell{};
  BrickNode made{};

  bool is_large() const { return primitives.size() > large_node; }
};

/// Where something begins among nodes and words.
struct Place {
  std::uint64_t node = 0, word = 0;
};

/// Puts each primitive where `places` says for each of its cells, and moves these on.
void distribute(std::span<const std::uint32_t> primitives, std::span<const std::uint64_t> cells,
                CellCounts& places, std::uint32_t* lists) {
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for (std::uint64_t rest = cells[i]; rest != 0; rest &= rest - 1)
      lists[places[static_cast<unsigned>(std::countr_zero(rest))]++] = primitives[i];
}

/// Makes nodes and all that is below them, on one thread.
template <class Primitives>
class TreeBuilder {
 public:
  TreeBuilder(const NodeRules& rules, MemoryMeter& meter)
      : rules_(rules),
        order_(meter),
        stack_(MeteredAllocator<std::uint32_t>(meter)),
        cells_(MeteredAllocator<std::uint64_t>(meter)) {}

  /// Adds what is below the task's node to `part`.
  void make(Task& task, Part<Primitives>& part) {
    const std::size_t count = task.primitives.size();
    part.all.add(task.primitives, stack_);
    if (!task.block) {
      task.made = node_of(0, count, task.cell, task.level, task.duplication, part);
      return;
    }
    CutBrick brick = rules_.block(*task.block);
    CellCounts counts{};
    find_cells(brick, gathered(0, count, part), others(0, count, part));
    rules_.count(std::span(cells_).first(count), counts);
    add_children(brick.node, 0, count, counts, part, [&](std::size_t first, unsigned bit) {
      return node_of(first, counts[bit], rules_.root_box(*task.block, bit), 0, 1, part);
    });
    task.made = brick.node;
  }

 private:
  /// The primitives that lie in stack_ from `first` on.
  std::span<const std::uint32_t> primitives(std::size_t first, std::size_t count) const {
    return std::span(stack_).subspan(first, count);
  }
  GatheredTriangles<Primitives> gathered(std::size_t first, std::size_t count, const Part<Primitives>& part) {
    const auto some = primitives(first, count);
    return {part.all, some.first(rules_.triangles_among(part.all, some)), buffer_};
  }
  /// As the scene numbers them.
  auto others(std::size_t first, std::size_t count, const Part<Primitives>& part) const {
    const auto some = primitives(first, count);
    return some.subspan(rules_.triangles_among(part.all, some)) |
           std::views::transform([&all = part.all](std::uint32_t p) { return all.primitive(p); });
  }

  /// A node and what is below it.
  BrickNode node_of(std::size_t first, std::size_t count, const Box& cell, std::uint32_t level,
                    double duplication, Part<Primitives>& part) {
    part.depth = std::max(part.depth, level);
    const auto triangles = gathered(first, count, part);
    CutBrick brick = rules_.cut(rules_.bounds_of(triangles, others(first, count, part)), cell);
    find_cells(brick, triangles, others(first, count, part));

    if (rules_.may_split(brick, count, level)) {
      CellCounts counts{};
      rules_.count(std::span(cells_).first(count), counts);
      const double more = double(sum_of(counts)) / double(count);
      if (rules_.splits(brick, counts, count, duplication)) {
        add_children(brick.node, first, count, counts, part, [&](std::size_t child, unsigned bit) {
          return node_of(child, counts[bit], cell_of(brick.node, bit), level + 1, duplication * more, part);
        });
        return brick.node;
      }
    }
    const std::size_t among = triangles.all().size();
    order_.sort(std::span(stack_).subspan(first, among), std::span(cells_).first(among));
    part.make_leaf(brick.node, primitives(first, among), std::span(cells_).first(among),
                   primitives(first, count).subspan(among));
    return brick.node;
  }

  /// Of each primitive the cells that it meets, and all of them in the node's mask.
  template <class Others>
  void find_cells(CutBrick& brick, const GatheredTriangles<Primitives>& triangles, const Others& others) {
    const std::size_t count = triangles.all().size() + others.size();
    if (cells_.size() < count) cells_.resize(count);
    const auto cells = std::span(cells_).first(count);
    rules_.cells_of(brick, triangles, others, cells);
    for (const std::uint64_t mask : cells) brick.node.occupied |= mask;
  }

  /// Gives each occupied cell a list of its primitives, at the end of stack_, and a child, child(where the
  /// list begins, cell).
  template <class Child>
  void add_children(BrickNode& node, std::size_t first, std::size_t count, const CellCounts& counts,
                    Part<Primitives>& part, const Child& child) {
    const std::size_t lists = stack_.size(), base = part.nodes.size();
    stack_.resize(lists + sum_of(counts));
    CellCounts places;
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0u);
    distribute(primitives(first, count), cells_, places, stack_.data() + lists);
    node.base = static_cast<std::uint32_t>(base);
    part.nodes.resize(base + static_cast<std::size_t>(std::popcount(node.occupied)));
    std::size_t list = lists;
    for (std::uint64_t rest = node.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      const BrickNode made = child(list, bit);
      part.nodes[node.child(bit)] = made;
      list += counts[bit];
    }
    stack_.resize(lists);
  }

  const NodeRules& rules_;
  GatherBuffer buffer_;
  LeafOrder order_;
  MeteredVector<std::uint32_t> stack_;
  MeteredVector<std::uint64_t> cells_;  // by primitive, of the node that is being made
};

/// Nodes that are too much for one thread.
class LargeNodes {
 public:
  LargeNodes(const NodeRules& rules, MemoryMeter& meter)
      : part(ScenePrimitives(rules.scene()), meter), rules_(rules), meter_(meter) {}

  /// Makes the task's node, on all threads, and adds tasks for its children, whose nodes have their places in
  /// `part`.
  void make(Task& task, MeteredVector<Task>& children) {
    const auto primitives = task.primitives;
    const std::size_t count = primitives.size(), chunks = (count + chunk_size - 1) / chunk_size;
    const auto part_of = [&](const auto& all, std::size_t chunk) {
      return all.subspan(chunk * chunk_size, std::min(chunk_size, count - chunk * chunk_size));
    };
    // Calls use(chunk, its triangles, its others) for each chunk of the primitives.
    const auto for_chunks = [&](const auto& use) {
      for_ranges(chunks, 1, [&](std::uint64_t begin, std::uint64_t end) {
        GatherBuffer buffer;
        for (std::uint64_t chunk = begin; chunk < end; ++chunk) {
          const auto these = part_of(primitives, chunk);
          const std::size_t triangles = rules_.triangles_among(part.all, these);
          use(chunk, GatheredTriangles(part.all, these.first(triangles), buffer), these.subspan(triangles));
        }
      });
    };

    CutBrick brick;
    if (task.block) {
      brick = rules_.block(*task.block);
    } else {
      part.depth = std::max(part.depth, task.level);
      MeteredVector<Bounds> bounds(chunks, MeteredAllocator<Bounds>(meter_));
      for_chunks([&](std::size_t chunk, const auto& triangles, auto others) {
        bounds[chunk] = rules_.bounds_of(triangles, others);
      });
      for (const Bounds& box : bounds) bounds[0].extend(box);
      brick = rules_.cut(bounds[0], task.cell);
    }

    MeteredVector<std::uint64_t> all_cells(count, MeteredAllocator<std::uint64_t>(meter_));
    const std::span<std::uint64_t> cells(all_cells);
    MeteredVector<CellCounts> places(chunks, MeteredAllocator<CellCounts>(meter_));
    for_chunks([&](std::size_t chunk, const auto& triangles, auto others) {
      rules_.cells_of(brick, triangles, others, part_of(cells, chunk));
      rules_.count(part_of(cells, chunk), places[chunk]);
    });
    CellCounts counts{};
    for (const CellCounts& in_chunk : places)
      for (std::size_t i = 0; i < 64; ++i) counts[i] += in_chunk[i];
    for (std::size_t i = 0; i < 64; ++i) brick.node.occupied |= std::uint64_t{counts[i] != 0} << i;
    if (!task.block && !(rules_.may_split(brick, count, task.level) &&
                         rules_.splits(brick, counts, count, task.duplication))) {
      const std::size_t triangles = rules_.triangles_among(part.all, primitives);
      std::vector<std::uint32_t> ordered(primitives.begin(), primitives.end());
      LeafOrder(meter_).sort(std::span(ordered).first(triangles), cells.first(triangles));
      part.make_leaf(brick.node, std::span(ordered).first(triangles), cells.first(triangles),
                     primitives.subspan(triangles));
      task.made = brick.node;
      return;
    }

    // Where each chunk's primitives begin in each cell's list.
    CellCounts place;
    std::exclusive_scan(counts.begin(), counts.end(), place.begin(), 0u);
    for (CellCounts& in_chunk : places)
      for (std::size_t i = 0; i < 64; ++i) place[i] += std::exchange(in_chunk[i], place[i]);
    const std::uint64_t references = sum_of(counts);
    std::uint32_t* list = lists_.emplace_back(references, MeteredAllocator<std::uint32_t>(meter_)).data();
    for_ranges(chunks, 16, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t chunk = begin; chunk < end; ++chunk)
        distribute(part_of(primitives, chunk), part_of(cells, chunk), places[chunk], list);
    });

    brick.node.base = static_cast<std::uint32_t>(part.nodes.size());
    task.made = brick.node;
    Task child;
    if (!task.block) {
      child.level = task.level + 1;
      child.duplication = task.duplication * double(references) / double(count);
    }
    const auto block = task.block;  // `task` may move
    for (std::uint64_t rest = brick.node.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      child.primitives = {list, counts[bit]};
      child.cell = block ? rules_.root_box(*block, bit) : cell_of(brick.node, bit);
      child.place = brick.node.child(bit);
      children.push_back(child);
      list += counts[bit];
    }
    part.nodes.resize(part.nodes.size() + static_cast<std::size_t>(std::popcount(brick.node.occupied)));
  }

  Part<ScenePrimitives> part;

 private:
  static constexpr std::size_t chunk_size = GatherBuffer::capacity;

  const NodeRules& rules_;
  MemoryMeter& meter_;
  std::vector<MeteredVector<std::uint32_t>> lists_;  // that the children's primitives lie in
};

/// For all nodes and words that come before the end.
void make_room(const Place& end, Bricks& bricks) {
  if (std::max(end.node, end.word + widest_vector) >= most_numbered) refuse_bricks();
  bricks.nodes.grow(end.node);
  bricks.words.grow(end.word + widest_vector);
}

/// Makes the nodes of all tasks but the large ones and what is below them, and writes their leaves, from
/// `end` on, which moves. Where the bricks `can_grow` where they are, each part's leaves are written while
/// what they are made of is at hand, and take its place in memory.
template <class Primitives>
void make_parts(const NodeRules& rules, std::span<Task> tasks, const Primitives& none, bool can_grow,
                MemoryMeter& meter, Place& end, Bricks& bricks) {
  // Of about as many references each, whatever the number of threads.
  std::vector<std::size_t> begins{0};
  std::size_t references = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!tasks[i].is_large()) references += tasks[i].primitives.size();
    if (references >= part_size || i + 1 == tasks.size()) {
      begins.push_back(i + 1);
      references = 0;
    }
  }
  const auto for_small_tasks = [&](std::size_t part, const auto& use) {
    for (std::size_t i = begins[part]; i < begins[part + 1]; ++i)
      if (!tasks[i].is_large()) use(tasks[i]);
  };
  std::vector<Part<Primitives>> parts(begins.size() - 1, Part<Primitives>(none, meter));
  std::vector<Place> places(parts.size());

  const auto make = [&](TreeBuilder<Primitives>& builder, std::uint64_t p) {
    for_small_tasks(p, [&](Task& task) { builder.make(task, parts[p]); });
  };
  const auto place = [&](std::uint64_t p) {
    places[p] = end;
    end.node += parts[p].nodes.size();
    end.word += parts[p].end_of_words();
    bricks.depth = std::max(bricks.depth, parts[p].depth);
  };
  const auto write = [&](std::uint64_t p) {
    const Part<Primitives> part = std::move(parts[p]);
    const auto move = [&](BrickNode& node) {
      node.base += static_cast<std::uint32_t>(node.is_leaf() ? places[p].word : places[p].node);
    };
    for_small_tasks(p, [&](Task& task) { move(task.made); });
    BrickNode* to = bricks.nodes.data() + places[p].node;
    for (const BrickNode& node : part.nodes) move(*to++ = node);
    part.write_leaves(bricks.words.data() + places[p].word);
  };

  if (can_grow) {
    for_each_in_order(
        parts.size(),
        [&](std::uint64_t p) {
          TreeBuilder<Primitives> builder(rules, meter);
          make(builder, p);
        },
        [&](std::uint64_t p) {
          place(p);
          make_room(end, bricks);
        },
        write);
    return;
  }
  for_ranges(parts.size(), 1, [&](std::uint64_t first, std::uint64_t last) {
    TreeBuilder<Primitives> builder(rules, meter);
    for (std::uint64_t p = first; p < last; ++p) make(builder, p);
  });
  for (std::uint64_t p = 0; p < parts.size(); ++p) place(p);
  make_room(end, bricks);
  for_ranges(parts.size(), 1, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t p = first; p < last; ++p) write(p);
  });
}

}  // namespace

void build_bricks(const Scene& scene, const BrickOptions& options, MemoryMeter& meter, Bricks& bricks) {
  const NodeRules rules(scene, bricks, options);
  MeteredVector<Task> tasks{MeteredAllocator<Task>(meter)};
  SparseLists lists(meter);
  lists.build(rules.block_count(), scene.primitive_count(),
              [&](std::uint32_t begin, std::uint32_t end, const auto& add) {
                for (std::uint32_t p = begin; p < end; ++p)
                  rules.for_each_row_near(
                      p, [&](std::uint64_t first, std::uint32_t count) { add(p, first, count); });
                return true;
              });
  for (std::uint32_t block = 0; block < lists.cells(); ++block)
    if (!lists[block].empty()) tasks.push_back({.primitives = lists[block], .block = block});

  LargeNodes large(rules, meter);
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (tasks[i].is_large()) large.make(tasks[i], tasks);

  // All together, the large nodes first.
  Place end{large.part.nodes.size(), large.part.end_of_words()};
  bricks.depth = large.part.depth;
  const bool is_far = scene.vertices().size_bytes() + scene.triangles().size_bytes() >= far_bytes;
  if (is_far && bricks.nodes.set_aside(most_numbered) && bricks.words.set_aside(most_numbered))
    make_parts(rules, std::span(tasks), LocalPrimitives(scene, meter), true, meter, end, bricks);
  else
    make_parts(rules, std::span(tasks), ScenePrimitives(scene), false, meter, end, bricks);
  make_room(end, bricks);
  bricks.nodes.give_back();
  bricks.words.give_back();
  large.part.write_leaves(bricks.words.data());
  std::fill_n(bricks.words.data() + end.word, widest_vector, 0u);
  bricks.roots.assign(cell_count(bricks.cells.n), Bricks::empty_cell);
  bricks.root_boxes.assign(bricks.roots.size(), {});
  for (const Task& task : tasks)
    if (!task.block) bricks.nodes[task.place] = task.made;
  for (const Task& task : tasks) {
    if (!task.block) continue;
    for (std::uint64_t rest = task.made.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      const std::uint64_t cell = rules.root_cell(*task.block, bit);
      const std::uint32_t root = task.made.child(bit);
      bricks.roots[cell] = root;
      bricks.root_boxes[cell] = rules.root_box_of(*task.block, bit, bricks.nodes[root]);
    }
  }
}

}  // namespace raymeter
