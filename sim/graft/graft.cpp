#include "sim/graft/graft.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/core/error.h"
#include "engine/cut/cut.h"
#include "sim/graft/corners.h"
#include "sim/graft/section.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double most_spacing_mm = 1;  // published margin between neighbouring saw cuts

/// Directions of a piece: x along it, z up, y outward. The first is upright, each further one is
/// turned by the least rotation, so that sections of neighbours agree in the plane between them.
std::vector<Matrix3d> piece_frames(const std::vector<Vector3d>& corners, const Vector3d& up,
                                   double roll_deg) {
  std::vector<Matrix3d> frames;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vector3d x = (corners[i + 1] - corners[i]).normalized();
    Matrix3d R;
    if (i == 0) {
      const Vector3d z = (up - up.dot(x) * x).normalized();
      R << x, z.cross(x), z;
      R = R * Eigen::AngleAxisd(roll_deg / degrees, Vector3d::UnitX());
    } else {
      const Matrix3d& last = frames.back();
      R = Eigen::Quaterniond::FromTwoVectors(last.col(0), x).toRotationMatrix() * last;
      R.col(0) = x;
    }
    frames.push_back(R);
  }
  return frames;
}

/// Planes across the axis at each corner: normals along it.
std::vector<Plane> corner_planes(const std::vector<Vector3d>& corners, const Defect& defect,
                                 double clearance_mm) {
  std::vector<Plane> planes;
  const auto direction = [&](std::size_t i) {
    return Vector3d((corners[i + 1] - corners[i]).normalized());
  };
  const DefectFace &first = defect.faces[0], &second = defect.faces[1];
  planes.push_back(plane_through(first.point + clearance_mm * first.normal, first.normal));
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    planes.push_back(plane_through(corners[i], direction(i - 1) + direction(i)));
  planes.push_back(plane_through(second.point + clearance_mm * second.normal, -second.normal));
  return planes;
}

Plane moved_plane(const Pose& X, const Plane& plane) {
  const Vector3d normal = X.R * plane.normal;
  return {normal, plane.offset_mm + normal.dot(X.t)};
}

Plane reversed(const Plane& plane) { return {-plane.normal, -plane.offset_mm}; }

/// X_CD of a piece whose axis begins at a place of the donor's.
Pose donor_pose(const Donor& donor, const Matrix3d& R_CP, const Vector3d& from, double length_mm,
                double at_mm) {
  // The chord of the donor's axis as long as the piece.
  double chord_end = at_mm + length_mm;
  if (donor.bend_radius_mm > 0) {
    const double half = length_mm / (2 * donor.bend_radius_mm);
    chord_end = at_mm + 2 * donor.bend_radius_mm * std::asin(std::min(half, 1.));
  }
  const Vector3d x = (donor.axis(chord_end) - donor.axis(at_mm)).normalized(),
                 z = Vector3d::UnitZ();
  Matrix3d R_DP;
  R_DP << x, z.cross(x), z;
  const Eigen::Quaterniond R(Matrix3d(R_CP * R_DP.transpose()));
  return {R.normalized(), from - R.normalized() * donor.axis(at_mm)};
}

/// Points of the donor's section near a place of its axis.
std::vector<Vector3d> section_points(const Donor& donor, const Plane& plane, double at_mm) {
  const double near_mm = 2 * (donor.height_mm + donor.width_mm);
  std::vector<Vector3d> points;
  for (const auto& line : plane_section(donor.mesh, plane))
    for (const Vector3d& p : line)
      if ((p - donor.axis(at_mm)).norm() < near_mm) points.push_back(p);
  return points;
}

/// Distance between a cut and the next piece's first cut where they are nearest; negative: they
/// cross. Normals along the donor.
double distance_between(const Donor& donor, const Plane& end, double end_mm, const Plane& begin,
                        double begin_mm) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& p : section_points(donor, end, end_mm))
    least = std::min(least, -begin.distance(p));
  for (const Vector3d& p : section_points(donor, begin, begin_mm))
    least = std::min(least, end.distance(p));
  return least;
}

