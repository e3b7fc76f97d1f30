#include "render/scene/visibility.h"

#include <algorithm>
#include <array>
#include <limits>

namespace condyle {
namespace {

/// Edge-on triangles are left to the GPU, which rounds differently.
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

/// Whether all triangles of the piece face towards (1) or away from (-1) the eye.
bool all_turned(const GpuMesh::Piece& piece, const Eigen::Vector4f& eye, float toward) {
  const float sine = piece.normals.sine + nearly_edge_on;
  if (sine >= 1) return false;
  if (eye.w() == 0) return toward * piece.normals.axis.dot(eye.head<3>()) > sine;
  const Eigen::Vector3f offset = eye.head<3>() - piece.box.center();
  return toward * piece.normals.axis.dot(offset) >
         sine * offset.norm() + 0.5f * piece.box.diagonal().norm();
}

/// From a part to pixels, the depth in clip space and 1; the last is 0 in front of the near plane.
struct Projection {
  Eigen::Matrix4f to_clip;
  Eigen::Vector2f half;  // of the picture, pixels

  Eigen::Vector4f operator()(const Eigen::Vector3f& point) const {
    const Eigen::Vector4f p = to_clip.leftCols<3>() * point + to_clip.col(3);
    const float inverse = 1 / p.w();
    const bool before = p.w() > 0 && p.z() > -p.w();
    return {(p.x() * inverse + 1) * half.x(), (p.y() * inverse + 1) * half.y(), p.z() * inverse,
            before ? 1.f : 0.f};
  }
};

/// Whether the whole box is occluded.
bool hidden(const Eigen::AlignedBox3f& box, const Projection& project, const CoverGrid& cover) {
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector4f p =
        project(box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)));
    if (p.w() < 1) return false;
    low = low.min(p.head<3>().array());
    high = high.max(p.head<3>().array());
  }
  return cover.hides(low.head<2>(), high.head<2>(), low.z());
}

/// Whether the triangle is completely outside the picture. Corners as projected.
bool unseen(const Eigen::Vector4f& a, const Eigen::Vector4f& b, const Eigen::Vector4f& c,
            Sides sides, const CoverGrid& cover) {
  constexpr float rounding = 1.f / 16;  // pixels; GPUs move corners by less
  if (a.w() + b.w() + c.w() < 3) return false;
  const Eigen::Vector4f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  if (sides != Sides::both) {
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    const float away = sides == Sides::front ? -area : area;
    if (away > rounding * (high - low).head<2>().sum()) return true;
  }
  return cover.hides(low.head<2>(), high.head<2>(), low.z());
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
  const Projection project = {
      to_clip, {0.5f * static_cast<float>(from.width), 0.5f * static_cast<float>(from.height)}};
  projected_.resize(std::max(projected_.size(), mesh.points().size()));
  turn_of_.resize(projected_.size(), turn_);
  ++turn_;
  const auto place = [&](int corner) -> const Eigen::Vector4f& {
    const auto i = static_cast<std::size_t>(corner);
    if (turn_of_[i] != turn_) projected_[i] = project(mesh.points()[i]);
    turn_of_[i] = turn_;
    return projected_[i];
  };
  for (const auto& piece : surface.pieces) {
    if (frustum.misses(piece.box)) continue;
    if (sides != Sides::both && all_turned(piece, eye, sides == Sides::front ? -1.f : 1.f))
      continue;
    if (cover && hidden(piece.box, project, *cover)) continue;
    const auto first = surface.triangles.begin() + piece.first_triangle;
    if (!cover) {  // the GPU culls the other side
      chosen_.insert(chosen_.end(), first, first + piece.triangle_count);
      continue;
    }
    for (auto t = first; t != first + piece.triangle_count; ++t)
      if (!unseen(place((*t)[0]), place((*t)[1]), place((*t)[2]), sides, *cover))
        chosen_.push_back(*t);
  }
  return chosen_;
}

}  // namespace condyle
