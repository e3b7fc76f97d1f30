#include "render/face/mouth_space.h"

#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double cell_mm = 0.5;          // of the ceiling grid
constexpr double row_mm = 1;             // of the arch
constexpr double throat_mm = 18;         // behind the last tooth
constexpr double behind_teeth_mm = 1.6;  // from teeth to the cheek
constexpr double within_crowns_mm = 5;   // of a bone that carries crowns, with their cusps and pits
constexpr double gum_mm = 1;             // of a palate without separate gums
constexpr double soft_palate_slope = 0.85;  // down over back, behind the bone

Eigen::AlignedBox3d box_around(std::span<const Vector3d> places) {
  Eigen::AlignedBox3d box;
  for (const auto& p : places) box.extend(p);
  return box;
}

Eigen::AlignedBox3d region_around(Eigen::AlignedBox3d teeth) {
  const Vector3d front_low = teeth.min() - Vector3d(5, 10, 0);
  teeth.extend(teeth.max() + Vector3d(5, throat_mm + 5, 0));
  teeth.extend(front_low);
  return teeth;
}

SoftPalate soft_palate(const Ceiling& bone, const AboveCeiling& above,
                       const Eigen::AlignedBox3d& teeth, double mid_z) {
  SoftPalate soft = {teeth.max().y(), mid_z + MouthSpace::fornix_up_mm, mid_z + 4};
  bool found = false;
  for (double y = teeth.min().y(); y < teeth.max().y() + throat_mm; y += 0.5) {
    const double z = bone.at(teeth.center().x(), y);
    // Also where mucosa ends in front of its bone.
    const bool steps_up = found && y > teeth.max().y() && z > soft.begin_z;
    if (z < mid_z + MouthSpace::highest_palate_mm && !steps_up) {
      soft.begin_y = y;
      soft.begin_z = z + above.at(y, z);
      found = true;
    } else if (found) {
      break;
    }
  }
  return soft;
}

}  // namespace

Ceiling::Ceiling(std::span<const Part> parts, const Eigen::AlignedBox3d& region, double above)
    : low_(region.min().head<2>()), above_(above) {
  const Eigen::Vector2d size = region.sizes().head<2>();
  columns_ = static_cast<int>(size.x() / cell_mm) + 2;
  rows_ = static_cast<int>(size.y() / cell_mm) + 2;
  heights_.assign(static_cast<std::size_t>(columns_ * rows_), none);
  for (const auto& part : parts)
    if (part.role == Role::skull || part.role == Role::maxilla || part.role == Role::upper_gums)
      for (const auto& t : part.mesh.triangles)
        add(part.mesh.vertices[static_cast<std::size_t>(t[0])],
            part.mesh.vertices[static_cast<std::size_t>(t[1])],
            part.mesh.vertices[static_cast<std::size_t>(t[2])]);
}

double Ceiling::at(double x, double y) const {
  const int c = static_cast<int>(std::lround((x - low_.x()) / cell_mm)),
            r = static_cast<int>(std::lround((y - low_.y()) / cell_mm));
  if (c < 0 || r < 0 || c >= columns_ || r >= rows_) return none;
  return heights_[static_cast<std::size_t>(r * columns_ + c)];
}

void Ceiling::add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  if (std::max({a.z(), b.z(), c.z()}) < above_) return;
  const Eigen::Matrix2d sides =
      (Eigen::Matrix2d() << (b - a).head<2>(), (c - a).head<2>()).finished();
  if (std::abs(sides.determinant()) < 1e-9) return;
  const Eigen::Matrix2d to_barycentric = sides.inverse();
  const auto within = [&](double cell, int k) {
    return static_cast<int>(std::clamp(cell, -1.0, static_cast<double>(k == 0 ? columns_ : rows_)));
  };
  const auto first = [&](double v, int k) {
    return std::max(0, within(std::ceil((v - low_[k]) / cell_mm), k));
  };
  const auto last = [&](double v, int k) {
    return std::min((k == 0 ? columns_ : rows_) - 1,
                    within(std::floor((v - low_[k]) / cell_mm), k));
  };
  for (int r = first(std::min({a.y(), b.y(), c.y()}), 1);
       r <= last(std::max({a.y(), b.y(), c.y()}), 1); ++r)
    for (int k = first(std::min({a.x(), b.x(), c.x()}), 0);
         k <= last(std::max({a.x(), b.x(), c.x()}), 0); ++k) {
      const Eigen::Vector2d barycentric =
          to_barycentric * (low_ + cell_mm * Eigen::Vector2d(k, r) - a.head<2>());
      if (barycentric.minCoeff() < -1e-9 || barycentric.sum() > 1 + 1e-9) continue;
      const double z = a.z() + barycentric.x() * (b - a).z() + barycentric.y() * (c - a).z();
      double& kept = heights_[static_cast<std::size_t>(r * columns_ + k)];
      if (z > above_) kept = std::min(kept, z);
    }
}

