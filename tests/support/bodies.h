#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/frame/body_tree.h"
#include "sim/frame/part.h"

namespace condyle::test {

/// Gives each segment and transplant its own body, a child of the cranium or of the body given here
/// by name. The tree that the parts belong to.
inline BodyTree bodies_for(std::vector<Part>& parts,
                           const std::map<std::string, BodyId>& parents = {}) {
  BodyTree bodies = native_bodies();
  for (Part& part : parts) {
    if (!is_piece(part.role)) continue;
    const auto parent = parents.find(part.name);
    part.body = bodies.add({.name = part.name,
                            .parent = parent == parents.end() ? cranium_body : parent->second,
                            .driver = BodyDriver::hand});
  }
  return bodies;
}

}  // namespace condyle::test
