#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/case/case.h"

namespace condyle {

/// The opening between the lips of a face surface: one closed chain of border vertices, from the
/// right corner along the upper lip to the left corner and back along the lower lip.
struct MouthOutline {
  int right_corner = -1, left_corner = -1;
  std::vector<int> upper, lower;  // right to left, without the corners
  bool found() const { return right_corner >= 0; }
};

/// Border loops of a welded mesh, each a chain of vertices in the order of the surface's own edges.
std::vector<std::vector<int>> border_loops(const TriMesh& mesh);

/// Whether the surface's triangles face outward. Then a border loop runs along the upper lip from
/// the right corner to the left, and back along the lower: the surface lies on its left. Heights
/// cannot distinguish the lips, since closed lips overlap.
bool faces_outward(const TriMesh& mesh);

/// The border loop at the mouth, if the face has one. `incisors`: midpoint of the incisal points.
MouthOutline find_mouth(const TriMesh& face, const Landmarks& landmarks,
                        const Eigen::Vector3d& incisors);

/// Cuts a face whose lips are one surface along the lip line, from corner to corner, by duplicating
/// vertices (at the end of the list, with colours), and returns the new opening; empty if no lip
/// line can be found.
MouthOutline cut_lip_line(TriMesh& face, const Landmarks& landmarks,
                          const Eigen::Vector3d& incisors, std::vector<std::string>& notes);

/// Creates an opening between the lips of a face that has none, so that the displayed face can
/// open; adds a note to the case. Does nothing when there is an opening already.
void part_lips(Case& patient);

}  // namespace condyle
