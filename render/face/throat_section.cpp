#include "render/face/throat_section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/face/tongue_bend.h"

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
using Tissue = SectionOutline::Tissue;

constexpr float middle_mm = 8;  // half the width of the airway, about
// Levels at which the airway gives way, from the lowest upward.
constexpr float level_mm = 2, below_tongue_mm = 130;
constexpr int levels = 100;
constexpr float wall_mm = 1;         // between the airway and what moves before it
constexpr float least_depth = 0.7f;  // of the airway, of that at rest
constexpr float steepest_up = 0.8f, steepest_down = 0.4f;  // change of the wall's shift by height
constexpr float below_palate = 2;                          // the same, just below the soft palate
constexpr int smoothed = 4;                                // levels to either side
constexpr float palate_tip = -54;                          // the airway moves below it
constexpr int fineness = 4;                                // pieces of the curve between two points

/// For this tongue, mm. The airway comes first; its back wall begins and ends at the points of
/// `back_wall`.
const Eigen::AlignedBox3f usual_tongue(Vector3f(-24, -87.4f, -72.5f), Vector3f(24, -30, -37.7f));
constexpr std::size_t back_wall[] = {1, 13}, epiglottis = 2;
const std::vector<SectionOutline>& outlines() {
  static const std::vector<SectionOutline> all = {
      {Tissue::air, 9, false, {{-45, -28},  {-45, -17},  {-40, -13},  {-31, -14},  {-24, -22},
                               {-19, -32},  {-15, -45},  {-13, -60},  {-13, -80},  {-16, -99},
                               {-19, -112}, {-23, -130}, {-24, -150}, {-25, -182}, {-40, -182},
                               {-39, -150}, {-38, -128}, {-35, -112}, {-36, -99},  {-31, -90},
                               {-28, -76},  {-27, -62},  {-30, -50},  {-36, -40},  {-44, -34}}},
      {Tissue::mucosa,
       15,
       false,
       {{-45, -27},
        {-45, -31.5f},
        {-39, -36},
        {-33, -43},
        {-28, -52},
        {-25, -54},
        {-23.5f, -51},
        {-26, -43},
        {-30, -35},
        {-37, -28}}},
      {Tissue::mucosa,
       8,
       false,
       {{-36, -100}, {-32, -89}, {-27, -80}, {-25, -80}, {-26, -89}, {-31, -101}}},
      {Tissue::muscle,
       13,
       true,
       {{-81, -64},
        {-79, -78},
        {-70, -88},
        {-58, -94},
        {-46, -97},
        {-38, -97},
        {-33, -91},
        {-29, -78},
        {-28.5f, -62},
        {-34, -54},
        {-50, -56},
        {-70, -56}}},
      {Tissue::bone,
       4,
       true,
       {{-46, -98}, {-44, -95}, {-40, -95}, {-38, -98}, {-40, -101}, {-44, -101}}},
  };
  return all;
}

/// A closed Catmull-Rom curve through the points.
std::vector<Vector2f> curve(const std::vector<Vector2f>& through) {
  std::vector<Vector2f> fine;
  const std::size_t n = through.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2f &a = through[(i + n - 1) % n], &b = through[i], &c = through[(i + 1) % n],
                   &d = through[(i + 2) % n];
    for (int k = 0; k < fineness; ++k) {
      const float t = static_cast<float>(k) / fineness;
      fine.push_back(b + 0.5f * t *
                             (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))));
    }
  }
  return fine;
}

bool is_back(std::size_t of_curve) {
  return of_curve >= back_wall[0] * fineness && of_curve <= back_wall[1] * fineness;
}

using Levels = ThroatSection::Levels;

/// At each level the largest of those up to `by` levels away.
Levels widened(const Levels& values, int by) {
  Levels out(values.size());
  for (int i = 0; i < levels; ++i) {
    const auto first = values.begin() + std::max(0, i - by),
               last = values.begin() + std::min(levels, i + by + 1);
    out[static_cast<std::size_t>(i)] = *std::max_element(first, last);
  }
  return out;
}

/// Not below the given shift, smooth and nowhere steeper than a wall can bend.
Levels eased(const Levels& shift) {
  Levels wide = widened(shift, smoothed + 1);
  for (std::size_t i = 1; i < wide.size(); ++i)
    wide[i] = std::max(wide[i], wide[i - 1] - steepest_up * level_mm);
  for (std::size_t i = wide.size() - 1; i > 0; --i)
    wide[i - 1] = std::max(wide[i - 1], wide[i] - steepest_down * level_mm);
  Levels smooth(wide.size());
  for (int i = 0; i < levels; ++i) {
    float sum = 0;
    for (int k = -smoothed; k <= smoothed; ++k)
      sum += wide[static_cast<std::size_t>(std::clamp(i + k, 0, levels - 1))];
    smooth[static_cast<std::size_t>(i)] = sum / (2 * smoothed + 1);
  }
  return smooth;
}

/// Flesh behind the airway: the cavity of the open mouth ends before it.
SectionOutline flesh_behind(const SectionOutline& air) {
  constexpr float thick_mm = 25;
  constexpr std::size_t from = 6 * fineness, to = 11 * fineness;  // behind tongue and epiglottis
  SectionOutline flesh = air;
  flesh.tissue = Tissue::flesh;
  const auto first = air.points.begin() + from, last = air.points.begin() + to;
  flesh.points.assign(first, last);
  for (auto p = last; p != first;) flesh.points.push_back(*--p + Vector2f(thick_mm, 0));
  return flesh;
}

}  // namespace

