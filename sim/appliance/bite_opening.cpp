#include "sim/appliance/bite_opening.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double most_deg = 15;
constexpr double beyond_mm = 1;  // distances are found up to this much more than needed
constexpr double angle_error_deg = 0.002;

/// Finds the least distance of two arches as one of them turns.
class TurningArches {
 public:
  TurningArches(const SplintArches& arches, double room_mm, int threads)
      : arches_(arches),
        reach_(room_mm + beyond_mm),
        threads_(threads),
        upper_(arches.upper.mesh),
        lower_(arches.lower.mesh) {
    if (!arches.condyles) return;
    const auto& [left, right] = *arches.condyles;
    center_ = 0.5 * (left + right);
    axis_ = (left - right).normalized();
    // A positive angle lowers the incisors: away from the upper arch.
    const Vector3d path = axis_.cross(arches.lower.edge - center_);
    const Vector3d down = -arches_up();
    if (path.dot(down) < 0) axis_ = -axis_;
    radius_ = path.norm();
  }

  bool has_hinge() const { return arches_.condyles.has_value(); }
  double incisal_mm(double deg) const { return 2 * radius_ * std::sin(0.5 * deg * degree); }
  double angle_deg(double incisal_mm) const {
    return 2 * std::asin(std::clamp(0.5 * incisal_mm / radius_, -1.0, 1.0)) / degree;
  }
  Pose pose(double deg) const {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(deg * degree, axis_));
    return deg == 0 ? Pose{} : Pose{R, center_ - R * center_};
  }

  /// Least signed distance of the corners of either arch from the other, at most the reach.
  double distance(const Pose& X) const {
    const Pose back = X.inverse();
    return std::min(least(arches_.lower.mesh, X, upper_, bounding_box(arches_.upper.mesh)),
                    least(arches_.upper.mesh, back, lower_, bounding_box(arches_.lower.mesh)));
  }

 private:
  Vector3d arches_up() const {
    const SplintArch& upper = arches_.upper;
    return (upper.molars[0] - upper.molars[1])
        .cross(0.5 * (upper.molars[0] + upper.molars[1]) - upper.edge)
        .normalized();
  }
  double least(const TriMesh& mesh, const Pose& X, const TriangleTree& other,
               const Box& box) const {
    constexpr std::size_t run = 512;
    const std::size_t runs = (mesh.vertices.size() + run - 1) / run;
    std::vector<double> found(runs, reach_);
    parallel_for(runs, threads_, [&](std::size_t r) {
      const std::size_t end = std::min(mesh.vertices.size(), (r + 1) * run);
      for (std::size_t v = r * run; v < end; ++v) {
        const Vector3d p = X * mesh.vertices[v];
        if (!box.contains(p, reach_)) continue;
        // Nearer than what is known, or within the other arch.
        const SurfacePoint near = other.signed_nearest(p, reach_);
        if (near.triangle >= 0) found[r] = std::min(found[r], near.distance);
      }
    });
    return *std::min_element(found.begin(), found.end());
  }

  const SplintArches& arches_;
  double reach_;
  int threads_;
  TriangleTree upper_, lower_;
  Vector3d center_ = Vector3d::Zero(), axis_ = Vector3d::UnitX();
  double radius_ = 1;
};

std::string distance_text(double mm) {
  return mm < 0 ? fmt::format("overlap by {:.2f} mm", -mm) : fmt::format("are {:.2f} mm apart", mm);
}

/// The least angle at which the arches are this far apart; absent where none suffices.
std::optional<double> needed_deg(const TurningArches& turning, double room_mm) {
  double low = 0, high = 1;
  while (turning.distance(turning.pose(high)) < room_mm) {
    low = high;
    high *= 2;
    if (high > most_deg) return std::nullopt;
  }
  while (high - low > angle_error_deg) {
    const double middle = 0.5 * (low + high);
    (turning.distance(turning.pose(middle)) < room_mm ? low : high) = middle;
  }
  return high;
}

BiteOpening opened(const TurningArches& turning, double deg, double before_mm) {
  BiteOpening opening{turning.pose(deg), deg, turning.incisal_mm(deg), before_mm, before_mm};
  if (deg != 0) opening.after_mm = turning.distance(opening.X_lower);
  return opening;
}

}  // namespace

BiteOpening open_bite(const SplintArches& arches, double room_mm, int threads) {
  const TurningArches turning(arches, room_mm, threads);
  const double before = turning.distance({});
  if (before >= room_mm) return opened(turning, 0, before);
  if (!turning.has_hinge())
    throw InputError(fmt::format(
        "the arches {}, and the splint needs {:.2f} mm: the bite opens about the condyles, but the "
        "case lacks the landmarks left_condyle and right_condyle",
        distance_text(before), room_mm));
  const auto deg = needed_deg(turning, room_mm);
  if (!deg)
    throw InputError(
        fmt::format("the arches {}, and no opening by {} degrees about the condyles parts them by "
                    "the {:.2f} mm "
                    "that the splint needs",
                    distance_text(before), most_deg, room_mm));
  return opened(turning, *deg, before);
}

BiteOpening turn_bite(const SplintArches& arches, double incisal_mm, double room_mm, int threads) {
  const TurningArches turning(arches, room_mm, threads);
  const double before = turning.distance({});
  if (!turning.has_hinge() && incisal_mm != 0)
    throw InputError(
        "the bite opens about the condyles, but the case lacks the landmarks left_condyle and "
        "right_condyle");
  const BiteOpening opening =
      opened(turning, incisal_mm == 0 ? 0 : turning.angle_deg(incisal_mm), before);
  if (opening.after_mm >= room_mm) return opening;
  std::string needed = "no opening by the hinge gives it";
  if (turning.has_hinge())
    if (const auto deg = needed_deg(turning, room_mm))
      needed =
          fmt::format("an opening of {:.1f} mm at the incisors gives it", turning.incisal_mm(*deg));
  throw InputError(
      fmt::format("opened by {:.1f} mm the arches {}, and the splint needs {:.2f} mm: {}",
                  incisal_mm, distance_text(opening.after_mm), room_mm, needed));
}

}  // namespace condyle
