#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/collide/distance_field.h"
#include "engine/collide/shells.h"
#include "engine/core/parallel.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A triangle made ready for many queries.
struct Face {
  Vector3d a, ab, ac, normal;
  double bb = 0, bc = 0, cc = 0;  // products of ab and ac
  Vector3d center;                // of its ball
  double radius = 0;
  int shell = 0, triangle = 0;  // in that shell
  std::uint8_t rim = 0;
};

/// Square distance, and the barycentric coordinates of the nearest point: exactly 0 on edges and
/// corners. source: Ericson, Real-Time Collision Detection, 5.1.5.
double nearest(const Face& f, const Vector3d& p, Vector3d& at) {
  const Vector3d ap = p - f.a;
  const double d1 = f.ab.dot(ap), d2 = f.ac.dot(ap);
  const double d3 = d1 - f.bb, d4 = d2 - f.bc, d5 = d1 - f.bc, d6 = d2 - f.cc;
  double v = 0, w = 0;
  at.setZero();
  if (d1 <= 0 && d2 <= 0) {
    at[0] = 1;
  } else if (d3 >= 0 && d4 <= d3) {
    at[1] = v = 1;
  } else if (d6 >= 0 && d5 <= d6) {
    at[2] = w = 1;
  } else {
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
      v = d1 / (d1 - d3);
      at = {1 - v, v, 0};
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
      w = d2 / (d2 - d6);
      at = {1 - w, 0, w};
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      v = 1 - w;
      at = {0, v, w};
    } else {
      const double sum = va + vb + vc;
      v = vb / sum;
      w = vc / sum;
      at = {1 - v - w, v, w};
    }
  }
  return (ap - v * f.ab - w * f.ac).squaredNorm();
}

bool on_rim(const Face& f, const Vector3d& at) {
  if (f.rim == 0) return false;
  const int zeros = (at[0] == 0) + (at[1] == 0) + (at[2] == 0);
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && at[k] != 0) return f.rim & (8 << k);
    if (zeros == 1 && at[k] == 0) return f.rim & (1 << (k + 1) % 3);
  }
  return false;
}

/// A cube of bricks with the faces that can be nearest to some point of it, grouped by shell.
struct Cube {
  int x = 0, y = 0, z = 0;  // in bricks
  std::vector<int> faces;
};

/// What is nearest to a point.
struct Survey {
  double closed = infinity;  // signed distance to the union of closed shells
  double open = infinity;    // distance to the nearest open shell
  double value = infinity;   // of the field
};

}  // namespace

/// From the whole box down to bricks and blocks of samples: each cube keeps of its parent's faces
/// those that can be nearest to any point of it.
class FieldBuilder {
 public:
  FieldBuilder(DistanceField& field, const TriMesh& mesh) : field_(field) {
    shells_ = solid_shells(mesh);
    for (const Shell& shell : shells_) {
      trees_.emplace_back(shell.mesh);
      for (std::size_t i = 0; i < shell.mesh.triangles.size(); ++i) add_face(shell, i);
    }
  }

  void run(int threads) {
    int edge = 1;
    while (edge < *std::max_element(field_.size_.begin(), field_.size_.end())) edge *= 2;
    std::vector<Cube> cubes(1);
    cubes[0].faces.resize(faces_.size());
    for (std::size_t i = 0; i < faces_.size(); ++i) cubes[0].faces[i] = static_cast<int>(i);
    for (; edge > 1; edge /= 2) {
      std::vector<std::vector<Cube>> parts(8 * cubes.size());
      parallel_for(parts.size(), threads, [&](std::size_t i) {
        const Cube& parent = cubes[i / 8];
        Cube child{parent.x + (i & 1 ? edge / 2 : 0),
                   parent.y + (i & 2 ? edge / 2 : 0),
                   parent.z + (i & 4 ? edge / 2 : 0),
                   {}};
        if (narrow(parent, edge / 2, child)) parts[i].push_back(std::move(child));
      });
      cubes.clear();
      for (auto& part : parts)
        for (auto& cube : part) cubes.push_back(std::move(cube));
    }
    if (field_.brick_.size() == 1) {  // no halving came by
      Cube only;
      const bool kept = narrow(cubes[0], 1, only);
      cubes.assign(kept ? 1 : 0, only);
    }
    field_.bricks_.resize(cubes.size());
    for (std::size_t i = 0; i < cubes.size(); ++i)
      field_.brick_[field_.slot(cubes[i].x, cubes[i].y, cubes[i].z)] = static_cast<int>(i);
    parallel_for(cubes.size(), threads, [&](std::size_t i) { fill(cubes[i], field_.bricks_[i]); });
  }

