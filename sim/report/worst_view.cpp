#include <fmt/format.h>

#include <algorithm>

#include "engine/mesh/refine.h"
#include "sim/report/check_page.h"

namespace condyle {
namespace {

constexpr double seen_mm = 30;           // about the contact
constexpr double edge_share = 1.0 / 60;  // of that radius: fine enough for the picture's bands
constexpr double reach_mm = 6;           // distances beyond are not drawn
constexpr int most_triangles = 600000;

std::vector<float> distances(const Part& part, const Pose& X_part, const TriMesh& other,
                             const Pose& X_other, int threads) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(part.mesh.vertices.size());
  for (const auto& p : part.mesh.vertices) points.push_back(X_part * p);
  return distances_to(SignedSurface(other), X_other, points, reach_mm, threads);
}

}  // namespace

std::vector<std::size_t> pairs_to_show(const ClearanceCheck& check, std::size_t most) {
  const bool any = check.violated();
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < check.pairs.size(); ++i)
    if (!any || check.pairs[i].violated()) shown.push_back(i);
  std::stable_sort(shown.begin(), shown.end(), [&](std::size_t i, std::size_t j) {
    const auto &p = check.pairs[i], &q = check.pairs[j];
    if (p.beyond_rest_mm != q.beyond_rest_mm) return p.beyond_rest_mm > q.beyond_rest_mm;
    return p.least_distance_mm < q.least_distance_mm;
  });
  if (shown.size() > most) shown.resize(most);
  return shown;
}

WorstView worst_view(const Scene& scene, const PairVerdict& pair, int threads) {
  const auto a = static_cast<std::size_t>(pair.worst.part_a),
             b = static_cast<std::size_t>(pair.worst.part_b);
  const auto& patient = scene.patient.parts;
  const double radius = seen_mm + pair.detail.size_mm / 2;
  const double edge_mm = radius * edge_share;
  WorstView view;
  std::size_t drawn_a = 0, drawn_b = 0;
  for (std::size_t i = 0; i < patient.size(); ++i) {
    if (!collides(patient[i].role) || patient[i].mesh.empty()) continue;
    if (i == a) drawn_a = view.parts.size();
    if (i == b) drawn_b = view.parts.size();
    view.parts.push_back(patient[i]);
  }
  Part &part_a = view.parts[drawn_a], &part_b = view.parts[drawn_b];
  part_a.mesh =
      refine_near(std::move(part_a.mesh), pair.detail.middle, radius, edge_mm, most_triangles);
  part_b.mesh = refine_near(std::move(part_b.mesh), pair.X_CM_worst.inverse() * pair.detail.middle,
                            radius, edge_mm, most_triangles);
  view.distance_a = distances(part_a, Pose{}, patient[b].mesh, pair.X_CM_worst, threads);
  view.distance_b = distances(part_b, pair.X_CM_worst, patient[a].mesh, Pose{}, threads);
  return view;
}

std::string open_surface_words(const PairVerdict& pair) {
  const bool open_a = pair.detail.open_a, open_b = pair.detail.open_b;
  if (open_a && open_b)
    return "Both have open surfaces, which have no inside: near them distance is shown without "
           "sign, as if apart.";
  if (!open_a && !open_b) return "";
  return fmt::format(
      "{0} has open surfaces, which have no inside: near them, distance on {1} is shown without "
      "sign, as if apart.",
      open_a ? pair.a : pair.b, open_a ? pair.b : pair.a);
}

std::string worst_caption(const ClearanceCheck& check, const PairVerdict& pair) {
  const int frame = pair.worst_frame();
  const auto f = static_cast<std::size_t>(frame);
  std::string text;
  if (!pair.worst.touching)
    text = fmt::format("nearest {:.2f} mm", pair.worst.distance_mm);
  else if (pair.worst_was_apart)
    text = fmt::format("{:.2f} mm deep where they are apart at rest", pair.worst_depth_mm);
  else if (pair.beyond_rest_mm > 0 && pair.rest_depth_mm > 0)
    text = fmt::format("{:.2f} mm deep, {:.2f} mm deeper than at rest", pair.worst_depth_mm,
                       pair.beyond_rest_mm);
  else if (pair.beyond_rest_mm > 0)
    text = fmt::format("{:.2f} mm deep", pair.worst_depth_mm);
  else
    text = pair.rest_depth_mm > 0 ? "touching, not deeper than at rest" : "touching";
  const auto& detail = pair.detail;
  text += fmt::format(" at {:.1f} mm opening, {:.1f}° rotation ({:.2f} s)", check.opening_mm[f],
                      check.rotation_deg[f], check.time_s[f]);
  if (pair.worst.touching) {
    text += fmt::format("; contact {:.1f} mm² in {} {}", detail.area_mm2, detail.patches,
                        detail.patches == 1 ? "patch" : "patches");
    if (detail.volume_known) text += fmt::format(", overlap {:.1f} mm³", detail.volume_mm3);
  }
  text += "; " + detail.side +
          (detail.side == "both"     ? " sides"
           : detail.side == "middle" ? ""
                                     : " side");
  if (!detail.region.empty()) text += ", " + detail.region;
  return text;
}

}  // namespace condyle