DonorCut donor_cut(const Donor& donor, const Plane& along, double at_mm) {
  const Vector3d x = donor.direction(at_mm), z = Vector3d::UnitZ(), y = z.cross(x);
  const double nx = along.normal.dot(x), ny = along.normal.dot(y), nz = along.normal.dot(z);
  const double to_plane = -along.distance(donor.axis(at_mm)) / nx;
  return {at_mm + to_plane, std::acos(std::clamp(nx, -1., 1.)) * degrees,
          std::atan2(-ny, nx) * degrees, std::atan2(-nz, nx) * degrees};
}

/// Lays the pieces on the donor.
class DonorLayout {
 public:
  DonorLayout(const Donor& donor, const GraftLayout& graft)
      : donor_(donor),
        graft_(graft),
        frames_(piece_frames(graft.corners, graft.defect.up, graft.step.roll_deg)),
        planes_(corner_planes(graft.corners, graft.defect, graft.step.clearance_mm)) {}

  struct Place {
    double at_mm = 0, end_mm = 0;  // of the piece's axis on the donor's
    Pose X_CD;
    Plane begin, end;  // on the donor, normals along it
  };
  Place place(std::size_t piece, double at_mm) const {
    const Vector3d from = graft_.corners[piece];
    const double length = (graft_.corners[piece + 1] - from).norm();
    const Pose X_CD = donor_pose(donor_, frames_[piece], from, length, at_mm);
    const Pose X_DC = X_CD.inverse();
    return {at_mm, donor_.place(X_DC * graft_.corners[piece + 1]), X_CD,
            moved_plane(X_DC, planes_[piece]), moved_plane(X_DC, planes_[piece + 1])};
  }

  /// The place of the first piece: its outermost point lies where the donor may be taken.
  Place first() const {
    double at = donor_.first_mm + 1;
    Place found = place(0, at);
    for (int pass = 0; pass < 20; ++pass) {
      const auto [low, high] = reach(found);
      (void)high;
      at += donor_.first_mm - low;
      found = place(0, at);
      if (std::abs(donor_.first_mm - low) < 1e-6) break;
    }
    return found;
  }

  /// The place of a piece that keeps a distance from the one before it.
  Place after(std::size_t piece, const Place& before, double distance_mm) const {
    double at = before.end_mm + distance_mm;
    Place found = place(piece, at);
    for (int pass = 0; pass < 50; ++pass) {
      const double error = distance_mm - gap(before, found);
      at += error;
      found = place(piece, at);
      if (std::abs(error) < 1e-6) break;
    }
    return found;
  }

  double gap(const Place& before, const Place& place) const {
    return distance_between(donor_, before.end, before.end_mm, place.begin, place.at_mm);
  }

  /// Part of the donor's axis that a piece needs, over its whole section.
  std::pair<double, double> reach(const Place& place) const {
    std::pair<double, double> range{place.at_mm, place.end_mm};
    // Beyond the donor's end no section is left: the tilt of the faces says how far.
    for (const bool second : {false, true}) {
      const Plane& plane = second ? place.end : place.begin;
      const double at = second ? place.end_mm : place.at_mm;
      const Vector3d x = donor_.direction(at), y = Vector3d::UnitZ().cross(x);
      for (const auto& line : plane_section(donor_.mesh, square_plane()))
        for (const Vector3d& p : line) {
          const Vector3d local = p - donor_.axis(0.5 * donor_.length_mm);
          const Vector3d middle_y = Vector3d::UnitZ().cross(donor_.direction(middle()));
          const Vector3d q =
              donor_.axis(at) + local.dot(middle_y) * y + local.z() * Vector3d::UnitZ();
          const double shift = -plane.distance(q) / plane.normal.dot(x);
          range.first = std::min(range.first, at + shift);
          range.second = std::max(range.second, at + shift);
        }
    }
    return range;
  }

  const Plane& plane(std::size_t corner) const { return planes_[corner]; }

 private:
  double middle() const { return 0.5 * donor_.length_mm; }
  Plane square_plane() const {
    return plane_through(donor_.axis(middle()) + 1e-3 * donor_.direction(middle()),
                         donor_.direction(middle()));
  }