 private:
  void add_face(const Shell& shell, std::size_t i) {
    const auto& t = shell.mesh.triangles[i];
    Face f;
    f.a = shell.mesh.vertices[t[0]];
    f.ab = shell.mesh.vertices[t[1]] - f.a;
    f.ac = shell.mesh.vertices[t[2]] - f.a;
    f.normal = f.ab.cross(f.ac);
    if (!(f.normal.squaredNorm() > 0)) return;
    f.bb = f.ab.squaredNorm();
    f.bc = f.ab.dot(f.ac);
    f.cc = f.ac.squaredNorm();
    f.center = f.a + (f.ab + f.ac) / 3;
    for (const Vector3d& corner : {f.a, Vector3d(f.a + f.ab), Vector3d(f.a + f.ac)})
      f.radius = std::max(f.radius, (corner - f.center).norm() * (1 + 1e-12));
    f.shell = static_cast<int>(trees_.size()) - 1;
    f.triangle = static_cast<int>(i);
    f.rim = shell.rim[i];
    faces_.push_back(f);
  }

  /// Negative where p lies behind the face, edge or corner nearest to it.
  double signed_distance(const Face& f, const Vector3d& p, const Vector3d& at,
                         double distance) const {
    const Vector3d away = p - (f.a + at[1] * f.ab + at[2] * f.ac);
    if (at[0] > 0 && at[1] > 0 && at[2] > 0) return away.dot(f.normal) < 0 ? -distance : distance;
    SurfacePoint found;
    found.barycentric = at;
    found.triangle = f.triangle;
    return away.dot(trees_[f.shell].pseudonormal(found)) < 0 ? -distance : distance;
  }

  /// `kept`, if given: faces that can be nearest to a point within `radius` of p.
  Survey survey(const std::vector<int>& faces, const Vector3d& p, double radius,
                std::vector<int>* kept) const {
    struct Run {
      std::size_t first, last;  // faces of one shell
      double distance;
      bool closed;
    };
    thread_local std::vector<double> least;
    thread_local std::vector<Run> runs;
    least.resize(faces.size());
    runs.clear();
    Survey result;
    for (std::size_t first = 0; first < faces.size();) {
      const int shell = faces_[faces[first]].shell;
      double best = infinity, best2 = infinity;
      const Face* nearest_face = nullptr;
      Vector3d nearest_at;
      std::size_t last = first;
      for (; last < faces.size() && faces_[faces[last]].shell == shell; ++last) {
        const Face& f = faces_[faces[last]];
        const double reach = best + f.radius;
        const double to_center2 = (p - f.center).squaredNorm();
        // Not nearer than the best: its ball tells how far at least. In small cubes an exact
        // distance spares more further down than it costs.
        if (to_center2 >= reach * reach) {
          const double bound = std::sqrt(to_center2) - f.radius;
          if (!kept || radius > 2.5 || bound > best + 2 * radius) {
            least[last] = bound;
            continue;
          }
        }
        Vector3d at;
        const double d2 = nearest(f, p, at);
        least[last] = kept ? std::sqrt(d2) : 0;
        if (d2 < best2) {
          best2 = d2;
          best = std::sqrt(d2);
          nearest_face = &f;
          nearest_at = at;
        }
      }
      const bool closed = shells_[shell].closed;
      double distance = signed_distance(*nearest_face, p, nearest_at, best);
      if (closed) {
        result.closed = std::min(result.closed, distance);
      } else {
        result.open = std::min(result.open, best);
        if (on_rim(*nearest_face, nearest_at) || best > field_.settings_.band_mm) distance = best;
      }
      result.value = std::min(result.value, distance);
      runs.push_back({first, last, closed ? distance : best, closed});
      first = last;
    }
    if (!kept) return result;
    for (const Run& run : runs) {
      if (run.closed && run.distance > result.closed + 2 * radius) continue;
      if (!run.closed && run.distance > field_.settings_.band_mm + radius &&
          run.distance > std::abs(result.closed) + 2 * radius && result.closed < infinity)
        continue;
      const double limit = (std::abs(run.distance) + 2 * radius) * (1 + 1e-12);
      for (std::size_t i = run.first; i < run.last; ++i)
        if (least[i] <= limit) kept->push_back(faces[i]);
    }
    return result;
  }

