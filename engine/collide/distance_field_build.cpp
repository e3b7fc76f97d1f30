#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/collide/field_face.h"
#include "engine/collide/shells.h"
#include "engine/collide/unchanged_faces.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

using Points = std::array<Vector3d, 4>;

/// Edge of the largest cubes, in bricks, that are copied as a whole from another field.
constexpr int largest_copied = 4;

/// A cube of bricks with the faces that can be nearest to any of its points, grouped by shell.
struct Cube {
  int x = 0, y = 0, z = 0;  // in bricks
  std::vector<int> faces;
  bool unchanged = false;  // all its bricks are those of the uncut mesh's field
};

/// The nearest distances of a point.
struct Survey {
  double closed = infinity;  // signed distance to the union of closed shells
  double open = infinity;    // distance to the nearest open shell
  double value = infinity;   // of the field
};

}  // namespace

/// Recursive subdivision from the whole box down to bricks and blocks of samples: each cube keeps
/// those of its parent's faces that can be nearest to any of its points.
class FieldBuilder {
 public:
  FieldBuilder(DistanceField& field, const TriMesh& mesh) : field_(field) {
    shells_ = solid_shells(mesh);
    for (const Shell& shell : shells_) {
      const int index = static_cast<int>(trees_.size());
      trees_.emplace_back(shell.mesh);
      for (std::size_t i = 0; i < shell.mesh.triangles.size(); ++i) {
        const FieldFace face = field_face(shell, index, static_cast<int>(i));
        if (face.normal.squaredNorm() > 0) faces_.push_back(face);
      }
    }
    Box box = bounding_box(mesh);
    const double grid_mm = DistanceField::cells * field.settings_.spacing_mm;
    for (int k = 0; k < 8; ++k) {
      const Vector3d corner(k & 1 ? field.size_[0] : 0, k & 2 ? field.size_[1] : 0,
                            k & 4 ? field.size_[2] : 0);
      box.add(field.origin_ + grid_mm * corner);
    }
    center_ = box.center();
    rounding_mm_ = static_cast<float>(1e-6 * box.size().norm());
    planes_.reserve(faces_.size());
    for (const FieldFace& face : faces_) planes_.emplace_back(face, center_);
  }

  /// Bricks are copied from the field of the uncut mesh where the piece has no other faces near.
  void copy_from(const DistanceField& field, const TriMesh& uncut) {
    const std::vector<Shell> shells = solid_shells(uncut);
    const auto closed = [](const Shell& shell) { return shell.closed; };
    if (!std::all_of(shells.begin(), shells.end(), closed) ||
        !std::all_of(shells_.begin(), shells_.end(), closed))
      return;  // beyond a rim the side may differ
    uncut_ = &field;
    const double diagonal =
        largest_copied * DistanceField::cells * field_.settings_.spacing_mm * std::sqrt(3.0);
    unchanged_.emplace(shells_, faces_, shells, 2 * field_.settings_.band_mm + 3 * diagonal);
  }

  void run(int threads, const Progress& progress) {
    int edge = 1;
    while (edge < *std::max_element(field_.size_.begin(), field_.size_.end())) edge *= 2;
    std::vector<Cube> cubes(1);
    cubes[0].faces.resize(faces_.size());
    for (std::size_t i = 0; i < faces_.size(); ++i) cubes[0].faces[i] = static_cast<int>(i);
    for (edge = std::max(edge, 2); edge > 1; edge /= 2) {
      report(progress, "measuring the bone", 0);
      std::vector<std::vector<Cube>> parts(2 * cubes.size());
      parallel_for(parts.size(), threads,
                   [&](std::size_t i) { narrow(cubes[i / 2], edge / 2, i % 2 != 0, parts[i]); });
      cubes.clear();
      for (auto& part : parts)
        for (auto& cube : part) cubes.push_back(std::move(cube));
    }
    field_.bricks_.resize(cubes.size());
    for (std::size_t i = 0; i < cubes.size(); ++i)
      field_.brick_[field_.slot(cubes[i].x, cubes[i].y, cubes[i].z)] = static_cast<int>(i);
    constexpr std::size_t at_once = 256;  // between two reports of progress
    for (std::size_t first = 0; first < cubes.size(); first += at_once) {
      report(progress, "measuring the bone",
             static_cast<double>(first) / static_cast<double>(cubes.size()));
      parallel_for(std::min(at_once, cubes.size() - first), threads,
                   [&](std::size_t i) { fill(cubes[first + i], field_.bricks_[first + i]); });
    }
  }

