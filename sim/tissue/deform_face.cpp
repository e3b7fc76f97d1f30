#include <algorithm>
#include <numeric>

#include "engine/core/parallel.h"
#include "engine/math/smooth_step.h"
#include "engine/tissue/layered_net.h"
#include "sim/tissue/model.h"

namespace condyle {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
/// The nine entries of a matrix by columns, and a shift.
using LinearMap = Eigen::Array<float, 12, 1>;

/// The nodes as the displayed face follows them: where a node moves unlike its neighbours by
/// millimetres, as in a sharp fold of the net, it goes with them.
Nodes shown_nodes(const TissueModel& model, const Nodes& now) {
  constexpr int rounds = 4;
  constexpr double ignored_mm = 1, whole_mm = 4;
  const auto& ring = model.handles.ring;
  Nodes shown = now, next = now;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t c = 0; c < ring.size(); ++c) {
      if (model.handle_evened[c] <= 0) continue;
      for (int s = 0; s < model.sheets; ++s) {
        const int node = node_of(static_cast<int>(c), s, model.sheets);
        Vector3d away = Vector3d::Zero();  // from its own motion to its neighbours'
        for (int n : ring[c]) {
          const int other = node_of(n, s, model.sheets);
          away += shown[other] - model.rest[other];
        }
        away = away / static_cast<double>(ring[c].size()) - (shown[node] - model.rest[node]);
        const double t = std::clamp((away.norm() - ignored_mm) / (whole_mm - ignored_mm), 0.0, 1.0);
        next[node] = shown[node] + model.handle_evened[c] * t * t * (3 - 2 * t) * away;
      }
    }
    shown = next;
  }
  return shown;
}

HandleMotion shown_motion(const TissueModel& model, const TissueState& state) {
  return handle_motion(model.handles, model.rest, shown_nodes(model, state.nodes));
}
}  // namespace

CarriedPoint carry_face_point(const TissueModel& model, const Vector3d& p, int side) {
  CarriedPoint point;
  const double inside = model.region.inside(p);
  if (inside <= 0) {
    point.fade = 0;
    return point;
  }
  const int own = side != 0 ? side : model.slit.side(p);
  std::vector<int> all(model.handles.node.size());
  std::iota(all.begin(), all.end(), 0);
  const auto to = [&](int h) {
    return model.slit.distance(p, own, model.rest[model.handles.node[h]], model.handle_side[h]);
  };
  // Motion bends sharply about the mouth, where a wide reach would even it out; farther away a
  // narrow one would show the net.
  const double about_mouth = 1 - smooth_step((model.slit.distance_from(p) - 20) / 30);
  point = carry(all, to, 1 - 0.2 * about_mouth);
  const double t = std::min(1.0, inside / 12);  // toward the rim all motion fades out
  point.fade = static_cast<float>(t * t * (3 - 2 * t));
  return point;
}

void deform_face(const TissueModel& model, const TissueState& state,
                 std::vector<Eigen::Vector3f>& face, int threads) {
  const std::size_t count = model.face_rest.size();
  if (face.size() != count) face.resize(count);
  for (std::size_t v = 0; v < count; ++v) face[v] = model.face_rest[v].cast<float>();
  if (model.carried.empty()) return;
  const HandleMotion motion = shown_motion(model, state);
  // As `carried`, with each handle's motion as one linear map in single precision, about a place in
  // the face so that none of it is lost: a dense face has to follow within a frame.
  const Vector3d origin = model.rest[model.handles.node.front()];
  std::vector<LinearMap> maps(model.handles.node.size());
  for (std::size_t h = 0; h < maps.size(); ++h) {
    const Vector3d shift =
        motion.moved[h] - motion.stretched[h] * (model.rest[model.handles.node[h]] - origin);
    maps[h].segment<9>(0) = motion.stretched[h].reshaped().cast<float>().array();
    maps[h].segment<3>(9) = shift.cast<float>().array();
  }
  constexpr std::size_t block = 2048;
  const std::size_t blocks = (model.carried.size() + block - 1) / block;
  parallel_for(blocks, threads, [&](std::size_t b) {
    const std::size_t last = std::min(model.carried.size(), (b + 1) * block);
    for (std::size_t i = b * block; i < last; ++i) {
      const int v = model.carried_vertex[i];
      const CarriedPoint& point = model.carried[i];
      LinearMap sum = LinearMap::Zero();
      for (int k = 0; k < CarriedPoint::capacity; ++k)
        sum += point.weight[k] * maps[static_cast<std::size_t>(point.handle[k])];
      const Vector3f from = (model.face_rest[v] - origin).cast<float>();
      face[v] += point.fade * (Eigen::Map<const Eigen::Matrix3f>(sum.data()) * from +
                               Eigen::Map<const Vector3f>(sum.data() + 9));
    }
  });
}

Vector3d carried_point(const TissueModel& model, const TissueState& state, const Vector3d& rest) {
  // A point on a lip belongs to the lip of the nearest vertex of the face.
  std::size_t nearest = 0;
  for (std::size_t v = 1; v < model.face_rest.size(); ++v)
    if ((model.face_rest[v] - rest).squaredNorm() < (model.face_rest[nearest] - rest).squaredNorm())
      nearest = v;
  const CarriedPoint point = carry_face_point(model, rest, model.face_side[nearest]);
  const HandleMotion motion = shown_motion(model, state);
  return carried(point, model.handles, model.rest, motion, rest);
}

}  // namespace condyle
