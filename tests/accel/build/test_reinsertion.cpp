// Parallel reinsertion, its kernels' threads run one by one: the tree stays one, its leaves stay,
// it gets cheaper, and the order of the threads does not matter.
#include <gtest/gtest.h>

#include <cstring>

#include "accel/build_cases.h"
#include "accel/serial_reinsertion.h"
#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/build/wide/collapse_cwbvh.h"

namespace pt {
namespace {

using namespace device_build;

std::vector<Bounds> boxes_of(const std::vector<Triangle>& triangles) {
  std::vector<Bounds> boxes;
  for (const Triangle& t : triangles) boxes.push_back(hit_bounds(t.v0, t.v1, t.v2));
  return boxes;
}

std::vector<Bounds> make_boxes(const char* name, std::uint32_t count) {
  for (const BuildCase& c : build_cases) {
    if (std::strcmp(c.name, name) == 0) return boxes_of(c.make(count));
  }
  throw std::runtime_error(name);
}

void run_backward(std::uint32_t count, const std::function<void(std::uint32_t)>& run) {
  while (count-- > 0) run(count);
}
void run_shuffled(std::uint32_t count, const std::function<void(std::uint32_t)>& run) {
  TestRandom random(count);
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  for (const std::uint32_t i : order) run(i);
}

/// What a walk from the root finds: whether all is as it must be, and the sum of areas.
class BuildTreeWalk {
 public:
  explicit BuildTreeWalk(const HostBuildTree& tree) : tree_(tree), seen_(tree.count()) {
    visit(tree.root);
    EXPECT_EQ(nodes_, tree.count() - 1);
    EXPECT_EQ(seen_, std::vector<int>(tree.count(), 1)) << "how often primitives are there";
  }

  double area = 0;

 private:
  std::uint32_t visit(TreeRef ref) {
    if (is_primitive(ref)) {
      ++seen_.at(ref_index(ref));
      return 1;
    }
    if (++nodes_ >= tree_.count()) return 0;  // a cycle, perhaps
    const BuildNode& node = tree_.nodes.at(ref_index(ref));
    area += static_cast<double>(node.bounds().half_area());
    const std::uint32_t below = visit(node.left) + visit(node.right);
    EXPECT_EQ(ref, make_ref(below, ref_index(ref))) << "the number of primitives";
    Bounds both = tree_[node.left].bounds();
    both.grow(tree_[node.right].bounds());
    EXPECT_EQ(both.min, node.min);
    EXPECT_EQ(both.max, node.max);
    return below;
  }

  const HostBuildTree& tree_;
  std::vector<int> seen_;
  std::uint32_t nodes_ = 0;
};

HostBuildTree reinserted(HostBuildTree tree, const ThreadOrder& order = run_forward) {
  SerialReinsertion(tree, order).run();
  return tree;
}

TEST(Reinsertion, KeepsEveryPrimitiveOnce) {
  for (const BuildCase& scene : build_cases) {
    for (const std::uint32_t count : {2u, 3u, 4u, 5u, 17u, 100u, 3000u}) {
      SCOPED_TRACE(testing::Message() << scene.name << ", " << count);
      const HostBuildTree before = SerialHploc(boxes_of(scene.make(count))).tree;
      const HostBuildTree after = reinserted(before);
      EXPECT_LE(BuildTreeWalk(after).area, 1.000001 * BuildTreeWalk(before).area);
      if (HasFailure()) return;
    }
  }
}

bool is_same_tree(const HostBuildTree& a, const HostBuildTree& b) {
  return a.root == b.root &&
         std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BuildNode)) == 0;
}

TEST(Reinsertion, TheOrderOfThreadsDoesNotMatter) {
  for (const BuildCase& scene : build_cases) {
    const HostBuildTree before = SerialHploc(boxes_of(scene.make(5000))).tree;
    const HostBuildTree forward = reinserted(before);
    EXPECT_TRUE(is_same_tree(reinserted(before, run_backward), forward)) << scene.name;
    EXPECT_TRUE(is_same_tree(reinserted(before, run_shuffled), forward)) << scene.name;
  }
}

