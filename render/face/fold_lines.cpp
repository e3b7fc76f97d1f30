#include "render/face/fold_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace condyle {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float adult_mouth_mm = 50;  // width for which lengths are given
constexpr float spacing_mm = 2.5;     // of samples

/// The face from the chin to the forehead in front view: x to the left, z up.
class FrontView {
 public:
  FrontView(std::span<const Vector3f> rest, std::span<const Vector3f> normals,
            std::span<const int> rim)
      : rest_(rest), normals_(normals) {
    Eigen::AlignedBox3f mouth;
    right_ = left_ = rest[static_cast<std::size_t>(rim.front())];
    for (const int v : rim) {
      const Vector3f& p = rest[static_cast<std::size_t>(v)];
      mouth.extend(p);
      if (p.x() < right_.x()) right_ = p;
      if (p.x() > left_.x()) left_ = p;
    }
    middle_ = mouth.center();
    width_ = left_.x() - right_.x();
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const Vector3f off = rest[v] - middle_;
      if (std::abs(off.x()) < 1.2f * width_ && off.z() > -1.5f * width_ &&
          off.z() < 2.8f * width_ && off.y() < 1.2f * width_)
        near_.push_back(v);
    }
    cell_ = 0.12f * width_;
    for (const std::size_t v : near_) cells_[cell_of(rest[v].x(), rest[v].z())].push_back(v);
  }

  float width() const { return width_; }
  const Vector3f& corner(int side) const { return side > 0 ? left_ : right_; }
  const Vector3f& middle() const { return middle_; }

  /// The tip of the nose; none if nothing protrudes above the mouth.
  std::optional<Vector3f> nose_tip() const {
    std::optional<Vector3f> tip;
    for (const std::size_t v : near_) {
      const Vector3f off = rest_[v] - middle_;
      if (std::abs(off.x()) < 0.2f * width_ && off.z() > 0.2f * width_ && off.z() < width_ &&
          (!tip || rest_[v].y() < tip->y()))
        tip = rest_[v];
    }
    if (!tip || tip->y() > middle_.y()) return std::nullopt;
    return tip;
  }

  /// Where the ala meets the cheek: farthest behind the line from the tip of the nose to the cheek,
  /// at the height of the alae.
  std::optional<Vector3f> alar_crease(int side, const Vector3f& tip) const {
    const auto s = static_cast<float>(side);
    const float height = tip.z() - 0.06f * width_, band = 0.05f * width_;
    const auto cheek = skin_at({middle_.x() + s * 0.75f * width_, height});
    if (!cheek) return std::nullopt;
    const Vector2f from(tip.x(), tip.y()),
        along = (Vector2f(cheek->x(), cheek->y()) - from).normalized();
    std::optional<Vector3f> crease;
    float deepest = 0;
    for (const std::size_t v : near_) {
      const Vector3f& p = rest_[v];
      const float out = s * (p.x() - middle_.x());
      if (std::abs(p.z() - height) > band || out < 0.2f * width_ || out > 0.6f * width_ ||
          normals_[v].dot(Vector3f(0.7f * s, -0.7f, 0)) < 0.3f)
        continue;
      const Vector2f off = Vector2f(p.x(), p.y()) - from;
      const float behind = s * (along.x() * off.y() - along.y() * off.x());
      if (behind > deepest) deepest = behind, crease = p;
    }
    return crease;
  }

  /// Mean of the foremost skin around a position (x, z); none where there is no skin.
  std::optional<Vector3f> skin_at(const Vector2f& at) const {
    const float radius = 0.06f * width_, deep = 0.15f * width_;
    float front = std::numeric_limits<float>::infinity();
    const auto around = near(at.x(), at.y());
    const auto inside = [&](std::size_t v) {
      return (Vector2f(rest_[v].x(), rest_[v].z()) - at).squaredNorm() < radius * radius;
    };
    for (const std::size_t v : around)
      if (inside(v)) front = std::min(front, rest_[v].y());
    Vector3f sum = Vector3f::Zero();
    float weights = 0;
    for (const std::size_t v : around) {
      if (!inside(v) || rest_[v].y() > front + deep) continue;
      const float weight = 1 - (Vector2f(rest_[v].x(), rest_[v].z()) - at).norm() / radius + 1e-3f;
      sum += weight * rest_[v];
      weights += weight;
    }
    if (weights <= 0) return std::nullopt;
    return Vector3f(at.x(), sum.y() / weights, at.y());
  }

  /// Mean normal around a position on the skin.
  Vector3f normal_at(const Vector3f& p) const {
    const float radius = cell_;
    Vector3f sum = Vector3f::Zero();
    for (const std::size_t v : near(p.x(), p.z()))
      if ((rest_[v] - p).squaredNorm() < radius * radius && normals_[v].y() < 0.3f)
        sum += normals_[v];
    return sum.norm() > 0 ? Vector3f(sum.normalized()) : Vector3f(-Vector3f::UnitY());
  }

  /// The foremost point of the midline above the root of the nose.
  std::optional<Vector3f> glabella(const Vector3f& tip) const {
    const float step = 0.04f * width_, distinct = 0.01f * width_;
    std::optional<Vector3f> root, above;
    for (float up = 0.4f * width_; up < 1.7f * width_; up += step) {
      const auto p = skin_at({middle_.x(), tip.z() + up});
      if (!p) break;
      if (!root || (!above && p->y() > root->y())) root = p;
      if (root->y() - p->y() > distinct && (!above || p->y() < above->y())) above = p;
    }
    return above;
  }

  /// Where the midline is farthest behind the line from the lower lip to the chin.
  std::optional<Vector3f> mentolabial_point() const {
    std::vector<Vector3f> profile;
    for (float down = 0.06f; down < 1.0f; down += 0.02f)
      if (const auto p = skin_at({middle_.x(), middle_.z() - down * width_})) profile.push_back(*p);
    if (profile.size() < 10) return std::nullopt;
    const auto foremost = [](auto from, auto to) {
      return std::min_element(from, to,
                              [](const Vector3f& a, const Vector3f& b) { return a.y() < b.y(); });
    };
    const auto half = profile.begin() + static_cast<std::ptrdiff_t>(profile.size()) / 3;
    const auto lip = foremost(profile.begin(), half), chin = foremost(half, profile.end());
    const Vector3f along = (*chin - *lip).normalized();
    std::optional<Vector3f> point;
    float deepest = 0.02f * width_;
    for (auto p = lip; p != chin; ++p) {
      const Vector3f off = *p - *lip, away = off - off.dot(along) * along;
      if (away.y() > deepest) deepest = away.y(), point = *p;
    }
    return point;
  }

 private:
  using Cell = std::pair<int, int>;
  Cell cell_of(float x, float z) const {
    return {static_cast<int>(std::floor(x / cell_)), static_cast<int>(std::floor(z / cell_))};
  }
  /// All vertices within the edge of a cell, and others; ascending.
  std::vector<std::size_t> near(float x, float z) const {
    const Cell middle = cell_of(x, z);
    std::vector<std::size_t> around;
    for (int i = -1; i <= 1; ++i)
      for (int k = -1; k <= 1; ++k)
        if (const auto cell = cells_.find({middle.first + i, middle.second + k});
            cell != cells_.end())
          around.insert(around.end(), cell->second.begin(), cell->second.end());
    std::sort(around.begin(), around.end());
    return around;
  }

  std::span<const Vector3f> rest_, normals_;
  std::vector<std::size_t> near_;
  float cell_ = 0;  // edge of a cell, at least the radius of what is asked
  std::map<Cell, std::vector<std::size_t>> cells_;
  Vector3f right_, left_, middle_;
  float width_ = 0;
};

