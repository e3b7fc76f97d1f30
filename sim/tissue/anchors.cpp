#include "sim/tissue/anchors.h"

#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"
#include "engine/tissue/harmonic_weights.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/placement.h"
#include "sim/tissue/tissue_defaults.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using namespace tissue_defaults;

/// Amount of tissue each column represents, relative to a column of the default mesh: an area, or
/// on a border a length. A column on the lip line represents half an area; the line accounts for
/// the other half.
std::vector<double> tissue_of_columns(const CoarseSkin& skin, double finer) {
  const double by_area = 1 / finer, by_length = std::sqrt(by_area);
  std::vector<double> fraction(skin.mesh.vertices.size(), by_area);
  for (std::size_t c = 0; c < fraction.size(); ++c)
    if (skin.rim[c] || skin.border[c]) fraction[c] = by_length;
  for (const auto* lip : {&skin.mouth.upper, &skin.mouth.lower})
    for (int c : *lip) fraction[c] = 0.5 * (by_area + by_length);
  return fraction;
}

/// N/mm of tissue grown on bone more or less firmly, 1 to 0.
double attached_stiffness(double firmness) {
  return loose_stiffness * std::pow(bone_stiffness / loose_stiffness, firmness);
}

/// Weight of the lower jaw for a lip's inner side: that of its own jaw except near the corners.
double lip_weight(double weight) { return smooth_step(smooth_step(weight)); }

/// Fraction of the mandible's motion that a border of the face follows, by its distance from it.
double border_follows(double to_mandible_mm) {
  return 1 - smooth_step((to_mandible_mm - border_full_mm) / border_reach_mm);
}

/// Whether the innermost node of a column lies on the bone that it is attached to: below most of
/// the nose there is none.
bool on_bone(const Column& column) {
  constexpr double most_mm = 3;
  return !column.cartilage ||
         (column.support && std::abs(column.met_depth - column.depth) < most_mm);
}

/// The anchors added and the weights of the lower jaw assigned so far.
class Anchoring {
 public:
  Anchoring(const AnchorSource& from, TissueMesh& mesh, TissueSupport& support,
            TissueSummary& summary)
      : from_(from),
        mesh_(mesh),
        support_(support),
        summary_(summary),
        lower_(from.bones.jaw.lower_arch),
        tissue_(tissue_of_columns(from.skin, from.finer)) {}

  void to_bone() {
    for (int c = 0; c < mesh_.columns; ++c) {
      const Column& column = from_.columns[c];
      if (from_.skin.rim[c] || !column.attached_to) continue;
      const int inner = node(c, mesh_.sheets - 1);
      const bool lower = *column.attached_to == lower_;
      add(inner, lower ? 1 : 0, attached_stiffness(column.firmness),
          on_bone(column) ? AnchorKind::bone : AnchorKind::cartilage);
      give(inner, lower ? 1 : 0);
      if (column.cartilage)
        for (int s = 0; s + 1 < mesh_.sheets; ++s)
          add(node(c, s), lower ? 1 : 0, cartilage_stiffness, AnchorKind::cartilage);
      ++(lower ? summary_.attached_to_mandible : summary_.attached_to_cranium);
    }
    check_attachment(summary_.attached_to_cranium, summary_.attached_to_mandible, from_.bones,
                     summary_.notes);
  }

  /// Every node of the rim is fixed.
  void to_rim() {
    for (int c = 0; c < mesh_.columns; ++c)
      if (from_.skin.rim[c])
        for (int s = 0; s < mesh_.sheets; ++s) {
          give(node(c, s), 0);
          add(node(c, s), 0, rim_stiffness, AnchorKind::rim);
          ++summary_.boundary;
        }
  }

  /// The lids keep their places on the eyeballs.
  void to_lids() {
    if (!from_.skin.eyes) return;
    for (int c = 0; c < mesh_.columns; ++c) {
      if (from_.skin.rim[c]) continue;
      const Vector3d& p = from_.skin.mesh.vertices[c];
      const double distance =
          std::min(from_.skin.eyes->left.distance(p), from_.skin.eyes->right.distance(p));
      const double held = 1 - smooth_step((distance - lid_mm) / lid_fades_mm);
      if (held <= 0) continue;
      for (int s = 0; s < mesh_.sheets; ++s)
        add(node(c, s), 0, held * lid_stiffness, AnchorKind::cartilage);
    }
  }

