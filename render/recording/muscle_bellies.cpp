#include "render/recording/muscle_bellies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/math/smooth_step.h"
#include "engine/mesh/triangle_tree.h"
#include "render/recording/muscle_looks.h"
#include "render/recording/strap.h"
#include "sim/muscles/muscle_names.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int ring_count = 25, column_count = 5;
constexpr double least_end = 0.3;  // thickness at the attachments over that of the belly

double along_belly(int ring) { return static_cast<double>(ring) / (ring_count - 1); }

/// Thickness of a belly over that in its middle.
double fullness(double s) { return least_end + (1 - least_end) * std::sin(std::numbers::pi * s); }

double width_at(const BellyShape& shape, double s) {
  const double t = 2 * s - 1, end = t < 0 ? shape.origin_width : shape.insertion_width;
  return 1 + (end - 1) * t * t;
}

/// Distance to the nearest bone, negative inside.
double bone_distance(const std::vector<TriangleTree>& bones, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const TriangleTree& bone : bones) least = std::min(least, bone.signed_distance(p));
  return least;
}

constexpr double step_mm = 0.8;

/// How far a point has to move for that clearance from bone; where nothing in reach has it, to the
/// place with most.
double way_out(const std::vector<TriangleTree>& bones, const Vector3d& from,
               const Vector3d& direction, double clearance) {
  constexpr double reach = 20;
  double best = 0, most = -std::numeric_limits<double>::infinity();
  for (double out = 0; out <= reach; out += step_mm) {
    const double distance = bone_distance(bones, from + out * direction);
    if (distance >= clearance) return out;
    if (distance > most + 1e-9) most = distance, best = out;
  }
  return best;
}

/// The same of a fan, which also sinks onto bone nearby.
double way_onto(const std::vector<TriangleTree>& bones, const Vector3d& from,
                const Vector3d& direction, double clearance) {
  constexpr double reach = 14;
  if (bone_distance(bones, from) < clearance) return way_out(bones, from, direction, clearance);
  for (double in = step_mm; in <= reach; in += step_mm)
    if (bone_distance(bones, from - in * direction) < clearance) return step_mm - in;
  return 0;
}

/// A string that is pulled tight over obstacles of these heights; its ends stay.
void tighten(std::array<double, ring_count>& height) {
  const auto obstacles = height;
  constexpr int rounds = 300;
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 1; i + 1 < height.size(); ++i)
      height[i] = std::max(obstacles[i], 0.5 * (height[i - 1] + height[i + 1]));
  for (int round = 0; round < 2; ++round)
    for (std::size_t i = 1; i + 1 < height.size(); ++i)
      height[i] = 0.25 * height[i - 1] + 0.5 * height[i] + 0.25 * height[i + 1];
}

Vector3d thin_direction(BellyShape::Thin thin, double side) {
  switch (thin) {
    case BellyShape::Thin::lateral:
      return {side, 0, 0};
    case BellyShape::Thin::medial:
      return {-side, 0, 0};
    case BellyShape::Thin::vertical:
      return {0, 0, -1};
    case BellyShape::Thin::front:
      return {0, -1, 0};
  }
  return {side, 0, 0};
}

/// Axes and half sizes of a muscle at rest.
struct Frame {
  Vector3d from, along, thin, wide;
  double half_width, half_thick;

  /// In the middle of its thickness, at a fraction of its length, x from -1 to 1 of its width. The
  /// outlines of its ends are round.
  Vector3d place(const BellyShape& shape, double s, double x) const {
    constexpr double roundness = 0.1;
    const double round = roundness * x * x * (std::pow(1 - s, 6) - std::pow(s, 6));
    return from + (s + round) * along + x * half_width * width_at(shape, s) * wide;
  }
};

Frame frame_of(const Muscle& muscle, const BellyShape& shape, double midline) {
  Frame f;
  f.from = muscle.origin;
  f.along = muscle.insertion - muscle.origin;
  const Vector3d unit = f.along.normalized();
  const double side = muscle.origin.x() + muscle.insertion.x() < 2 * midline ? -1 : 1;
  const Vector3d asked = thin_direction(shape.thin, side);
  f.thin = asked - asked.dot(unit) * unit;
  f.thin = f.thin.norm() > 0.1 ? f.thin.normalized() : unit.unitOrthogonal();
  f.wide = unit.cross(f.thin);
  const double area = belly_area_mm2(muscle.max_force_N);
  f.half_thick = std::sqrt(area / (std::numbers::pi * shape.flatness));
  f.half_width = shape.flatness * f.half_thick;
  return f;
}