  /// False when the band does not reach the child: then its places are told how far it is.
  bool narrow(const Cube& parent, int edge, Cube& child) {
    if (child.x >= field_.size_[0] || child.y >= field_.size_[1] || child.z >= field_.size_[2])
      return false;
    const double mm = DistanceField::cells * field_.settings_.spacing_mm;
    const double radius = 0.5 * edge * mm * std::sqrt(3.0) * (1 + 1e-12);
    const Vector3d center =
        place_center(child.x, child.y, child.z) + Vector3d::Constant(0.5 * (edge - 1) * mm);
    const Survey found = survey(parent.faces, center, radius, &child.faces);
    const double outside = std::min(found.closed, found.open);
    const double band = field_.settings_.band_mm;
    const bool inside = found.closed < -(band + radius);
    if (!inside && outside <= band + radius) {
      // Past a rim the sign may jump: only the plain distance holds there.
      const bool open_near = found.open <= band + radius;
      if (edge == 1)
        bound(child.x, child.y, child.z, open_near ? std::min(found.closed, -found.open) : outside);
      return true;
    }
    for (int z = child.z; z < std::min(child.z + edge, field_.size_[2]); ++z)
      for (int y = child.y; y < std::min(child.y + edge, field_.size_[1]); ++y)
        for (int x = child.x; x < std::min(child.x + edge, field_.size_[0]); ++x) {
          const double way = (place_center(x, y, z) - center).norm();
          bound(x, y, z, (inside ? found.closed : outside) - (inside ? 0.0 : way));
          // Inside, a lower bound is of no use to anyone; below zero says enough.
        }
    return false;
  }

  void bound(int x, int y, int z, double value) {
    field_.bound_[field_.slot(x, y, z)] = static_cast<float>(value - 1e-4);
  }

  Vector3d place_center(int x, int y, int z) const {
    const double mm = DistanceField::cells * field_.settings_.spacing_mm;
    return field_.origin_ + mm * Vector3d(x + 0.5, y + 0.5, z + 0.5);
  }

  struct Block {
    int low[3], high[3];  // samples, inclusive
  };

  void fill(const Cube& cube, DistanceField::Brick& brick) const {
    constexpr int last = DistanceField::cells;
    fill_block({{0, 0, 0}, {last, last, last}}, cube, cube.faces, brick);
    DistanceField::mark_unknown(brick, field_.settings_.spacing_mm);
  }

  void fill_block(const Block& block, const Cube& cube, const std::vector<int>& faces,
                  DistanceField::Brick& brick) const {
    const double h = field_.settings_.spacing_mm;
    const auto at = [&](double x, double y, double z) {
      return Vector3d(field_.origin_ +
                      h * Vector3d(cube.x * 8 + x, cube.y * 8 + y, cube.z * 8 + z));
    };
    const int widest = std::max(
        {block.high[0] - block.low[0], block.high[1] - block.low[1], block.high[2] - block.low[2]});
    if (widest <= 1) {
      for (int z = block.low[2]; z <= block.high[2]; ++z)
        for (int y = block.low[1]; y <= block.high[1]; ++y)
          for (int x = block.low[0]; x <= block.high[0]; ++x)
            brick.value[static_cast<std::size_t>(x + DistanceField::corners *
                                                         (y + DistanceField::corners * z))] =
                static_cast<float>(survey(faces, at(x, y, z), 0, nullptr).value);
      return;
    }
    for (int part = 0; part < 8; ++part) {
      Block child = block;
      bool empty = false;
      for (int k = 0; k < 3; ++k) {
        const int middle = (block.low[k] + block.high[k]) / 2;
        if (part & (1 << k))
          child.low[k] = middle + 1;
        else
          child.high[k] = middle;
        empty = empty || child.low[k] > child.high[k];
      }
      if (empty) continue;
      double middle[3], radius2 = 0;
      for (int k = 0; k < 3; ++k) {
        middle[k] = 0.5 * (child.low[k] + child.high[k]);
        const double half = 0.5 * h * (child.high[k] - child.low[k]);
        radius2 += half * half;
      }
      std::vector<int> kept;
      survey(faces, at(middle[0], middle[1], middle[2]), std::sqrt(radius2) * (1 + 1e-9), &kept);
      fill_block(child, cube, kept, brick);
    }
  }

  DistanceField& field_;
  std::vector<Shell> shells_;
  std::vector<TriangleTree> trees_;  // one per shell
  std::vector<Face> faces_;          // by shell
};

DistanceField::DistanceField(const TriMesh& mesh, const FieldSettings& settings, int threads)
    : settings_(settings) {
  lay_out(mesh);
  FieldBuilder(*this, mesh).run(threads);
}

}  // namespace condyle
