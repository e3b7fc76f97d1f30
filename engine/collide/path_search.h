#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/collide/slide.h"

namespace condyle {

struct PathSearchSettings {
  // Straight directions along which the body is moved more often than along others; unit.
  std::vector<Eigen::Vector3d> directions = {};
  double reach_mm = 70;    // of the pivot from the start
  double turn_rad = 2.4;   // of the body from the start
  double extend_mm = 5;    // longest move between two poses of the tree
  int max_poses = 20'000;  // to be examined before the search gives up
  double margin_mm = 0.5;  // more distance than this is no gain
  std::uint64_t seed = 1;
};

struct PathSearch {
  std::vector<Pose> poses = {};  // from the start to a goal; empty: no path was found
  Pose farthest = {};            // pose reached from the start with the largest displacement
  double farthest_mm = 0;        // of the pivot there
  int examined = 0;              // poses compared with the obstacles
};

/// A path of a body from one pose to one of several, along which no sample is deeper than allowed
/// (SlidingContact): RRT-Connect, whose moves slide along obstacles, then shortened and moved away
/// from obstacles where that brings a sample farther away, up to the margin. Between successive
/// poses of the path the body moves as interpolate() does about the contact's pivot, which was
/// examined in steps of half a millimetre. Depends on its arguments alone.
/// source: Kuffner and LaValle, RRT-Connect, ICRA 2000; the sliding moves are those of
/// Zhang and Manocha, An efficient retraction-based RRT planner, ICRA 2008.
/// `finer`: the contact that the found path is shortened and widened by.
PathSearch find_path(const SlidingContact& contact, const SlidingContact& finer, const Pose& start,
                     const std::vector<Pose>& goals, const PathSearchSettings& settings = {});

}  // namespace condyle
