// Below the chin skin rests on skin as the mouth opens wide.
#include "sim/tissue/skin_fold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "engine/collide/triangle_distance.h"
#include "engine/core/units.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "sim/tissue/solver_cache.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Shortest translation that separates any two crossing faces of the skin without a common column,
/// mm.
double deepest_crossing(const TissueModel& model, const Nodes& x) {
  std::vector<Triangle> faces;
  std::vector<Box> boxes;
  for (const auto& t : model.mesh->triangles) {
    Triangle face;
    Box box;
    for (int k = 0; k < 3; ++k) {
      face[k] = x[node_of(t[k], 0, model.mesh->sheets)];
      box.add(face[k]);
    }
    faces.push_back(face);
    boxes.push_back(box);
  }
  double deepest = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto &a = model.mesh->triangles[i], &b = model.mesh->triangles[k];
      const auto in_b = [&](int column) { return (b.array() == column).any(); };
      if ((boxes[i].low.array() > boxes[k].high.array()).any() ||
          (boxes[k].low.array() > boxes[i].high.array()).any() ||
          std::any_of(a.begin(), a.end(), in_b) || !triangle_crossing(faces[i], faces[k]).crosses)
        continue;
      deepest = std::max(deepest, triangle_overlap(faces[i], faces[k]));
    }
  return deepest;
}

double farthest(const Nodes& a, const Nodes& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

// Without it skin penetrated skin by 4 mm, and columns snapped by 10 mm from fold to fold.
TEST(SkinFold, TheChinComesToLieOnTheThroatAndLeavesItAgain) {
  Case patient = test::builtin();
  part_lips(patient);
  const auto model = build_tissue(patient);
  ASSERT_TRUE(model);
  const auto& [chin, throat] = model->contact->fold;
  EXPECT_GT(chin.points.size(), 50u);
  EXPECT_GT(throat.points.size(), 50u);
  TissueWarmStart warm;
  const auto touches = [&] {
    const ContactLists& lists = warm.last->touches;
    const std::size_t obstacles = model->contact->obstacles.size();
    return lists[obstacles + chin_on_throat].size() + lists[obstacles + throat_on_chin].size();
  };

  constexpr double step = 0.75 * degree;
  constexpr int begin = 26, widest = 50, looked_at = 48;  // steps
  TissueState state = rest_tissue(*model);
  for (const double fraction : {0.25, 0.5, 0.75})
    state = solve_tissue(
        *model, state, test::jaw_at(model->opening.path->pose(fraction * begin * step)), {}, warm);
  EXPECT_EQ(touches(), 0u);
  double max_step = 0, deepest = 0;
  Nodes opening;
  const auto go_to = [&](int i) {
    const TissueState next =
        solve_tissue(*model, state, test::jaw_at(model->opening.path->pose(i * step)), {}, warm);
    EXPECT_TRUE(next.converged) << i;
    EXPECT_LT(next.penetration_mm, 0.1) << i;
    if (state.X_CB[1].R.coeffs() != next.X_CB[1].R.coeffs() && i != begin)
      max_step = std::max(max_step, farthest(state.nodes, next.nodes));
    state = next;
    deepest = std::max(deepest, deepest_crossing(*model, state.nodes));
  };
  for (int i = begin; i <= widest; ++i) {
    go_to(i);
    if (i == looked_at) opening = state.nodes;
  }
  EXPECT_GT(touches(), 8u);
  for (int i = widest - 1; i >= looked_at; --i) go_to(i);
  std::printf(
      "skin crosses by up to %.2f mm; largest displacement of a step %.2f mm; opening and closing "
      "%.2f mm apart\n",
      deepest, max_step, farthest(opening, state.nodes));
  EXPECT_LT(deepest, 0.6);  // between points 6 mm apart
  EXPECT_LT(max_step, 4);
  EXPECT_LT(farthest(opening, state.nodes), 1);
}

}  // namespace
}  // namespace condyle
