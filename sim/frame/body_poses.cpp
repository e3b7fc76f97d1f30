#include "sim/frame/body_poses.h"

namespace condyle {

std::vector<std::size_t> free_parts(std::span<const Part> parts) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (body_of(parts[i].role) == Body::free) list.push_back(i);
  return list;
}

Pose pose_of(std::span<const Part> parts, std::size_t part, const BodyPoses& at) {
  Body body = body_of(parts[part].role);
  if (body == Body::free) {
    std::size_t place = 0;
    for (std::size_t i = 0; i < part; ++i)
      if (body_of(parts[i].role) == Body::free) ++place;
    if (place < at.X_CF.size()) return at.X_CF[place];
    body = parts[part].carrier;
  }
  return body == Body::mandible ? at.X_CM : Pose{};
}

}  // namespace condyle
