#pragma once

#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/case/case.h"
#include "sim/operation/operation.h"

namespace condyle {

/// The nearest of several closed surfaces.
class NearestSurface {
 public:
  void add(const TriMesh& mesh, int value) { surfaces_.push_back({TriangleTree(mesh), value}); }
  bool empty() const { return surfaces_.empty(); }

  struct Found {
    double distance = std::numeric_limits<double>::infinity();  // negative inside
    int value = -1;
  };
  Found at(const Eigen::Vector3d& p) const;
  /// The value that most of the points have, of those inside a surface if these are a tenth of
  /// them: of a tooth its root. Of equal ones the least. `part`: its share, if requested.
  int of_most(std::span<const Eigen::Vector3d> points, double* part = nullptr) const;

 private:
  struct Surface {
    TriangleTree tree;
    int value;
  };
  std::vector<Surface> surfaces_;
};

/// The bodies of an operated case that own what the bodies of the uncut case did.
class OwnerFinder {
 public:
  OwnerFinder(const Case& uncut, const Case& operated);

  /// Whether cuts made bodies of this one.
  bool was_cut(BodyId uncut_body) const;
  /// The body of the nearest bone or tooth of what was `uncut_body`.
  BodyId owner(BodyId uncut_body, const Eigen::Vector3d& point) const;
  /// The body of this name, whether it was cut or not.
  BodyId same(BodyId uncut_body) const;
  /// The body of the uncut case from which this one was cut.
  BodyId origin(BodyId body) const { return origin_[index_of(body)]; }

 private:
  const Case& uncut_;
  const Case& operated_;
  std::vector<BodyId> origin_;                // by body of the operated case
  std::map<BodyId, NearestSurface> nearest_;  // by body of the uncut case that was cut
};

/// Owners of the landmarks after the cuts: those of the planner's table as there, those of teeth by
/// their arch, others by the nearest bone or tooth, within 3 mm of it and farther from the face.
/// Others have no owner.
LandmarkOwners landmark_owners(const Case& uncut, const OwnerFinder& finder);

/// Those that are nearer to a resected segment than to what remains of the body from which it was
/// cut.
std::set<std::string> resected_landmarks(const Case& uncut, const OwnerFinder& finder,
                                         const Operated& operated);

/// The jaw's bodies after the cuts: arches by their teeth, else the incisal points, condyles by
/// their landmarks.
JawBodies jaw_bodies(const Case& uncut, const Case& operated, const OwnerFinder& finder);

std::vector<MuscleOwners> muscle_owners(const Case& uncut, const OwnerFinder& finder);

}  // namespace condyle
