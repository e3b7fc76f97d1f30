#include "engine/field/mesh_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A triangle prepared for many distances.
struct RasterTriangle {
  Vector3d a, ab, ac, normal;  // unit normal; zero without area
  double d00, d01, d11, per_ab2, per_ac2, per_bc2, per_area2;
  Vector3d low, high;

  RasterTriangle(const Vector3d& p, const Vector3d& q, const Vector3d& r)
      : a(p), ab(q - p), ac(r - p), normal(ab.cross(ac)) {
    d00 = ab.squaredNorm();
    d01 = ab.dot(ac);
    d11 = ac.squaredNorm();
    const double bc2 = (ac - ab).squaredNorm(), area2 = d00 * d11 - d01 * d01;
    per_ab2 = d00 > 0 ? 1 / d00 : 0;
    per_ac2 = d11 > 0 ? 1 / d11 : 0;
    per_bc2 = bc2 > 0 ? 1 / bc2 : 0;
    per_area2 = area2 > 0 ? 1 / area2 : 0;
    normal = area2 > 0 ? Vector3d(normal / std::sqrt(area2)) : Vector3d::Zero();
    low = p.cwiseMin(q).cwiseMin(r);
    high = p.cwiseMax(q).cwiseMax(r);
  }

  double squared_distance(const Vector3d& p) const {
    const Vector3d v = p - a;
    const double s = ab.dot(v), t = ac.dot(v);
    if (per_area2 > 0) {
      const double u = (d11 * s - d01 * t) * per_area2, w = (d00 * t - d01 * s) * per_area2;
      if (u >= 0 && w >= 0 && u + w <= 1) {
        const double height = normal.dot(v);
        return height * height;
      }
    }
    const auto to_segment = [](const Vector3d& from, const Vector3d& along, double at) {
      return (from - std::clamp(at, 0.0, 1.0) * along).squaredNorm();
    };
    const Vector3d bc = ac - ab, vb = v - ab;
    return std::min({to_segment(v, ab, s * per_ab2), to_segment(v, ac, t * per_ac2),
                     to_segment(vb, bc, bc.dot(vb) * per_bc2)});
  }
};

/// First and last sample of an even axis within [low, high].
struct SampleRange {
  int first, last;
};

class EvenAxis {
 public:
  explicit EvenAxis(const GridAxis& axis)
      : start_(axis[0]),
        per_step_(1 / (axis[1] - axis[0])),
        count_(static_cast<double>(axis.size())) {}

  SampleRange within(double low, double high) const {
    const double from = std::min((low - start_) * per_step_ - 1e-9, count_);
    const double to = std::min((high - start_) * per_step_ + 1e-9, count_ - 1);
    const int down = static_cast<int>(std::max(from, 0.0));  // std::ceil is a call
    return {from > down ? down + 1 : down, to < 0 ? -1 : static_cast<int>(to)};
  }

 private:
  double start_, per_step_, count_;
};

/// Samples whose values are being lowered.
struct Raster {
  SampledField& field;
  double band;
  EvenAxis along_x{field.axes[0]}, along_y{field.axes[1]}, along_z{field.axes[2]};
};