  const Donor& donor_;
  const GraftLayout& graft_;
  std::vector<Matrix3d> frames_;
  std::vector<Plane> planes_;
};

/// Cuts a piece from the donor and puts it in place.
GraftPiece cut_piece(const Donor& donor, const DonorLayout::Place& place, const std::string& body) {
  const Vector3d middle = 0.5 * (donor.axis(place.at_mm) + donor.axis(place.end_mm)),
                 x = (donor.axis(place.end_mm) - donor.axis(place.at_mm)).normalized(),
                 z = Vector3d::UnitZ(), y = z.cross(x);
  const double side = 2 * (donor.height_mm + donor.width_mm),
               half = 0.5 * (place.end_mm - place.at_mm) + side;
  std::vector<Plane> reach;
  for (const double sign : {1., -1.}) {
    reach.push_back(plane_through(middle + sign * half * x, sign * x));
    reach.push_back(plane_through(middle + sign * side * y, sign * y));
    reach.push_back(plane_through(middle + sign * side * z, sign * z));
  }
  const std::vector<Cut> cuts = {{"first", Region::above(place.begin, 0), reach, 0},
                                 {"second", Region::above(reversed(place.end), 1), reach, 0}};
  CutResult result = cut_bone(donor.mesh, cuts);
  for (Piece& cut : result.pieces) {  // largest first
    if (cut.sides[0] != CutSide::above || cut.sides[1] != CutSide::above) continue;
    GraftPiece piece{.body = body, .mesh = std::move(cut.mesh), .wall = std::move(cut.wall)};
    for (Vector3d& v : piece.mesh.vertices) v = place.X_CD * v;
    piece.X_CD = place.X_CD;
    piece.faces = {reversed(moved_plane(place.X_CD, place.begin)),
                   moved_plane(place.X_CD, place.end)};
    piece.cuts = {donor_cut(donor, place.begin, place.at_mm),
                  donor_cut(donor, place.end, place.end_mm)};
    piece.start_mm = place.at_mm;
    const Vector3d from = donor.axis(place.at_mm);
    piece.length_mm = -place.end.distance(from) / place.end.normal.dot(x) +
                      place.begin.distance(from) / place.begin.normal.dot(x);
    piece.volume_mm3 = cut.volume_mm3;
    return piece;
  }
  throw InputError(fmt::format("the saw cuts of {} leave nothing of the donor", body));
}

std::vector<DonorLayout::Place> find_places(const Donor& donor, const DonorLayout& layout,
                                            GraftLayout& graft) {
  const GraftStep& step = graft.step;
  std::vector<DonorLayout::Place> places;
  for (std::size_t i = 0; i < static_cast<std::size_t>(step.pieces); ++i) {
    places.push_back(!step.starts_mm.empty() ? layout.place(i, step.starts_mm[i])
                     : i == 0                ? layout.first()
                              : layout.after(i, places.back(), step.kerf_mm + step.spacing_mm));
    const auto [low, high] = layout.reach(places.back());
    graft.donor_from_mm = i == 0 ? low : std::min(graft.donor_from_mm, low);
    graft.donor_to_mm = i == 0 ? high : std::max(graft.donor_to_mm, high);
    if (i == 0) continue;
    const double gap = layout.gap(places[i - 1], places[i]);
    graft.spacing_mm.push_back(gap - step.kerf_mm);
    if (gap < step.kerf_mm - 1e-3)
      throw InputError(
          fmt::format("the saw cuts between {0} and {1} {2} on the donor: at their nearest they "
                      "are {3:.2f} mm apart, and the saw takes {4:g} mm",
                      graft_bodies(step)[i - 1], graft_bodies(step)[i],
                      gap < 0 ? "cross" : "run into each other", gap, step.kerf_mm));
    if (gap - step.kerf_mm > most_spacing_mm + 1e-3)
      graft.warnings.push_back(fmt::format(
          "{:.1f} mm of the donor are lost between {} and {}; 0 to {:g} mm beyond the kerf are "
          "needed",
          gap - step.kerf_mm, graft_bodies(step)[i - 1], graft_bodies(step)[i], most_spacing_mm));
  }
  constexpr double rounding_mm = 1e-3;
  if (graft.donor_from_mm < -rounding_mm || graft.donor_to_mm > donor.length_mm + rounding_mm)
    throw InputError(
        fmt::format("the graft needs the donor from {:.1f} to {:.1f} mm; {} has only "
                    "0 to {:.1f} mm",
                    graft.donor_from_mm, graft.donor_to_mm, donor.name, donor.length_mm));
  if (graft.donor_from_mm < donor.first_mm - rounding_mm ||
      graft.donor_to_mm > donor.last_mm + rounding_mm)
    graft.warnings.push_back(fmt::format(
        "the graft takes the donor from {:.1f} to {:.1f} mm; {:g} to {:g} mm may be taken: {}",
        graft.donor_from_mm, graft.donor_to_mm, donor.first_mm, donor.last_mm, donor.kept));
  return places;
}

