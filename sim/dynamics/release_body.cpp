#include "sim/dynamics/release_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/collide/solid.h"
#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Fraction of its speed that a part loses in a step to the hand: it comes to rest within a few
// steps, and the fraction is far below 2, where damping becomes unstable.
constexpr double lost_in_step = 0.2;

constexpr double deep_start_mm = 1, deep_rest_mm = 0.1;

Box moved(const Box& box, const Pose& X) {
  Box out;
  for (int corner = 0; corner < 8; ++corner)
    out.add(X * Vector3d((corner & 1) ? box.high.x() : box.low.x(),
                         (corner & 2) ? box.high.y() : box.low.y(),
                         (corner & 4) ? box.high.z() : box.low.z()));
  return out;
}

Box grown(Box box, double by) {
  box.low.array() -= by;
  box.high.array() += by;
  return box;
}

bool overlaps(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

void refuse_bad(const Case& patient, const std::vector<BodyId>& bodies,
                const ReleaseSettings& settings) {
  const BodyTree& tree = patient.bodies;
  for (const BodyId body : bodies) {
    if (index_of(body) >= tree.bodies().size() || !tree.roams(body))
      throw InputError("only a segment or a transplant can be released; body " +
                       std::to_string(static_cast<int>(body)) + " is neither");
    if (std::count(bodies.begin(), bodies.end(), body) > 1)
      throw InputError(tree[body].name + " is released twice");
  }
  const std::string& name = tree[bodies[0]].name;
  if (!(settings.push_N.norm() > 0) || !settings.push_N.allFinite())
    throw InputError(name + ": it needs a non-zero push to come to rest");
  if (!(settings.speed_mm_s > 0) || !(settings.reach_mm > 0))
    throw InputError(name + ": the speed and the reach must be above 0");
}

/// A surface in the world: all bone of a released body, or one part of a fixed body.
struct Piece {
  int part = 0;  // in the case; the first of a released body
  BodyId body = cranium_body;
  TriMesh mesh;  // in the body's coordinates
};

/// The bone of a body and of its descendants, except other released bodies.
Piece gathered(const Case& patient, BodyId body, const std::vector<BodyId>& released,
               const BodyPoses& from) {
  const BodyTree& tree = patient.bodies;
  Piece piece{.part = -1, .body = body, .mesh = {}};
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& part = patient.parts[i];
    if (!collides(part.role) || part.mesh.empty() || !tree.is_within(part.body, body)) continue;
    if (std::any_of(released.begin(), released.end(), [&](BodyId other) {
          return other != body && tree.is_within(other, body) && tree.is_within(part.body, other);
        }))
      continue;
    if (piece.part < 0) piece.part = static_cast<int>(i);
    const Pose X_BP = pose_in(body, part.body, from);
    const auto first = static_cast<int>(piece.mesh.vertices.size());
    for (const Vector3d& v : part.mesh.vertices)
      piece.mesh.vertices.push_back(bit_identical(X_BP, {}) ? v : X_BP * v);
    for (const auto& t : part.mesh.triangles)
      piece.mesh.triangles.push_back(t + Eigen::Vector3i::Constant(first));
  }
  if (piece.part < 0) throw InputError(tree[body].name + ": has no bone that could be released");
  return piece;
}

/// With the inertia of the hand, or of the surrounding soft tissue: so large that push and drag
/// balance at the requested speed.
DynamicBody loose(const Piece& piece, const Pose& X_CB, double step_s,
                  const ReleaseSettings& settings, int threads, const Progress& progress) {
  DynamicBody body;
  body.mass = mass_properties(piece.mesh, 1e-6);
  const double mass_kg =
      1000 * settings.push_N.norm() * step_s / (lost_in_step * settings.speed_mm_s);
  body.mass.inertia *= mass_kg / body.mass.mass_kg;
  body.mass.mass_kg = mass_kg;
  body.drag_N_s_mm = lost_in_step * mass_kg / step_s / 1000;
  body.turning_drag_N_mm_s = lost_in_step * min_moment(body.mass) / step_s / 1000;
  body.X_WB = X_CB;
  body.surfaces = {std::make_shared<const ContactSurface>(
      make_contact_surface(piece.mesh, {}, threads, progress))};
  return body;
}

