#include "render/life/living_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

constexpr float closest_eyes_mm = 30;  // distance of both eyeballs, at least
constexpr float below_jaw_mm = 6, shortest_neck_mm = 30;
const Vector3f shoulders_breathe(0, -0.4f, 1.2f), notch_breathes(0, -1.2f, 0.5f);  // mm
constexpr float nostril_breathes_mm = 0.35f, nostril_mm = 6;
const Vector3f ala_from_tip(16, 16, -5);  // mm, as in the built-in patient

float smooth(float t) { return static_cast<float>(smooth_step(t)); }

}  // namespace

LivingFace::LivingFace(std::span<const Part> parts, std::span<const Vector3f> rest,
                       std::span<const Eigen::Vector3i> triangles,
                       const std::optional<Eigen::Vector3d>& nose_tip) {
  eyes_.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].role != Role::eyes) continue;
    LivingEyes eyes(parts[i].mesh);
    if (!eyes.eyeballs().empty()) eyes_[i] = std::move(eyes);
  }
  find_lids(rest, triangles);
  for (auto& eyes : eyes_)
    if (eyes) eyes->root_lashes(lids_, rest, triangles);
  find_neck(parts, rest);
  if (nose_tip) find_nostrils(rest, nose_tip->cast<float>());
}

/// Sides count from the middle between the eyeballs; where all are on one side, from the face's.
void LivingFace::find_lids(std::span<const Vector3f> rest,
                           std::span<const Eigen::Vector3i> triangles) {
  Eigen::AlignedBox3f balls, face;
  for (const auto& eyes : eyes_)
    if (eyes)
      for (const Eyeball& ball : eyes->eyeballs()) balls.extend(ball.centre);
  if (balls.isEmpty()) return;
  for (const Vector3f& p : rest) face.extend(p);
  const float middle = (balls.sizes().x() > closest_eyes_mm ? balls : face).center().x();
  for (std::size_t i = 0; i < eyes_.size(); ++i) {
    if (!eyes_[i]) continue;
    for (std::size_t e = 0; e < eyes_[i]->eyeballs().size(); ++e) {
      const Eyeball& ball = eyes_[i]->eyeballs()[e];
      const FaceSide side = ball.centre.x() > middle ? FaceSide::left : FaceSide::right;
      EyeParts& found = side == FaceSide::left ? left_ : right_;
      found.eyeball = true;
      if (auto lid = UpperLid::find(rest, triangles, ball, side)) {
        found.lid = true;
        lower_lids_.emplace_back(*lid, rest);
        lids_.push_back(std::move(*lid));
        lid_eyes_.emplace_back(i, e);
      }
    }
  }
}

/// The skin below the jaw, down to its end, which stays with the trunk.
void LivingFace::find_neck(std::span<const Part> parts, std::span<const Vector3f> rest) {
  float jaw = std::numeric_limits<float>::infinity(), end = jaw;
  for (const Part& part : parts)
    if (collides(part.role))
      for (const auto& p : part.mesh.vertices) jaw = std::min(jaw, static_cast<float>(p.z()));
  for (const Vector3f& p : rest) end = std::min(end, p.z());
  const float top = jaw - below_jaw_mm;
  if (!std::isfinite(top) || top - end < shortest_neck_mm) return;
  float front = std::numeric_limits<float>::infinity(), back = -front;
  for (const Vector3f& p : rest)
    if (p.z() < top) front = std::min(front, p.y()), back = std::max(back, p.y());
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const float still = smooth((top - rest[v].z()) / (top - end));
    if (!(still > 0)) continue;
    const float before = smooth(1.6f * (back - rest[v].y()) / (back - front) - 0.6f);
    const float low = still * still;
    neck_.push_back({static_cast<int>(v), still,
                     low * ((1 - before) * shoulders_breathe + before * notch_breathes)});
  }
}