/// Lowers the squared distances of one layer of samples, x = axes[0][i], to those of a triangle.
void raster_distance(const RasterTriangle& triangle, int i, const Raster& raster) {
  SampledField& field = raster.field;
  const double band = raster.band;
  if (triangle.low.z() - band > field.axes[2].back() ||
      triangle.high.z() + band < field.axes[2].front())
    return;
  const double x = field.axes[0][static_cast<std::size_t>(i)];
  const double beside = std::max({0.0, triangle.low.x() - x, x - triangle.high.x()});
  const SampleRange rows = raster.along_y.within(triangle.low.y() - band, triangle.high.y() + band);
  for (int j = rows.first; j <= rows.last; ++j) {
    const double y = field.axes[1][static_cast<std::size_t>(j)];
    const double behind = std::max({0.0, triangle.low.y() - y, y - triangle.high.y()});
    const double left = band * band - beside * beside - behind * behind;
    if (left < 0) continue;
    const double reach = std::sqrt(left);
    double low = triangle.low.z() - reach, high = triangle.high.z() + reach;
    if (const double n = triangle.normal.z(); std::abs(n) > 1e-6) {
      // Samples within the band of the triangle's plane.
      const double middle = triangle.a.z() - (triangle.normal.x() * (x - triangle.a.x()) +
                                              triangle.normal.y() * (y - triangle.a.y())) /
                                                 n;
      low = std::max(low, middle - band / std::abs(n));
      high = std::min(high, middle + band / std::abs(n));
    }
    const SampleRange samples = raster.along_z.within(low, high);
    float* row = &field.values[field.index(i, j, 0)];
    const double base = triangle.normal.x() * (x - triangle.a.x()) +
                        triangle.normal.y() * (y - triangle.a.y()) -
                        triangle.normal.z() * triangle.a.z();
    const double outside = beside * beside + behind * behind;
    for (int k = samples.first; k <= samples.last; ++k) {
      // Its box or its plane is farther away than another triangle.
      const double z = field.axes[2][static_cast<std::size_t>(k)];
      const double off = std::max({0.0, triangle.low.z() - z, z - triangle.high.z()});
      const double height = base + triangle.normal.z() * z;
      if (std::max(outside + off * off, height * height) >= row[k]) continue;
      row[k] = std::min(row[k], static_cast<float>(triangle.squared_distance({x, y, z})));
    }
  }
}

/// Whether (x, y) lies to the left of the edge; edges of two triangles agree, whatever the
/// rounding.
bool is_left(const TriMesh& mesh, int from, int to, double x, double y) {
  const bool forward = from < to;
  const Vector3d& a = mesh.vertices[static_cast<std::size_t>(forward ? from : to)];
  const Vector3d& b = mesh.vertices[static_cast<std::size_t>(forward ? to : from)];
  const bool left = (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x()) >= 0;
  return left == forward;
}

/// Where a line along z passes through the surface: +1 outward as z grows.
struct Crossing {
  double z;
  int sense;
};

/// Gives the samples of one layer their signs; their values are squared distances.
class LayerSigns {
 public:
  LayerSigns(const TriMesh& mesh, const Raster& raster, int i)
      : mesh_(mesh),
        raster_(raster),
        field_(raster.field),
        i_(i),
        crossings_(field_.axes[1].size()) {}

  void add(int t) {
    const auto& v = mesh_.triangles[static_cast<std::size_t>(t)];
    const Vector3d &a = mesh_.vertices[static_cast<std::size_t>(v[0])],
                   &b = mesh_.vertices[static_cast<std::size_t>(v[1])],
                   &c = mesh_.vertices[static_cast<std::size_t>(v[2])];
    const double x = field_.axes[0][static_cast<std::size_t>(i_)];
    const SampleRange rows =
        raster_.along_y.within(std::min({a.y(), b.y(), c.y()}), std::max({a.y(), b.y(), c.y()}));
    for (int j = rows.first; j <= rows.last; ++j) {
      const double y = field_.axes[1][static_cast<std::size_t>(j)];
      const bool left = is_left(mesh_, v[0], v[1], x, y);
      if (is_left(mesh_, v[1], v[2], x, y) != left || is_left(mesh_, v[2], v[0], x, y) != left)
        continue;
      const Vector3d n = (b - a).cross(c - a);
      const double z =
          n.z() != 0 ? a.z() - (n.x() * (x - a.x()) + n.y() * (y - a.y())) / n.z() : a.z();
      crossings_[static_cast<std::size_t>(j)].push_back({z, left ? 1 : -1});
    }
  }

  void finish() {
    for (std::size_t j = 0; j < crossings_.size(); ++j) {
      auto& line = crossings_[j];
      std::sort(line.begin(), line.end(), [](const Crossing& a, const Crossing& b) {
        return a.z != b.z ? a.z < b.z : a.sense < b.sense;
      });
      float* row = &field_.values[field_.index(i_, static_cast<int>(j), 0)];
      int winding = 0;
      std::size_t next = 0;
      for (std::size_t k = 0; k < field_.axes[2].size(); ++k) {
        for (; next < line.size() && line[next].z <= field_.axes[2][k]; ++next)
          winding -= line[next].sense;
        const auto distance = static_cast<float>(std::min(std::sqrt(double(row[k])), raster_.band));
        row[k] = winding > 0 ? -distance : distance;
      }
    }
  }