  /// A free border of the face (a mask that ends below the jaw) follows the mandible by as much as
  /// the tissue and its distance allow.
  void to_border() {
    const auto of_tissue = harmonic_weights(mesh_.elements, given_, given_weight_);
    for (int c = 0; c < mesh_.columns; ++c)
      if (from_.skin.border[c] && !from_.skin.rim[c])
        for (int s = 0; s < mesh_.sheets; ++s) {
          const int n = node(c, s);
          const double distance = from_.bones.mandible.empty()
                                      ? 1e9
                                      : from_.bones.mandible.nearest(mesh_.rest[n]).distance;
          const double weight = of_tissue[n] * border_follows(distance);
          if (s + 1 == mesh_.sheets && from_.columns[c].attached_to) continue;
          give(n, weight);
          add(n, weight, rim_stiffness, AnchorKind::other);
          ++summary_.boundary;
        }
  }

  /// Tissue that does not grow on bone is connected to both jaws by loose tissue: one weak spring
  /// to each, with the node's weights. Without it the inner sheet of a stretched cheek can fold
  /// in either direction.
  std::vector<char> loosely() {
    const auto weight = harmonic_weights(mesh_.elements, given_, given_weight_);
    for (double of_node : weight) support_.node.add(lower_, of_node);
    std::vector<char> attached(mesh_.elements.node_count, 0);
    for (int n : mesh_.elements.anchor_node) attached[n] = 1;
    for (int c = 0; c < mesh_.columns; ++c) {
      const int inner = node(c, mesh_.sheets - 1);
      if (attached[inner]) continue;
      const bool neck = !from_.columns[c].support;
      const bool lip = from_.columns[c].to_mouth < lip_margin_mm;
      add(inner, lip && !neck ? lip_weight(weight[inner]) : weight[inner],
          neck  ? neck_stiffness
          : lip ? lip_stiffness
                : loose_stiffness,
          AnchorKind::other);
      if (!neck && from_.columns[c].to_mouth > lip_edge_mm) continue;
      for (int s = 0; s + 1 < mesh_.sheets; ++s) {
        const int n = node(c, s);
        if (attached[n]) continue;
        if (neck)
          add(n, weight[n], platysma_stiffness, AnchorKind::other);
        else
          add(n, lip_weight(weight[n]), lip_edge_stiffness, AnchorKind::other);
      }
    }
    // What is attached loosely still slides.
    for (int c = 0; c < mesh_.columns; ++c)
      if (!from_.skin.rim[c] && from_.columns[c].firmness < 0.5)
        attached[node(c, mesh_.sheets - 1)] = 0;
    return attached;
  }

 private:
  int node(int column, int sheet) const { return node_of(column, sheet, mesh_.sheets); }

  void add(int node, double lower_weight, double stiffness, AnchorKind kind) {
    const bool inner = node % mesh_.sheets == mesh_.sheets - 1;
    stiffness *= from_.firmness * tissue_[node / mesh_.sheets] * (inner ? 1 : from_.depth_fraction);
    mesh_.elements.anchor_node.push_back(node);
    mesh_.elements.anchor_stiffness.push_back(stiffness);
    support_.anchor.add(lower_, lower_weight);
    support_.kind.push_back(kind);
  }
  void give(int node, double lower_weight) {
    given_.push_back(node);
    given_weight_.push_back(lower_weight);
  }

  const AnchorSource& from_;
  TissueMesh& mesh_;
  TissueSupport& support_;
  TissueSummary& summary_;
  BodyId lower_;
  std::vector<double> tissue_;
  std::vector<int> given_;
  std::vector<double> given_weight_;
};

}  // namespace

std::vector<char> add_anchors(const AnchorSource& from, TissueMesh& mesh, TissueSupport& support,
                              TissueSummary& summary) {
  Anchoring anchoring(from, mesh, support, summary);
  anchoring.to_bone();
  anchoring.to_rim();
  anchoring.to_lids();
  anchoring.to_border();
  return anchoring.loosely();
}

}  // namespace condyle
