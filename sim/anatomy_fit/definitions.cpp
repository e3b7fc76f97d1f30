#include "sim/anatomy_fit/definitions.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <optional>

namespace condyle {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

/// The farthest point of the surface in a direction, in the frame of the Frankfort plane.
/// `profile`: along the midline only. x: of the left one of a pair.
struct Definition {
  const char* name;
  Vector3d direction;
  bool profile = false;
};

const std::vector<Definition>& definitions() {
  static const std::vector<Definition> all = {{"menton", {0, 0, -1}},
                                              {"pogonion", {0, -1, 0}},
                                              {"gnathion", {0, -0.7071, -0.7071}},
                                              {"b_point", {0, 1, 0}, true},
                                              {"condylion", {0, 0, 1}},
                                              {"coronoid_tip", {0, 0, 1}},
                                              {"condyle_lateral_pole", {1, 0, 0}},
                                              {"condyle_medial_pole", {-1, 0, 0}},
                                              {"gonion", {0, 0, 0}},  // see gonion_direction()
                                              {"glabella", {0, -1, 0}},
                                              {"nasion", {0, 1, 0}, true},
                                              {"a_point", {0, 1, 0}, true},
                                              {"ans", {0, -1, 0}},
                                              {"vertex", {0, 0, 1}},
                                              {"opisthocranion", {0, 1, 0}},
                                              {"zygion", {1, 0, 0}},
                                              {"euryon", {1, 0, 0}},
                                              {"mastoidale", {0, 0, -1}},
                                              {"pronasale", {0, -1, 0}},
                                              {"soft_glabella", {0, -1, 0}},
                                              {"sellion", {0, 1, 0}, true},
                                              {"soft_b_point", {0, 1, 0}, true},
                                              {"soft_pogonion", {0, -1, 0}},
                                              {"soft_menton", {0, 0, -1}},
                                              {"soft_vertex", {0, 0, 1}},
                                              {"soft_opisthocranion", {0, 1, 0}},
                                              {"soft_zygion", {1, 0, 0}},
                                              {"soft_euryon", {1, 0, 0}},
                                              {"alare", {1, 0, 0}}};
  return all;
}

/// Rotation nearest to a matrix.
Matrix3d rotation_of(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

/// Axes of the Frankfort plane by three points, as columns; x to the left, y back.
Matrix3d frankfort(const Vector3d& left_porion, const Vector3d& right_porion,
                   const Vector3d& orbitale) {
  Matrix3d axes;
  const Vector3d x = (left_porion - right_porion).normalized();
  const Vector3d back = 0.5 * (left_porion + right_porion) - orbitale;
  axes.col(0) = x;
  axes.col(1) = (back - back.dot(x) * x).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

using Points = std::map<std::string, Vector3d>;

Matrix3d frankfort(const Points& points) {
  return frankfort(points.at("left_porion"), points.at("right_porion"),
                   0.5 * (points.at("left_orbitale") + points.at("right_orbitale")));
}

/// Away from the line from condylion to menton.
Vector3d gonion_direction(const Points& points, const std::string& side) {
  const Vector3d& top = points.at(side + "condylion");
  const Vector3d line = (points.at("menton") - top).normalized();
  const Vector3d across = points.at(side + "gonion") - top;
  return (across - across.dot(line) * line).normalized();
}

/// The mean of the vertices that lie about farthest along `direction`, preferring those near `p`:
/// on flat surfaces the point hardly moves, on pointed ones it goes to the tip.
Vector3d farthest(const std::vector<Vector3d>& patch, const Vector3d& p,
                  const Vector3d& direction) {
  constexpr double prefer_mm = 20, spread_mm = 0.1;
  double most = -1e300;
  const auto height = [&](const Vector3d& v) {
    return direction.dot(v - p) - (v - p).squaredNorm() / (2 * prefer_mm);
  };
  for (const auto& v : patch) most = std::max(most, height(v));
  Vector3d sum = Vector3d::Zero();
  double weight = 0;
  for (const auto& v : patch) {
    const double w = std::exp((height(v) - most) / spread_mm);
    sum += w * v;
    weight += w;
  }
  return sum / weight;
}

class Definer {
 public:
  Definer(std::map<std::string, ProposedLandmark>& marks, const FittedPart& part, const Case& model)
      : marks_(marks), part_(part), model_(model), surface_(model.find(part.role)->mesh) {
    axes_ = rotation_of(part.fit.similarity.matrix);
    Points carried;
    for (const auto& [name, mark] : marks) carried[name] = mark.point;
    carried_ = std::move(carried);
    const bool plane_known = marks.count("left_porion") != 0 && !marks["left_porion"].doubtful &&
                             !marks["right_porion"].doubtful && !marks["left_orbitale"].doubtful &&
                             !marks["right_orbitale"].doubtful;
    if (plane_known) axes_ = frankfort(carried_) * frankfort(model.landmarks.points).transpose();
  }

  void apply() {
    for (const auto& definition : definitions()) {
      if (marks_.count(definition.name)) move(definition, "", 1);
      if (marks_.count(std::string("left_") + definition.name)) {
        move(definition, "left_", 1);
        move(definition, "right_", -1);
      }
    }
  }

 private:
  void move(const Definition& definition, const std::string& side, double sign) {
    constexpr double reach_mm = 6, midline_mm = 2.5;
    const std::string name = side + definition.name;
    ProposedLandmark& mark = marks_.at(name);
    if (mark.doubtful) return;
    const Vector3d& own = model_.landmarks.points.at(name);
    std::vector<Vector3d> model_patch, patch;
    for (const auto& v : surface_.vertices) {
      if ((v - own).squaredNorm() > reach_mm * reach_mm) continue;
      if (definition.profile && std::abs(v.x() - own.x()) > midline_mm) continue;
      model_patch.push_back(v);
      patch.push_back(part_.fit.deformation(v));
    }
    if (patch.empty()) return;
    Vector3d model_direction(sign * definition.direction.x(), definition.direction.y(),
                             definition.direction.z());
    Vector3d direction = axes_ * model_direction;
    if (std::string(definition.name) == "gonion") {
      model_direction = gonion_direction(model_.landmarks.points, side);
      direction = gonion_direction(carried_, side);
    }
    // What the same rule moves on the built-in patient is not a difference of the scan.
    const Vector3d model_shift = farthest(model_patch, own, model_direction) - own;
    const Vector3d shift = farthest(patch, mark.point, direction) - mark.point -
                           part_.fit.similarity.matrix * model_shift;
    const SurfacePoint found = part_.target->pairs.tree().nearest(mark.point + shift);
    if (found.triangle < 0 || found.distance > 2) return;
    mark.uncertainty_mm += 0.5 * (found.point - mark.point).norm();
    mark.point = found.point;
  }

  std::map<std::string, ProposedLandmark>& marks_;
  const FittedPart& part_;
  const Case& model_;
  const TriMesh& surface_;
  Points carried_;
  Matrix3d axes_;
};

}  // namespace

void apply_definitions(std::map<std::string, ProposedLandmark>& marks, const FittedPart& part,
                       const Case& model) {
  if (!model.find(part.role)) return;
  Definer(marks, part, model).apply();
}

}  // namespace condyle