ThroatSection::ThroatSection(std::span<const Part> parts) {
  const auto tongue = std::find_if(parts.begin(), parts.end(), [](const Part& part) {
    return part.role == Role::tongue && !part.mesh.empty();
  });
  if (tongue == parts.end()) return;
  for (const auto& v : tongue->mesh.vertices) tongue_.extend(v.cast<float>());
  if (tongue_.sizes().minCoeff() <= 0) {
    tongue_.setEmpty();
    return;
  }
  const Vector3f scale = tongue_.sizes().cwiseQuotient(usual_tongue.sizes());
  const auto place = [&](const Vector2f& p) -> Vector2f {
    return tongue_.center().tail<2>() +
           scale.tail<2>().cwiseProduct(p - usual_tongue.center().tail<2>());
  };
  for (SectionOutline outline : outlines()) {
    for (Vector2f& p : outline.points) p = place(p);
    outline.points = curve(outline.points);
    outline.half_width *= scale.x();
    outline.middle = tongue_.center().x();
    rest_.push_back(std::move(outline));
  }
  palate_tip_z_ = place({0, palate_tip}).y();
  const auto keep_middle = [&](const Part& part, std::vector<Vector3f>& kept) {
    for (const auto& v : part.mesh.vertices)
      if (std::abs(static_cast<float>(v.x()) - tongue_.center().x()) < middle_mm)
        kept.push_back(v.cast<float>());
  };
  keep_middle(*tongue, tongue_middle_);
  for (const Part& part : parts)
    if (part.body == tongue->body && collides(part.role)) keep_middle(part, jaw_middle_);
  find_walls();
  overlap_at_rest_ = overlap({}, rest_);
}

float ThroatSection::height(std::size_t level) const {
  return tongue_.min().z() - below_tongue_mm + level_mm * (static_cast<float>(level) + 0.5f);
}

std::size_t ThroatSection::level_at(float z) const {
  const float level = (z - height(0)) / level_mm;
  return static_cast<std::size_t>(
      std::lround(std::clamp(level, 0.f, static_cast<float>(levels - 1))));
}

/// Measures both walls of the airway at rest.
void ThroatSection::find_walls() {
  constexpr float far = std::numeric_limits<float>::infinity();
  front_.assign(levels, far);
  back_.assign(levels, -far);
  const auto& air = rest_.front().points;
  for (std::size_t i = 0; i < air.size(); ++i) {
    const std::size_t next = (i + 1) % air.size();
    const Vector2f &a = air[i], &b = air[next];
    const std::size_t from = level_at(std::min(a.y(), b.y())),
                      to = level_at(std::max(a.y(), b.y()));
    for (std::size_t l = from; l <= to; ++l) {
      const float t = std::clamp((height(l) - a.y()) / (b.y() - a.y()), 0.f, 1.f);
      const float y = a.x() + (std::isfinite(t) ? t : 0) * (b.x() - a.x());
      front_[l] = std::min(front_[l], y);
      back_[l] = std::max(back_[l], y);
    }
  }
}

/// By how much what moves lies behind the front wall at rest, by level; mm, not below 0.
ThroatSection::Levels ThroatSection::overlap(const Pose& X_CM,
                                             std::span<const SectionOutline> bent) const {
  Levels most(levels, 0);
  const auto note = [&](float y, float z) {
    const std::size_t l = level_at(z);
    if (std::isfinite(front_[l])) most[l] = std::max(most[l], y + wall_mm - front_[l]);
  };
  const TongueBend bend(tongue_, X_CM);
  for (const Vector3f& v : tongue_middle_) {
    const Vector3f p = bend(v);
    note(p.y(), p.z());
  }
  for (const Vector3f& v : jaw_middle_) {
    const Eigen::Vector3d p = X_CM * v.cast<double>();
    note(static_cast<float>(p.y()), static_cast<float>(p.z()));
  }
  for (const SectionOutline& outline : bent)
    if (outline.with_tongue)
      for (const Vector2f& p : outline.points) note(p.x(), p.y());
  return most;
}

std::vector<SectionOutline> ThroatSection::at(const Pose& X_CM) const {
  std::vector<SectionOutline> now = rest_;
  if (now.empty()) return now;
  const TongueBend bend(tongue_, X_CM);
  for (SectionOutline& outline : now)
    if (outline.with_tongue)
      for (Vector2f& p : outline.points) {
        const Vector3f rest(tongue_.center().x(), p.x(), p.y());
        p = (outline.tissue == Tissue::bone ? bend.hyoid() * rest : bend(rest)).tail<2>();
      }
  Levels shift = overlap(X_CM, now);
  for (std::size_t l = 0; l < shift.size(); ++l)
    shift[l] = std::max(0.f, shift[l] - overlap_at_rest_[l]);
  shift = eased(shift);
  for (std::size_t l = 0; l < shift.size(); ++l)
    shift[l] = std::min(shift[l], below_palate * std::max(0.f, palate_tip_z_ - height(l)));

  const auto shift_at = [&](float z) {
    const float at = std::clamp((z - height(0)) / level_mm, 0.f, levels - 1.001f);
    const auto l = static_cast<std::size_t>(at);
    return shift[l] + (at - static_cast<float>(l)) * (shift[l + 1] - shift[l]);
  };
  auto& air = now.front().points;
  for (std::size_t i = 0; i < air.size(); ++i) {
    const std::size_t l = level_at(air[i].y());
    const float spare = is_back(i) ? (1 - least_depth) * (back_[l] - front_[l]) : 0;
    air[i].x() += std::max(0.f, shift_at(air[i].y()) - spare);
  }
  for (Vector2f& p : now[epiglottis].points) p.x() += shift_at(p.y());
  now.insert(now.begin(), flesh_behind(now.front()));
  return now;
}

}  // namespace condyle
