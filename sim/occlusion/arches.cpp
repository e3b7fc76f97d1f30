#include "sim/occlusion/arches.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/occlusion/elastic_layer.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double crown_mm = 16;          // height of the crowns, including the curve of the arch
constexpr double margin_mm = 2;          // around the crowns
constexpr double on_bone_mm = 3;         // largest distance of an incisal landmark on the bone
constexpr double molar_fraction = 0.58;  // fraction of the arch length in front of the first molars
constexpr double molar_behind_mm = 28;
constexpr double slice_mm = 4, top_mm = 1.5, piece_mm = 1;
constexpr double steepest_cos = 0.8;  // limit of the inclination of the occlusal plane: 37 degrees

// Normal incisors, mm; the norms of cephalometry.cpp.
constexpr double normal_overjet_mm = 2.5, normal_overbite_mm = 2.5;

/// Finds one arch; "height" is measured towards the opposing arch.
class ArchReader {
 public:
  ArchReader(const Case& patient, bool upper, double midline_mm, std::vector<std::string>& notes)
      : patient_(patient),
        upper_(upper),
        body_(upper ? patient.jaw.upper_arch : patient.jaw.lower_arch),
        midline_mm_(midline_mm),
        notes_(notes) {}

  Arch read() {
    arch_.part = patient_.teeth_of(body_);
    const auto landmark =
        patient_.landmarks.find(upper_ ? "upper_incisal_point" : "lower_incisal_point");
    const bool teeth = arch_.part && !arch_.part->mesh.empty();
    if (!teeth) take_bone(landmark);
    if (teeth) {
      Box box = bounding_box(arch_.part->mesh);
      front_mm_ = box.low.y();
      back_mm_ = box.high.y();
      if (upper_)
        box.high.z() = std::min(box.high.z(), box.low.z() + crown_mm);
      else
        box.low.z() = std::max(box.low.z(), box.high.z() - crown_mm);
      arch_.crowns = box;
      arch_.edge = incisal_edge(landmark);
    } else {
      arch_.edge = *landmark;
      const Vector3d &e = arch_.edge, size(40, 60, crown_mm);
      arch_.crowns.add(Vector3d(midline_mm_ - size.x(), e.y() - 8, e.z() - size.z()));
      arch_.crowns.add(Vector3d(midline_mm_ + size.x(), e.y() + size.y(), e.z() + size.z()));
    }
    arch_.crowns.low.array() -= margin_mm;
    arch_.crowns.high.array() += margin_mm;
    const double molar_y = teeth ? front_mm_ + molar_fraction * (back_mm_ - front_mm_)
                                 : arch_.edge.y() + molar_behind_mm;
    const auto pieces = make_layer_surface(arch_.part->mesh, arch_.crowns, piece_mm).pieces;
    std::array<std::optional<Vector3d>, 2> found;
    for (int side = 0; side < 2; ++side) {
      const int fdi = upper_ ? (side == 0 ? 26 : 16) : (side == 0 ? 36 : 46);
      found[side] = top_of(tooth_vertices(fdi));
      if (!found[side]) {
        std::vector<Vector3d> slice;
        for (const auto& piece : pieces) {
          const double x = (piece.point.x() - midline_mm_) * (side == 0 ? 1 : -1);
          if (x > 8 && std::abs(piece.point.y() - molar_y) < slice_mm) slice.push_back(piece.point);
        }
        found[side] = top_of(slice);
      }
    }
    const auto mirrored = [&](const Vector3d& p) {
      return Vector3d(2 * midline_mm_ - p.x(), p.y(), p.z());
    };
    if (!found[0] && !found[1])
      throw InputError(
          fmt::format("{}: no {} molars were found at y = {:.0f} mm; a bite needs "
                      "back teeth",
                      arch_.part->name, upper_ ? "upper" : "lower", molar_y));
    for (int side = 0; side < 2; ++side)
      arch_.molars[side] = found[side] ? *found[side] : mirrored(*found[1 - side]);
    return arch_;
  }

 private:
  double height(const Vector3d& p) const { return upper_ ? -p.z() : p.z(); }

  std::vector<Vector3d> tooth_vertices(int fdi) const {
    std::vector<Vector3d> points;
    const auto& mesh = arch_.part->mesh;
    for (const auto& tooth : arch_.part->teeth) {
      if (tooth.fdi != fdi) continue;
      for (int t = 0; t < tooth.triangle_count; ++t)
        for (const int v : mesh.triangles[tooth.first_triangle + t])
          points.push_back(mesh.vertices[v]);
    }
    return points;
  }

  std::optional<Vector3d> highest(const std::vector<Vector3d>& points) const {
    if (points.empty()) return std::nullopt;
    return *std::max_element(points.begin(), points.end(),
                             [&](const auto& a, const auto& b) { return height(a) < height(b); });
  }

  /// At the centre of the highest vertices and at the height of the tip.
  std::optional<Vector3d> top_of(const std::vector<Vector3d>& points) const {
    const auto tip = highest(points);
    if (!tip) return tip;
    Box top;
    for (const auto& p : points)
      if (height(p) > height(*tip) - top_mm) top.add(p);
    return Vector3d(top.center().x(), top.center().y(), tip->z());
  }

