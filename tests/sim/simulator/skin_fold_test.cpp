// Below the chin skin comes to lie on skin as the mouth opens wide.
#include "sim/tissue/skin_fold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "engine/collide/triangle_distance.h"
#include "engine/tissue/layered_net.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/model.h"
#include "tests/support/builtin.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The least move that parts any two faces of the skin that cross and have no column in common, mm.
double deepest_crossing(const TissueModel& model, const Nodes& x) {
  std::vector<Triangle> faces;
  std::vector<Box> boxes;
  for (const auto& t : model.triangles) {
    Triangle face;
    Box box;
    for (int k = 0; k < 3; ++k) {
      face[k] = x[node_of(t[k], 0, model.sheets)];
      box.add(face[k]);
    }
    faces.push_back(face);
    boxes.push_back(box);
  }
  double deepest = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto &a = model.triangles[i], &b = model.triangles[k];
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

// Without it skin went through skin by 4 mm, and columns snapped by 10 mm from fold to fold.
TEST(SkinFold, TheChinComesToRestOnTheThroatAndLeavesItAgain) {
  Case patient = test::builtin();
  part_lips(patient);
  const auto model = build_tissue(patient);
  ASSERT_TRUE(model);
  const auto& [chin, throat] = model->contact.fold;
  EXPECT_GT(chin.points.size(), 50u);
  EXPECT_GT(throat.points.size(), 50u);
  const auto touches = [&](const TissueState& state) {
    const Looks& looks = *state.touches;
    return looks[chin_on_throat].size() + looks[throat_on_chin].size();
  };

  constexpr double degree = 3.14159265358979 / 180, step = 0.75 * degree;
  constexpr int begin = 26, widest = 50, looked_at = 48;  // steps
  TissueState state = rest_tissue(*model);
  for (const double share : {0.25, 0.5, 0.75})
    state = follow(*model, state, model->path.pose(share * begin * step));
  EXPECT_EQ(touches(state), 0u);
  double leap = 0, deepest = 0;
  Nodes opening;
  const auto go_to = [&](int i) {
    const TissueState next = follow(*model, state, model->path.pose(i * step));
    EXPECT_TRUE(next.converged) << i;
    EXPECT_LT(next.penetration_mm, 0.1) << i;
    if (state.X_CM.R.coeffs() != next.X_CM.R.coeffs() && i != begin)
      leap = std::max(leap, farthest(state.nodes, next.nodes));
    state = next;
    deepest = std::max(deepest, deepest_crossing(*model, state.nodes));
  };
  for (int i = begin; i <= widest; ++i) {
    go_to(i);
    if (i == looked_at) opening = state.nodes;
  }
  EXPECT_GT(touches(state), 8u);
  for (int i = widest - 1; i >= looked_at; --i) go_to(i);
  std::printf(
      "skin crosses by up to %.2f mm; longest way of a step %.2f mm; opening and closing "
      "%.2f mm apart\n",
      deepest, leap, farthest(opening, state.nodes));
  EXPECT_LT(deepest, 0.6);  // between points 6 mm apart
  EXPECT_LT(leap, 4);
  EXPECT_LT(farthest(opening, state.nodes), 1);
}

}  // namespace
}  // namespace condyle
