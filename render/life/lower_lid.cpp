#include "render/life/lower_lid.h"

#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

constexpr double degree = 3.14159265358979 / 180;
constexpr float skin_about_mm = 22;          // of the eyeball's surface
constexpr double still_below = 34 * degree;  // the edge: skin that does not move
constexpr double lid_mm = 3,
                 far_before_mm = 12;  // skin further before the edge moves less, not at all
constexpr double at_edge = 3 * degree;
// The cheek that raises the lid: below the middle of its edge.
constexpr double middle_mm = 7, cheek_from_mm = 9, cheek_to_mm = 15;
constexpr float rise_per_cheek = 3.5f;  // chosen by eye
constexpr float most_raised = 0.3f;  // of the opening

}  // namespace

LowerLid::LowerLid(const UpperLid& above, std::span<const Vector3f> rest) : above_(above) {
  const Eyeball& ball = above.eyeball();
  const UpperLid::Gap middle = above.gap_at(0);
  const double edge_mm = middle.away * std::sin(middle.bottom);
  for (std::size_t v = 0; v < rest.size(); ++v) {
    if ((rest[v] - ball.centre).norm() > ball.radius + skin_about_mm) continue;
    const auto at = above.place_of(rest[v].cast<double>());
    if (at.away < 1) continue;
    const auto vertex = static_cast<int>(v);
    const double height = at.away * std::sin(at.up), below = edge_mm - height;
    if (std::abs(at.along) < middle_mm && std::cos(at.up) > 0 && at.away > middle.away - lid_mm) {
      if (std::abs(at.up - middle.bottom) < at_edge)
        edge_.push_back({vertex, static_cast<float>(height)});
      else if (below > cheek_from_mm && below < cheek_to_mm)
        cheek_.push_back({vertex, static_cast<float>(height)});
    }
    const UpperLid::Gap gap = above.gap_at(at.along);
    const double open = gap.top - gap.bottom;
    if (!(open > 0) || at.up > (gap.top + gap.bottom) / 2) continue;
    const double lower = (gap.bottom - at.up) / still_below;
    const double before = (at.away - gap.away - lid_mm) / (far_before_mm - lid_mm);
    const double share =
        smooth_step(open / above.widest()) * (1 - smooth_step(lower)) * (1 - smooth_step(before));
    if (share > 1e-3) members_.push_back({vertex, static_cast<float>(share)});
  }
}

float LowerLid::raised(std::span<const Vector3f> places) const {
  const auto risen = [&](const std::vector<Gauge>& gauge) {
    double sum = 0;
    for (const auto& [vertex, rest] : gauge) {
      const auto at = above_.place_of(places[static_cast<std::size_t>(vertex)].cast<double>());
      sum += at.away * std::sin(at.up) - rest;
    }
    return static_cast<float>(sum / static_cast<double>(gauge.size()));
  };
  if (cheek_.empty() || edge_.empty()) return 0;
  const float cheek = risen(cheek_), higher = std::min(cheek - risen(edge_), cheek);
  const float asked = rise_per_cheek * higher / static_cast<float>(above_.gap_at(0).away);
  const float limit = most_raised * static_cast<float>(above_.widest());
  return asked > 0.002f ? asked * limit / std::hypot(asked, limit) : 0;
}

void LowerLid::move(float raised, const Vector3f& gaze, std::span<Vector3f> places) const {
  if (!(raised > 0)) return;
  for (const auto& [vertex, share] : members_) {
    Vector3f& p = places[static_cast<std::size_t>(vertex)];
    p = above_.slid(p, raised * share, gaze);
  }
}

}  // namespace condyle
