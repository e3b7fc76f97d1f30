#include "render/face/tooth_tint.h"

#include <algorithm>
#include <limits>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

const Vector3f dentine(.985f, .95f, .86f), canine(.99f, .975f, .94f), enamel_edge(.95f, .98f, 1);
constexpr double edge_mm = 1.8;    // extent of the translucent edge
constexpr double neck_from = 0.3;  // of the height of the crown, from its edge

Vector3f blended(const Vector3f& factor, double fraction) {
  return Vector3f::Ones() + static_cast<float>(fraction) * (factor - Vector3f::Ones());
}

}  // namespace

std::vector<Vector3f> tooth_tint(const Part& part) {
  if (!is_teeth(part.role) || part.teeth.empty()) return {};
  std::vector<Vector3f> tint(part.mesh.vertices.size(), Vector3f::Ones());
  const double down = part.role == Role::upper_teeth ? -1 : 1;  // sign of z at the edge
  for (const Tooth& tooth : part.teeth) {
    const auto first = part.mesh.triangles.begin() + tooth.first_triangle;
    const auto last = first + tooth.triangle_count;
    double edge = -std::numeric_limits<double>::infinity(), gum = -edge;
    const auto towards_edge = [&](int v) {
      return down * part.mesh.vertices[static_cast<std::size_t>(v)].z();
    };
    for (auto t = first; t != last; ++t)
      for (const int v : *t) {
        edge = std::max(edge, towards_edge(v));
        gum = std::min(gum, towards_edge(v));
      }
    const int place = tooth.fdi % 10;  // from the midline
    for (auto t = first; t != last; ++t)
      for (const int v : *t) {
        const double off = edge - towards_edge(v);
        const double neck =
            smooth_step((off / std::max(edge - gum, 1e-6) - neck_from) / (1 - neck_from));
        Vector3f& own = tint[static_cast<std::size_t>(v)];
        own = blended(dentine, neck);
        if (place == 3) own = own.cwiseProduct(canine);
        if (place <= 3)
          own = own.cwiseProduct(blended(enamel_edge, 1 - smooth_step(off / edge_mm)));
      }
  }
  return tint;
}

}  // namespace condyle