/// The wings of the nose, beside and behind its tip.
void LivingFace::find_nostrils(std::span<const Vector3f> rest, const Vector3f& tip) {
  for (std::size_t v = 0; v < rest.size(); ++v)
    for (const float side : {-1.f, 1.f}) {
      const Vector3f ala(side * ala_from_tip.x(), ala_from_tip.y(), ala_from_tip.z());
      const float near = std::exp(-(rest[v] - tip - ala).squaredNorm() / (nostril_mm * nostril_mm));
      if (near > 0.02f)
        nostrils_.push_back(
            {static_cast<int>(v), 0, Vector3f(side * nostril_breathes_mm * near, 0, 0)});
    }
}

std::vector<LidPose> LivingFace::move_lids(const LifeSigns& signs, bool raises,
                                           std::span<Vector3f> places) const {
  std::vector<LidPose> poses;
  for (std::size_t i = 0; i < lids_.size(); ++i) {
    const auto [part, eyeball] = lid_eyes_[i];
    const Vector3f gaze = eyes_[part]->gaze_of(eyeball, signs);
    LidPose pose{.lowered = lids_[i].lowered(signs)};
    if (raises) {
      pose.raised = lower_lids_[i].raised(places);
      lower_lids_[i].move(pose.raised, gaze, places);
    }
    lids_[i].move(pose.lowered, gaze, places);
    poses.push_back(pose);
  }
  return poses;
}

LivingFace::Moved LivingFace::move_face(const Life& life, const LifeSigns& signs, bool raises,
                                        std::span<Vector3f> places) const {
  Moved moved;
  const std::vector<LidPose> lids = move_lids(signs, raises, places);
  moved.lashes = lash_shifts(places);
  if (signs.alive) breathe(life, signs, places);
  for (std::size_t i = 0; i < lids_.size(); ++i) lids_[i].shade(lids[i].lowered, moved.shades);
  return moved;
}

void LivingFace::breathe(const Life& life, const LifeSigns& signs,
                         std::span<Vector3f> places) const {
  const auto breath = static_cast<float>(signs.breath);
  for (const Member& member : neck_) {
    Vector3f& p = places[static_cast<std::size_t>(member.vertex)];
    const Pose X = still_in_cranium(life, member.still * signs.extension);
    p = (X * (p + breath * member.breathes).cast<double>()).cast<float>();
  }
  for (const Member& member : nostrils_)
    places[static_cast<std::size_t>(member.vertex)] += breath * member.breathes;
}

std::vector<std::vector<Vector3f>> LivingFace::lash_shifts(std::span<const Vector3f> places) const {
  std::vector<std::vector<Vector3f>> shifts(eyes_.size());
  for (std::size_t i = 0; i < eyes_.size(); ++i)
    if (eyes_[i]) shifts[i] = eyes_[i]->root_shifts(places);
  return shifts;
}

void LivingFace::move_eyes(std::size_t part, const LifeSigns& signs,
                           std::span<const Vector3f> lashes, std::span<Vector3f> places,
                           std::span<Vector3f> normals) const {
  if (!has_eyes(part)) return;
  eyes_[part]->move(signs, places, normals);
  eyes_[part]->move_lashes(lashes, lids_, places, normals);
}

std::string LivingFace::lids_shortfall() const {
  if (!left_.eyeball && !right_.eyeball) return "no eyeballs were found";
  if (lids_.empty()) return "no open lids were found";
  const std::string side = open_side();
  if (side.empty()) return {};
  const bool has_eyeball = (side == "left" ? left_ : right_).eyeball;
  return has_eyeball ? "no open lids were found on the " + side
                     : "no " + side + " eyeball was found";
}

std::string LivingFace::open_side() const {
  if (left_.lid == right_.lid) return {};
  return left_.lid ? "right" : "left";
}

std::string LivingFace::shortfall() const {
  std::string lacks = lids_shortfall();
  const auto add = [&](const char* text) {
    lacks += (lacks.empty() ? "" : "; ") + std::string(text);
  };
  if (const std::string side = open_side(); !side.empty())
    lacks += ": the " + side + " eye does not blink";
  else if (!lacks.empty())
    lacks +=
        left_.eyeball || right_.eyeball ? ": the eyes do not blink" : ": eyes and lids do not move";
  if (neck_.empty()) add("no neck was found: the whole head turns, and the neck does not breathe");
  if (nostrils_.empty()) add("no landmark pronasale on the face: the nostrils do not breathe");
  return lacks;
}

}  // namespace condyle
