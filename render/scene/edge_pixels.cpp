#include "render/scene/edge_pixels.h"

#include <algorithm>

namespace condyle {

std::span<std::uint8_t> EdgePixels::marks_within(const DrawnBox& box) {
  box_ = box;
  marks_.assign(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()), 0);
  return marks_;
}

bool EdgePixels::any(const Eigen::Vector2f& low, const Eigen::Vector2f& high, float widened) const {
  const float margin = 0.1f + widened;  // pixels; GPUs move corners by less than the first
  // Far outside, values may exceed the range of int.
  const auto first = [margin](float pixel, int from, int end) {
    return static_cast<int>(
        std::clamp(pixel - margin, static_cast<float>(from), static_cast<float>(end)));
  };
  const auto last = [margin](float pixel, int from, int end) {
    return static_cast<int>(
        std::clamp(pixel + margin, static_cast<float>(from - 1), static_cast<float>(end - 1)));
  };
  const int x0 = first(low.x(), box_.x0, box_.x1), x1 = last(high.x(), box_.x0, box_.x1);
  const int y1 = last(high.y(), box_.y0, box_.y1);
  for (int y = first(low.y(), box_.y0, box_.y1); y <= y1; ++y) {
    const std::uint8_t* row = marks_.data() + std::ptrdiff_t{y - box_.y0} * box_.width() - box_.x0;
    for (int x = x0; x <= x1; ++x)
      if (row[x]) return true;
  }
  return false;
}

const std::vector<Eigen::Vector3i>& EdgePixels::touching(std::span<const Eigen::Vector3f> points,
                                                         std::span<const Eigen::Vector3i> triangles,
                                                         const Eigen::Matrix4f& to_clip, int width,
                                                         int height, float widened) {
  const Eigen::Vector2f half(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  projected_.clear();
  for (const auto& point : points) {
    const Eigen::Vector4f p = to_clip.leftCols<3>() * point + to_clip.col(3);
    const float inverse = 1 / p.w();
    projected_.emplace_back((p.x() * inverse + 1) * half.x(), (p.y() * inverse + 1) * half.y(),
                            p.w() > 0 && p.z() > -p.w() ? 1.f : 0.f);
  }
  chosen_.clear();
  for (const auto& t : triangles) {
    const Eigen::Vector3f &a = projected_[static_cast<std::size_t>(t[0])],
                          &b = projected_[static_cast<std::size_t>(t[1])],
                          &c = projected_[static_cast<std::size_t>(t[2])];
    const Eigen::Vector3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    if (low.z() < 1 || any(low.head<2>(), high.head<2>(), widened)) chosen_.push_back(t);
  }
  return chosen_;
}

}  // namespace condyle
