#include "sim/tissue/pieces.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/tissue/harmonic_weights.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

void check(const CutBone& cut) {
  if (cut.owner.size() != cut.surface.triangles.size() || cut.surface.empty())
    throw InputError("cut bone: " + std::to_string(cut.owner.size()) + " owners for " +
                     std::to_string(cut.surface.triangles.size()) + " triangles");
  for (const BodyId owner : cut.owner)
    if (std::none_of(cut.pieces.begin(), cut.pieces.end(),
                     [&](const BodySurface& piece) { return piece.body == owner; }))
      throw InputError("cut bone: a triangle belongs to body " + std::to_string(index_of(owner)) +
                       ", which is no piece");
}

/// Distribution of a cut bone's tissue: for each node, the fraction of the bone's weight that each
/// piece takes over.
class PieceFractions {
 public:
  PieceFractions(const TissueModel& uncut, const CutBone& cut)
      : cut_(cut), tree_(cut.surface), mesh_(*uncut.mesh) {
    const TissueSupport& support = uncut.support;
    std::vector<int> given;
    // of each piece, of each constrained node
    std::vector<std::vector<double>> value(cut.pieces.size());
    for (std::size_t i = 0; i < support.kind.size(); ++i) {
      if (support.kind[i] == AnchorKind::other || support.kind[i] == AnchorKind::cartilage)
        continue;
      const int node = mesh_.elements.anchor_node[i];
      given.push_back(node);
      const BodyId owner =
          support.kind[i] == AnchorKind::rim ? cranium_body : owner_of_column(node);
      const double weight = weight_of(support.anchor, i, cut.whole);
      for (std::size_t p = 0; p < value.size(); ++p)
        value[p].push_back(cut.pieces[p].body == owner ? weight : 0);
    }
    for (const auto& of_piece : value)
      field_.push_back(harmonic_weights(mesh_.elements, given, of_piece));
  }

  /// The piece that an attached node moves with: that of the innermost node of its column.
  BodyId owner_of_column(int node) const {
    return owner_at(mesh_.rest[node - node % mesh_.sheets + mesh_.sheets - 1]);
  }
  BodyId owner_at(const Vector3d& p) const { return cut_.owner[tree_.nearest(p).triangle]; }

  /// Appends the pieces' parts of `weight` at a node.
  void add(int node, double weight, std::vector<BodyWeight>& to) const {
    constexpr double negligible = 1e-3;
    double sum = 0;
    for (const auto& field : field_)
      if (field[node] > negligible) sum += field[node];
    if (sum == 0) {
      to.push_back({owner_of_column(node), weight});
      return;
    }
    for (std::size_t p = 0; p < field_.size(); ++p)
      if (field_[p][node] > negligible)
        to.push_back({cut_.pieces[p].body, weight * field_[p][node] / sum});
  }

  /// The remainder of a list belongs to the cranium.
  static double weight_of(const BodyWeights& weights, std::size_t item, BodyId body) {
    return body == cranium_body ? 1 - weights.sum(item) : weights.of(item, body);
  }

 private:
  const CutBone& cut_;
  TriangleTree tree_;
  const TissueMesh& mesh_;
  std::vector<std::vector<double>> field_;  // of each piece, of each node
};

/// The weights of an item at a node, with cut bones replaced by their pieces.
std::vector<BodyWeight> on_pieces(const BodyWeights& weights, std::size_t item, int node,
                                  std::span<const CutBone> cuts,
                                  std::span<const PieceFractions> fractions) {
  std::vector<BodyWeight> now;
  const auto is_cut = [&](BodyId body) {
    return std::any_of(cuts.begin(), cuts.end(),
                       [&](const CutBone& cut) { return cut.whole == body; });
  };
  for (const auto& entry : weights[item])
    if (!is_cut(entry.body)) now.push_back(entry);
  for (std::size_t c = 0; c < cuts.size(); ++c)
    if (const double weight = PieceFractions::weight_of(weights, item, cuts[c].whole); weight != 0)
      fractions[c].add(node, weight, now);
  return now;
}

/// The septum parts from a segment of the upper jaw, and holds the nose back on the skull.
std::vector<BodyWeight> held_by_septum(std::vector<BodyWeight> of, std::span<const CutBone> cuts) {
  for (const CutBone& cut : cuts) {
    double held = 0;
    for (auto& [body, weight] : of) {
      const bool is_piece =
          body != cut.whole && std::any_of(cut.pieces.begin(), cut.pieces.end(),
                                           [&](const auto& piece) { return piece.body == body; });
      if (!is_piece) continue;
      held += cut.septum * weight;
      weight *= 1 - cut.septum;
    }
    if (held > 0) of.push_back({cut.whole, held});
  }
  return of;
}

