#include "sim/dynamics/excitation_finder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int max_rounds = 200;
constexpr double close_enough = 1e-6;  // tolerance of an excitation

/// Minimises x.Ax/2 - b.x over 0 <= x <= 1, A positive definite, by coordinate descent.
VectorXd bounded_minimum(const MatrixXd& A, const VectorXd& b, VectorXd x) {
  for (int round = 0; round < max_rounds; ++round) {
    double moved = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double better = std::clamp(x[i] + (b[i] - A.row(i).dot(x)) / A(i, i), 0.0, 1.0);
      moved = std::max(moved, std::abs(better - x[i]));
      x[i] = better;
    }
    if (moved < close_enough) break;
  }
  return x;
}

}  // namespace

ExcitationFinder::ExcitationFinder(const Case& patient, const MuscleJaw& jaw,
                                   const ExcitationFinderSettings& settings)
    : settings_(settings), last_(jaw.muscles().size(), 0.0), law_(jaw.law()) {
  for (const auto& [name, weight] :
       {std::pair{"lower_incisal_point", 1.0}, std::pair{"left_condyle", settings.condyle_weight},
        std::pair{"right_condyle", settings.condyle_weight}}) {
    points_.push_back(*patient.landmarks.find(name));  // present, since the joints use them
    weights_.push_back(weight);
  }
}

std::vector<double> ExcitationFinder::find(const MuscleJaw& jaw, const Pose& now,
                                           const Pose& after) {
  const double h = settings_.hold_s;
  const Eigen::Matrix3d R = jaw.pose().R.toRotationMatrix();
  const auto pulls = jaw.pulls();
  // Mass, and the loss of muscle force with the speed that it produces.
  Eigen::Matrix<double, 6, 6> inertia = Eigen::Matrix<double, 6, 6>::Zero();
  inertia.topLeftCorner<3, 3>() = jaw.mass().mass_kg * Eigen::Matrix3d::Identity();
  inertia.bottomRightCorner<3, 3>() = R * jaw.mass().inertia * R.transpose();
  for (const auto& pull : pulls)
    inertia +=
        h * mm_per_m * pull.tension.slope_N_s_mm * pull.direction * pull.direction.transpose();
  const Eigen::Matrix<double, 6, 6> give = inertia.inverse();
  // Directions constrained by the guides.
  const Eigen::Matrix<double, 3, 6> held = jaw.held();
  const Eigen::Matrix<double, 6, 3> held_give = give * held.transpose();
  const Eigen::Matrix<double, 6, 6> free =
      Eigen::Matrix<double, 6, 6>::Identity() - held_give * (held * held_give).inverse() * held;

  // Velocities of the points after the interval: without excitation, and per muscle.
  const auto count = static_cast<Eigen::Index>(last_.size());
  Vector6d coasting;
  coasting << jaw.motion().velocity, jaw.motion().spin;
  Vector6d passive = jaw.other_forces();
  MatrixXd by_muscle = MatrixXd::Zero(6, count);
  for (Eigen::Index m = 0; m < count; ++m) {
    const auto& pull = pulls[static_cast<std::size_t>(m)];
    const double activation = jaw.states()[static_cast<std::size_t>(m)].activation;
    // The activation during the interval lies between its present value and the excitation.
    const double follows = next_activation(law_, 0, 1, 0.5 * h);
    passive += (pull.tension.passive_N + (1 - follows) * activation * pull.tension.active_N) *
               pull.direction;
    by_muscle.col(m) = follows * pull.tension.active_N * pull.direction;
  }
  coasting = free * (coasting + h * mm_per_m * give * passive);
  by_muscle = (free * give * by_muscle * (h * mm_per_m)).eval();

  MatrixXd A = MatrixXd::Zero(count, count);
  VectorXd b = VectorXd::Zero(count);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Vector3d arm = jaw.pose() * points_[k] - jaw.center();
    Eigen::Matrix<double, 3, 6> velocity;
    velocity.leftCols<3>().setIdentity();
    velocity.rightCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    const Vector3d target = (after * points_[k] - now * points_[k]) / h +
                            settings_.catch_up_per_s * (now * points_[k] - jaw.pose() * points_[k]);
    const MatrixXd effect = velocity * by_muscle;
    const double weight = weights_[k] * weights_[k];
    A += weight * effect.transpose() * effect;
    b += weight * effect.transpose() * (target - velocity * coasting);
  }
  const double effort = settings_.effort_mm_s * settings_.effort_mm_s,
               change = settings_.change_mm_s * settings_.change_mm_s;
  const VectorXd before = Eigen::Map<const VectorXd>(last_.data(), count);
  A.diagonal().array() += effort + change;
  b += change * before;
  const VectorXd found = bounded_minimum(A, b, before);
  last_.assign(found.data(), found.data() + count);
  return last_;
}

}  // namespace condyle
