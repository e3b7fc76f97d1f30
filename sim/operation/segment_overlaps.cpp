#include "sim/operation/segment_overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "engine/collide/overlap_measure.h"
#include "engine/collide/solid.h"
#include "engine/core/infinity.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double least_overlap_mm = 0.1;

/// The uncut bone that a part was made from; teeth count with the bone that carries them, so that a
/// root in a neighbouring piece is trimmed.
std::string source_of(const Operated& operated, const Part& part) {
  if (is_teeth(part.role))
    for (const Part& bone : operated.patient.parts)
      if (bone.body == part.body && collides(bone.role) && !is_teeth(bone.role))
        return source_of(operated, bone);
  const auto found = operated.origin.find(part.name);
  return found == operated.origin.end() ? part.name : found->second.part;
}

SegmentOverlap::Kind kind_of(const Operated& operated, const Part& a, const Part& b) {
  if (is_teeth(a.role) && is_teeth(b.role)) return SegmentOverlap::Kind::occlusal;
  if (source_of(operated, a) == source_of(operated, b)) return SegmentOverlap::Kind::trimmed;
  return SegmentOverlap::Kind::collision;
}

Box placed_box(const TriMesh& mesh, const Pose& X) {
  Box box;
  for (const Vector3d& p : mesh.vertices) box.add(X * p);
  return box;
}

bool boxes_meet(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

/// The parts of an operated patient with their solids, made when they are needed.
class OverlapSearch {
 public:
  explicit OverlapSearch(const Operated& operated) : operated_(operated) {}

  OverlapDepth depth(const Part& a, const Pose& X_CA, const Part& b, const Pose& X_CB) {
    if (!boxes_meet(placed_box(a.mesh, X_CA), placed_box(b.mesh, X_CB))) return {};
    return overlap_depth(solid(a), X_CA, solid(b), X_CB, {.tolerance_mm = 0.01});
  }
  /// At the uncut rest, where pieces of one bone share their cut faces alone.
  double rest_depth(const Part& a, const Part& b) {
    const auto key = std::pair(&a, &b);
    const auto found = rest_.find(key);
    if (found != rest_.end()) return found->second;
    const double rest = kind_of(operated_, a, b) == SegmentOverlap::Kind::trimmed
                            ? 0.0
                            : depth(a, {}, b, {}).depth_mm;
    return rest_[key] = rest;
  }

 private:
  const Solid& solid(const Part& part) {
    auto& made = solids_[&part];
    if (!made) made = std::make_unique<const Solid>(part.mesh);
    return *made;
  }

  const Operated& operated_;
  std::map<const Part*, std::unique_ptr<const Solid>> solids_;
  std::map<std::pair<const Part*, const Part*>, double> rest_;
};

bool of_segment(const BodyTree& bodies, BodyId segment, BodyId body) {
  const auto all = bodies.subtree(segment);
  return std::find(all.begin(), all.end(), body) != all.end();
}

}  // namespace

std::vector<SegmentOverlap> segment_overlaps(const Operated& operated, const std::string& segment) {
  const BodyTree& bodies = operated.patient.bodies;
  const BodyId only = bodies.find(segment).value_or(cranium_body);
  OverlapSearch search(operated);
  std::vector<SegmentOverlap> overlaps;
  const auto& parts = operated.patient.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = i + 1; k < parts.size(); ++k) {
      const Part &a = parts[i], &b = parts[k];
      if (!collides(a.role) || !collides(b.role) || a.mesh.empty() || b.mesh.empty()) continue;
      if (!segment.empty() && of_segment(bodies, only, a.body) == of_segment(bodies, only, b.body))
        continue;
      const Pose &X_CA = operated.poses[a.body], &X_CB = operated.poses[b.body];
      if (bit_identical(X_CA, X_CB)) continue;  // not moved relative to each other
      const OverlapDepth found = search.depth(a, X_CA, b, X_CB);
      if (found.depth_mm < least_overlap_mm ||
          found.depth_mm < search.rest_depth(a, b) + least_overlap_mm)
        continue;
      overlaps.push_back({a.name, b.name, bodies[a.body].name, bodies[b.body].name,
                          kind_of(operated, a, b), found.depth_mm, found.point,
                          overlap_volume(a.mesh, X_CA, b.mesh, X_CB, 128).mm3});
    }
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const auto& a, const auto& b) { return a.depth_mm > b.depth_mm; });
  return overlaps;
}