TissueSupport support_on_pieces(const TissueModel& uncut, std::span<const CutBone> cuts,
                                std::span<const PieceFractions> fractions) {
  const TissueSupport& before = uncut.support;
  TissueSupport support = before;
  support.anchor = support.node = {};
  for (std::size_t i = 0; i < before.kind.size(); ++i) {
    const int node = uncut.mesh->elements.anchor_node[i];
    if (before.kind[i] != AnchorKind::bone) {
      std::vector<BodyWeight> now;
      if (before.kind[i] != AnchorKind::rim)
        now = on_pieces(before.anchor, i, node, cuts, fractions);
      support.anchor.add(
          before.kind[i] == AnchorKind::cartilage ? held_by_septum(std::move(now), cuts) : now);
      continue;
    }
    std::vector<BodyWeight> now(before.anchor[i].begin(), before.anchor[i].end());
    for (std::size_t c = 0; c < cuts.size(); ++c)
      if (PieceFractions::weight_of(before.anchor, i, cuts[c].whole) == 1)
        now = {{fractions[c].owner_of_column(node), 1}};
    support.anchor.add(now);
  }
  for (std::size_t n = 0; n < before.node.size(); ++n)
    support.node.add(on_pieces(before.node, n, static_cast<int>(n), cuts, fractions));
  return support;
}

/// Points that lay in the whole bone leave the piece that owns the nearest triangle where they left
/// the bone before, not through a cut face.
TissueContact contact_on_pieces(const TissueModel& uncut, std::span<const CutBone> cuts,
                                std::span<const PieceFractions> fractions, const JawBodies& jaw,
                                int threads) {
  TissueContact contact = *uncut.contact;
  contact.upper.body = jaw.upper_arch;
  contact.lower.body = jaw.lower_arch;
  contact.obstacles.clear();
  for (const auto& whole : uncut.contact->obstacles) {
    const auto cut = std::find_if(cuts.begin(), cuts.end(),
                                  [&](const CutBone& of) { return of.whole == whole.body; });
    if (cut == cuts.end()) {
      contact.obstacles.push_back(whole);
      continue;
    }
    const PieceFractions& owners = fractions[static_cast<std::size_t>(cut - cuts.begin())];
    const std::size_t first = contact.obstacles.size();
    contact.obstacles.resize(first + cut->pieces.size());
    parallel_for(cut->pieces.size(), threads, [&](std::size_t p) {
      const BodySurface& piece = cut->pieces[p];
      std::vector<std::optional<Vector3d>> shift(contact.points.size());
      for (std::size_t i = 0; i < shift.size(); ++i)
        if (!whole.shift[i].isZero() &&
            owners.owner_at(contact.points[i].at(uncut.mesh->rest)) == piece.body)
          shift[i] = whole.shift[i];
      contact.obstacles[first + p] = make_piece_obstacle(contact, uncut.mesh->rest, piece,
                                                         cut->surface, whole, threads, shift);
    });
    for (const auto& graft : cut->grafts)
      contact.obstacles.push_back(make_new_obstacle(contact, uncut.mesh->rest, graft, threads));
  }
  return contact;
}

/// The origins of muscles of the face go with the pieces on which they lie.
TissueMuscles muscles_on_pieces(TissueMuscles muscles, std::span<const CutBone> cuts,
                                std::span<const PieceFractions> fractions) {
  for (TissueMuscles::Line& line : muscles.lines)
    for (TissueMuscles::Point& point : line.points)
      for (std::size_t c = 0; c < cuts.size(); ++c)
        if (point.bone == cuts[c].whole) {
          point.bone = fractions[c].owner_at(point.rest);
          break;
        }
  return muscles;
}

}  // namespace

std::shared_ptr<const TissueModel> carry_to_pieces(const TissueModel& uncut,
                                                   std::span<const CutBone> cuts,
                                                   const JawBodies& jaw, int threads) {
  std::vector<PieceFractions> fractions;
  for (const auto& cut : cuts) {
    check(cut);
    fractions.emplace_back(uncut, cut);
  }
  auto model = std::make_shared<TissueModel>(uncut);
  model->support = support_on_pieces(uncut, cuts, fractions);
  model->contact = std::make_shared<const TissueContact>(
      contact_on_pieces(uncut, cuts, fractions, jaw, threads));
  model->muscles = muscles_on_pieces(std::move(model->muscles), cuts, fractions);
  model->opening.body = jaw.lower_arch;
  for (const auto& cut : cuts) {
    auto& along = model->opening.along;
    if (std::erase(along, cut.whole) == 0) continue;
    for (const auto& piece : cut.pieces) along.push_back(piece.body);
  }
  return model;
}

}  // namespace condyle
