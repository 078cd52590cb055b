#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<Cell> make_cells(std::size_t count) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::int32_t>(i * 10);
    cells.push_back({64, {{at, -at, 0}, {at + 9, 5 - at, 1}}});
  }
  return cells;
}

/// Checks the subtree of `index`; returns the index after it.
std::uint32_t check_subtree(const std::vector<TreeNode>& tree, std::uint32_t index,
                            const std::vector<Cell>& cells) {
  const TreeNode& node = tree.at(index);
  QuantumBox box = cells.at(node.first_cell).box;
  for (std::uint32_t i = 1; i < node.cell_count; ++i) {
    box = box.united(cells.at(node.first_cell + i).box);
  }
  CHECK(node.box == box);
  if (node.right == 0) {
    check_equal(node.cell_count, 1);
    return index + 1;
  }
  const TreeNode& left = tree.at(index + 1);
  const TreeNode& right = tree.at(node.right);
  CHECK(left.first_cell == node.first_cell);
  CHECK(right.first_cell == node.first_cell + left.cell_count);
  CHECK(left.cell_count + right.cell_count == node.cell_count);
  CHECK(check_subtree(tree, index + 1, cells) == node.right);
  return check_subtree(tree, node.right, cells);
}

void check_tree(const std::vector<TopNode>& top, std::size_t cell_count) {
  const auto cells = make_cells(cell_count);
  const auto tree = build_cell_tree(top, cells);
  REQUIRE(tree.size() == 2 * cell_count - 1);
  CHECK(tree[0].cell_count == cell_count);
  CHECK(check_subtree(tree, 0, cells) == tree.size());
}

}  // namespace

TEST_CASE("no cells have no tree") { CHECK(build_cell_tree({}, {}).empty()); }

TEST_CASE("one bucket of any number of cells follows the split rule") {
  for (std::uint32_t count = 1; count <= 40; ++count) {
    check_tree({{0, count, 0}}, count);
    if (count == 1) continue;
    const auto tree = build_cell_tree(std::vector<TopNode>{{0, count, 0}}, make_cells(count));
    CHECK(tree[1].cell_count == left_count(count, 1));
  }
}

TEST_CASE("buckets below an explicit top tree, also a deep chain of them") {
  check_tree({{0, 8, 2}, {0, 5, 0}, {5, 3, 0}}, 8);
  check_tree({{0, 8, 4}, {0, 5, 3}, {0, 1, 0}, {1, 4, 0}, {5, 3, 0}}, 8);
  check_tree({{0, 4, 2}, {0, 1, 0}, {1, 3, 4}, {1, 1, 0}, {2, 2, 0}}, 4);
  std::vector<TopNode> chain;
  for (std::uint32_t i = 0; i + 1 < 200; ++i) {
    chain.push_back({i, 200 - i, 2 * i + 2});
    chain.push_back({i, 1, 0});
  }
  chain.push_back({199, 1, 0});
  check_tree(chain, 200);
}

TEST_CASE("a top tree that is none over the cells is refused") {
  const auto cells = make_cells(8);
  const std::vector<std::vector<TopNode>> wrong{
      {},
      {{0, 7, 0}},                                    // too few cells
      {{0, 9, 0}},                                    // too many
      {{1, 8, 0}},                                    // not from the first
      {{0, 8, 0}, {0, 8, 0}},                         // a node no one refers to
      {{0, 8, 1}, {0, 5, 0}, {5, 3, 0}},              // right is left
      {{0, 8, 3}, {0, 5, 0}, {5, 3, 0}},              // right past the end
      {{0, 8, 2}, {0, 8, 0}, {8, 0, 0}},              // an empty right side
      {{0, 8, 2}, {0, 0, 0}, {0, 8, 0}},              // an empty left side
      {{0, 8, 2}, {0, 5, 0}, {4, 3, 0}},              // overlapping sides
      {{0, 8, 2}, {0, 5, 0}, {5, 2, 0}},              // a cell left out
      {{0, 8, 2}, {0, 5, 0}, {5, 3, 1}},              // a cycle
      {{0, 8, 3}, {0, 5, 0}, {5, 1, 0}, {5, 3, 0}},   // a node skipped
      {{0, 8, 0xffffffff}, {0, 5, 0}, {5, 3, 0}},     // far past the end
      {{0, 8, 2}, {0xfffffff0, 0x15, 0}, {5, 3, 0}},  // sums that wrap around
  };
  for (const auto& top : wrong) {
    CAPTURE(&top - wrong.data());
    CHECK_THROWS_AS(build_cell_tree(top, cells), InputError);
  }
  CHECK_THROWS_AS(build_cell_tree(std::vector<TopNode>{{0, 1, 0}}, {}), InputError);
}