  Vector3d incisal_edge(const std::optional<Vector3d>& landmark) {
    const char* name = upper_ ? "upper" : "lower";
    const auto left = highest(tooth_vertices(upper_ ? 21 : 31)),
               right = highest(tooth_vertices(upper_ ? 11 : 41));
    if (left && right) return 0.5 * (*left + *right);
    if (arch_.part->teeth.empty()) {
      // Motion-tracking markers are often off the edge: the teeth take precedence.
      std::array<std::vector<Vector3d>, 2> front;
      for (const auto& p : arch_.part->mesh.vertices)
        if (const double x = p.x() - midline_mm_; std::abs(x) < 5 && p.y() < front_mm_ + 12)
          front[x > 0 ? 0 : 1].push_back(p);
      const auto tip_left = highest(front[0]), tip_right = highest(front[1]);
      if (tip_left && tip_right) {
        notes_.push_back(fmt::format("the {} incisal edge is the {} of the teeth near the midline",
                                     name, upper_ ? "lowest" : "highest"));
        return 0.5 * (*tip_left + *tip_right);
      }
    }
    if (landmark) {
      notes_.push_back(fmt::format("the {} incisal edge is the landmark", name));
      return *landmark;
    }
    throw InputError(fmt::format(
        "{}: there are no front teeth and no landmark {}_incisal_point; add the landmark",
        arch_.part->name, name));
  }

  void take_bone(const std::optional<Vector3d>& landmark) {
    const char* name = upper_ ? "upper" : "lower";
    for (const Role role : {Role::maxilla, Role::skull, Role::mandible, Role::segment}) {
      const Part* bone = patient_.find(role, body_);
      if (!landmark || !bone || bone->mesh.empty()) continue;
      if (TriangleTree(bone->mesh).nearest(*landmark, on_bone_mm).triangle < 0) continue;
      arch_.part = bone;
      notes_.push_back(
          fmt::format("the {} arch is the surface of {}, because the case has no {} teeth", name,
                      bone->name, name));
      return;
    }
    throw InputError(fmt::format(
        "the case has no {0} teeth: a bite needs both arches. Import them with --{0}-teeth, or, if "
        "the {1} carries its crowns, give the landmark {0}_incisal_point on it",
        name, upper_ ? "maxilla" : "mandible"));
  }

  const Case& patient_;
  const bool upper_;
  const BodyId body_;
  const double midline_mm_;
  std::vector<std::string>& notes_;
  Arch arch_;
  double front_mm_ = 0, back_mm_ = 0;  // y
};

/// Axes of an arch: to the left molar, back and up in its occlusal plane.
Matrix3d axes_of(const Arch& arch) {
  const Vector3d left = (arch.molars[0] - arch.molars[1]).normalized();
  const Vector3d back = 0.5 * (arch.molars[0] + arch.molars[1]) - arch.edge;
  const Vector3d up = left.cross(back).normalized();
  Matrix3d axes;
  axes << left, up.cross(left), up;
  return axes;
}

}  // namespace

Arches find_arches(const Case& patient) {
  Arches arches;
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (left && right) {
    arches.condyles = {*left, *right};
    arches.midline_mm = 0.5 * (left->x() + right->x());
  } else {
    arches.notes.push_back(
        "the landmarks left_condyle and right_condyle are missing: the joints exert no force, and "
        "the "
        "displacement of the condyles is not reported");
    if (const auto edge = patient.landmarks.find("upper_incisal_point"))
      arches.midline_mm = edge->x();
    else if (const Part* teeth = patient.teeth_of(patient.jaw.upper_arch))
      arches.midline_mm = bounding_box(teeth->mesh).center().x();
  }
  arches.upper = ArchReader(patient, true, arches.midline_mm, arches.notes).read();
  arches.lower = ArchReader(patient, false, arches.midline_mm, arches.notes).read();

  const Vector3d& edge = arches.upper.edge;
  const Vector3d across = arches.upper.molars[0] - arches.upper.molars[1];
  const Vector3d back = 0.5 * (arches.upper.molars[0] + arches.upper.molars[1]) - edge;
  arches.up = across.cross(back).normalized();
  if (!(arches.up.z() > steepest_cos)) {
    arches.notes.push_back(
        "the occlusal plane cannot be determined from the incisal edge and the molars; the "
        "horizontal plane is used");
    arches.up = Vector3d::UnitZ();
  }
  arches.left = (across - arches.up * arches.up.dot(across)).normalized();
  arches.front = arches.left.cross(arches.up);
  return arches;
}

Pose normal_relation(const Arches& arches) {
  const Matrix3d upper = axes_of(arches.upper);
  const Matrix3d turn = upper * axes_of(arches.lower).transpose();
  const Vector3d edge =
      arches.upper.edge + upper * Vector3d(0, normal_overjet_mm, normal_overbite_mm);
  return {Eigen::Quaterniond(turn), edge - turn * arches.lower.edge};
}

}  // namespace condyle
