#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/operation/operation.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

// Deviations of a segment that are accepted in orthognathic surgery (textbook values).
constexpr double accepted_mm = 2, accepted_deg = 4;

/// Position of a segment in the second plan or case, relative to the first: displacement of its
/// centroid, and rotations as in ClinicalMove.
struct SegmentDifference {
  std::string body;
  double left_mm = 0, forward_mm = 0, up_mm = 0;
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
  double angle_deg = 0;  // of the whole rotation
  double rms_mm = 0;     // of the registration on the case's bone; 0 between plans

  double distance_mm() const { return Eigen::Vector3d(left_mm, forward_mm, up_mm).norm(); }
  bool accepted() const { return distance_mm() <= accepted_mm && angle_deg <= accepted_deg; }
};

/// A landmark of the planner's table in the second relative to the first, mm.
struct LandmarkDifference {
  std::string label, landmark;
  double left_mm = 0, forward_mm = 0, up_mm = 0;

  double distance_mm() const { return Eigen::Vector3d(left_mm, forward_mm, up_mm).norm(); }
};

struct PlanComparison {
  std::string first, second;  // names of the plans or of the case
  std::vector<SegmentDifference> segments;
  std::vector<LandmarkDifference> landmarks;
  std::vector<std::string> notes;  // segments of one alone or cut differently; the registration
};

/// Two plans of the same uncut case. Compares bodies of equal names other than the cranium.
/// throws: InputError where no segment has the same name in both.
PlanComparison compare_plans(const Operated& first, const Operated& second,
                             const ClinicalFrame& frame);

/// A plan with what was achieved: a case of the patient after the operation, in any position. It is
/// registered on the bones of the cranium that the plan leaves in place; then each segment, from
/// its planned position, on the bone of its name, or else on all bones. Cut faces do not count.
/// throws: InputError for a case without bone, or one whose cranium cannot be registered.
PlanComparison compare_with_case(const Operated& planned, const Case& achieved,
                                 const ClinicalFrame& frame, int threads = 2);

/// Tables of segments and landmarks, directions in words.
std::string plan_comparison_text(const PlanComparison& comparison);
nlohmann::ordered_json plan_comparison_json(const PlanComparison& comparison);

}  // namespace condyle
