#include "sim/case/front_profile.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace condyle {

namespace {
constexpr double face_depth_mm = 50;  // largest depth of the profile behind its foremost point
}  // namespace

FrontProfile front_profile(const TriMesh& mesh, double x0) {
  FrontProfile front;
  const auto keep = [&](int bin, double y) {
    const auto [it, fresh] = front.try_emplace(bin, y);
    if (!fresh) it->second = std::min(it->second, y);
  };
  double foremost = 1e9;
  for (const auto& t : mesh.triangles) {
    std::vector<Eigen::Vector3d> ends;
    for (int e = 0; e < 3; ++e) {
      const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[e])];
      const Eigen::Vector3d& b = mesh.vertices[static_cast<std::size_t>(t[(e + 1) % 3])];
      if ((a.x() < x0) != (b.x() < x0))
        ends.push_back(a + (x0 - a.x()) / (b.x() - a.x()) * (b - a));
    }
    if (ends.size() != 2) continue;
    if (ends[0].z() > ends[1].z()) std::swap(ends[0], ends[1]);
    foremost = std::min({foremost, ends[0].y(), ends[1].y()});
    const double low = ends[0].z(), height = ends[1].z() - low;
    const auto bin_of = [](double z) { return static_cast<int>(std::floor(z / profile_bin_mm)); };
    keep(bin_of(low), ends[0].y());
    keep(bin_of(low + height), ends[1].y());
    for (int bin = bin_of(low) + 1; bin < bin_of(low + height); ++bin)
      keep(bin, ends[0].y() +
                    ((bin + 0.5) * profile_bin_mm - low) / height * (ends[1].y() - ends[0].y()));
  }
  std::erase_if(front, [&](const auto& at) { return at.second > foremost + face_depth_mm; });
  return front;
}

double hollow_depth(const FrontProfile& front, int bin, double y) {
  constexpr int reach = static_cast<int>(8 / profile_bin_mm);  // height of a lip
  double above = y, below = y;
  for (int step = 1; step <= reach; ++step) {
    if (const auto at = front.find(bin + step); at != front.end())
      above = std::min(above, at->second);
    if (const auto at = front.find(bin - step); at != front.end())
      below = std::min(below, at->second);
  }
  return y - std::max(above, below);
}

}  // namespace condyle