/// A smooth curve through positions in front view, laid on the skin. side: of the bulge, as the
/// sign of its direction across the curve. begins: fraction of the depth at the first knot.
std::vector<FoldLine::Sample> laid(const FrontView& face, std::span<const Vector2f> knots,
                                   float side, float begins) {
  std::vector<Vector2f> curve;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const Vector2f &a = knots[k], &b = knots[k + 1];
    const Vector2f before = k > 0 ? knots[k - 1] : Vector2f(2 * a - b);
    const Vector2f after = k + 2 < knots.size() ? knots[k + 2] : Vector2f(2 * b - a);
    const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / spacing_mm)));
    for (int i = k == 0 ? 0 : 1; i <= steps; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(steps);
      curve.push_back(0.5f *
                      (2 * a + t * (b - before) + t * t * (2 * before - 5 * a + 4 * b - after) +
                       t * t * t * (3 * a - before - 3 * b + after)));
    }
  }
  std::vector<FoldLine::Sample> samples;
  for (const Vector2f& at : curve)
    if (const auto p = face.skin_at(at))
      samples.push_back({*p, face.normal_at(*p), Vector3f::Zero(), 1});
  const std::size_t n = samples.size();
  if (n < 4) return {};
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3f along = samples[std::min(i + 1, n - 1)].point - samples[i > 0 ? i - 1 : 0].point;
    samples[i].across = (side * samples[i].normal.cross(along)).normalized();
    const float t = static_cast<float>(i) / static_cast<float>(n - 1), ends = 4 * t * (1 - t);
    const float fraction = std::sqrt(std::max(ends, 0.f)) * std::min(1.f, 2 * ends);
    samples[i].fraction = t < 0.5f ? begins + (1 - begins) * fraction : fraction;
  }
  return samples;
}

}  // namespace

