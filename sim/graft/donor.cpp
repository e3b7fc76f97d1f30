#include "sim/graft/donor.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Profile = std::vector<Vector2d>;  // (y, z), counter-clockwise seen against x

constexpr double station_mm = 2;
constexpr double free_ends_mm = 70;  // of a fibula, for knee and ankle

/// A polygon with its corners rounded by arcs.
Profile rounded(const Profile& corners, double radius_mm) {
  constexpr int arc_steps = 6;
  Profile profile;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d p = corners[i], before = (corners[(i + n - 1) % n] - p).normalized(),
                   after = (corners[(i + 1) % n] - p).normalized();
    const double half = 0.5 * std::acos(std::clamp(before.dot(after), -1., 1.));
    const Vector2d center = p + (before + after).normalized() * radius_mm / std::sin(half);
    const Vector2d a = p + before * radius_mm / std::tan(half) - center,
                   b = p + after * radius_mm / std::tan(half) - center;
    const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    for (int k = 0; k <= arc_steps; ++k)
      profile.push_back(center + Eigen::Rotation2Dd(turn * k / arc_steps) * a);
  }
  return profile;
}

/// The same with edges of at most 2 mm, in the middle of its box, scaled to a size.
Profile finished(const Profile& profile, double width_mm, double height_mm) {
  Profile fine;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vector2d p = profile[i], next = profile[(i + 1) % profile.size()];
    const int parts = std::max(1, static_cast<int>(std::ceil((next - p).norm() / station_mm)));
    for (int k = 0; k < parts; ++k) fine.push_back(p + (next - p) * k / parts);
  }
  Vector2d low = fine[0], high = fine[0];
  for (const Vector2d& p : fine) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (Vector2d& p : fine)
    p = (p - 0.5 * (low + high))
            .cwiseQuotient(high - low)
            .cwiseProduct(Vector2d(width_mm, height_mm));
  return fine;
}

/// The profile along the donor's axis, with flat ends.
TriMesh swept(const Donor& donor, const Profile& profile) {
  TriMesh mesh;
  const int stations = static_cast<int>(std::ceil(donor.length_mm / station_mm)),
            n = static_cast<int>(profile.size());
  for (int s = 0; s <= stations; ++s) {
    const double at = donor.length_mm * s / stations;
    const Vector3d x = donor.direction(at), y = Vector3d::UnitZ().cross(x);
    for (const Vector2d& p : profile)
      mesh.vertices.push_back(donor.axis(at) + p.x() * y + p.y() * Vector3d::UnitZ());
  }
  for (int s = 0; s < stations; ++s)
    for (int i = 0; i < n; ++i) {
      const int a = s * n + i, b = s * n + (i + 1) % n;
      mesh.triangles.emplace_back(a, b, b + n);
      mesh.triangles.emplace_back(a, b + n, a + n);
    }
  for (const int s : {0, stations}) {
    const int middle = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(donor.axis(donor.length_mm * s / stations));
    for (int i = 0; i < n; ++i) {
      const int a = s * n + i, b = s * n + (i + 1) % n;
      if (s == 0)
        mesh.triangles.emplace_back(middle, b, a);
      else
        mesh.triangles.emplace_back(middle, a, b);
    }
  }
  if (signed_volume(mesh) < 0) flip(mesh);
  return mesh;
}

Donor fibula() {
  Donor donor{.name = "fibula", .mesh = {}, .length_mm = 360, .height_mm = 15, .width_mm = 13};
  donor.first_mm = free_ends_mm;
  donor.last_mm = donor.length_mm - free_ends_mm;
  donor.kept = fmt::format("{:g} mm at each end of a fibula stay for knee and ankle", free_ends_mm);
  // The flat lateral surface faces outward.
  const Profile triangle = {{6.5, -7.5}, {6.5, 7.5}, {-6.5, 0}};
  donor.mesh = swept(donor, finished(rounded(triangle, 2.5), donor.width_mm, donor.height_mm));
  return donor;
}

Donor iliac_block() {
  Donor donor{.name = "iliac_block",
              .mesh = {},
              .length_mm = 45,
              .bend_radius_mm = 120,
              .height_mm = 25,
              .width_mm = 12};
  donor.last_mm = donor.length_mm;
  const Profile block = {{6, -12.5}, {6, 12.5}, {-6, 12.5}, {-6, -12.5}};
  donor.mesh = swept(donor, finished(rounded(block, 1.5), donor.width_mm, donor.height_mm));
  return donor;
}

