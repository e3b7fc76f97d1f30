#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/tissue/frame_embedding.h"
#include "engine/tissue/rolling_factor.h"
#include "engine/tissue/spring_prism.h"
#include "sim/tissue/opening_path.h"
#include "sim/tissue/skin_region.h"
#include "sim/tissue/slit.h"
#include "sim/tissue/tissue.h"
#include "sim/tissue/tissue_contact.h"

namespace condyle {

/// See tissue.h. Nodes in `node_of` order (layered_net.h), mm, at rest in the cranium's frame.
struct TissueModel : std::enable_shared_from_this<TissueModel> {
  int columns = 0, sheets = 0;
  std::vector<int>
      cut_from;  // for each layer of the net, the number of the layer asked for; empty: its own
  std::vector<Eigen::Vector3i> triangles;  // of the columns, seen from outside
  Nodes rest;
  SpringPrismNet net;
  std::shared_ptr<const NetRuns> runs;  // of the net as it is solved

  // A share of 1 goes with the mandible, 0 with the cranium: a point X asks for X + share (X_CM X -
  // X).
  std::vector<double> anchor_share;
  Nodes anchor_offset;  // of each target, turned as its bone turns: what balances the strains
  Nodes node_force;     // weight, N; or none
  Nodes held_force;  // N, turned as far as its node's bone turns: what strains cannot balance; or
                     // none
  TissueContact contact;
  // Preconditioners, for states turned by `from_rad` and more; rising, the first from 0.
  struct Factor {
    double from_rad = 0;
    std::shared_ptr<const HessianFactor> factor;
  };
  std::vector<Factor> factors;
  OpeningPath path;
  std::vector<double> node_share;  // of every node, to foresee where a motion takes it

  // The displayed face.
  RegionShape region;
  LipSlit slit;
  HandleSet handles;
  std::vector<double> handle_evened;     // 0 to 1: how much its motion is evened out for display
  std::vector<signed char> handle_side;  // +1 above the lip line, -1 below
  std::vector<int> carried_vertex;       // of the face part
  std::vector<CarriedPoint> carried;
  std::vector<Eigen::Vector3d> face_rest;
  std::vector<signed char> face_side;

  TissueSummary summary;
};

/// What the bones ask of the tissue with the mandible at X_CM.
NetLoads loads_at(const TissueModel& model, const Pose& X_CM);

/// The same, with what the tissue touches when its nodes are at x.
NetLoads touching_loads(const TissueModel& model, const Pose& X_CM, const Nodes& x);

/// Farthest way of any node, mm.
double largest_way(const Nodes& from, const Nodes& to);

/// How the face's point p with its side (0 = unknown) is carried.
CarriedPoint carry_face_point(const TissueModel& model, const Eigen::Vector3d& p, int side);

}  // namespace condyle
