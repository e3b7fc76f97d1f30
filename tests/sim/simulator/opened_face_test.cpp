// What is seen of the built-in patient with the mouth wide open: no fold where skin should run
// smoothly from ear to chin, and teeth between the lips.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/mesh/topology.h"
#include "sim/phantom/phantom.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/jaw_pose.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class OpenedFace : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    patient_ = new Case(builtin_patient());
    part_lips(*patient_);
    const auto model = build_tissue(*patient_);
    TissueState state = rest_tissue(*model);
    TissueWarmStart warm;
    constexpr int steps = 24;
    for (int i = 1; i <= steps; ++i)
      state = solve_tissue(*model, state, test::jaw_at(opened(44.0 * i / steps)), {}, warm);
    pose_ = opened(44.0);
    opened_ = new std::vector<Vector3f>;
    deform_face(*model, state, *opened_);
  }
  static void TearDownTestSuite() {
    delete patient_;
    delete opened_;
  }

  /// 50 mm of descent at the incisors for 44 degrees.
  static Pose opened(double degrees) {
    const Vector3d condyles = 0.5 * (*patient_->landmarks.find("left_condyle") +
                                     *patient_->landmarks.find("right_condyle"));
    const double slide = std::max(0.0, degrees - 4) * 0.41;
    Pose X_CM;
    X_CM.R = Eigen::Quaterniond(Eigen::AngleAxisd(degrees * degree, Vector3d::UnitX()));
    X_CM.t = condyles - X_CM.R * condyles + Vector3d(0, -slide, -7.3 * (1 - std::exp(-slide / 6)));
    return X_CM;
  }

  static const TriMesh& face() { return patient_->find(Role::face)->mesh; }

  /// Largest increase of the angle between neighbouring triangles within a box at rest.
  static double sharpest_fold(const Vector3d& low, const Vector3d& high) {
    const auto normal = [](const auto& vertices, const Eigen::Vector3i& t) -> Vector3d {
      const Vector3d a = vertices[t[0]].template cast<double>(),
                     b = vertices[t[1]].template cast<double>(),
                     c = vertices[t[2]].template cast<double>();
      return (b - a).cross(c - a).normalized();
    };
    const auto bend = [&](const auto& vertices, int t, int u) {
      const auto& triangles = face().triangles;
      return std::acos(std::clamp(
          normal(vertices, triangles[t]).dot(normal(vertices, triangles[u])), -1.0, 1.0));
    };
    double sharpest = 0;
    const EdgeList list = find_edges(face());
    for (const auto& edge : list.edges) {
      const Vector3d at = 0.5 * (face().vertices[edge.low] + face().vertices[edge.high]);
      const Vector3d left(std::abs(at.x()), at.y(), at.z());
      if (edge.count != 2 || (left.array() < low.array()).any() ||
          (left.array() > high.array()).any())
        continue;
      const int t = list.sides[edge.first].triangle, u = list.sides[edge.first + 1].triangle;
      sharpest = std::max(sharpest, bend(*opened_, t, u) - bend(face().vertices, t, u));
    }
    return sharpest / degree;
  }

  inline static Case* patient_ = nullptr;
  inline static std::vector<Vector3f>* opened_ = nullptr;
  inline static Pose pose_;
};

TEST_F(OpenedFace, SkinRunsSmoothlyFromEarToChin) {
  EXPECT_LT(sharpest_fold({40, -40, -60}, {90, 60, -25}), 25);   // below the ear lobe
  EXPECT_LT(sharpest_fold({35, -45, -95}, {80, 20, -60}), 45);   // behind the jaw angle
  EXPECT_LT(sharpest_fold({25, -75, -60}, {80, -40, -10}), 15);  // cheek
}

TEST_F(OpenedFace, TeethShowBetweenTheLips) {
  double upper_lip = 1e9, lower_lip = -1e9;  // edges in the middle, z
  for (std::size_t v = 0; v < opened_->size(); ++v) {
    const Vector3d& p = face().vertices[v];
    if (std::abs(p.x()) > 2 || p.y() > -95 || std::abs(p.z() + 50.5) > 14) continue;
    const double z = (*opened_)[v].z();
    if (z > -75)
      upper_lip = std::min(upper_lip, z);
    else
      lower_lip = std::max(lower_lip, z);
  }
  const double upper_edge = patient_->landmarks.find("upper_incisal_point")->z();
  const double lower_edge = (pose_ * *patient_->landmarks.find("lower_incisal_point")).z();
  EXPECT_GT(upper_lip - upper_edge, 1);
  EXPECT_GT(lower_edge - lower_lip, 1);
}

}  // namespace
}  // namespace condyle