Donor rib() {
  constexpr double ends_mm = 15;  // cartilage in front, the joint behind
  Donor donor{.name = "rib",
              .mesh = {},
              .length_mm = 200,
              .bend_radius_mm = 110,
              .height_mm = 12,
              .width_mm = 8};
  donor.first_mm = ends_mm;
  donor.last_mm = donor.length_mm - ends_mm;
  donor.kept = fmt::format("{:g} mm at each end of a rib stay for cartilage and joint", ends_mm);
  constexpr int points = 24;
  Profile ellipse;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    ellipse.emplace_back(std::cos(angle) * donor.width_mm, std::sin(angle) * donor.height_mm);
  }
  donor.mesh = swept(donor, finished(ellipse, donor.width_mm, donor.height_mm));
  return donor;
}

TriMesh read_donor(const std::string& file) {
  TriMesh mesh = read_mesh(file);
  weld(mesh);
  drop_degenerate(mesh);
  drop_duplicates(mesh);
  drop_unreferenced(mesh);
  orient_outward(mesh);
  if (const Topology found = inspect(mesh); !found.closed())
    throw InputError(file, "",
                     fmt::format("the donor's surface is not closed: it has {} open and "
                                 "{} non-manifold edges",
                                 found.boundary_edges, found.nonmanifold_edges));
  mesh.colors.clear();
  return mesh;
}

/// A surface along its principal axes, its lower end at the origin.
Donor donor_of(const std::string& file, TriMesh mesh) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& v : mesh.vertices) middle += v / static_cast<double>(mesh.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& v : mesh.vertices) spread += (v - middle) * (v - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(spread);
  Eigen::Matrix3d axes;  // rows: x longest, z second
  const auto fixed_sign = [](Vector3d v) {
    Eigen::Index k = 0;
    v.cwiseAbs().maxCoeff(&k);
    return Vector3d(v[k] < 0 ? -v : v);
  };
  axes.row(0) = fixed_sign(solved.eigenvectors().col(2));
  axes.row(2) = fixed_sign(solved.eigenvectors().col(1));
  axes.row(1) = Vector3d(axes.row(2)).cross(Vector3d(axes.row(0)));
  for (Vector3d& v : mesh.vertices) v = axes * (v - middle);
  const Box box = bounding_box(mesh);
  const Vector3d origin(box.low.x(), box.center().y(), box.center().z());
  for (Vector3d& v : mesh.vertices) v -= origin;
  Donor donor{.name = file,
              .mesh = std::move(mesh),
              .length_mm = box.size().x(),
              .height_mm = box.size().z(),
              .width_mm = box.size().y()};
  donor.last_mm = donor.length_mm;
  return donor;
}

bool is_built_in(const std::string& name) {
  const auto& names = donor_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

Vector3d Donor::axis(double at_mm) const {
  if (bend_radius_mm == 0) return {at_mm, 0, 0};
  const double angle = at_mm / bend_radius_mm;
  return {bend_radius_mm * std::sin(angle), bend_radius_mm * (std::cos(angle) - 1), 0};
}

Vector3d Donor::direction(double at_mm) const {
  if (bend_radius_mm == 0) return Vector3d::UnitX();
  const double angle = at_mm / bend_radius_mm;
  return {std::cos(angle), -std::sin(angle), 0};
}

double Donor::place(const Vector3d& p) const {
  if (bend_radius_mm == 0) return p.x();
  return bend_radius_mm * std::atan2(p.x(), p.y() + bend_radius_mm);
}

const std::vector<std::string>& donor_names() {
  static const std::vector<std::string> names = {"fibula", "iliac_block", "rib"};
  return names;
}

Donor make_donor(const GraftStep& step) {
  if (step.donor == "fibula") return fibula();
  if (step.donor == "iliac_block") return iliac_block();
  if (step.donor == "rib") return rib();
  TriMesh mesh = read_donor(step.donor);
  const std::string shape = fmt::format("{:016x}", mesh_hash(mesh));
  if (!step.donor_shape.empty() && step.donor_shape != shape)
    throw InputError(step.donor, "", "the surface is not the one that the plan was made with");
  return donor_of(step.donor, std::move(mesh));
}

std::string donor_shape(const std::string& donor) {
  if (is_built_in(donor)) return "";
  return fmt::format("{:016x}", mesh_hash(read_donor(donor)));
}

}  // namespace condyle