std::vector<SegmentOverlap> body_overlaps(const Operated& operated, const std::string& body) {
  const BodyTree& bodies = operated.patient.bodies;
  const auto known = bodies.find(body);
  if (!known) return {};
  // Those with a segment's own children are not among the segment's.
  auto overlaps = segment_overlaps(operated, bodies.subtree(*known).size() == 1 ? body : "");
  std::erase_if(overlaps, [&](const SegmentOverlap& overlap) {
    return overlap.body_a != body && overlap.body_b != body;
  });
  return overlaps;
}

bool cut_bones_overlap(const Operated& operated, const std::string& a, const std::string& b) {
  const BodyTree& bodies = operated.patient.bodies;
  const auto body_a = bodies.find(a), body_b = bodies.find(b);
  if (!body_a || !body_b) return false;
  const Pose &X_CA = operated.poses[*body_a], &X_CB = operated.poses[*body_b];
  if (bit_identical(X_CA, X_CB)) return false;
  OverlapSearch search(operated);
  const auto is_cut = [&](const Part& part) { return operated.origin.contains(part.name); };
  for (const Part& of_a : operated.patient.parts)
    for (const Part& of_b : operated.patient.parts)
      if (of_a.body == *body_a && of_b.body == *body_b && is_cut(of_a) && is_cut(of_b) &&
          kind_of(operated, of_a, of_b) == SegmentOverlap::Kind::trimmed &&
          search.depth(of_a, X_CA, of_b, X_CB).depth_mm >= least_overlap_mm)
        return true;
  return false;
}

double free_fraction(const Operated& operated, const std::string& segment,
                     const std::function<Pose(double)>& pose) {
  const BodyTree& bodies = operated.patient.bodies;
  const auto body = bodies.find(segment);
  if (!body) return 1;
  OverlapSearch search(operated);
  std::vector<std::pair<const Part*, const Part*>> pairs;  // of the segment, of the others
  Box box;
  for (const Part& a : operated.patient.parts) {
    if (!collides(a.role) || a.mesh.empty() || !of_segment(bodies, *body, a.body)) continue;
    box.add(bounding_box(a.mesh));
    for (const Part& b : operated.patient.parts)
      if (collides(b.role) && !b.mesh.empty() && !of_segment(bodies, *body, b.body) &&
          kind_of(operated, a, b) == SegmentOverlap::Kind::collision)
        pairs.emplace_back(&a, &b);
  }
  const auto is_free = [&](double fraction) {
    const Pose X = pose(fraction);
    return std::none_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      const auto& [a, b] = pair;
      const double depth = search.depth(*a, X, *b, operated.poses[b->body]).depth_mm;
      return depth >= least_overlap_mm && depth >= search.rest_depth(*a, *b) + least_overlap_mm;
    });
  };
  constexpr double step_mm = 0.25, fine_mm = 0.01;
  double travel = 0;
  const Pose whole = pose(1);
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner(k & 1 ? box.low.x() : box.high.x(), k & 2 ? box.low.y() : box.high.y(),
                          k & 4 ? box.low.z() : box.high.z());
    travel = std::max(travel, (whole * corner - corner).norm());
  }
  const int steps = std::clamp(static_cast<int>(std::ceil(travel / step_mm)), 1, 400);
  for (int i = 1; i <= steps; ++i) {
    if (is_free(static_cast<double>(i) / steps)) continue;
    double low = static_cast<double>(i - 1) / steps, high = static_cast<double>(i) / steps;
    while ((high - low) * travel > fine_mm) {
      const double middle = 0.5 * (low + high);
      (is_free(middle) ? low : high) = middle;
    }
    return low;
  }
  return 1;
}

std::string place_words(const Vector3d& place, const Landmarks& landmarks) {
  std::string words = fmt::format("({:.1f}, {:.1f}, {:.1f})", place.x(), place.y(), place.z());
  double least = infinity;
  std::string nearest;
  for (const auto& [name, point] : landmarks.points)
    if (const double distance = (point - place).norm(); distance < least) {
      least = distance;
      nearest = name;
    }
  if (!nearest.empty()) words += fmt::format(", {:.0f} mm from {}", least, nearest);
  return words;
}

std::string overlap_text(const SegmentOverlap& overlap, const Landmarks& landmarks) {
  const char* meaning = overlap.kind == SegmentOverlap::Kind::trimmed ? "bone to be trimmed"
                        : overlap.kind == SegmentOverlap::Kind::occlusal
                            ? "teeth of both arches interfere"
                            : "a collision";
  return fmt::format("{} and {} overlap by {:.1f} mm, {:.0f} mm³, at {}: {}", overlap.a, overlap.b,
                     overlap.depth_mm, overlap.volume_mm3, place_words(overlap.at, landmarks),
                     meaning);
}

}  // namespace condyle
