#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace condyle {

/// A segment that leaves the patient, with the teeth that it carries.
struct ResectStep {
  std::string segment = {};  // made by an earlier cut

  bool operator==(const ResectStep&) const = default;
};

constexpr int max_graft_pieces = 4;

/// Bone from elsewhere in the place of a resected segment, in pieces with mitred faces along a
/// curve.
struct GraftStep {
  std::string name = "graft";    // of its bodies: name, or name_1 to name_n
  std::string donor = "fibula";  // fibula, iliac_block, rib, or a file with a closed surface
  std::string donor_shape = {};  // of a file: hash of its surface, 16 hexadecimal digits
  std::string replaces = {};     // segment that an earlier step resects
  int pieces = 1;                // 1 to 4
  // Axis of the graft, in the cranium's frame at the uncut rest; empty: along the lower border of
  // the resected bone.
  std::vector<Eigen::Vector3d> curve = {};
  // Height of the axis above the lower border; none: half the height of the donor's section.
  std::optional<double> height_mm = {};
  double roll_deg = 0;        // of the donor about its own axis
  double kerf_mm = 0.5;       // of the saw on the donor
  double spacing_mm = 0.5;    // between neighbouring saw cuts on the donor, beyond the kerf
  double clearance_mm = 0.2;  // between the graft's end faces and the host bone
  // Places of the pieces on the donor's axis, from its end; empty: spaced by kerf and spacing.
  std::vector<double> starts_mm = {};
  std::string approach = "submandibular";  // or intraoral: the side that the surgeon works from

  bool operator==(const GraftStep&) const = default;
};

/// "graft" of one piece, else "graft_1", "graft_2", ...
std::vector<std::string> graft_bodies(const GraftStep& step);

/// Item and problem of the first value that is refused; absent if there is none.
using GraftStepProblem = std::optional<std::pair<std::string, std::string>>;
GraftStepProblem graft_step_problem(const ResectStep& step);
GraftStepProblem graft_step_problem(const GraftStep& step);

/// The donor as reports name it: "own surface" for that of a file, whose name may be a patient's.
std::string donor_label(const GraftStep& step);

/// "fibula in 3 pieces for resected; kerf 0.5 mm": a step in a list.
std::string graft_step_details(const GraftStep& step);

}  // namespace condyle