/// The same tree as the CPU's builders have it.
BinaryTree to_binary(const HostBuildTree& tree) {
  BinaryTree binary;
  binary.node_capacity = tree.count();
  binary.nodes.reset(new Bvh2Node[tree.count()]());
  binary.bounds = tree[tree.root].bounds();
  std::uint32_t count = 0;
  const std::function<std::uint32_t(TreeRef)> add = [&](TreeRef ref) {
    if (is_primitive(ref)) {
      binary.order.push_back(ref_index(ref));
      return make_leaf(static_cast<std::uint32_t>(binary.order.size() - 1), 1);
    }
    const std::uint32_t index = count++;
    const BuildNode& node = tree[ref];
    const TreeRef children[] = {node.left, node.right};
    for (int i = 0; i < 2; ++i) {
      set_child_bounds(binary.nodes[index], i, tree[children[i]].bounds());
      binary.nodes[index].child[i] = add(children[i]);
    }
    return index;
  };
  binary.root = add(tree.root);
  return binary;
}

double wide_cost(const BinaryTree& tree) {
  const Cwbvh wide = collapse_cwbvh(tree, default_cwbvh_costs);
  return measure_tree(std::span(wide.nodes), 0).sah_cost(static_cast<double>(cwbvh_triangle_cost));
}

BinaryTree binned_tree(const std::vector<Bounds>& boxes) {
  return build_sah(static_cast<std::uint32_t>(boxes.size()),
                   [&](std::uint32_t i) { return boxes[i]; });
}

