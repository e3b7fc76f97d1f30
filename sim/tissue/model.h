#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "engine/tissue/frame_embedding.h"
#include "engine/tissue/spring_prism.h"
#include "sim/tissue/body_weights.h"
#include "sim/tissue/muscle_lines.h"
#include "sim/tissue/opening_path.h"
#include "sim/tissue/oral_fissure.h"
#include "sim/tissue/skin_region.h"
#include "sim/tissue/tissue.h"
#include "sim/tissue/tissue_contact.h"

namespace condyle {

class PathFactors;

/// The material: columns of prisms and springs from the skin inward.
struct TissueMesh {
  int columns = 0, sheets = 0;
  std::vector<int> cut_from;  // per layer, number of the requested layer; empty: its own
  std::vector<Eigen::Vector3i> triangles;  // of the columns, counter-clockwise from outside
  Nodes rest;                              // mm, in the cranium's frame, in `node_of` order
  SpringPrismMesh elements;
  std::shared_ptr<const ElementBatches> runs;  // SIMD layout of the elements
  std::vector<double> own_stiffness;           // of each node at rest, N/mm: see own_stiffness()
};

/// What an anchor represents.
enum class AnchorKind : signed char {
  bone,       // tissue grown on bone: it moves with one body
  cartilage,  // the nose, where no bone is below it: carried by the bones around it
  rim,        // the cut towards the rest of the face: fixed
  other,      // borders, lips, loose tissue: carried by several bodies
};

/// What holds the tissue from outside, by the bodies that carry it.
struct TissueSupport {
  BodyWeights anchor;            // of each anchor of the mesh
  std::vector<AnchorKind> kind;  // of each anchor
  Nodes anchor_offset;           // of each target, rotated with its bodies: balances the strains
  BodyWeights node;              // of every node, for extrapolation
  Nodes node_force;              // weight, N; empty without
  // N, rotated with the node's bodies: the part that strains cannot balance; empty without
  Nodes held_force;
};

/// How the columns, as its handles, carry the displayed face.
struct FaceDisplay {
  RegionShape region;
  OralFissure fissure;
  double corner_reach_mm = 0;  // see OralFissure::sampled_at
  HandleSet handles;
  std::vector<double> handle_evened;     // 0 to 1: how strongly its motion is smoothed for display
  std::vector<signed char> handle_side;  // +1 above the lip line, -1 below
  std::vector<int> carried_vertex;       // of the face part
  std::vector<CarriedPoint> carried;
  std::vector<Eigen::Vector3d> carried_from;  // the points whose motion these take
  std::vector<Eigen::Vector3d> face_rest;
  std::vector<signed char> face_side;
};

/// A rest that is not the mesh's own: the patient after an operation.
struct PlannedRest {
  std::vector<Pose> X_CB;             // from the mesh's rest to this one
  Nodes nodes;                        // mm, in equilibrium there
  std::vector<Eigen::Vector3d> face;  // vertices of the displayed face there, mm
};

/// See tissue.h. Its members are read only and shared with models for the pieces of cut bones.
struct TissueModel {
  std::shared_ptr<const TissueMesh> mesh;
  TissueSupport support;
  std::shared_ptr<const TissueContact> contact;
  std::shared_ptr<const PathFactors> factors;
  OpeningPredictor opening;
  std::shared_ptr<const FaceDisplay> display;
  std::shared_ptr<const PlannedRest> planned;  // null: at rest as the mesh
  TissueSummary summary;
  TissueMuscles muscles;
};

/// Poses of the bodies from the mesh's rest, of poses from the planned one; null: the mesh's own.
std::vector<Pose> poses_from_mesh(const PlannedRest* planned, std::span<const Pose> X_CB);
/// The same, of poses from the model's rest.
std::vector<Pose> poses_from_mesh(const TissueModel& model, std::span<const Pose> X_CB);

/// Loads of the bones and muscles on the tissue with the bodies at X_CB. `excitation`: of each
/// muscle of the face, or none.
MeshLoads loads_at(const TissueModel& model, std::span<const Pose> X_CB,
                   std::span<const double> excitation = {});

/// The same, with the contacts of nodes at x.
MeshLoads contact_loads(const TissueModel& model, std::span<const Pose> X_CB, const Nodes& x);

/// Prisms without a positive volume.
int count_inverted(const SpringPrismMesh& elements, const Nodes& x);

/// Largest displacement of any node, mm.
double largest_displacement(const Nodes& from, const Nodes& to);

/// How the face's point p with its side (0 = unknown) is carried.
CarriedPoint carry_face_point(const TissueMesh& mesh, const FaceDisplay& display,
                              const Eigen::Vector3d& p, int side);

/// Solves a plain opening and fills `opening.path` and `factors`.
void make_opening_path(const Eigen::Vector3d& condyles, TissueModel& model, int threads);

}  // namespace condyle
