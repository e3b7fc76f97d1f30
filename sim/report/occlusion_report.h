#pragma once

#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/occlusion/occlusion.h"

namespace condyle {

/// What was asked for and what came of it.
struct OcclusionReport {
  std::string patient;
  std::string start;  // in words
  OcclusionSettings settings;
  Bite bite;
  std::string picture = {};             // file beside the report, or empty
  std::vector<std::string> notes = {};  // besides the bite's own

  std::string json() const;  // content of report.json
  std::string text() const;  // a few sentences for people
  std::string page() const;  // one page for people, HTML without scripts
};

/// The bite as a motion file of one row.
std::string bite_pose_csv(const Bite& bite);

/// Two seconds from the start to the bite by way of an open mouth, as a motion file.
std::string bite_motion_csv(const Bite& bite, const Pose& start);

/// "1.2 mm down, 0.3 mm forward": parts below 0.05 mm are left out.
std::string way_in_words(const Eigen::Vector3d& way);

/// Both arches in the bite, ready to be drawn: with small triangles where they touch.
struct BiteView {
  std::vector<Part> parts;                  // bones and teeth at rest
  std::vector<float> upper_gap, lower_gap;  // of the arches' vertices to the other arch, mm
};
BiteView bite_view(const Case& patient, const Bite& bite, int threads);

}  // namespace condyle
