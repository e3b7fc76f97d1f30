#pragma once

#include <set>
#include <string>
#include <vector>

namespace condyle {

/// Cameras of a recording: as the window looks, and so but turning once around the patient.
inline constexpr const char* own_camera = "view";
inline constexpr const char* turning_camera = "turning";

/// How edges are made smooth: samples of the graphics driver, a filter, or not at all.
enum class RecordEdges { msaa, fxaa, none };

constexpr int least_picture_px = 16, most_picture_px = 8192;  // a side

/// How a person wants recordings; what says nothing about the patient is kept from one run to the
/// next.
struct RecordChoice {
  int width = 1920, height = 1080;  // pixels
  double frames_per_second = 30;
  int supersampling = 1;  // 1 to 4
  RecordEdges edges = RecordEdges::msaa;
  bool film = true, transparent = false;
  std::set<std::string> cameras = {own_camera};
  // Of this patient alone:
  bool camera_from_file = false;
  std::string camera_file = {}, caption = {};

  /// Those that are chosen, in the order of the list; a file without a name is none.
  std::vector<std::string> wanted_cameras() const;
  bool operator==(const RecordChoice&) const = default;
};

}  // namespace condyle
