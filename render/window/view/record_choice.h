#pragma once

#include <set>
#include <string>
#include <vector>

#include "render/camera/camera.h"

namespace condyle {

/// Antialiasing of edges: multisampling, a filter (FXAA), or none.
enum class RecordEdges { msaa, fxaa, none };

constexpr int min_picture_px = 16, max_picture_px = 8192;  // a side

/// The user's choices for recordings; those independent of the patient are kept from one run to the
/// next.
struct RecordChoice {
  int width = 1920, height = 1080;  // pixels
  double frames_per_second = 30;
  int supersampling = 1;  // 1 to 4
  RecordEdges edges = RecordEdges::msaa;
  bool film = true, transparent = false;
  std::set<std::string> cameras = {own_camera};
  // Choices for this patient alone:
  bool camera_from_file = false;
  std::string camera_file = {}, caption = {};

  /// The selected cameras, in the order of the list; a file without a name is ignored.
  std::vector<std::string> selected_cameras() const;
  bool operator==(const RecordChoice&) const = default;
};

}  // namespace condyle
