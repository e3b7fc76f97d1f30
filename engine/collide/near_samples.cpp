#include "engine/collide/near_samples.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

// Largest angle between a contact normal and the face normals at its sample: 30 degrees.
constexpr double facing_cos = 0.866, facing_sin = 0.5;
constexpr double faces_below_mm = 0.05;  // deeper samples are contacts in any case

struct Search {
  const SurfaceSamples& samples;
  const DistanceField& field;
  Eigen::Matrix3d R;
  Vector3d t;
  double reach_mm;
  std::vector<NearSample>& found;

  void ball(int index) {
    const SurfaceSamples::Ball& ball_here = samples.balls[index];
    const Vector3d center = R * ball_here.center.cast<double>() + t;
    // Within the band the field is more accurate than its bounds.
    const DistanceField::Spot at_center = field.spot(center);
    const double bound =
        at_center.known ? at_center.distance_mm - field_bend_mm : field.lower_bound(center);
    if (bound > ball_here.radius + reach_mm) return;
    if (ball_here.right != 0) {
      ball(index + 1);
      ball(ball_here.right);
      return;
    }
    for (int i = ball_here.first; i < ball_here.first + ball_here.count; ++i) {
      const DistanceField::Spot here = field.spot(R * samples.points[i] + t);
      if (here.distance_mm <= reach_mm)
        found.push_back({i, here.known ? here.distance_mm : -reach_mm});
    }
  }
};

/// `near`: the places that can be within reach of a point of the ball.
void around(const SurfaceSamples& samples, int index, const std::vector<Vector3d>& near,
            double reach_mm, std::vector<int>& found) {
  constexpr double rounding_mm = 1e-6;
  const SurfaceSamples::Ball& ball = samples.balls[index];
  const Vector3d center = ball.center.cast<double>();
  const double radius = ball.radius + rounding_mm;
  std::vector<Vector3d> kept;
  for (const Vector3d& place : near) {
    const double distance = (place - center).norm();
    if (distance + radius < reach_mm) {
      for (int i = ball.first; i < ball.first + ball.count; ++i) found.push_back(i);
      return;
    }
    if (distance < reach_mm + radius) kept.push_back(place);
  }
  if (kept.empty()) return;
  if (ball.right != 0) {
    around(samples, index + 1, kept, reach_mm, found);
    around(samples, ball.right, kept, reach_mm, found);
    return;
  }
  for (int i = ball.first; i < ball.first + ball.count; ++i)
    if (std::any_of(kept.begin(), kept.end(), [&](const Vector3d& place) {
          return (samples.points[i] - place).squaredNorm() < reach_mm * reach_mm;
        }))
      found.push_back(i);
}

void lower(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS, int index,
           double& least) {
  const SurfaceSamples::Ball& ball = samples.balls[index];
  const double bound = field.lower_bound(X_FS * ball.center.cast<double>()) - ball.radius;
  if (bound >= least) return;
  if (ball.right == 0) {
    least = bound;
    return;
  }
  lower(samples, field, X_FS, index + 1, least);
  lower(samples, field, X_FS, ball.right, least);
}

}  // namespace

void collect_near(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                  double reach_mm, std::vector<NearSample>& found) {
  if (samples.balls.empty()) return;
  Search{samples, field, X_FS.R.toRotationMatrix(), X_FS.t, reach_mm, found}.ball(0);
}

std::vector<int> samples_around(const SurfaceSamples& samples, const std::vector<Vector3d>& places,
                                double reach_mm) {
  std::vector<int> found;
  if (!samples.balls.empty()) around(samples, 0, places, reach_mm, found);
  return found;
}

double clearance_bound(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                       double max_mm) {
  if (!samples.balls.empty()) lower(samples, field, X_FS, 0, max_mm);
  return max_mm;
}

SampleDistance query_sample(const DistanceField& field, const Vector3d& p_F,
                            const Vector3d& normal_F, double spread) {
  return classified(field.at(p_F), normal_F, spread);
}

SampleDistance classified(const FieldSample& here, const Vector3d& normal_F, double spread) {
  SampleDistance result{here.distance_mm, here.gradient, here.known, false};
  // Where two faces are equally near the gradient is not reliable; the sample's own face decides.
  if (result.gradient.squaredNorm() < 0.1 && result.distance_mm < 0) result.gradient = -normal_F;
  const double cosine = -result.gradient.dot(normal_F) / result.gradient.norm();
  const double least =
      spread * facing_cos - std::sqrt(std::max(0.0, 1 - spread * spread)) * facing_sin;
  result.faces = result.distance_mm < -faces_below_mm || spread < -facing_cos || cosine >= least;
  return result;
}

}  // namespace condyle
