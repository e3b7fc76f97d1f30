#include "sim/frame/body_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/core/error.h"
#include "sim/frame/body_poses.h"

using namespace condyle;

namespace {

/// cranium <- maxilla, mandible <- chin <- graft
BodyTree operated() {
  BodyTree tree;
  tree.add({.name = "maxilla"});
  const BodyId mandible = tree.add({.name = "mandible", .driver = BodyDriver::motion});
  const BodyId chin = tree.add({.name = "chin", .parent = mandible, .driver = BodyDriver::plan});
  tree.add({.name = "graft", .parent = chin, .driver = BodyDriver::hand});
  return tree;
}

}  // namespace

TEST(BodyTree, SubtreesFollowTheParents) {
  const BodyTree tree = operated();
  EXPECT_EQ(tree.subtree(BodyId{2}), (std::vector<BodyId>{BodyId{2}, BodyId{3}, BodyId{4}}));
  EXPECT_TRUE(tree.is_within(BodyId{4}, cranium_body));
  EXPECT_FALSE(tree.is_within(BodyId{4}, BodyId{1}));
  EXPECT_FALSE(tree.is_within(BodyId{2}, BodyId{3}));
}

TEST(BodyTree, ParentsPrecedeChildrenAfterAnyChange) {
  std::mt19937 random(7);
  const auto any = [&](int below) {
    return static_cast<int>(random() % static_cast<unsigned>(below));
  };
  int moved = 0, refused = 0;
  for (int round = 0; round < 200; ++round) {
    BodyTree tree;
    for (int i = 0; i < 8; ++i)
      tree.add({.name = "b" + std::to_string(i), .parent = BodyId{any(tree.size())}});
    const BodyTree before = tree;
    const BodyId body{1 + any(8)}, parent{any(9)};
    if (before.is_within(parent, body)) {
      EXPECT_THROW(tree.reparent(body, parent), InputError);
      EXPECT_EQ(tree, before);
      ++refused;
    } else {
      const auto number = tree.reparent(body, parent);
      for (int i = 1; i < 9; ++i) {
        const BodyId old{i}, now = number[static_cast<std::size_t>(i)];
        EXPECT_EQ(tree[now].name, before[old].name);
        EXPECT_LT(tree[now].parent, now);
        const BodyId expected = old == body ? parent : before[old].parent;
        EXPECT_EQ(tree[tree[now].parent].name, before[expected].name);
      }
      ++moved;
    }
    const BodyTree whole = tree;
    const BodyId gone{1 + any(8)};
    const auto number = tree.remove(gone);
    EXPECT_FALSE(number[index_of(gone)]);
    for (int i = 1; i < tree.size(); ++i) EXPECT_LT(tree[BodyId{i}].parent, BodyId{i});
    for (const BodyId child : whole.subtree(gone)) {
      if (child == gone || whole[child].parent != gone) continue;
      const BodyId heir = tree[*number[index_of(child)]].parent;
      EXPECT_EQ(tree[heir].name, whole[whole[gone].parent].name);
    }
  }
  EXPECT_GT(moved, 50);
  EXPECT_GT(refused, 10);
}

TEST(BodyTree, CyclesAndUnknownParentsAreRefused) {
  BodyTree tree = operated();
  EXPECT_THROW(tree.add({.name = ""}), InputError);
  EXPECT_THROW(tree.add({.name = "chin"}), InputError);
  EXPECT_THROW(tree.add({.name = "x", .parent = BodyId{9}}), InputError);
  EXPECT_THROW(tree.remove(cranium_body), InputError);
  EXPECT_THROW(tree.reparent(cranium_body, BodyId{1}), InputError);
  EXPECT_EQ(tree, operated());
}

TEST(BodyPoses, AMotionOfTheJawMovesItsBodiesWhereverTheyAreInTheTree) {
  const Pose X_CM{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX())),
                  Eigen::Vector3d(1, -4, -7)};
  const BodyPoses at = with_jaw_at(operated(), X_CM);
  ASSERT_EQ(at.X_CB.size(), 5u);
  for (const int body : {0, 1}) EXPECT_TRUE(bit_identical(at[BodyId{body}], {})) << body;
  for (const int body : {2, 3, 4}) EXPECT_TRUE(bit_identical(at[BodyId{body}], X_CM)) << body;

  // The same bits as a native mandible with all that hangs on it.
  BodyTree native = native_bodies();
  native.add({.name = "chin", .parent = mandible_body, .driver = BodyDriver::hand});
  native.add({.name = "graft", .driver = BodyDriver::hand});
  const BodyPoses moved = with_jaw_at(native, X_CM), expected = completed(native, BodyPoses(X_CM));
  for (int body = 0; body < native.size(); ++body)
    EXPECT_TRUE(bit_identical(moved[BodyId{body}], expected[BodyId{body}])) << body;
}