 private:
  const TriMesh& mesh_;
  const Raster& raster_;
  SampledField& field_;
  int i_;
  std::vector<std::vector<Crossing>> crossings_;
};

/// Triangles by the layers of samples that they reach. Those below the samples cross lines along z.
std::vector<std::vector<int>> by_layer(const std::vector<RasterTriangle>& triangles,
                                       const Raster& raster) {
  const SampledField& field = raster.field;
  const GridAxis &y = field.axes[1], &z = field.axes[2];
  const double band = raster.band;
  std::vector<std::vector<int>> layers(field.axes[0].size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3d &low = triangles[t].low, &high = triangles[t].high;
    if (low.y() - band > y.back() || high.y() + band < y.front() || low.z() - band > z.back())
      continue;
    const SampleRange range = raster.along_x.within(low.x() - band, high.x() + band);
    for (int i = range.first; i <= range.last; ++i)
      layers[static_cast<std::size_t>(i)].push_back(static_cast<int>(t));
  }
  return layers;
}

/// Samples around one, with their distances.
struct Neighbour {
  int i, j, k;
  float distance;
};

}  // namespace

SampledField mesh_field(const TriMesh& mesh, const std::array<GridAxis, 3>& axes, double band_mm,
                        int threads) {
  assert(axes[0].size() > 1 && axes[1].size() > 1 && axes[2].size() > 1 && band_mm > 0);
  SampledField field{axes, {}};
  field.values.assign(axes[0].size() * axes[1].size() * axes[2].size(),
                      static_cast<float>(band_mm * band_mm));
  std::vector<RasterTriangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.emplace_back(mesh.vertices[static_cast<std::size_t>(t[0])],
                           mesh.vertices[static_cast<std::size_t>(t[1])],
                           mesh.vertices[static_cast<std::size_t>(t[2])]);
  const Raster raster{field, band_mm};
  const auto layers = by_layer(triangles, raster);
  parallel_for(axes[0].size(), threads, [&](std::size_t layer) {
    const int i = static_cast<int>(layer);
    LayerSigns signs(mesh, raster, i);
    for (const int t : layers[layer]) {
      const RasterTriangle& triangle = triangles[static_cast<std::size_t>(t)];
      raster_distance(triangle, i, raster);
      if (triangle.low.x() <= axes[0][layer] && axes[0][layer] <= triangle.high.x()) signs.add(t);
    }
    signs.finish();
  });
  return field;
}

double even_value(const SampledField& field, const Vector3d& p) {
  std::array<int, 3> cell;
  std::array<double, 3> part;
  for (int a = 0; a < 3; ++a) {
    const GridAxis& axis = field.axes[static_cast<std::size_t>(a)];
    const int last = static_cast<int>(axis.size()) - 2;
    const double u = std::clamp((p[a] - axis[0]) / (axis[1] - axis[0]), 0.0, last + 1.0);
    cell[static_cast<std::size_t>(a)] = std::min(static_cast<int>(u), last);
    part[static_cast<std::size_t>(a)] = u - cell[static_cast<std::size_t>(a)];
  }
  const std::size_t along_y = field.axes[2].size(), along_x = along_y * field.axes[1].size();
  const float* v = &field.values[field.index(cell[0], cell[1], cell[2])];
  const auto line = [&](std::size_t at) { return v[at] + part[2] * (v[at + 1] - v[at]); };
  const double near = line(0) + part[1] * (line(along_y) - line(0));
  const double far = line(along_x) + part[1] * (line(along_x + along_y) - line(along_x));
  return near + part[0] * (far - near);
}