// The stored shares are those of a tree by binned SAH, after the collapse.
TEST(Reinsertion, TreesGetNearlyAsCheapAsTheCpuBuilders) {
  struct {
    const char* scene;
    double before, after;
  } const cases[] = {{"hills", 1.087, 1.019}, {"soup", 1.016, 0.951}, {"far_away", 0.970, 0.923}};
  for (const auto& c : cases) {
    const std::vector<Bounds> boxes = make_boxes(c.scene, 40'000);
    const double reference = wide_cost(binned_tree(boxes));
    const HostBuildTree before = SerialHploc(boxes).tree;
    const HostBuildTree after = reinserted(before);
    EXPECT_NEAR(wide_cost(to_binary(before)) / reference, c.before, 0.004) << c.scene;
    EXPECT_NEAR(wide_cost(to_binary(after)) / reference, c.after, 0.004) << c.scene;
    // The CPU's reinsertion takes a few of the nodes alone, and moves them one by one.
    const std::optional<BinaryTree> upper = reinsert_nodes(to_binary(before));
    if (upper) {
      EXPECT_LT(wide_cost(to_binary(after)), wide_cost(*upper)) << c.scene;
    }
  }
}

/// Halves the numbers: a tree that knows nothing of where things are.
HostBuildTree tree_by_number(const std::vector<Bounds>& boxes) {
  HostBuildTree tree;
  for (const Bounds& box : boxes) tree.primitives.push_back({box.min, 0, box.max, 0});
  tree.nodes.resize(boxes.size(), {{}, no_node, {}, no_node});
  std::uint32_t used = 0;
  const std::function<TreeRef(std::uint32_t, std::uint32_t)> add = [&](std::uint32_t first,
                                                                       std::uint32_t end) {
    if (end - first == 1) return make_ref(1, first);
    const std::uint32_t index = used++, middle = (first + end) / 2;
    const TreeRef left = add(first, middle), right = add(middle, end);
    Bounds box = tree[left].bounds();
    box.grow(tree[right].bounds());
    tree.nodes[index] = {box.min, left, box.max, right};
    return make_ref(end - first, index);
  };
  tree.root = add(0, static_cast<std::uint32_t>(boxes.size()));
  return tree;
}

// The sum of areas, and so every estimate of a gain, is checked against the tree that follows.
TEST(Reinsertion, ASingleMoveGainsWhatItsSearchSays) {
  const HostBuildTree before = tree_by_number(make_boxes("soup", 60));
  int moved = 0;
  for (std::uint32_t chosen = 0; chosen < 120; ++chosen) {
    HostBuildTree tree = before;
    SerialReinsertion reinsertion(tree, run_forward);
    const ReinsertionJob& job = reinsertion.job();
    const Move found = find_best_move(job, chosen);
    reinsertion.pass(static_cast<int>(chosen), [&](std::uint32_t i) {
      job.moves[i] = job.candidate(i) == chosen ? found : Move{};
    });
    const double saved = BuildTreeWalk(before).area - BuildTreeWalk(tree).area;
    if (found.to == no_node) continue;
    ++moved;
    EXPECT_NEAR(saved, static_cast<double>(found.gain), 1e-5 * BuildTreeWalk(before).area);
  }
  EXPECT_GT(moved, 60);
}

/// A legal move of a random gain: to somewhere below the other child of an ancestor.
Move random_move(const ReinsertionJob& job, TestRandom& random, std::uint32_t candidate) {
  const TreeRef moved = numbered_ref(job, candidate);
  const std::uint32_t parent = parent_of(job, moved);
  if (parent == no_node || random.below(3) == 0) return {};
  std::uint32_t pivot = parent;
  TreeRef below = moved;
  while (random.below(3) != 0 && job.parents[pivot] != no_node) {
    below = node_ref(pivot);
    pivot = job.parents[pivot];
  }
  TreeRef to = other_child(job, job.nodes[pivot], below);
  if (pivot == parent && is_primitive(to)) return {};
  bool has_moved_down = pivot != parent;  // beside the old sibling nothing would change
  while (!is_primitive(to) && (!has_moved_down || random.below(4) != 0)) {
    const BuildNode& node = job.nodes[ref_index(to)];
    to = random.below(2) == 0 ? node.left : node.right;
    has_moved_down = true;
  }
  return {static_cast<float>(1 + random.below(5)), to, pivot};
}

/// The made moves, found in `before`, the job as it was, change different links.
void expect_different_links(const ReinsertionJob& before, const ReinsertionJob& after) {
  std::vector<int> changes(2 * before.count);
  for (std::uint32_t i = 0; i < after.candidates(); ++i) {
    const TreeRef to = after.moves[i].to;
    if (to == no_node) continue;
    const ChangedLinks links = links_of(before, numbered_ref(before, after.candidate(i)), to);
    for (const TreeRef ref : {links.moved, links.sibling, node_ref(links.parent), links.to}) {
      EXPECT_EQ(++changes[number_of(before, ref)], 1);
    }
  }
}

// Whatever moves are wanted at once, many of them into each other: what is made leaves a tree.
TEST(Reinsertion, AnyMovesAtOnceLeaveATree) {
  TestRandom random(3);
  std::size_t made = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const std::uint32_t count = 3 + random.below(60);
    HostBuildTree trees[3];
    trees[0] = trees[1] = trees[2] = tree_by_number(boxes_of(make_soup(count, 10, 1)));
    const ThreadOrder orders[3] = {run_forward, run_backward, run_shuffled};
    const auto seed = static_cast<std::uint64_t>(trial);
    for (int i = 0; i < 3; ++i) {
      SerialReinsertion reinsertion(trees[i], orders[i]);
      const ReinsertionJob& job = reinsertion.job();
      for (int pass = 0; pass < 4; ++pass) {
        std::vector<Move> moves;
        TestRandom choice(4 * seed + static_cast<std::uint64_t>(pass) + 1);
        const std::uint32_t first = static_cast<std::uint32_t>(pass) % reinsertion_stride;
        for (std::uint32_t c = first; c < 2 * count; c += reinsertion_stride) {
          moves.push_back(random_move(job, choice, c));
        }
        std::vector<BuildNode> nodes = trees[i].nodes;
        std::vector<std::uint32_t> parents(job.parents, job.parents + 2 * count);
        ReinsertionJob before = job;
        before.nodes = nodes.data(), before.parents = parents.data();
        made += reinsertion.pass(pass, [&](std::uint32_t k) { job.moves[k] = moves[k]; });
        expect_different_links(before, job);
        const BuildTreeWalk walk(trees[i]);
        if (HasFailure()) FAIL() << "trial " << trial << ", pass " << pass;
      }
    }
    ASSERT_TRUE(is_same_tree(trees[1], trees[0])) << trial;
    ASSERT_TRUE(is_same_tree(trees[2], trees[0])) << trial;
  }
  EXPECT_GT(made, 20'000u);
}

TEST(Reinsertion, EndsWithCoordinatesThatAreNotNumbers) {
  std::vector<Bounds> boxes = make_boxes("soup", 3000);
  for (std::size_t i = 0; i < boxes.size(); i += 7) boxes[i].min.y = boxes[i].max.y = NAN;
  for (std::size_t i = 0; i < boxes.size(); i += 11) boxes[i].max.x = HUGE_VALF;
  HostBuildTree tree = SerialHploc(boxes).tree;
  SerialReinsertion(tree, run_forward).run();
  std::vector<int> seen(tree.count());
  const std::function<void(TreeRef)> visit = [&](TreeRef ref) {
    if (is_primitive(ref)) {
      ++seen.at(ref_index(ref));
    } else {
      visit(tree[ref].left), visit(tree[ref].right);
    }
  };
  visit(tree.root);
  EXPECT_EQ(seen, std::vector<int>(tree.count(), 1));
}

}  // namespace
}  // namespace pt
