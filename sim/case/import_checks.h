#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/mesh/measure.h"
#include "sim/case/case.h"
#include "sim/case/case_io.h"

namespace condyle {

/// Refuses a patient whose box is not of a head's size, naming the unit that would fit.
void check_size(const Box& box, const ImportRequest& request);

/// Where the mesh's edges cross the sagittal plane x = `middle`, and its vertices within `near_mm`.
std::vector<Eigen::Vector3d> midline_points(const TriMesh& mesh, double middle, double near_mm);

/// Adds condyle centres and incisal points that are missing, estimated from the meshes, each with a
/// note. Does nothing for a point that is there.
void estimate_landmarks(Case& patient);

/// Refuses landmarks of a jaw that is nowhere near this mandible. One far point alone may be right:
/// a resected condyle has its landmark still.
void check_landmarks(const Case& patient, const ImportRequest& request);

/// Refuses a mandible that is upside down, back to front or side to side in LPS, naming a frame
/// that would fit. `patient` is as converted by the request.
void check_frame(const Case& patient, const ImportRequest& request);

/// Gives each segment and transplant its carrier: the one asked for by name, else the body (cranium
/// or mandible) that it lies nearest to, with a note.
/// throws: InputError for a name that no free part has.
void choose_carriers(Case& patient, const std::map<std::string, Body>& asked);

}  // namespace condyle
