#include "sim/operation/closed_bone.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include "engine/core/error.h"
#include "engine/cut/cap_rims.h"
#include "engine/cut/cell_complex.h"
#include "engine/field/wrap.h"
#include "engine/mesh/holes.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

/// Drops triangles that repeat a corner, with their sources.
void drop_collapsed(ClosedBone& bone) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < bone.mesh.triangles.size(); ++i) {
    const Eigen::Vector3i t = bone.mesh.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    bone.mesh.triangles[kept] = t;
    bone.source[kept++] = bone.source[i];
  }
  bone.mesh.triangles.resize(kept);
  bone.source.resize(kept);
}

/// The nearest triangle of `from` to each of a wrapped surface, -1 where it closes an opening.
std::vector<int> traced(const TriMesh& wrapped, const TriMesh& from) {
  const TriangleTree tree(from);
  const auto normal_of = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) { return (b - a).cross(c - a).normalized(); };
  std::vector<int> source(wrapped.triangles.size(), -1);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const auto& t = wrapped.triangles[i];
    const auto &a = wrapped.vertices[t[0]], &b = wrapped.vertices[t[1]],
               &c = wrapped.vertices[t[2]];
    const SurfacePoint near = tree.nearest((a + b + c) / 3, most_wrapped_mm);
    if (near.triangle < 0) continue;
    const auto& corners = tree.corners(near.triangle);
    // A lid that leaves the rim lies near the surface, too, but across it.
    if (std::abs(normal_of(a, b, c).dot(normal_of(corners[0], corners[1], corners[2]))) > 0.5)
      source[i] = near.triangle;
  }
  return source;
}

/// What is kept of a wrapped surface.
struct Wrapped {
  WrappedSurface surface;
  std::vector<int> source;  // triangles of the mesh that was wrapped
};

/// Wraps a mesh, or finds it among the last that were wrapped: a plan is applied again and again.
std::shared_ptr<const Wrapped> wrapped_once(const TriMesh& mesh) {
  constexpr std::size_t most = 4;
  static std::mutex mutex;
  static std::deque<std::pair<std::uint64_t, std::shared_ptr<const Wrapped>>> last;
  const std::lock_guard lock(mutex);
  const std::uint64_t hash = mesh_hash(mesh);
  for (const auto& [known, wrapped] : last)
    if (known == hash) return wrapped;
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  auto fresh = std::make_shared<Wrapped>();
  fresh->surface = wrap(mesh, {.threads = threads});  // the same bits for any number of threads
  fresh->source = traced(fresh->surface.mesh, mesh);
  if (last.size() == most) last.pop_front();
  last.emplace_back(hash, fresh);
  return fresh;
}

void wrap_bone(ClosedBone& bone, const std::string& name, int open, int left) {
  const auto wrapped = wrapped_once(bone.mesh);
  const WrappedSurface& surface = wrapped->surface;
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        fmt::format("{} cannot be cut: its surface is open or turned at {} edges, {} before flat "
                    "ends and small "
                    "holes were closed, and {}; close it in the program that made it",
                    name, left, open, why));
  };
  if (surface.solids != 1)
    refuse(surface.solids == 0 ? std::string("encloses nothing")
                               : fmt::format("wrapped, it is {} solids", surface.solids));
  if (surface.largest_mm > most_wrapped_mm)
    refuse(fmt::format("wrapped, it lies up to {:.2f} mm off (at most {} mm)", surface.largest_mm,
                       most_wrapped_mm));
  std::vector<int> source = wrapped->source;
  for (int& triangle : source)
    if (triangle >= 0) triangle = bone.source[triangle];
  bone.mesh = surface.mesh;
  bone.source = std::move(source);
  bone.notes.push_back(fmt::format(
      "{}: its surface is open or turned at {} edges; it was wrapped, within {:.2f} mm "
      "(mean {:.2f}) of its outer surface; openings are closed by lids, up to {:.1f} mm "
      "from the surface",
      name, open, surface.largest_mm, surface.mean_mm, surface.opening_mm));
}

std::string repairs(const CappedRims& capped, const ClosedHoles& closed) {
  std::string text;
  if (capped.rims > 0)
    text += fmt::format(", {} flat rim{} where the surface ends capped, the longest {:.0f} mm",
                        capped.rims, capped.rims == 1 ? "" : "s", capped.longest_rim_mm);
  if (closed.holes > 0)
    text += fmt::format(", {} hole{} closed, the longest rim {:.1f} mm", closed.holes,
                        closed.holes == 1 ? "" : "s", closed.longest_rim_mm);
  return text;
}

}  // namespace

ClosedBone closed_bone(const Part& part) {
  ClosedBone bone{part.mesh, std::vector<int>(part.mesh.triangles.size()), {}};
  std::iota(bone.source.begin(), bone.source.end(), 0);
  const int open = unbalanced_edges(bone.mesh);
  if (open == 0) return bone;
  weld(bone.mesh);
  drop_collapsed(bone);
  orient_outward(bone.mesh);
  const CappedRims capped = cap_flat_rims(bone.mesh);
  const ClosedHoles closed = close_small_holes(bone.mesh);
  orient_outward(bone.mesh);
  bone.source.resize(bone.mesh.triangles.size(), -1);
  if (const int left = unbalanced_edges(bone.mesh); left > 0) {
    wrap_bone(bone, part.name, open, left);
    return bone;
  }
  bone.notes.push_back(fmt::format("{}: open or turned at {} edges; welded and oriented{}",
                                   part.name, open, repairs(capped, closed)));
  return bone;
}

}  // namespace condyle
