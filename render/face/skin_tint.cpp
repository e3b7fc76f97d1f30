#include "render/face/skin_tint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// The closed mouth in front view: its rim from one corner to the other.
class Mouth {
 public:
  Mouth(const TriMesh& face, std::span<const int> rim) : face_(face), rim_(rim) {
    for (const int v : rim) box_.extend(place(v));
  }
  double width() const { return box_.sizes().x(); }
  Vector3d middle() const { return box_.center(); }
  const Eigen::AlignedBox3d& box() const { return box_; }

  /// mm from the rim.
  double distance_to(const Vector3d& p) const {
    double nearest = infinity;
    for (std::size_t i = 0; i < rim_.size(); ++i) {
      const Vector3d &a = place(rim_[i]), along = place(rim_[(i + 1) % rim_.size()]) - a;
      const double t =
          std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
      nearest = std::min(nearest, (p - a - t * along).squaredNorm());
    }
    return std::sqrt(nearest);
  }
  /// -1 at one corner, 1 at the other.
  double across(const Vector3d& p) const { return (p.x() - middle().x()) / (0.5 * width()); }
  /// Height of the rim at this position in front view.
  double height_at(double x) const {
    double weights = 0, sum = 0;
    for (const int v : rim_) {
      const double weight = std::exp(-std::pow((place(v).x() - x) / 2, 2)) + 1e-12;
      weights += weight;
      sum += weight * place(v).z();
    }
    return sum / weights;
  }

 private:
  const Vector3d& place(int v) const { return face_.vertices[static_cast<std::size_t>(v)]; }
  const TriMesh& face_;
  std::span<const int> rim_;
  Eigen::AlignedBox3d box_;
};

/// Fractions of the mouth's width: extent of the red above and below the rim.
double red_of_lip(double across, bool upper) {
  const double a = std::min(std::abs(across), 1.0);
  if (!upper) return 0.155 * std::pow(1 - a * a, 0.7);
  const double bow = 1 - 0.14 * std::exp(-std::pow(a / 0.09, 2));
  return 0.135 * bow * std::pow(1 - std::pow(a, 1.7), 0.8);
}

}  // namespace

void tint_skin(const TriMesh& face, std::span<const int> rim, std::vector<Vector3f>& colors) {
  const Mouth mouth(face, rim);
  const double width = mouth.width();
  const Vector3f red(.90f, .67f, .72f), flushed(.99f, .915f, .92f);
  Eigen::AlignedBox3d near = mouth.box();
  near.extend(near.max() + Vector3d::Constant(0.2 * width));
  near.extend(near.min() - Vector3d::Constant(0.2 * width));
  double nose = infinity;
  for (const auto& p : face.vertices)
    if (std::abs(p.x() - mouth.middle().x()) < 0.2 * width && p.z() > near.max().z() &&
        p.z() < mouth.middle().z() + width)
      nose = std::min(nose, p.y());
  for (std::size_t v = 0; v < colors.size(); ++v) {
    const Vector3d& p = face.vertices[v];
    const Vector3d from = (p - mouth.middle()) / width;
    const auto spot = [&](double x, double z, double size) {
      return std::exp(
          -(std::pow((std::abs(from.x()) - x) / size, 2) + std::pow((from.z() - z) / size, 2)));
    };
    const double tip = spot(0, 0.75, 0.3) * std::exp(-std::pow((p.y() - nose) / 12, 2));
    const double blood =
        std::min(1.0, spot(0.85, 0.75, 0.4) + tip) * (1 - smooth((p.y() - nose - 60) / 30));
    colors[v] = colors[v].cwiseProduct(Vector3f::Ones() +
                                       static_cast<float>(blood) * (flushed - Vector3f::Ones()));
    if (!near.contains(p)) continue;
    // The rim itself is red up to its corners.
    const double reach =
        std::max(0.02, red_of_lip(mouth.across(p), p.z() > mouth.height_at(p.x()))) * width;
    const double fraction = 1 - smooth((mouth.distance_to(p) - reach + 0.8) / 1.6);
    colors[v] = colors[v].cwiseProduct(Vector3f::Ones() +
                                       static_cast<float>(fraction) * (red - Vector3f::Ones()));
  }
}

}  // namespace condyle
