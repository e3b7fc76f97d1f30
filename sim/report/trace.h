#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/frame/frame_state.h"

namespace condyle {

/// Writes trace.csv, one row per frame. Rows go to a temporary file in the same folder, which
/// replaces the target in `finish`; until then an earlier trace remains intact.
class TraceWriter {
 public:
  /// The pose columns are of the lower arch's body. `muscles`: names in a muscle-driven motion;
  /// three columns are appended for each, then seven of the pose of each body other than the
  /// cranium and the lower arch's. throws: MachineError when the file cannot be created.
  explicit TraceWriter(const std::filesystem::path& file,
                       const std::vector<std::string>& muscles = {},
                       const BodyTree& bodies = native_bodies(), const JawBodies& jaw = {});
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  void add(int frame, const FrameState& state);
  void finish();

  static const char* header();

 private:
  void put(const std::string& text);

  std::filesystem::path file_, beside_;
  BodyId jaw_;
  std::vector<BodyId> others_;
  std::FILE* stream_ = nullptr;
  long rows_ = 0;
  double before_s_ = 0;  // time of the previous row: speeds are over the time between rows
  Eigen::Vector3d incisor_before_ = Eigen::Vector3d::Zero();
};

}  // namespace condyle
