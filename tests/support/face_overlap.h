#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/model.h"

namespace condyle::test {

/// Depth of the tissue's faces, not their nodes alone, in bone, teeth and the other lip: 36
/// samples on each face of the inner side that may slide, and of the lips' edges. Every bone and
/// row of teeth is asked by itself: inside by the winding number, as deep as its nearest surface.
/// What overlaps at rest is taken off for each sample: its own depth in the same jaw or lip then.
class FaceOverlap {
 public:
  FaceOverlap(const Case& patient, const TissueModel& model) : model_(model) {
    for (const auto& part : patient.parts)
      if (collides(part.role))
        parts_[part.body == mandible_body].push_back(
            {TriangleTree(part.mesh), bounding_box(part.mesh)});
    constexpr double firm = 0.3;  // N/mm: what is held by more is grown on and does not slide
    std::vector<char> held(model.mesh->rest.size(), 0);
    for (std::size_t i = 0; i < model.mesh->elements.anchor_node.size(); ++i)
      if (model.mesh->elements.anchor_stiffness[i] > firm)
        held[model.mesh->elements.anchor_node[i]] = 1;
    for (const auto& t : model.mesh->triangles) {
      const auto inner = [&](int k) {
        return node_of(t[k], model.mesh->sheets - 1, model.mesh->sheets);
      };
      if (!held[inner(0)] && !held[inner(1)] && !held[inner(2)])
        add({inner(0), inner(1), inner(2)}, neither);
    }
    for (const auto& face : model.contact->upper.edge) add(face, upper);
    for (const auto& face : model.contact->lower.edge) add(face, lower);
    for (const auto* lip : {&model.contact->upper, &model.contact->lower})
      for (const auto& face : lip->edge)
        for (const int n : face)
          if (n % model.mesh->sheets == 0) edge_.push_back(model.mesh->rest[n]);
    std::sort(edge_.begin(), edge_.end(),
              [](const auto& a, const auto& b) { return a.x() < b.x(); });
    for (auto& sample : samples_)
      for (int jaw = 0; jaw < 2; ++jaw)
        sample.in_jaw_at_rest[jaw] = in_jaw(jaw, at(sample, model.mesh->rest));
    for (const Lip lip : {upper, lower}) {
      const TriangleTree other(body(lip == upper ? lower : upper, model.mesh->rest));
      for (auto& sample : samples_)
        if (sample.lip == lip) sample.in_lip_at_rest = depth(other, at(sample, model.mesh->rest));
    }
  }

  std::size_t samples() const { return samples_.size(); }

  /// Largest depth of a sample in a jaw, mm beyond rest.
  double in_jaws(const Pose& X_CM, const Nodes& x) const {
    const Pose X_MC = X_CM.inverse();
    double deepest = 0;
    for (const auto& sample : samples_) {
      const Eigen::Vector3d p = at(sample, x);
      deepest = std::max({deepest, in_jaw(0, p) - sample.in_jaw_at_rest[0],
                          in_jaw(1, X_MC * p) - sample.in_jaw_at_rest[1]});
    }
    return deepest;
  }

  /// Largest depth of a sample of one lip's edge in the other lip, mm beyond rest.
  double in_other_lip(const Nodes& x) const {
    double deepest = 0;
    for (const Lip lip : {upper, lower}) {
      const TriangleTree other(body(lip == upper ? lower : upper, x));
      for (const auto& sample : samples_)
        if (sample.lip == lip && far_from_corners(sample))
          deepest = std::max(deepest, depth(other, at(sample, x)) - sample.in_lip_at_rest);
    }
    return deepest;
  }

 private:
  enum Lip : signed char { lower = -1, neither = 0, upper = 1 };
  struct Sample {
    std::array<int, 3> node;
    std::array<double, 3> weight;
    Lip lip;  // of whose edge it is
    std::array<double, 2> in_jaw_at_rest{};
    double in_lip_at_rest = 0;
  };
  struct Part {
    TriangleTree tree;
    Box box;
  };

  void add(const std::array<int, 3>& face, Lip lip) {
    constexpr int n = 7;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        samples_.push_back(
            {face, {double(n - i - j) / n, double(i) / n, double(j) / n}, lip, {}, 0});
  }
  static Eigen::Vector3d at(const Sample& sample, const Nodes& x) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) p += sample.weight[k] * x[sample.node[k]];
    return p;
  }
  static double depth(const TriangleTree& tree, const Eigen::Vector3d& p) {
    return !tree.empty() && tree.winding_number(p) > 0.5 ? tree.nearest(p).distance : 0;
  }
  double in_jaw(int jaw, const Eigen::Vector3d& p) const {
    double deepest = 0;
    for (const auto& part : parts_[jaw])
      if (part.box.contains(p)) deepest = std::max(deepest, depth(part.tree, p));
    return deepest;
  }

  /// All prisms of one lip near the mouth, as one closed surface.
  TriMesh body(Lip lip, const Nodes& x) const {
    constexpr double near_mm = 15;
    TriMesh mesh;
    mesh.vertices = x;
    const int inner = model_.mesh->sheets - 1;
    const auto node = [&](int column, int s) { return node_of(column, s, model_.mesh->sheets); };
    const auto belongs = [&](int c) {
      return model_.display->handle_side[c] == lip &&
             to_edge(model_.mesh->rest[node(c, 0)]) < near_mm;
    };
    std::set<std::array<int, 2>> border;  // directed edges that have no other side
    for (const auto& t : model_.mesh->triangles) {
      if (!belongs(t[0]) || !belongs(t[1]) || !belongs(t[2])) continue;
      mesh.triangles.emplace_back(node(t[0], 0), node(t[1], 0), node(t[2], 0));
      mesh.triangles.emplace_back(node(t[0], inner), node(t[2], inner), node(t[1], inner));
      for (int k = 0; k < 3; ++k)
        if (const int a = t[k], b = t[(k + 1) % 3]; border.erase({b, a}) == 0)
          border.insert({a, b});
    }
    for (const auto& [a, b] : border)
      for (int s = 0; s < inner; ++s) {
        mesh.triangles.emplace_back(node(a, s), node(a, s + 1), node(b, s + 1));
        mesh.triangles.emplace_back(node(a, s), node(b, s + 1), node(b, s));
      }
    return mesh;
  }
  double to_edge(const Eigen::Vector3d& p) const {
    double nearest = 1e9;
    for (const auto& q : edge_) nearest = std::min(nearest, (q - p).norm());
    return nearest;
  }
  bool far_from_corners(const Sample& sample) const {
    constexpr double corner_mm = 5;  // nearer to a corner both lips are one
    const Eigen::Vector3d p = at(sample, model_.mesh->rest);
    return (p - edge_.front()).norm() > corner_mm && (p - edge_.back()).norm() > corner_mm;
  }

  const TissueModel& model_;
  std::vector<Eigen::Vector3d> edge_;  // of the skin between the lips at rest, by x
  std::vector<Sample> samples_;
  std::array<std::vector<Part>, 2> parts_;  // of cranium and mandible
};

}  // namespace condyle::test
