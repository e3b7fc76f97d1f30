#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "engine/cut/region.h"
#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"
#include "sim/graft/defect.h"
#include "sim/graft/donor.h"
#include "sim/plan/graft_step.h"

namespace condyle {

/// A saw cut on the donor.
struct DonorCut {
  double place_mm = 0;     // on the donor's axis, from its end
  double angle_deg = 0;    // off a cut square to the axis
  double outward_deg = 0;  // the same seen along z: positive, its outer side lies farther along
  double up_deg = 0;       // the same seen along y: positive, its upper side lies farther along
};

/// A piece of a graft.
struct GraftPiece {
  std::string body = {};
  TriMesh mesh = {};           // closed; in place on the jaw, cranium's frame at the uncut rest
  std::vector<int> wall = {};  // of each triangle: 0 and 1 on its first and second face, else -1
  Pose X_CD = {};              // of the donor, as this piece lies
  std::array<Plane, 2> faces = {};  // in place; normals out of the piece
  std::array<DonorCut, 2> cuts = {};
  double start_mm = 0;   // place of its first corner on the donor's axis, as GraftStep::starts_mm
  double length_mm = 0;  // along its axis, between its faces
  double volume_mm3 = 0;
};

/// A graft in place.
struct GraftLayout {
  GraftStep step = {};
  Defect defect = {};
  std::vector<Eigen::Vector3d> curve = {};    // that it follows
  std::vector<Eigen::Vector3d> corners = {};  // of its axis, one more than pieces
  std::vector<GraftPiece> pieces = {};
  std::vector<double> spacing_mm = {};  // between neighbouring saw cuts beyond the kerf; negative:
                                        // they run into each other
  double donor_from_mm = 0, donor_to_mm = 0;  // part of the donor's axis that is used
  double curve_deviation_mm = 0;              // largest distance of the axis from the curve
  std::vector<std::string> warnings = {};     // for people
};

constexpr double least_piece_mm = 20;  // for the blood supply of a vascularised piece

/// Lays a graft along a curve in a defect: corners on the curve where the squared distance of its
/// straight axis from the curve is least, inner faces that bisect the angle between neighbours, end
/// faces parallel to those of the host at the step's clearance. Pieces are cut from the donor one
/// after another; neighbouring saw cuts are `kerf + spacing` apart where they are nearest.
/// `resected`: the bone that was there.
/// throws: InputError for a gap that the clearances fill, bone no thicker than the saw, a graft
/// that its donor is too short for, saw cuts that run into each other, and as find_defect(),
/// border_curve() and make_donor().
GraftLayout lay_graft(const GraftStep& step, const TriMesh& resected, const Defect& defect);

}  // namespace condyle