/// Pairs of pieces that may overlap.
struct PairPieces {
  std::size_t below, lies;
};

/// The deepest of all pairs, by the exact surfaces.
struct Deepest {
  double depth_mm = 0;
  PairPieces pair = {};
};
Deepest deepest_of(const std::vector<Piece>& pieces, const std::vector<PairPieces>& pairs,
                   const std::map<std::size_t, Solid>& solids, const BodyPoses& at) {
  Deepest deepest;
  for (const PairPieces& pair : pairs) {
    const double depth = overlap_depth(solids.at(pair.below), at[pieces[pair.below].body],
                                       solids.at(pair.lies), at[pieces[pair.lies].body])
                             .depth_mm;
    if (depth > deepest.depth_mm) deepest = {depth, pair};
  }
  return deepest;
}

/// The world of a release: the released bodies first, then the parts that they can reach.
struct ReleaseWorld {
  RigidWorld world;
  std::vector<Piece> pieces;
  std::vector<int> bodies;        // in the world, of the released pieces
  std::vector<PairPieces> pairs;  // of the world
};

void add_reached_parts(const Case& patient, const BodyPoses& from, const std::vector<Box>& near,
                       const ReleaseSettings& settings, int threads, const Progress& progress,
                       ReleaseWorld& out) {
  const auto add_pair = [&](int below, std::size_t piece, std::size_t mover) {
    out.world.add_pair({.a = below, .b = out.bodies[mover], .friction = settings.friction});
    out.pairs.push_back({piece, mover});
  };
  const std::size_t released = out.bodies.size();
  const auto is_released = [&](const Part& part) {
    return std::any_of(
        out.pieces.begin(), out.pieces.begin() + static_cast<long>(released),
        [&](const Piece& piece) { return patient.bodies.is_within(part.body, piece.body); });
  };
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& other = patient.parts[i];
    if (!collides(other.role) || other.mesh.empty() || is_released(other)) continue;
    const Pose& X_CO = from[other.body];
    const Box box = bounding_box(other.mesh);
    Box here;
    std::vector<std::size_t> movers;
    for (std::size_t m = 0; m < released; ++m) {
      const Box reach = moved(near[m], X_CO.inverse());
      if (!overlaps(reach, box)) continue;
      here.add(reach);
      movers.push_back(m);
    }
    if (movers.empty()) continue;
    ContactSurfaceSettings surface;
    surface.field.region = here;
    DynamicBody fixed;
    fixed.X_WB = X_CO;
    fixed.surfaces = {std::make_shared<const ContactSurface>(
        make_contact_surface(other.mesh, surface, threads, progress))};
    if (fixed.surfaces[0]->samples.points.empty()) continue;
    const int below = out.world.add_body(fixed);
    out.pieces.push_back({static_cast<int>(i), other.body, other.mesh});
    for (const std::size_t m : movers) add_pair(below, out.pieces.size() - 1, m);
  }
  for (std::size_t a = 0; a < released; ++a)
    for (std::size_t b = a + 1; b < released; ++b)
      if (overlaps(near[a], near[b])) add_pair(out.bodies[b], b, a);
}

/// Poses of all bodies after the released ones have moved, with their descendants.
BodyPoses poses_after(const Case& patient, const BodyPoses& from, const ReleaseWorld& made) {
  std::vector<Pose> X_PB = in_parents(patient.bodies, from);
  BodyPoses after = from;
  for (int b = 1; b < patient.bodies.size(); ++b) {
    const BodyId body{b};
    const auto piece = std::find_if(made.pieces.begin(),
                                    made.pieces.begin() + static_cast<long>(made.bodies.size()),
                                    [&](const Piece& released) { return released.body == body; });
    const auto index = static_cast<std::size_t>(piece - made.pieces.begin());
    const BodyId parent = patient.bodies[body].parent;
    if (index < made.bodies.size())
      after.X_CB[index_of(body)] = made.world.pose(made.bodies[index]);
    else if (!bit_identical(after[parent], from[parent]))
      after.X_CB[index_of(body)] = composed(after[parent], X_PB[index_of(body)]);
  }
  return after;
}

}  // namespace