 private:
  /// Negative where p lies behind the face, edge or corner nearest to it.
  double signed_distance(const FieldFace& f, const Vector3d& p, const Vector3d& at,
                         double distance) const {
    const Vector3d away = p - (f.a + at[1] * f.ab + at[2] * f.ac);
    if (at[0] > 0 && at[1] > 0 && at[2] > 0) return away.dot(f.normal) < 0 ? -distance : distance;
    SurfacePoint found;
    found.barycentric = at;
    found.triangle = f.triangle;
    return away.dot(trees_[f.shell].pseudonormal(found)) < 0 ? -distance : distance;
  }

  /// Upper bound of a squared distance bound where the distance is at most this value.
  float square_limit(double distance) const {
    const float most = static_cast<float>(distance) + rounding_mm_;
    return most * most * (1 + 1e-6f);
  }

  /// The nearest face of one shell found so far.
  struct Nearest {
    double square = infinity;
    int face = -1;
    Vector3d at;

    /// Keeps the first of equally near faces.
    void consider(const std::vector<FieldFace>& faces, int other, const Vector3d& p) {
      Vector3d there;
      const double square_there = nearest(faces[other], p, there);
      if (square_there >= square) return;
      square = square_there;
      face = other;
      at = there;
    }
  };

  /// Adds the result of one more shell. Returns its distance, signed where it is closed.
  double add_shell(const Nearest& found, const Vector3d& p, Survey& result) const {
    const FieldFace& face = faces_[found.face];
    const double plain = std::sqrt(found.square);
    double distance = signed_distance(face, p, found.at, plain);
    const bool closed = shells_[face.shell].closed;
    if (closed) {
      result.closed = std::min(result.closed, distance);
    } else {
      result.open = std::min(result.open, plain);
      if (on_rim(face, found.at) || plain > field_.settings_.band_mm) distance = plain;
    }
    result.value = std::min(result.value, distance);
    return closed ? distance : plain;
  }