/// Displacements along the thin direction, by column from -1 to 1 of the width.
using Bends = std::array<std::array<double, ring_count>, column_count>;

Bends bends_of(const Frame& f, const BellyShape& shape, const std::vector<TriangleTree>& bones) {
  constexpr double covered = 0.8;  // of the half width, by the columns
  Bends bends = {};
  if (shape.lie == Lie::straight) return bends;
  const bool fan = shape.lie == Lie::fan;
  for (int column = 0; column < column_count; ++column) {
    auto& heights = bends[static_cast<std::size_t>(column)];
    const double x = covered * (2.0 * column / (column_count - 1) - 1);
    for (int ring = 0; ring < ring_count; ++ring) {
      const double s = along_belly(ring);
      const Vector3d at = f.place(shape, s, x);
      const double clearance = 0.75 * f.half_thick * fullness(s);
      // Beneath the arch a fan is straight.
      heights[static_cast<std::size_t>(ring)] =
          fan ? way_onto(bones, at, f.thin, clearance) * (1 - smooth_step((s - 0.5) / 0.2))
              : way_out(bones, at, f.thin, clearance);
    }
    tighten(heights);
  }
  return bends;
}

double bend_at(const Bends& bends, int ring, double x) {
  const double place = std::clamp(0.5 * (x + 1), 0.0, 1.0) * (column_count - 1);
  const int left = std::min(static_cast<int>(place), column_count - 2);
  const double t = place - left;
  const auto r = static_cast<std::size_t>(ring), c = static_cast<std::size_t>(left);
  return (1 - t) * bends[c][r] + t * bends[c + 1][r];
}

std::vector<TriangleTree> bones_near(const std::vector<Muscle>& muscles, const Case& patient) {
  constexpr double margin_mm = 40;
  Eigen::AlignedBox3d box;
  for (const Muscle& muscle : muscles) box.extend(muscle.origin), box.extend(muscle.insertion);
  box.min().array() -= margin_mm;
  box.max().array() += margin_mm;
  std::vector<TriangleTree> bones;
  for (const Part& part : patient.parts) {
    if (!collides(part.role) || is_teeth(part.role)) continue;
    TriMesh near;
    near.vertices = part.mesh.vertices;
    for (const Eigen::Vector3i& t : part.mesh.triangles)
      if (box.contains(part.mesh.vertices[static_cast<std::size_t>(t[0])]))
        near.triangles.push_back(t);
    if (!near.triangles.empty()) bones.emplace_back(near);
  }
  return bones;
}

double excitation_of(const Muscle& muscle, const Motion& motion, const FrameState& frame) {
  for (std::size_t k = 0; k < std::min(frame.muscles.size(), motion.muscle_names.size()); ++k)
    if (motion.muscle_names[k] == muscle.name) return frame.muscles[k].excitation;
  return 0;
}

/// 1 in the belly, 0 at the attachments.
float flesh(const Muscle& muscle, double s) {
  const double tendon = std::clamp(0.4 * muscle.tendon_ratio, 0.06, 0.2);
  const double t = std::clamp(std::min(s, 1 - s) / tendon, 0.0, 1.0);
  return static_cast<float>(t * t * (3 - 2 * t));
}

}  // namespace

MuscleBellies::MuscleBellies(std::vector<Muscle> muscles, const Case& patient,
                             const Progress& progress)
    : muscles_(std::move(muscles)) {
  if (muscles_.empty()) return;
  const auto bones = bones_near(muscles_, patient);
  double midline = 0;
  for (const Muscle& muscle : muscles_)
    midline +=
        0.5 * (muscle.origin.x() + muscle.insertion.x()) / static_cast<double>(muscles_.size());
  for (const Muscle& muscle : muscles_) {
    report(progress, "shaping the muscles",
           static_cast<double>(bellies_.size()) / static_cast<double>(muscles_.size()));
    const BellyShape shape = belly_shape(muscle.kind);
    const Frame f = frame_of(muscle, shape, midline);
    const Bends bends = bends_of(f, shape, bones);
    Belly belly;
    for (int ring = 0; ring < ring_count; ++ring) {
      const double s = along_belly(ring);
      for (int side = 0; side < strap_sides; ++side) {
        const Eigen::Vector2d at = strap_side(side);
        const double out = bend_at(bends, ring, at.x()) + at.y() * f.half_thick * fullness(s);
        belly.rest.push_back(f.place(shape, s, at.x()) + out * f.thin);
        belly.fibres.push_back(fibre_of(side, f.half_width));
      }
    }
    belly.rest.push_back(muscle.origin);
    belly.rest.push_back(muscle.insertion);
    belly.fibres.resize(belly.rest.size(), 0);
    FibreBody strap;
    add_strap_triangles(strap, 0, ring_count, false);
    belly.triangles = std::move(strap.triangles);
    bellies_.push_back(std::move(belly));
  }
}

