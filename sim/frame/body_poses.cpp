#include "sim/frame/body_poses.h"

#include <cassert>

namespace condyle {

const Pose& BodyPoses::operator[](BodyId body) const {
  static const Pose rest;
  assert(static_cast<int>(body) >= 0);
  return index_of(body) < X_CB.size() ? X_CB[index_of(body)] : rest;
}

Pose& BodyPoses::operator[](BodyId body) {
  assert(static_cast<int>(body) >= 0);
  if (index_of(body) >= X_CB.size()) X_CB.resize(index_of(body) + 1);
  return X_CB[index_of(body)];
}

bool bit_identical(const Pose& a, const Pose& b) {
  return a.R.coeffs() == b.R.coeffs() && a.t == b.t;
}

Pose composed(const Pose& X_CP, const Pose& X_PB) {
  if (bit_identical(X_CP, {})) return X_PB;
  return bit_identical(X_PB, {}) ? X_CP : X_CP * X_PB;
}

Pose pose_in(BodyId reference, BodyId body, const BodyPoses& at) {
  const Pose &X_CR = at[reference], &X_CB = at[body];
  if (bit_identical(X_CR, {})) return X_CB;
  return bit_identical(X_CR, X_CB) ? Pose{} : X_CR.inverse() * X_CB;
}

BodyId lower_jaw_of(std::span<const Part> parts) {
  for (const Role role : {Role::lower_teeth, Role::mandible})
    for (const Part& part : parts)
      if (part.role == role) return part.body;
  return mandible_body;
}

BodyPoses completed(const BodyTree& tree, BodyPoses at) {
  if (at.X_CB.empty()) at.X_CB.emplace_back();
  while (static_cast<int>(at.X_CB.size()) < tree.size())
    at.X_CB.push_back(at[tree[BodyId{static_cast<int>(at.X_CB.size())}].parent]);
  return at;
}

BodyPoses placed(const BodyTree& tree, std::span<const Pose> X_PB) {
  assert(X_PB.size() <= tree.bodies().size());
  BodyPoses at;
  for (std::size_t b = 0; b < tree.bodies().size(); ++b) {
    const Pose X = b < X_PB.size() ? X_PB[b] : Pose{};
    at.X_CB.push_back(b == 0 ? X : composed(at[tree.bodies()[b].parent], X));
  }
  return at;
}

std::vector<Pose> in_parents(const BodyTree& tree, const BodyPoses& at) {
  assert(at.X_CB.size() >= tree.bodies().size());
  std::vector<Pose> X_PB{at[cranium_body]};
  for (int b = 1; b < tree.size(); ++b)
    X_PB.push_back(pose_in(tree[BodyId{b}].parent, BodyId{b}, at));
  return X_PB;
}

std::vector<Pose> motion_target_poses(const BodyTree& tree, const Pose& X_CM,
                                      std::span<const Pose> others) {
  std::vector<Pose> X_PB(tree.bodies().size());
  for (std::size_t b = 1; b < X_PB.size(); ++b) {
    const bool leads = tree.moved_by_motion(BodyId{static_cast<int>(b)});
    X_PB[b] = leads ? X_CM : b < others.size() ? others[b] : Pose{};
  }
  return X_PB;
}

BodyPoses with_jaw_at(const BodyTree& tree, const Pose& X_CM) {
  return placed(tree, motion_target_poses(tree, X_CM));
}

BodyPoses with_jaw_at(const BodyTree& tree, const BodyPoses& at, const Pose& X_CM) {
  const BodyPoses before = completed(tree, at);
  return placed(tree, motion_target_poses(tree, X_CM, in_parents(tree, before)));
}

}  // namespace condyle