  /// The nearest distances of four points. `kept`, where given: per point, the faces that can be
  /// nearest to other points within its radius.
  std::array<Survey, 4> survey(const std::vector<int>& faces, const Points& points,
                               const std::array<double, 4>& radius,
                               std::array<std::vector<int>, 4>* kept) const {
    using Four = FacePlanes::Four;
    struct Run {
      std::size_t first, last;
      std::array<double, 4> distance;
      bool closed;
    };
    thread_local std::vector<Four> squares;
    thread_local std::vector<Run> runs;
    squares.resize(faces.size());
    runs.clear();
    Four x, y, z;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3f from_center = (points[k] - center_).cast<float>();
      x[k] = from_center.x();
      y[k] = from_center.y();
      z[k] = from_center.z();
    }
    std::array<Survey, 4> result;
    for (std::size_t first = 0; first < faces.size();) {
      Run run{first, first, {}, false};
      const int shell = faces_[faces[first]].shell;
      run.closed = shells_[shell].closed;
      Four least = Four::Constant(std::numeric_limits<float>::infinity());
      for (; run.last < faces.size() && faces_[faces[run.last]].shell == shell; ++run.last) {
        squares[run.last] = planes_[faces[run.last]].square_distances(x, y, z);
        // The bound 0 of a sliver says nothing about the nearest face.
        least = least.min((squares[run.last] > 0)
                              .select(squares[run.last], std::numeric_limits<float>::infinity()));
      }
      Four limit;
      for (int k = 0; k < 4; ++k) limit[k] = square_limit(std::sqrt(least[k]) + rounding_mm_);
      std::array<Nearest, 4> found;
      for (std::size_t i = run.first; i < run.last; ++i) {
        if (!(squares[i] <= limit).any()) continue;
        for (int k = 0; k < 4; ++k)
          if (squares[i][k] <= limit[k]) found[k].consider(faces_, faces[i], points[k]);
      }
      for (int k = 0; k < 4; ++k) run.distance[k] = add_shell(found[k], points[k], result[k]);
      first = run.last;
      if (kept) runs.push_back(run);
    }
    for (const Run& run : runs) {
      Four limit;
      for (int k = 0; k < 4; ++k) {
        const double reach = 2 * radius[k], distance = run.distance[k], closed = result[k].closed;
        const bool far = run.closed ? distance > closed + reach
                                    : distance > field_.settings_.band_mm + radius[k] &&
                                          distance > std::abs(closed) + reach && closed < infinity;
        limit[k] = far ? -1 : square_limit(std::abs(distance) + reach);
      }
      for (std::size_t i = run.first; i < run.last; ++i)
        for (int k = 0; k < 4; ++k)
          if (squares[i][k] <= limit[k]) (*kept)[k].push_back(faces[i]);
    }
    return result;
  }

  const DistanceField::Brick* uncut_brick(int x, int y, int z) const {
    if (!uncut_ || x >= field_.size_[0] || y >= field_.size_[1] || z >= field_.size_[2])
      return nullptr;
    const std::int32_t index = uncut_->brick_[uncut_->slot(x, y, z)];
    return index < 0 ? nullptr : &uncut_->bricks_[static_cast<std::size_t>(index)];
  }

  /// Whether the field within a radius (mm) of a point is that of the uncut mesh, of which one
  /// sample there is given. The distance to a union of closed shells changes by at most the
  /// displacement: where both are the same at one place, and the faces in which the meshes differ
  /// are this far away, these are nearest nowhere within the radius. Not so where a shell crosses
  /// itself; the field has unknown cells there.
  bool is_unchanged(const std::vector<int>& faces, const Vector3d& p, double radius,
                    double distance, const Vector3d& place, float uncut) const {
    const double reach = std::abs(distance) + 2 * radius + 1e-3;
    Vector3d barycentric;
    for (const int face : faces)
      if (!unchanged_->contains(face) && nearest(faces_[face], p, barycentric) <= reach * reach)
        return false;
    if (!unchanged_->are_missing_beyond(p, reach)) return false;
    return static_cast<float>(survey(faces, {place, place, place, place}, {}, nullptr)[0].value) ==
           uncut;
  }

  /// The same for a cube of several bricks, one of which the uncut mesh's field has.
  bool is_unchanged(const Cube& cube, int edge, const Vector3d& center, double radius,
                    double distance) const {
    constexpr int half = DistanceField::cells / 2;
    const DistanceField::Brick* sampled = nullptr;
    Vector3d place;
    for (int i = 0; i < edge * edge * edge; ++i) {
      Cube at;
      at.x = cube.x + i % edge;
      at.y = cube.y + i / edge % edge;
      at.z = cube.z + i / (edge * edge);
      const auto* brick = uncut_brick(at.x, at.y, at.z);
      if (!brick) continue;
      if (brick->unknown.any()) return false;
      if (!sampled) place = place_of(at, half, half, half);
      if (!sampled) sampled = brick;
    }
    return sampled && is_unchanged(cube.faces, center, radius, distance, place,
                                   sampled->value[sample_index(half, half, half)]);
  }

  void copy_children(const Cube& parent, int edge, bool upper, std::vector<Cube>& reached) {
    for (int k = 0; k < 4; ++k) {
      Cube child;
      child.x = parent.x + (k & 1 ? edge : 0);
      child.y = parent.y + (k & 2 ? edge : 0);
      child.z = parent.z + (upper ? edge : 0);
      child.unchanged = true;
      if (edge == 1) {
        if (child.x >= field_.size_[0] || child.y >= field_.size_[1] || child.z >= field_.size_[2])
          continue;
        const std::size_t place = field_.slot(child.x, child.y, child.z);
        field_.bound_[place] = uncut_->bound_[place];
        if (!uncut_brick(child.x, child.y, child.z)) continue;
      }
      reached.push_back(std::move(child));
    }
  }

  /// Four children of a cube, as far as the band reaches them.
  void narrow(const Cube& parent, int edge, bool upper, std::vector<Cube>& reached) {
    if (parent.unchanged) {
      copy_children(parent, edge, upper, reached);
      return;
    }
    const double mm = DistanceField::cells * field_.settings_.spacing_mm;
    const double radius = 0.5 * edge * mm * std::sqrt(3.0) * (1 + 1e-12);
    std::array<Cube, 4> child;
    Points center;
    for (int k = 0; k < 4; ++k) {
      child[k].x = parent.x + (k & 1 ? edge : 0);
      child[k].y = parent.y + (k & 2 ? edge : 0);
      child[k].z = parent.z + (upper ? edge : 0);
      center[k] = place_center(child[k].x, child[k].y, child[k].z) +
                  Vector3d::Constant(0.5 * (edge - 1) * mm);
    }
    std::array<std::vector<int>, 4> kept;
    const auto found = survey(parent.faces, center, {radius, radius, radius, radius}, &kept);
    for (int k = 0; k < 4; ++k)
      if (keep(child[k], edge, center[k], radius, found[k])) {
        child[k].faces = std::move(kept[k]);
        if (uncut_ && edge > 1 && edge <= largest_copied &&
            is_unchanged(child[k], edge, center[k], radius, found[k].closed)) {
          child[k].unchanged = true;
          child[k].faces.clear();
        }
        reached.push_back(std::move(child[k]));
      }
  }

  /// False when the band does not reach the child; its grid places then receive the bound of the
  /// distance.
  bool keep(const Cube& child, int edge, const Vector3d& center, double radius,
            const Survey& found) {
    if (child.x >= field_.size_[0] || child.y >= field_.size_[1] || child.z >= field_.size_[2])
      return false;
    const double outside = std::min(found.closed, found.open);
    const double band = field_.settings_.band_mm;
    const bool inside = found.closed < -(band + radius);
    if (!inside && outside <= band + radius) {
      // Beyond a rim the sign may be discontinuous: only the unsigned distance is valid there.
      const bool open_near = found.open <= band + radius;
      if (edge == 1)
        bound(child.x, child.y, child.z, open_near ? std::min(found.closed, -found.open) : outside);
      return true;
    }
    for (int z = child.z; z < std::min(child.z + edge, field_.size_[2]); ++z)
      for (int y = child.y; y < std::min(child.y + edge, field_.size_[1]); ++y)
        for (int x = child.x; x < std::min(child.x + edge, field_.size_[0]); ++x) {
          const double shift = (place_center(x, y, z) - center).norm();
          bound(x, y, z, (inside ? found.closed : outside) - (inside ? 0.0 : shift));
          // Inside, the magnitude of the bound is not used: any negative value suffices.
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

  static std::size_t sample_index(int x, int y, int z) {
    return static_cast<std::size_t>(x + DistanceField::corners * (y + DistanceField::corners * z));
  }

  void fill(const Cube& cube, DistanceField::Brick& brick) const {
    const DistanceField::Brick* uncut = uncut_brick(cube.x, cube.y, cube.z);
    if (cube.unchanged) {
      brick = *uncut;
      return;
    }
    constexpr int last = DistanceField::cells;
    fill_block({{0, 0, 0}, {last, last, last}}, cube, cube.faces, uncut, brick);
    DistanceField::mark_unknown(brick, field_.settings_.spacing_mm);
  }

  /// Copies the samples of a block where they are those of the uncut mesh's field.
  bool copy_block(const Block& block, const Cube& cube, const std::vector<int>& faces,
                  const DistanceField::Brick& uncut, DistanceField::Brick& brick) const {
    int at[3];
    double radius2 = 0;
    for (int k = 0; k < 3; ++k) {
      at[k] = (block.low[k] + block.high[k]) / 2;
      const double wide = field_.settings_.spacing_mm * (block.high[k] - at[k]);
      radius2 += wide * wide;
    }
    const float value = uncut.value[sample_index(at[0], at[1], at[2])];
    const Vector3d p = place_of(cube, at[0], at[1], at[2]);
    if (!is_unchanged(faces, p, std::sqrt(radius2), value, p, value)) return false;
    for (int z = block.low[2]; z <= block.high[2]; ++z)
      for (int y = block.low[1]; y <= block.high[1]; ++y)
        for (int x = block.low[0]; x <= block.high[0]; ++x) {
          const std::size_t i = sample_index(x, y, z);
          brick.value[i] = uncut.value[i];
        }
    return true;
  }

  Vector3d place_of(const Cube& cube, double x, double y, double z) const {
    return field_.origin_ +
           field_.settings_.spacing_mm * Vector3d(cube.x * DistanceField::cells + x,
                                                  cube.y * DistanceField::cells + y,
                                                  cube.z * DistanceField::cells + z);
  }

  /// `uncut`: the brick of the uncut mesh's field, where there is one.
  void fill_block(const Block& block, const Cube& cube, const std::vector<int>& faces,
                  const DistanceField::Brick* uncut, DistanceField::Brick& brick) const {
    if (uncut && !uncut->unknown.any() && copy_block(block, cube, faces, *uncut, brick)) return;
    const int widest = std::max(
        {block.high[0] - block.low[0], block.high[1] - block.low[1], block.high[2] - block.low[2]});
    if (widest <= 2) {
      sample(block, cube, faces, brick);
      return;
    }
    for (int upper = 0; upper < 2; ++upper) {
      std::array<Block, 4> child;
      Points middle;
      std::array<double, 4> radius;
      for (int part = 0; part < 4; ++part) {
        double center[3], radius2 = 0;
        child[part] = block;
        Block& c = child[part];
        for (int k = 0; k < 3; ++k) {
          const int half = (block.low[k] + block.high[k]) / 2;
          if ((part + 4 * upper) & (1 << k))
            c.low[k] = half + 1;
          else
            c.high[k] = half;
          center[k] = 0.5 * (c.low[k] + c.high[k]);
          const double wide = 0.5 * field_.settings_.spacing_mm * (c.high[k] - c.low[k]);
          radius2 += wide * wide;
        }
        middle[part] = place_of(cube, center[0], center[1], center[2]);
        radius[part] = std::sqrt(radius2) * (1 + 1e-9);
      }
      std::array<std::vector<int>, 4> kept;
      survey(faces, middle, radius, &kept);
      for (int part = 0; part < 4; ++part) fill_block(child[part], cube, kept[part], uncut, brick);
    }
  }

  void sample(const Block& block, const Cube& cube, const std::vector<int>& faces,
              DistanceField::Brick& brick) const {
    Points points;
    std::array<std::size_t, 4> places;
    int waiting = 0;
    const auto ask = [&] {
      for (int k = waiting; k < 4; ++k) points[k] = points[0];
      const auto found = survey(faces, points, {}, nullptr);
      for (int k = 0; k < waiting; ++k) brick.value[places[k]] = static_cast<float>(found[k].value);
      waiting = 0;
    };
    for (int z = block.low[2]; z <= block.high[2]; ++z)
      for (int y = block.low[1]; y <= block.high[1]; ++y)
        for (int x = block.low[0]; x <= block.high[0]; ++x) {
          points[waiting] = place_of(cube, x, y, z);
          places[waiting] = sample_index(x, y, z);
          if (++waiting == 4) ask();
        }
    if (waiting > 0) ask();
  }

  DistanceField& field_;
  std::vector<Shell> shells_;
  std::vector<TriangleTree> trees_;  // one per shell
  std::vector<FieldFace> faces_;     // by shell
  std::vector<FacePlanes> planes_;   // of the faces
  Vector3d center_ = Vector3d::Zero();
  float rounding_mm_ = 0;  // error of the bounds of the planes
  const DistanceField* uncut_ = nullptr;
  std::optional<UnchangedFaces> unchanged_;  // with uncut_
};

DistanceField::DistanceField(const TriMesh& mesh, const FieldSettings& settings, int threads,
                             const Progress& progress)
    : settings_(settings) {
  lay_out(mesh);
  FieldBuilder(*this, mesh).run(threads, progress);
  find_whole();
}

DistanceField::DistanceField(const TriMesh& piece, const TriMesh& uncut,
                             const DistanceField& uncut_field, int threads,
                             const Progress& progress)
    : settings_(uncut_field.settings_),
      origin_(uncut_field.origin_),
      per_mm_(uncut_field.per_mm_),
      size_(uncut_field.size_),
      brick_(uncut_field.brick_.size(), -1),
      bound_(uncut_field.bound_.size(), std::numeric_limits<float>::infinity()) {
  FieldBuilder builder(*this, piece);
  builder.copy_from(uncut_field, uncut);
  builder.run(threads, progress);
  find_whole();
}

}  // namespace condyle