AboveCeiling::AboveCeiling(std::span<const Part> parts, const Ceiling& bone,
                           const Eigen::AlignedBox3d& region, double mid_z)
    : bare_(std::none_of(parts.begin(), parts.end(),
                         [](const Part& part) { return part.role == Role::upper_gums; })),
      front_(region.min().y()) {
  constexpr double arch_mm = 9;  // above the lip line, at most
  const auto rows = static_cast<std::size_t>(region.sizes().y() / row_mm) + 1;
  std::vector<double> lowest(rows, Ceiling::none);
  for (std::size_t r = 0; r < rows; ++r)
    for (double x = region.min().x(); x < region.max().x(); x += 0.5)
      lowest[r] = std::min(lowest[r], bone.at(x, front_ + static_cast<double>(r) * row_mm));
  constexpr std::size_t gap = 3;  // rows: between two teeth
  for (std::size_t r = 0; r < rows; ++r) {
    const auto first = lowest.begin() + static_cast<std::ptrdiff_t>(r - std::min(r, gap));
    const auto last = lowest.begin() + static_cast<std::ptrdiff_t>(std::min(r + gap + 1, rows));
    const double z = *std::min_element(first, last);
    lowest_.push_back(z < mid_z + arch_mm ? z : -Ceiling::none);
  }
}

double AboveCeiling::at(double y, double surface_z) const {
  constexpr double crowns_mm = 2.5, to_palate_mm = 2.5;
  if (!bare_) return MouthSpace::within_mm;
  const double row =
      std::clamp((y - front_) / row_mm, 0.0, static_cast<double>(lowest_.size() - 1));
  const double palate =
      smooth_step((surface_z - lowest_[static_cast<std::size_t>(row)] - crowns_mm) / to_palate_mm);
  return within_crowns_mm - palate * (within_crowns_mm + gum_mm);
}

double SoftPalate::at(double y) const {
  return std::max(lowest_z, begin_z - soft_palate_slope * std::max(0.0, y - begin_y));
}

MouthWidth::MouthWidth(std::span<const Vector3d> arches, const Eigen::AlignedBox3d& teeth)
    : front_(teeth.min().y()) {
  half_.assign(static_cast<std::size_t>(teeth.sizes().y()) + 1, 0);
  for (const auto& v : arches) {
    double& half = half_[static_cast<std::size_t>(v.y() - front_)];
    half = std::max(half, std::abs(v.x() - teeth.center().x()));
  }
  for (std::size_t i = 1; i < half_.size(); ++i) half_[i] = std::max(half_[i], half_[i - 1]);
}

double MouthWidth::at(double y) const {
  const auto i = static_cast<std::size_t>(std::max(0.0, y - front_));
  return half_[std::min(i, half_.size() - 1)] + behind_teeth_mm;
}

MouthSpace::MouthSpace(std::span<const Part> parts, std::span<const Vector3d> arches, double mid)
    : teeth(box_around(arches)),
      mid_z(mid),
      throat_y(teeth.max().y() + throat_mm),
      tongueless(std::none_of(parts.begin(), parts.end(),
                              [](const Part& part) { return part.role == Role::tongue; })),
      bone(parts, region_around(teeth), mid_z + 1),
      above(parts, bone, region_around(teeth), mid_z),
      width(arches, teeth),
      soft(soft_palate(bone, above, teeth, mid_z)) {}

}  // namespace condyle
