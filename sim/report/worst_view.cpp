#include "engine/mesh/refine.h"
#include "sim/report/check_page.h"

namespace condyle {
namespace {

constexpr double seen_mm = 30;  // visible radius about the contact
constexpr double edge_fraction =
    1.0 / 60;                   // edge length over that radius, fine enough for the colour bands
constexpr double reach_mm = 6;  // larger distances are not coloured
constexpr int max_triangles = 600000;

std::vector<float> distances(const Part& part, const Pose& X_part, const TriMesh& other,
                             const Pose& X_other, int threads) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(part.mesh.vertices.size());
  for (const auto& p : part.mesh.vertices) points.push_back(X_part * p);
  return distances_to(SignedSurface(other), X_other, points, reach_mm, threads);
}

}  // namespace

WorstView worst_view(const Scene& scene, const PairVerdict& pair, int threads) {
  const auto& [when, sample, measure, poses] = pair.worst;
  const auto a = static_cast<std::size_t>(sample.contact.part_a),
             b = static_cast<std::size_t>(sample.contact.part_b);
  const auto& patient = scene.patient.parts;
  const Pose X_CA = pose_of(patient[a], poses), X_CB = pose_of(patient[b], poses);
  const double radius = seen_mm + measure.size_mm / 2;
  const double edge_mm = radius * edge_fraction;
  WorstView view;
  std::size_t drawn_a = 0, drawn_b = 0;
  for (std::size_t i = 0; i < patient.size(); ++i) {
    if (!collides(patient[i].role) || patient[i].mesh.empty()) continue;
    if (i == a) drawn_a = view.parts.size();
    if (i == b) drawn_b = view.parts.size();
    view.parts.push_back(patient[i]);
  }
  const auto refined = [&](Part& part, const Pose& X) {
    part.mesh = refine_near(std::move(part.mesh), X.inverse() * measure.middle, radius, edge_mm,
                            max_triangles);
  };
  Part &part_a = view.parts[drawn_a], &part_b = view.parts[drawn_b];
  refined(part_a, X_CA);
  refined(part_b, X_CB);
  view.distance_a = distances(part_a, X_CA, patient[b].mesh, X_CB, threads);
  view.distance_b = distances(part_b, X_CB, patient[a].mesh, X_CA, threads);
  return view;
}

}  // namespace condyle