FibreBody MuscleBellies::body(std::size_t index, const Motion& motion, const FrameState& frame,
                              double opacity) const {
  const Muscle& muscle = muscles_[index];
  const Belly& belly = bellies_[index];
  const auto pose_of_body = [&](MuscleBody body) {
    if (body == MuscleBody::mandible) return frame.poses[mandible_body];
    // A hand that moves the jaw elsewhere does not affect the hyoid, which follows the motion.
    if (body == MuscleBody::hyoid && motion.hyoid) return motion.hyoid(frame.time_s);
    return Pose{};
  };
  const Pose X_CO = pose_of_body(muscle.origin_body), X_CI = pose_of_body(muscle.insertion_body);
  const Vector3d rest_span = muscle.insertion - muscle.origin,
                 now_span = X_CI * muscle.insertion - X_CO * muscle.origin;
  const double rest_mm = rest_span.norm(),
               thicker = std::sqrt(rest_mm / std::max(now_span.norm(), 0.2 * rest_mm));
  // One away from bone turns as a whole; others keep to the bones that they cover.
  const bool turns = belly_shape(muscle.kind).lie == Lie::straight;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(rest_span, now_span);
  const Vector3f color = muscle_color(action_of(muscle), excitation_of(muscle, motion, frame));

  FibreBody made{
      .triangles = belly.triangles, .fibres = belly.fibres, .opacity = static_cast<float>(opacity)};
  made.positions.reserve(belly.rest.size());
  for (int ring = 0; ring < ring_count; ++ring) {
    const double s = along_belly(ring);
    const auto carried = [&](const Vector3d& p) -> Vector3d {
      return (1 - s) * (X_CO * p) + s * (X_CI * p);
    };
    const std::span<const Vector3d> rest =
        std::span(belly.rest).subspan(static_cast<std::size_t>(ring) * strap_sides, strap_sides);
    Vector3d center = Vector3d::Zero();
    for (const Vector3d& p : rest) center += p / strap_sides;
    const Vector3d center_now = carried(center);
    const float red = flesh(muscle, s);
    for (const Vector3d& p : rest) {
      const Vector3d offset = turns ? Vector3d(turn * (p - center)) : carried(p) - center_now;
      made.positions.push_back((center_now + thicker * offset).cast<float>());
      made.colors.push_back(tendon_color + red * (color - tendon_color));
    }
  }
  made.positions.push_back((X_CO * muscle.origin).cast<float>());
  made.positions.push_back((X_CI * muscle.insertion).cast<float>());
  made.colors.resize(made.positions.size(), tendon_color);
  return made;
}

PlaceLabel MuscleBellies::label(std::size_t muscle, const FibreBody& body) const {
  Vector3f sum = Vector3f::Zero();
  const auto first = static_cast<std::size_t>(ring_count / 2 * strap_sides);
  for (std::size_t k = first; k < first + strap_sides; ++k) sum += body.positions[k] / strap_sides;
  return {short_name(muscles_[muscle]), sum};
}

void add_muscles(const MuscleBellies& bellies, const Motion& motion, const FrameState& frame,
                 std::span<const double> opacity, bool labels, Overlays& shown) {
  std::vector<Muscle> drawn;
  for (std::size_t m = 0; m < bellies.muscles().size(); ++m) {
    const double seen = opacity.empty() ? 1 : m < opacity.size() ? opacity[m] : 0;
    if (!(seen > 0)) continue;
    const Muscle& muscle = bellies.muscles()[m];
    FibreBody body = bellies.body(m, motion, frame, seen);
    if (labels) shown.labels.push_back(bellies.label(m, body));
    shown.bodies["muscle " + muscle.name] = std::move(body);
    drawn.push_back(muscle);
  }
  for (KeyEntry& entry : muscle_key(drawn)) shown.key.push_back(std::move(entry));
}

}  // namespace condyle