void sweep(SampledField& field, Sweep direction, int threads) {
  const std::size_t columns = field.axes[1].size(), height = field.axes[2].size();
  parallel_for(field.axes[0].size(), threads, [&](std::size_t i) {
    for (std::size_t j = 0; j < columns; ++j) {
      float* row = &field.values[(i * columns + j) * height];
      if (direction == Sweep::up)
        for (std::size_t k = 1; k < height; ++k) row[k] = std::min(row[k], row[k - 1]);
      else
        for (std::size_t k = height - 1; k-- > 0;) row[k] = std::min(row[k], row[k + 1]);
    }
  });
}

void remove_thin(SampledField& field, double radius_mm, double tolerance_mm, int threads) {
  const double step = field.axes[0][1] - field.axes[0][0];
  // A ball is centred on a sample, half a diagonal at most from where it fits best.
  const double least = radius_mm - 0.5 * step;
  const int reach = static_cast<int>(std::ceil((radius_mm + tolerance_mm) / step)) + 1;
  std::vector<Neighbour> around;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        const double distance = step * std::sqrt(double(i * i + j * j + k * k));
        if (distance <= reach * step) around.push_back({i, j, k, static_cast<float>(distance)});
      }
  std::sort(around.begin(), around.end(),
            [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
  const SampledField before = field;
  const Eigen::Vector3i size = field.size();
  const auto least_depth = static_cast<float>(-least);
  const auto allowed = static_cast<float>(tolerance_mm);
  parallel_for(field.axes[0].size(), threads, [&](std::size_t layer) {
    const int i = static_cast<int>(layer);
    for (int j = 0; j < size.y(); ++j)
      for (int k = 0; k < size.z(); ++k) {
        const std::size_t at = field.index(i, j, k);
        const float value = before.values[at];
        if (value >= 0 || value <= least_depth) continue;
        float nearest = static_cast<float>(radius_mm);  // beyond every ball
        for (const Neighbour& n : around) {
          const int a = i + n.i, b = j + n.j, c = k + n.k;
          if (a < 0 || b < 0 || c < 0 || a >= size.x() || b >= size.y() || c >= size.z()) continue;
          const float depth = before.values[before.index(a, b, c)];
          if (depth > least_depth) continue;
          nearest = std::min(nearest, n.distance + depth);
          if (nearest - allowed <= value) break;
        }
        field.values[at] = std::max(value, nearest - allowed);
      }
  });
}

void remove_thin_within(SampledField& field, const Box& box, double radius_mm, double tolerance_mm,
                        int threads) {
  const double step = field.axes[0][1] - field.axes[0][0];
  const double margin = radius_mm + tolerance_mm + 2 * step;
  SampledField part;
  std::array<int, 3> first;
  for (int a = 0; a < 3; ++a) {
    const GridAxis& axis = field.axes[static_cast<std::size_t>(a)];
    const SampleRange range = EvenAxis(axis).within(box.low[a] - margin, box.high[a] + margin);
    if (range.last <= range.first) return;
    first[static_cast<std::size_t>(a)] = range.first;
    part.axes[static_cast<std::size_t>(a)].assign(axis.begin() + range.first,
                                                  axis.begin() + range.last + 1);
  }
  const Eigen::Vector3i size = part.size();
  const auto row = [&](SampledField& of, int i, int j, int k) {
    return of.values.begin() + static_cast<std::ptrdiff_t>(of.index(i, j, k));
  };
  part.values.resize(part.axes[0].size() * part.axes[1].size() * part.axes[2].size());
  for (int i = 0; i < size.x(); ++i)
    for (int j = 0; j < size.y(); ++j)
      std::copy_n(row(field, first[0] + i, first[1] + j, first[2]), size.z(), row(part, i, j, 0));
  remove_thin(part, radius_mm, tolerance_mm, threads);
  for (int i = 0; i < size.x(); ++i)
    for (int j = 0; j < size.y(); ++j)
      for (int k = 0; k < size.z(); ++k)
        if (box.contains(part.position(i, j, k)))
          *row(field, first[0] + i, first[1] + j, first[2] + k) = *row(part, i, j, k);
}

}  // namespace condyle