Release release_body(const Case& patient, BodyId body, const BodyPoses& given,
                     const ReleaseSettings& settings, int threads, const Progress& progress) {
  const Progress making = [&](std::string_view, double) { report(progress, "releasing", 0); };
  making({}, 0);
  const BodyPoses from = completed(patient.bodies, given);
  std::vector<BodyId> released = {body};
  released.insert(released.end(), settings.yielding.begin(), settings.yielding.end());
  refuse_bad(patient, released, settings);

  RigidSettings world_settings;
  world_settings.gravity_mm_s2.setZero();
  ReleaseWorld made{RigidWorld(world_settings), {}, {}, {}};
  RigidWorld& world = made.world;
  std::vector<Box> near;  // in the cranium
  for (const BodyId b : released) {
    made.pieces.push_back(gathered(patient, b, released, from));
    const Piece& piece = made.pieces.back();
    made.bodies.push_back(
        world.add_body(loose(piece, from[b], world_settings.step_s, settings, threads, making)));
    near.push_back(grown(moved(bounding_box(piece.mesh), from[b]), settings.reach_mm));
  }
  world.add_force({.body = made.bodies[0],
                   .point = world.mass(made.bodies[0]).center,
                   .force_N = settings.push_N});
  add_reached_parts(patient, from, near, settings, threads, making, made);
  if (std::none_of(made.pairs.begin(), made.pairs.end(),
                   [](const PairPieces& pair) { return pair.below == 0 || pair.lies == 0; }))
    throw InputError(
        fmt::format("{}: nothing lies within {:g} mm of it; bring it nearer before releasing it",
                    patient.bodies[body].name, settings.reach_mm));

  std::map<std::size_t, Solid> solids;
  for (const PairPieces& pair : made.pairs) {
    making({}, 0);
    for (const std::size_t p : {pair.below, pair.lies}) solids.try_emplace(p, made.pieces[p].mesh);
  }
  const auto part_of = [&](std::size_t piece) { return made.pieces[piece].part; };
  if (const Deepest start = deepest_of(made.pieces, made.pairs, solids, from);
      start.depth_mm > deep_start_mm) {
    const auto name = [&](std::size_t piece) {
      return patient.parts[static_cast<std::size_t>(part_of(piece))].name;
    };
    throw InputError(fmt::format(
        "{}: starts {:.1f} mm deep in {}; move it out, or import it again with --push-out",
        name(start.pair.lies), start.depth_mm, name(start.pair.below)));
  }

  Release out;
  out.rest = run_to_rest(world, made.bodies, settings.rest, threads, progress);
  // Bone farther away is excluded.
  for (std::size_t m = 0; m < made.bodies.size(); ++m) {
    const Vector3d& center = world.mass(made.bodies[m]).center;
    const Vector3d path = world.pose(made.bodies[m]) * center - from[released[m]] * center;
    out.rest.reached &= path.norm() < settings.reach_mm;
  }
  out.poses = poses_after(patient, from, made);
  out.rest.depth_mm = deepest_of(made.pieces, made.pairs, solids, out.poses).depth_mm;
  out.rest.reached &= out.rest.depth_mm <= deep_rest_mm;
  for (const RigidContact& c : world.contacts()) {
    const PairPieces& pair = made.pairs[static_cast<std::size_t>(c.pair)];
    out.contacts.push_back(
        {part_of(pair.below), c.point, c.normal, c.gap_mm, c.push_N, part_of(pair.lies)});
  }
  return out;
}

}  // namespace condyle
