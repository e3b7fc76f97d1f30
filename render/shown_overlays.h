#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "render/overlay_key.h"
#include "render/overlays.h"

namespace condyle {

class SceneRenderer;

/// Lines and sheets in space that are shown beside the parts, by name.
struct Overlays {
  std::map<std::string, LineSet> lines = {};
  std::map<std::string, GlassSheet> sheets = {};
  std::vector<KeyEntry> key = {};  // to all of them
};

/// Keeps the overlays of one renderer as they are wanted.
class OverlaySender {
 public:
  /// What was sent before and is not among these is taken away.
  void send(SceneRenderer& renderer, const Overlays& wanted);

 private:
  std::set<std::string> lines_, sheets_;
};

}  // namespace condyle
