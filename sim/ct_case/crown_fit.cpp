#include "sim/ct_case/crown_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/landmark_names.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double crown_mm = 1;  // a crown is farther from the bone; its neck and roots are not
constexpr std::size_t most_samples = 1200, least_samples = 60;
constexpr double inside_mm = 1, outside_mm = 1.5;  // of a border, along the crown's normal
constexpr double reach_mm = 10, first_step_mm = 2.5, last_step_mm = 0.3;
constexpr double reach_deg = 12, first_turn_deg = 6;
constexpr double loss_per_mm = 0.004;   // of the share: of like places, the near one
constexpr double least_better = 0.08;   // of the share
constexpr double least_moved_mm = 1.5;  // less is within the width of the labels' borders

/// A motion about a center: translations along and rotations about the axes, mm and deg.
using Motion6 = std::array<double, 6>;

/// The template's crowns in the labels of a scan.
class CrownSearch {
 public:
  CrownSearch(const Volume& volume, const BoneVoxels& bone, VoxelLabel label, const TriMesh& teeth,
              const TriMesh& template_bone)
      : volume_(volume), bone_(bone), label_(label) {
    const TriangleTree around(template_bone);
    const std::vector<Vector3d> normals = vertex_normals(teeth);
    const std::size_t step = std::max<std::size_t>(1, teeth.vertices.size() / (2 * most_samples));
    for (std::size_t v = 0; v < teeth.vertices.size() && points_.size() < most_samples; v += step)
      if (around.signed_distance(teeth.vertices[v]) > crown_mm) {
        points_.push_back(teeth.vertices[v]);
        normals_.push_back(normals[v]);
      }
    for (const Vector3d& p : points_) center_ += p / static_cast<double>(points_.size());
  }

  bool has_crowns() const { return points_.size() >= least_samples; }

  Pose pose(const Motion6& motion) const {
    Pose X;
    for (int axis = 0; axis < 3; ++axis)
      X.R = X.R * Eigen::Quaterniond(Eigen::AngleAxisd(
                      motion[static_cast<std::size_t>(3 + axis)] * degree, Vector3d::Unit(axis)));
    X.t = center_ - X.R * center_ + Vector3d(motion[0], motion[1], motion[2]);
    return X;
  }

  double moved_mm(const Pose& X) const {
    double sum = 0;
    for (const Vector3d& p : points_) sum += (X * p - p).norm();
    return sum / static_cast<double>(points_.size());
  }

  /// Share of the crowns' vertices with bone on the inner side alone.
  double share(const Pose& X) const {
    std::size_t at_border = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3d p = X * points_[i], normal = X.R * normals_[i];
      at_border += is_bone(p - inside_mm * normal) && !is_bone(p + outside_mm * normal) ? 1 : 0;
    }
    return static_cast<double>(at_border) / static_cast<double>(points_.size());
  }

  Motion6 best() const {
    Motion6 best{};
    double most = value(best);
    const auto attempt = [&](const Motion6& motion) {
      const double now = value(motion);
      if (now <= most) return false;
      most = now;
      best = motion;
      return true;
    };
    for (double pitch = -reach_deg; pitch <= reach_deg; pitch += first_turn_deg)
      for (double x = -0.5 * reach_mm; x <= 0.5 * reach_mm; x += first_step_mm)
        for (double y = -reach_mm; y <= reach_mm; y += first_step_mm)
          for (double z = -reach_mm; z <= reach_mm; z += first_step_mm)
            attempt({x, y, z, pitch, 0, 0});
    double step = 0.5 * first_step_mm, turn = 0.5 * first_turn_deg;
    while (step > last_step_mm) {
      bool better = false;
      for (std::size_t a = 0; a < best.size(); ++a)
        for (const double sign : {-1.0, 1.0}) {
          Motion6 next = best;
          next[a] += sign * (a < 3 ? step : turn);
          better |= attempt(next);
        }
      if (!better) step /= 2, turn /= 2;
    }
    return best;
  }

 private:
  double value(const Motion6& motion) const {
    const Pose X = pose(motion);
    return share(X) - loss_per_mm * moved_mm(X);
  }

  bool is_bone(const Vector3d& p) const {
    const Vector3d at =
        (volume_.axes.transpose() * (p - volume_.origin)).cwiseQuotient(volume_.spacing_mm);
    std::array<int, 3> voxel;
    for (std::size_t a = 0; a < 3; ++a) {
      voxel[a] = static_cast<int>(std::lround(at[static_cast<Eigen::Index>(a)])) - bone_.box.low[a];
      if (voxel[a] < 0 || voxel[a] >= bone_.box.size[a]) return false;
    }
    return bone_.label[bone_.box.index(voxel[0], voxel[1], voxel[2])] == label_;
  }

  const Volume& volume_;
  const BoneVoxels& bone_;
  VoxelLabel label_;
  std::vector<Vector3d> points_, normals_;
  Vector3d center_ = Vector3d::Zero();
};

}  // namespace

std::optional<CrownFit> fit_crowns(const Volume& volume, const BoneVoxels& bone, VoxelLabel label,
                                   const TriMesh& teeth, const TriMesh& template_bone) {
  if (teeth.empty() || template_bone.empty()) return std::nullopt;
  const CrownSearch search(volume, bone, label, teeth, template_bone);
  if (!search.has_crowns()) return std::nullopt;
  CrownFit fit;
  fit.X = search.pose(search.best());
  fit.moved_mm = search.moved_mm(fit.X);
  fit.before = search.share({});
  fit.after = search.share(fit.X);
  if (fit.moved_mm < least_moved_mm || fit.after < fit.before + least_better) return std::nullopt;
  return fit;
}

void move_crowns(Role teeth, const Pose& X, AnatomyFit& fit) {
  const bool upper = teeth == Role::upper_teeth;
  for (CarriedPart& carried : fit.parts)
    if (carried.part.role == teeth)
      for (Vector3d& p : carried.part.mesh.vertices) p = X * p;
  std::vector<std::string> names = {upper ? "upper_incisal_point" : "lower_incisal_point"};
  for (const int quadrant : upper ? std::array{1, 2} : std::array{3, 4})
    for (int place = 1; place <= 8; ++place) {
      const ToothLandmarkNames tooth = tooth_landmark_names(10 * quadrant + place);
      names.insert(names.end(), {tooth.tip, tooth.apex});
    }
  for (const std::string& name : names)
    if (const auto mark = fit.landmarks.find(name); mark != fit.landmarks.end())
      mark->second.point = X * mark->second.point;
}

}  // namespace condyle
