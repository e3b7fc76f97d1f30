#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

namespace condyle {

/// Pixels x0 <= x < x1, y0 <= y < y1 from the lower left of a picture.
struct DrawnBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return std::max(0, x1 - x0); }
  int height() const { return std::max(0, y1 - y0); }
  bool empty() const { return width() == 0 || height() == 0; }
  bool operator==(const DrawnBox&) const = default;

  DrawnBox both(const DrawnBox& other) const {
    return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1),
            std::min(y1, other.y1)};
  }
  DrawnBox around(const DrawnBox& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1),
            std::max(y1, other.y1)};
  }
};

/// Accumulates the bounds of the drawn pixels of a picture.
class PictureBounds {
 public:
  PictureBounds(int width, int height, const Eigen::Matrix4f& view_projection)
      : half_(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height)),
        width_(width),
        height_(height),
        view_projection_(view_projection) {}

  /// Adds a point with a number of pixels around it. A point beside or behind the eye may project
  /// anywhere.
  void add(const Eigen::Vector3f& place, float pixels) {
    const Eigen::Vector4f p = view_projection_ * place.homogeneous();
    if (!(p.w() > 1e-3f)) {
      whole_ = true;
      return;
    }
    const Eigen::Array2f at = (p.head<2>().array() / p.w() + 1) * half_.array();
    low_ = low_.min(at - pixels);
    high_ = high_.max(at + pixels);
  }

  /// A box of a part.
  void add(const Eigen::AlignedBox3f& box, const Eigen::Matrix4f& model) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3f at = box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner));
      add(model.topLeftCorner<3, 3>() * at + model.topRightCorner<3, 1>(), 0);
    }
  }

  /// The bounds with a margin of `air` pixels, within the picture.
  DrawnBox box(int air) const {
    const DrawnBox all = {0, 0, width_, height_};
    if (whole_) return all;
    if (!(low_ <= high_).all()) return {};
    // Clamped to the range of int.
    const auto at = [](float pixel) { return static_cast<int>(std::clamp(pixel, -1e6f, 1e6f)); };
    return all.both({at(low_.x()) - air - 1, at(low_.y()) - air - 1, at(high_.x()) + air + 1,
                     at(high_.y()) + air + 1});
  }

 private:
  Eigen::Vector2f half_;
  int width_, height_;
  Eigen::Matrix4f view_projection_;
  Eigen::Array2f low_ = Eigen::Array2f::Constant(1e30f), high_ = -low_;
  bool whole_ = false;
};

}  // namespace condyle