std::vector<FoldLine> find_fold_lines(std::span<const Vector3f> rest,
                                      std::span<const Vector3f> normals, std::span<const int> rim) {
  std::vector<FoldLine> lines;
  if (rim.empty()) return lines;
  const FrontView face(rest, normals, rim);
  const float unit = face.width() / adult_mouth_mm;
  const auto add = [&](std::span<const Vector2f> knots, float side, const FoldLine& like,
                       float begins = 0) {
    FoldLine line = like;
    line.samples = laid(face, knots, side, begins);
    for (float* length : {&line.gauge_mm, &line.far_mm, &line.limit_mm, &line.groove_mm})
      *length *= unit;
    if (!line.samples.empty()) lines.push_back(std::move(line));
  };
  const auto tip = face.nose_tip();
  for (const int side : {1, -1}) {
    const auto s = static_cast<float>(side);
    const Vector2f corner(face.corner(side).x(), face.corner(side).z());
    const auto beside = [&](float out, float up) {
      return Vector2f(corner + unit * Vector2f(s * out, up));
    };
    if (const auto ala = tip ? face.alar_crease(side, *tip) : std::nullopt) {
      // On the cheek: a line that steps down from the ala would tear the skin.
      const Vector2f start(ala->x() + 5 * s * unit, ala->z());
      const Vector2f between = 0.5f * (start + beside(11, 3)) + unit * Vector2f(s * 2, 1);
      add(std::array{start, between, beside(11, 3), beside(10, -10)}, s,
          {.gauge_mm = 8,
           .far_mm = 24,
           .gain = 0.9f,
           .limit_mm = 2.5f,
           .groove_mm = 2.2f,
           .bulge = 0.9f,
           .continued = 0.6f},
          0.55f);
    }
    add(std::array{beside(3.5f, 5), beside(4.5f, 0), beside(4, -6)}, s,
        {.gauge_mm = 3.5f, .gain = 0.7f, .limit_mm = 0.8f, .groove_mm = 1.2f, .bulge = 0.4f});
  }
  // From the red of the lips, outward from the middle and long.
  const Vector2f stomion(face.middle().x(), face.middle().z());
  for (const auto& [out, length] : {std::pair{5.f, 8.f}, {9.5f, 6.f}, {14.5f, 8.f}, {20.f, 6.f}})
    for (const float side : {1.f, -1.f})
      for (const float up : {1.f, -1.f}) {
        const float red = 8 - 7 * out * out / 650;  // height of its border
        const auto at = [&](float beside, float height) {
          return Vector2f(stomion + unit * Vector2f(side * beside, up * height));
        };
        add(std::array{at(out, red), at(1.3f * out, red + length)}, side * up,
            {.gauge_mm = 2.5f, .gain = 0.9f, .limit_mm = 0.45f, .groove_mm = 1.2f, .bulge = 0.5f},
            0.7f);
      }
  if (const auto brows = tip ? face.glabella(*tip) : std::nullopt) {
    const auto at = [&](float beside, float higher) {
      return Vector2f(brows->x() + unit * beside, brows->z() + unit * higher);
    };
    // Across the forehead.
    for (const float up : {9.f, 17.f, 25.f})
      add(std::array{at(-36, up - 4), at(-18, up + 1), at(0, up - 1), at(18, up + 1),
                     at(36, up - 4)},
          1, {.gauge_mm = 4, .gain = 0.8f, .limit_mm = 0.8f, .groove_mm = 1.7f, .bulge = 0.7f});
    // Frown lines, from the root of the nose upward. Corrugators shorten this skin little.
    for (const float side : {1.f, -1.f})
      add(std::array{at(5 * side, -8), at(6.5f * side, 1), at(8.5f * side, 12)}, side,
          {.gauge_mm = 4,
           .onset = 0.01f,
           .gain = 1.5f,
           .limit_mm = 0.9f,
           .groove_mm = 1.4f,
           .bulge = 0.6f});
  }
  if (const auto sulcus = face.mentolabial_point()) {
    const Vector2f at(sulcus->x(), sulcus->z());
    add(std::array{Vector2f(at - unit * Vector2f(15, 4)), at,
                   Vector2f(at + unit * Vector2f(15, -4))},
        1, {.gauge_mm = 7, .gain = 0.7f, .limit_mm = 1.8f, .groove_mm = 2.5f, .bulge = 0.4f});
  }
  return lines;
}

}  // namespace condyle
