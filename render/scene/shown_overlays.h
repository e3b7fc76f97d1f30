#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "render/overlay/overlay_key.h"
#include "render/overlay/overlays.h"

namespace condyle {

class SceneRenderer;

/// Lines, sheets and bodies in space that are drawn with the parts, by name.
struct Overlays {
  std::map<std::string, LineSet> lines = {};
  std::map<std::string, GlassSheet> sheets = {};
  std::map<std::string, FibreBody> bodies = {};
  std::vector<PlaceLabel> labels = {};  // written on the finished picture
  std::vector<KeyEntry> key = {};       // to all of them
};

/// Keeps the overlays of one renderer up to date.
class OverlaySender {
 public:
  /// Removes overlays that were sent before and are not among these.
  void send(SceneRenderer& renderer, const Overlays& overlays);

 private:
  std::set<std::string> lines_, sheets_, bodies_;
};

}  // namespace condyle
