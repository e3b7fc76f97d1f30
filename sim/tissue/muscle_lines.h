#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/tissue/muscle_line.h"
#include "engine/tissue/spring_prism.h"
#include "sim/case/face_muscle.h"
#include "sim/tissue/body_weights.h"

namespace condyle {

struct TissueMesh;
struct TissueSupport;

/// The muscles of the face in one mesh.
struct TissueMuscles {
  /// A point in the tissue, or on a bone.
  struct Point {
    MuscleLine::Point carried;
    std::optional<BodyId> bone = {};
    Eigen::Vector3d rest = Eigen::Vector3d::Zero();  // mm
  };
  struct Line {
    int muscle = 0;
    std::vector<Point> points;
    double rest_mm = 0, limit_N = 0;
  };
  /// A loose anchor near a muscle: while the muscle is active, the tissue there glides.
  struct Yielding {
    int muscle = 0, anchor = 0;
    double closeness = 0;  // 0 to 1
  };
  std::vector<FaceMuscle> muscles;
  std::vector<Line> lines;
  std::vector<Yielding> yielding;
};

/// Without `upper_face`, muscles above the lower lids have no lines: the mesh ends below them.
TissueMuscles muscles_in_mesh(const TissueMesh& mesh, const TissueSupport& support,
                              std::vector<FaceMuscle> muscles, bool upper_face);

/// Stiffness of each anchor over that at rest; empty when no muscle is active.
std::vector<double> anchor_scales(const TissueMuscles& muscles, std::span<const double> excitation,
                                  std::size_t anchors);

/// The pull of the muscles. `excitation`: of each muscle, 0 to 1.
std::vector<MuscleLine> muscle_pull(const TissueMuscles& muscles,
                                    std::span<const double> excitation, std::span<const Pose> X_CB);

/// Muscles that have adapted to another rest: their lengths there are those at rest.
TissueMuscles at_new_rest(TissueMuscles muscles, const Nodes& nodes, std::span<const Pose> X_CB);

/// Length of each muscle, the mean of its lines, mm.
std::vector<double> muscle_lengths(const TissueMuscles& muscles, const Nodes& nodes,
                                   std::span<const Pose> X_CB);

}  // namespace condyle
