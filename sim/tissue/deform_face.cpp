#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>

#include "engine/core/parallel.h"
#include "engine/math/smooth_step.h"
#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/model.h"

namespace condyle {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
/// The nine entries of a matrix by columns, and a translation.
using LinearMap = Eigen::Array<float, 12, 1>;

/// The nodes as the displayed face follows them: a node that moves by millimetres relative to its
/// neighbours, as in a sharp fold of the mesh, follows the neighbours.
Nodes shown_nodes(const TissueModel& model, const Nodes& now) {
  const auto& [mesh, display] = std::tie(*model.mesh, *model.display);
  assert(now.size() == mesh.rest.size());
  constexpr int rounds = 4;
  constexpr double ignored_mm = 1, whole_mm = 4;
  const auto& ring = display.handles.ring;
  Nodes shown = now, next = now;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t c = 0; c < ring.size(); ++c) {
      if (display.handle_evened[c] <= 0) continue;
      for (int s = 0; s < mesh.sheets; ++s) {
        const int node = node_of(static_cast<int>(c), s, mesh.sheets);
        Vector3d away = Vector3d::Zero();  // difference between its own motion and its neighbours'
        for (int n : ring[c]) {
          const int other = node_of(n, s, mesh.sheets);
          away += shown[other] - mesh.rest[other];
        }
        away = away / static_cast<double>(ring[c].size()) - (shown[node] - mesh.rest[node]);
        const double t = std::clamp((away.norm() - ignored_mm) / (whole_mm - ignored_mm), 0.0, 1.0);
        next[node] = shown[node] + display.handle_evened[c] * t * t * (3 - 2 * t) * away;
      }
    }
    shown = next;
  }
  return shown;
}

HandleMotion shown_motion(const TissueModel& model, const TissueState& state) {
  return handle_motion(model.display->handles, model.mesh->rest, shown_nodes(model, state.nodes));
}
}  // namespace

CarriedPoint carry_face_point(const TissueMesh& mesh, const FaceDisplay& display, const Vector3d& p,
                              int side) {
  CarriedPoint point;
  const double inside = display.region.inside(p);
  if (inside <= 0) {
    point.fade = 0;
    return point;
  }
  assert(side >= -1 && side <= 1);
  const int own = side != 0 ? side : display.fissure.side(p);
  std::vector<int> all(display.handles.node.size());
  std::iota(all.begin(), all.end(), 0);
  const Vector3d at = display.fissure.sampled_at(p, display.corner_reach_mm);
  const auto to = [&](int h) {
    return display.fissure.distance(at, own, mesh.rest[display.handles.node[h]],
                                    display.handle_side[h]);
  };
  // Motion varies sharply around the mouth, where a wide reach would smooth it out; farther away a
  // narrow reach would reveal the mesh.
  const double about_mouth = 1 - smooth_step((display.fissure.distance_from(p) - 20) / 30);
  point = carry(all, to, 1 - 0.2 * about_mouth);
  const double t = std::min(1.0, inside / 12);  // all motion fades out towards the rim
  point.fade = static_cast<float>(t * t * (3 - 2 * t));
  return point;
}

void deform_face(const TissueModel& model, const TissueState& state,
                 std::vector<Eigen::Vector3f>& face, int threads) {
  const auto& [mesh, display] = std::tie(*model.mesh, *model.display);
  const std::size_t count = display.face_rest.size();
  if (face.size() != count) face.resize(count);
  for (std::size_t v = 0; v < count; ++v) face[v] = display.face_rest[v].cast<float>();
  if (display.carried.empty()) return;
  const HandleMotion motion = shown_motion(model, state);
  // As `carried`, with each handle's motion as one linear map in single precision about a point of
  // the face, so that no precision is lost: a dense face has to follow within a frame.
  const Vector3d origin = mesh.rest[display.handles.node.front()];
  std::vector<LinearMap> maps(display.handles.node.size());
  for (std::size_t h = 0; h < maps.size(); ++h) {
    const Vector3d shift =
        motion.moved[h] - motion.stretched[h] * (mesh.rest[display.handles.node[h]] - origin);
    maps[h].segment<9>(0) = motion.stretched[h].reshaped().cast<float>().array();
    maps[h].segment<3>(9) = shift.cast<float>().array();
  }
  constexpr std::size_t block = 2048;
  const std::size_t blocks = (display.carried.size() + block - 1) / block;
  parallel_for(blocks, threads, [&](std::size_t b) {
    const std::size_t last = std::min(display.carried.size(), (b + 1) * block);
    for (std::size_t i = b * block; i < last; ++i) {
      const int v = display.carried_vertex[i];
      const CarriedPoint& point = display.carried[i];
      LinearMap sum = LinearMap::Zero();
      for (int k = 0; k < CarriedPoint::capacity; ++k)
        sum += point.weight[k] * maps[static_cast<std::size_t>(point.handle[k])];
      const Vector3f from = (display.carried_from[i] - origin).cast<float>();
      face[v] += point.fade * (Eigen::Map<const Eigen::Matrix3f>(sum.data()) * from +
                               Eigen::Map<const Vector3f>(sum.data() + 9));
    }
  });
}

Vector3d carried_point(const TissueModel& model, const TissueState& state,
                       const Vector3d& at_rest) {
  const auto& [mesh, display] = std::tie(*model.mesh, *model.display);
  const auto& face = model.planned ? model.planned->face : display.face_rest;
  // A point on a lip belongs to the lip of the nearest vertex of the face.
  std::size_t nearest = 0;
  for (std::size_t v = 1; v < face.size(); ++v)
    if ((face[v] - at_rest).squaredNorm() < (face[nearest] - at_rest).squaredNorm()) nearest = v;
  const Vector3d rest =
      model.planned ? Vector3d(at_rest + display.face_rest[nearest] - face[nearest]) : at_rest;
  const CarriedPoint point = carry_face_point(mesh, display, rest, display.face_side[nearest]);
  const HandleMotion motion = shown_motion(model, state);
  const Vector3d from = display.fissure.sampled_at(rest, display.corner_reach_mm);
  return rest + (carried(point, display.handles, mesh.rest, motion, from) - from);
}

}  // namespace condyle
