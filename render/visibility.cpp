#include "render/visibility.h"

#include <algorithm>
#include <array>

namespace condyle {
namespace {

/// Sides that are seen edge-on are left to the card, which rounds in its own way.
constexpr float nearly_edge_on = 0.05f;

class Frustum {
 public:
  explicit Frustum(const Eigen::Matrix4f& to_clip) {
    for (int k = 0; k < 3; ++k) {
      planes_[static_cast<std::size_t>(2 * k)] = to_clip.row(3) + to_clip.row(k);
      planes_[static_cast<std::size_t>(2 * k + 1)] = to_clip.row(3) - to_clip.row(k);
    }
  }
  bool misses(const Eigen::AlignedBox3f& box) const {
    for (const auto& plane : planes_) {
      const Eigen::Vector3f n = plane.head<3>();
      // The corner that lies farthest inside.
      const Eigen::Vector3f corner = (n.array() > 0).select(box.max(), box.min());
      if (n.dot(corner) + plane[3] < -1e-4f * n.norm()) return true;
    }
    return false;
  }

 private:
  std::array<Eigen::Vector4f, 6> planes_;
};

/// Whether all triangles of the piece turn `toward` (1) or away from (-1) the eye.
bool all_turned(const GpuMesh::Piece& piece, const Eigen::Vector4f& eye, float toward) {
  const float sine = piece.normals.sine + nearly_edge_on;
  if (sine >= 1) return false;
  if (eye.w() == 0) return toward * piece.normals.axis.dot(eye.head<3>()) > sine;
  const Eigen::Vector3f way = eye.head<3>() - piece.box.center();
  return toward * piece.normals.axis.dot(way) >
         sine * way.norm() + 0.5f * piece.box.diagonal().norm();
}

/// Places of the corners in pixels, with the depth in clip space and 1; the last is 0 before the
/// near plane.
void project(std::span<const Eigen::Vector3f> points, std::span<const int> corners,
             const Eigen::Matrix4f& to_clip, int width, int height,
             std::vector<Eigen::Vector4f>& projected) {
  const Eigen::Vector2f half(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  projected.resize(points.size());
  for (const int corner : corners) {
    const auto i = static_cast<std::size_t>(corner);
    const Eigen::Vector4f p = to_clip * points[i].homogeneous();
    const float inverse = 1 / p.w();
    const bool before = p.w() > 0 && p.z() > -p.w();
    projected[i] << (p.x() * inverse + 1) * half.x(), (p.y() * inverse + 1) * half.y(),
        p.z() * inverse, before ? 1.f : 0.f;
  }
}

/// Whether nothing of the triangle reaches the picture. Corners as by `project`.
bool unseen(const Eigen::Vector4f& a, const Eigen::Vector4f& b, const Eigen::Vector4f& c,
            Sides sides, const CoverGrid* cover) {
  constexpr float rounding = 1.f / 16;  // pixels; cards move corners by less
  if (a.w() + b.w() + c.w() < 3) return false;
  const Eigen::Vector4f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  if (sides != Sides::both) {
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    const float away = sides == Sides::front ? -area : area;
    if (away > rounding * (high - low).head<2>().sum()) return true;
  }
  return cover && cover->hides(low.head<2>(), high.head<2>(), low.z());
}

}  // namespace

const std::vector<Eigen::Vector3i>& Visibility::choose(const GpuMesh& mesh,
                                                       const GpuMesh::Surface& surface,
                                                       const Eigen::Matrix4f& model,
                                                       const Viewpoint& from, Sides sides,
                                                       const CoverGrid* cover) {
  const Eigen::Matrix4f to_clip = from.view_projection * model;
  const Frustum frustum(to_clip);
  const Eigen::Matrix3f turn = model.topLeftCorner<3, 3>().transpose();
  Eigen::Vector4f eye;
  eye << turn * (from.eye.head<3>() - from.eye.w() * model.topRightCorner<3, 1>()), from.eye.w();
  if (cover && cover->empty()) cover = nullptr;
  chosen_.clear();
  if (cover || sides != Sides::both)
    project(mesh.points(), surface.corners, to_clip, from.width, from.height, projected_);
  for (const auto& piece : surface.pieces) {
    if (frustum.misses(piece.box)) continue;
    if (sides != Sides::both && all_turned(piece, eye, sides == Sides::front ? -1.f : 1.f))
      continue;
    const auto first = surface.triangles.begin() + piece.first_triangle;
    for (auto t = first; t != first + piece.triangle_count; ++t)
      if ((!cover && sides == Sides::both) ||
          !unseen(projected_[(*t)[0]], projected_[(*t)[1]], projected_[(*t)[2]], sides, cover))
        chosen_.push_back(*t);
  }
  return chosen_;
}

}  // namespace condyle