/// Refuses a graft whose end runs beside a face: its cut would be too long and too sharp.
void check_ends(const GraftLayout& graft) {
  constexpr double least_cosine = 0.34;  // 70 degrees off square
  const auto& corners = graft.corners;
  const Vector3d first = (corners[1] - corners[0]).normalized(),
                 last = (corners[corners.size() - 2] - corners.back()).normalized();
  const auto& faces = graft.defect.faces;
  for (const bool second : {false, true})
    if (const double cosine = (second ? last : first).dot(faces[second].normal);
        cosine < least_cosine)
      throw InputError(fmt::format(
          "the graft runs {:.0f} degrees off the {} face of the defect; more pieces or another "
          "curve bring it nearer to square",
          std::acos(std::clamp(cosine, -1., 1.)) * degrees, second ? "second" : "first"));
}

/// Refuses a gap that the clearances fill, and bone thinner than the saw.
void check_room(const GraftLayout& graft, const Donor& donor) {
  const GraftStep& step = graft.step;
  const auto& faces = graft.defect.faces;
  const double gap = (faces[1].point - faces[0].point).norm();
  if (gap <= 2 * step.clearance_mm)
    throw InputError(fmt::format(
        "the gap is {:.1f} mm wide; {:g} mm of clearance at both ends leave no room for a graft",
        gap, step.clearance_mm));
  if (const double thin = std::min(donor.height_mm, donor.width_mm); thin <= step.kerf_mm)
    throw InputError(fmt::format("{} is {:.2f} mm thick, no thicker than the saw of {:g} mm",
                                 donor.name, thin, step.kerf_mm));
}

void check_length(const GraftPiece& piece, const GraftStep& step) {
  if (piece.length_mm <= step.kerf_mm)
    throw InputError(fmt::format(
        "{} would be {:.2f} mm long, no longer than the saw of {:g} mm is thick; the gap is too "
        "small for {} piece{}",
        piece.body, piece.length_mm, step.kerf_mm, step.pieces, step.pieces == 1 ? "" : "s"));
}

}  // namespace

GraftLayout lay_graft(const GraftStep& step, const TriMesh& resected, const Defect& defect) {
  const Donor donor = make_donor(step);
  GraftLayout graft{.step = step, .defect = defect};
  check_room(graft, donor);
  graft.curve = step.curve.empty()
                    ? border_curve(resected, defect, step.height_mm.value_or(donor.height_mm / 2))
                    : curve_between(step.curve, defect);
  graft.corners = corners_on_curve(graft.curve, step.pieces, least_piece_mm);
  graft.curve_deviation_mm = deviation_of(graft.corners, graft.curve);
  check_ends(graft);
  const DonorLayout layout(donor, graft);
  const auto places = find_places(donor, layout, graft);
  const auto bodies = graft_bodies(step);
  for (std::size_t i = 0; i < places.size(); ++i) {
    graft.pieces.push_back(cut_piece(donor, places[i], bodies[i]));
    check_length(graft.pieces.back(), step);
    if (const double length = graft.pieces.back().length_mm; length < least_piece_mm)
      graft.warnings.push_back(
          fmt::format("{} is {:.1f} mm long; pieces below {:g} mm may lose "
                      "their blood supply",
                      bodies[i], length, least_piece_mm));
  }
  return graft;
}

}  // namespace condyle
