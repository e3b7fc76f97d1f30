#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/mesh/measure.h"
#include "sim/case/case.h"
#include "sim/case/case_io.h"

namespace condyle {

/// Refuses a patient whose bounding box is not of a head's size, naming the unit that would fit.
void check_size(const Box& box, const ImportRequest& request);

/// Points where the mesh's edges cross the sagittal plane x = `middle`, and its vertices within
/// `near_mm`.
std::vector<Eigen::Vector3d> midline_points(const TriMesh& mesh, double middle, double near_mm);

/// Adds missing condyle centres and incisal points, estimated from the meshes, each with a note.
/// Existing points are unchanged.
void estimate_landmarks(Case& patient);

/// Refuses landmarks of a jaw that are far from this mandible. A single distant point may be right:
/// the landmark of a resected condyle.
void check_landmarks(const Case& patient, const ImportRequest& request);

/// Refuses a mandible that is upside down, back to front or side to side in LPS, naming a frame
/// that would fit. `patient` is converted as requested.
void check_frame(const Case& patient, const ImportRequest& request);

/// Gives each segment and transplant its own body, child of the body given by name, else of the
/// cranium or mandible, whichever is nearer, with a note. throws: InputError for an unknown piece
/// or parent, and for pieces that form a cycle.
void make_piece_bodies(Case& patient, const std::map<std::string, std::string>& asked);

}  // namespace condyle
