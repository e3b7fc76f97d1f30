#pragma once

#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/occlusion/occlusion.h"

namespace condyle {

/// A bite with the settings and start from which it was found.
struct OcclusionReport {
  std::string patient;
  std::string start;  // as text
  OcclusionSettings settings;
  Bite bite;
  std::string picture = {};             // file name in the report's folder, or empty
  std::vector<std::string> notes = {};  // in addition to the bite's own

  std::string json() const;  // content of report.json
  std::string text() const;  // summary for the terminal
  std::string page() const;  // HTML page without scripts
};

/// The bite as a motion file of one row.
std::string bite_pose_csv(const Bite& bite);

/// A motion file of two seconds from the start to the bite through an opened position.
std::string bite_motion_csv(const Bite& bite, const Pose& start);

/// A displacement as text, "1.2 mm down, 0.3 mm forward"; components below 0.05 mm are omitted.
std::string displacement_text(const Eigen::Vector3d& displacement_mm);

/// Both arches in the bite, prepared for drawing: refined where they touch.
struct BiteView {
  std::vector<Part> parts;                  // bones and teeth at rest
  std::vector<float> upper_gap, lower_gap;  // of the arches' vertices to the other arch, mm
};
BiteView bite_view(const Case& patient, const Bite& bite, int threads);

}  // namespace condyle
