#include <cmath>

#include "engine/field/decimate.h"
#include "engine/field/isosurface.h"
#include "engine/field/smooth.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// The closed lips touch along a slit too fine for any grid. Therefore the face is sampled with the
// lips separated by a known map, and its vertices are mapped back.
constexpr double rest_half_gap = 0.05;  // mm, half the gap between the closed lips

/// Half the height of the slit for sampling; negative beyond the corner of the mouth.
double half_gap(double x) {
  const double s = std::abs(x) / mouth_corner_x;
  if (s >= 1) return mouth_corner_x - std::abs(x);
  return 1.35 * std::sqrt(1 - std::pow(s, 6));
}

/// From the space with parted lips to the patient at rest.
Vector3d closed_lips(const Vector3d& p) {
  const double gap = std::max(half_gap(p.x()), 0.0), line = lip_line(p.x(), p.y());
  const double above = p.z() - line, far = std::abs(above) - gap;
  const double rest = std::min(rest_half_gap, gap);
  double z = p.z();
  if (gap <= 0) return p;
  if (far <= 0) {
    z = line + above * rest / gap;
  } else {
    z -= std::copysign((gap - rest) * (1 - smooth_step(far / 13)), above);
  }
  return {p.x(), p.y(), z};
}

/// The slit between the parted lips.
Primitive slit() {
  return {[](const Vector3d& p) {
            return std::max(std::abs(p.z() - lip_line(p.x(), p.y())) - half_gap(p.x()), p.y() + 76);
          },
          {Vector3d(0, -125, -60), Vector3d(mouth_corner_x, -76, -42)}};
}

FieldRecipe parted_face() {
  const FieldRecipe skin = skin_recipe(Lips::none);
  FieldRecipe face(Symmetry::mirror_x);
  face.add({[skin](const Vector3d& p) { return skin(closed_lips(p)); },
            {Vector3d(0, -130, -195), Vector3d(130, 120, 135)}},
           0);
  const Primitive space = oral_space();
  face.cut({[space](const Vector3d& p) { return space.distance(closed_lips(p)); }, space.box}, 1.5);
  face.cut(slit(), 2);
  face.cut(ellipsoid(eye_center, Vector3d::Constant(eye_radius + .1)), 0);
  return face;
}

/// Positive where the surface is not skin: deep behind the lips, and the eye sockets.
double hidden(const Vector3d& p, const Primitive& space, const Primitive& lids) {
  // The lining tapers towards the corners, where it would hang like a curtain in the open mouth.
  const double lining = 6.5 * smooth_step((mouth_corner_x - std::abs(p.x())) / 16);
  const double mouth =
      std::min(0.6 - space.distance(p),
               std::max(std::abs(p.z() - lip_line(p.x(), p.y())) - lining, p.y() + 79));
  const double socket = std::min(eye_radius + .6 - (p - eye_center).norm(), lids.distance(p) - 1.5);
  return std::max(mouth, socket);
}

/// Finest at lips, eyes and nose, where appearance and tissue need it, then in the rest of the
/// face.
double importance(const Vector3d& p) {
  const auto bump = [&](double x, double y, double z, double r) {
    return std::exp(-(p - Vector3d(x, y, z)).squaredNorm() / (r * r));
  };
  const double front = smooth_step((-45 - p.y()) / 30) * smooth_step((p.z() + 115) / 15) *
                       smooth_step((65 - p.z()) / 20);
  return 1 + 60 * front + 250 * (bump(12, -98, -50, 15) + bump(32, -82, 15, 17)) +
         120 * (bump(0, -112, -18, 17) + bump(28, -86, 35, 16)) + 60 * bump(78, 10, 0, 30);
}

}  // namespace

Vector3d uneven_face(const Vector3d& p) {
  const auto near = [&](const Vector3d& c, const Vector3d& r) {
    return std::exp(-((p - c).cwiseQuotient(r)).squaredNorm());
  };
  return p + Vector3d(
                 1.1 * near({0, -110, -14}, {16, 22, 18}) - 1.2 * near({0, -95, -88}, {26, 24, 15}),
                 0, 1.1 * near({32, -84, 38}, {22, 16, 11}) - 0.9 * near({78, 8, 0}, {14, 26, 34}));
}

TriMesh face_surface() {
  const std::array<GridAxis, 3> grid = {graded_axis(0, 115, .85, 0, 46, .55),
                                        graded_axis(-126, 116, 1.1, -122, -74, .55),
                                        graded_axis(-191.5, 126, 1.2, -62, 26, .55)};
  TriMesh half = isosurface(sample_field(parted_face(), grid));
  for (auto& p : half.vertices) p = closed_lips(p);
  const Primitive space = oral_space(), lids = lid_opening();
  std::vector<double> values;
  for (const auto& p : half.vertices) values.push_back(hidden(p, space, lids));
  half = largest_piece(clipped(half, values));
  half = decimated(half, {.target_triangles = 50000, .importance = importance, .evenness = 0.01});
  TriMesh face = with_mirror_image(half);
  for (const auto& p : face.vertices) {
    const Vector3d left(std::abs(p.x()), p.y(), p.z());
    // The lining of the mouth is moist and red, including the corners, which show when the lips
    // part.
    const bool lining = std::abs(space.distance(left)) < 0.8 && p.y() < -76 &&
                        std::abs(p.z() - lip_line(left.x(), p.y())) < 12;
    face.colors.push_back(lining ? Eigen::Vector3f(.48f, .20f, .20f) : skin_color(p));
  }
  for (auto& p : face.vertices) p = uneven_face(p);
  return face;
}

}  // namespace condyle
