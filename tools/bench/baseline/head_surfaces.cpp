#include "tools/bench/baseline/head_surfaces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/units.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/simplify.h"
#include "sim/phantom/phantom.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::AngleAxisd, Eigen::Vector3d;

/// SplitMix64 (Steele et al. 2014): the same numbers on every machine.
class HeadNoise {
 public:
  explicit HeadNoise(std::uint64_t seed) : state_(seed) {}

  double uniform() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  Vector3d vector() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

/// Proportions that differ by 5 %, waves of 60 to 210 mm that displace by about 2 mm, and a chin
/// forward or back by 3 mm; standard deviations.
class SmoothWaves {
 public:
  explicit SmoothWaves(HeadNoise& noise) {
    scale_ = Vector3d::Ones() + 0.05 * noise.vector();
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      waves_[i].number =
          noise.vector().normalized() * 2 * std::numbers::pi / (60 + 30 * static_cast<double>(i));
      waves_[i].phase = 2 * std::numbers::pi * noise.uniform();
      waves_[i].size = 2 / std::sqrt(6 * 1.5) * noise.vector();
    }
    chin_ = 3 * noise.normal();
  }

  Vector3d operator()(Vector3d p, bool lower) const {
    if (lower) p.y() += chin_ * std::clamp((-p.y() - 20) / 60, 0.0, 1.0);
    Vector3d moved = scale_.cwiseProduct(p);
    for (const auto& wave : waves_) moved += wave.size * std::sin(wave.number.dot(p) + wave.phase);
    return moved;
  }

 private:
  struct Wave {
    Vector3d number, size;
    double phase = 0;
  };
  Vector3d scale_;
  std::array<Wave, 6> waves_;
  double chin_ = 0;
};

void append_mesh(TriMesh& mesh, const TriMesh& other) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    mesh.triangles.push_back(t + Eigen::Vector3i::Constant(first));
}

}  // namespace

TriMesh HeadSurfaces::bone() const {
  TriMesh both = skull;
  append_mesh(both, mandible);
  return both;
}

HeadSurfaces scanned_head(const Case& model, HeadPopulation population, std::uint64_t seed) {
  constexpr double noise_mm = 0.15;
  HeadNoise noise(1000 + seed);
  HeadSurfaces head;
  head.X_SH.R = AngleAxisd(8 * degree * noise.normal(), Vector3d::UnitX()) *
                AngleAxisd(4 * degree * noise.normal(), Vector3d::UnitY()) *
                AngleAxisd(4 * degree * noise.normal(), Vector3d::UnitZ());
  head.X_SH.t = 20 * noise.vector();
  const SmoothWaves waves(noise);
  const bool warped = population == HeadPopulation::warped;
  const Case patient = warped ? model : reshaped_head(model, {HeadChoice::Variant::standard, seed});
  const auto place = [&](const Vector3d& p, bool lower) -> Vector3d {
    return head.X_SH * (warped ? waves(p, lower) : p);
  };
  const auto scanned = [&](Role role, int triangles) {
    TriMesh mesh = patient.find(role)->mesh;
    mesh.colors.clear();
    for (auto& v : mesh.vertices)
      v = place(v, default_body(role) == mandible_body) + noise_mm * noise.vector();
    mesh = simplify(mesh, triangles);
    drop_unreferenced(mesh);
    return mesh;
  };
  head.skull = scanned(Role::skull, 35000);
  append_mesh(head.skull, scanned(Role::upper_teeth, 20000));
  head.mandible = scanned(Role::mandible, 30000);
  append_mesh(head.mandible, scanned(Role::lower_teeth, 20000));
  head.skin = scanned(Role::face, 60000);
  for (const auto& [name, p] : patient.landmarks.points)
    head.truth[name] = place(p, landmark_role(name) == Role::mandible);
  return head;
}

TriMesh scanned_between(const TriMesh& mesh, const HeadSurfaces& head, double low_mm,
                        double high_mm) {
  const double low = (head.X_SH * Vector3d(0, -60, low_mm)).z(),
               high = (head.X_SH * Vector3d(0, -60, high_mm)).z();
  TriMesh part;
  part.vertices = mesh.vertices;
  const auto inside = [&](int v) {
    const double z = mesh.vertices[static_cast<std::size_t>(v)].z();
    return z > low && z < high;
  };
  for (const auto& t : mesh.triangles)
    if (inside(t[0]) && inside(t[1]) && inside(t[2])) part.triangles.push_back(t);
  drop_unreferenced(part);
  return part;
}

}  // namespace condyle
