#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/frame/frame_state.h"

namespace condyle {

/// Writes trace.csv, a row per frame. Rows go to a file beside the target, which takes its place in
/// `finish`; until then an earlier trace stays whole.
class TraceWriter {
 public:
  /// `muscles`: names, of a motion that they drive; three columns each stand at the end.
  /// throws: MachineError when the file cannot be made.
  explicit TraceWriter(const std::filesystem::path& file,
                       const std::vector<std::string>& muscles = {});
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  void add(int frame, const FrameState& state);
  void finish();

  static const char* header();

 private:
  void put(const std::string& text);

  std::filesystem::path file_, beside_;
  std::FILE* stream_ = nullptr;
  long rows_ = 0;
  double before_s_ = 0;  // of the row before: speeds are over the time between rows
  Eigen::Vector3d incisor_before_ = Eigen::Vector3d::Zero();
};

}  // namespace condyle
