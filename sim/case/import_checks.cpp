#include "sim/case/import_checks.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/case/source_frame.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double min_head_mm = 40, max_head_mm = 600;

/// "0.2 mm", "200 m": a length in a readable unit.
std::string length_text(double mm) {
  if (mm >= 10'000) return fmt::format("{:.0f} m", mm / 1000);
  return mm >= 10 ? fmt::format("{:.0f} mm", mm) : fmt::format("{:.2g} mm", mm);
}

/// Orientation of the mandible from its shape alone: the chin crosses the midline; the rami are
/// apart at the sides and reach highest.
bool lies_as_lps(const TriMesh& mandible) {
  const Box box = bounding_box(mandible);
  const Vector3d size = box.size();
  int front = 0, back = 0;
  for (const auto& p : midline_points(mandible, box.center().x(), 0.1 * size.x())) {
    front += p.y() < box.low.y() + 0.3 * size.y();
    back += p.y() > box.high.y() - 0.3 * size.y();
  }
  int tops = 0, bottoms = 0;
  double top_y = 0, bottom_y = 0;
  for (const auto& p : mandible.vertices) {
    if (p.z() > box.high.z() - 0.15 * size.z()) top_y += p.y(), ++tops;
    if (p.z() < box.low.z() + 0.15 * size.z()) bottom_y += p.y(), ++bottoms;
  }
  return front > 0 && back == 0 && top_y / tops > bottom_y / bottoms;
}

struct JawPoints {
  std::optional<Vector3d> left_condyle, right_condyle, incisal;
};

JawPoints jaw_points(const Landmarks& landmarks) {
  return {landmarks.find("left_condyle"), landmarks.find("right_condyle"),
          landmarks.find("lower_incisal_point")};
}

/// What contradicts LPS in the jaw's landmarks; empty if nothing does.
std::string contradiction(const JawPoints& jaw) {
  if (jaw.left_condyle && jaw.right_condyle && jaw.left_condyle->x() <= jaw.right_condyle->x())
    return fmt::format(
        "the left condyle (x = {:.1f}) is to the right of the right one (x = {:.1f})",
        jaw.left_condyle->x(), jaw.right_condyle->x());
  for (const auto& [side, condyle] :
       {std::pair("left", jaw.left_condyle), std::pair("right", jaw.right_condyle)}) {
    if (!condyle || !jaw.incisal) continue;
    if (condyle->y() <= jaw.incisal->y())
      return fmt::format(
          "the {} condyle (y = {:.1f}) is in front of the incisal point (y = {:.1f})", side,
          condyle->y(), jaw.incisal->y());
    if (condyle->z() <= jaw.incisal->z())
      return fmt::format("the {} condyle (z = {:.1f}) is below the incisal point (z = {:.1f})",
                         side, condyle->z(), jaw.incisal->z());
  }
  return "";
}

/// The first common frame in which mandible and landmarks would be oriented correctly.
std::string fitting_frame(const TriMesh& mandible, const JawPoints& jaw,
                          const ImportRequest& request) {
  const Eigen::Matrix3d back = request.source.axes_to_lps.transpose();
  for (const auto& frame : all_frames()) {
    const Eigen::Matrix3d turn = source_frame("mm", frame).axes_to_lps * back;
    TriMesh lying = mandible;
    for (auto& v : lying.vertices) v = turn * v;
    JawPoints turned;
    if (jaw.left_condyle) turned.left_condyle = turn * *jaw.left_condyle;
    if (jaw.right_condyle) turned.right_condyle = turn * *jaw.right_condyle;
    if (jaw.incisal) turned.incisal = turn * *jaw.incisal;
    if (lies_as_lps(lying) && contradiction(turned).empty()) return frame;
  }
  return "";
}

}  // namespace

void check_size(const Box& box, const ImportRequest& request) {
  const double size = box.size().maxCoeff();
  if (size >= min_head_mm && size <= max_head_mm) return;
  std::string fits;
  for (const auto& units :
       all_units()) {  // the common ones first; inches only where nothing else fits
    const double other = size / request.source.unit_mm * unit_mm(units);
    if (other < min_head_mm || other > max_head_mm) continue;
    fits = units;
    break;
  }
  throw InputError(
      request.files.front().file, "",
      fmt::format("the patient is {} wide with --units {}; a head is 100 to 300 mm: {}",
                  length_text(size), request.source.units,
                  fits.empty() ? "no unit fits, so check which file this is"
                               : "did you mean --units " + fits + "?"));
}

void check_frame(const Case& patient, const ImportRequest& request) {
  const Part* mandible = patient.find(Role::mandible);
  if (!mandible) return;
  const JawPoints jaw = jaw_points(patient.landmarks);
  std::string problem = contradiction(jaw);
  if (problem.empty()) {
    // check_jaw_order refuses exchanged jaws.
    for (const auto& part : patient.parts)
      if ((part.role == Role::maxilla || part.role == Role::skull) && lies_as_lps(part.mesh) &&
          !lies_as_lps(mandible->mesh))
        return;
    // One point on each side proves the frame; the shape is used only without landmarks.
    const bool proved = jaw.incisal && (jaw.left_condyle || jaw.right_condyle);
    if (proved || lies_as_lps(mandible->mesh)) return;
    problem = "the mandible's rami are not behind and above its chin";
  }
  const std::string fits = fitting_frame(mandible->mesh, jaw, request);
  // A piece of a mandible has no such shape in any frame.
  if (fits.empty() && contradiction(jaw).empty()) return;
  throw InputError(request.files.front().file, "",
                   fmt::format("with --frame {} {}: the axes or the landmarks are wrong; {}",
                               request.source.axes, problem,
                               fits.empty() || fits == request.source.axes
                                   ? "check the directions of x, y and z of the files"
                                   : "did you mean --frame " + fits + "?"));
}

void check_landmarks(const Case& patient, const ImportRequest& request) {
  constexpr double far_mm = 40;
  const Part* mandible = patient.find(Role::mandible);
  if (!mandible) return;
  const TriangleTree tree(mandible->mesh);
  double nearest = std::numeric_limits<double>::infinity();
  std::string named;
  for (const char* name : {"left_condyle", "right_condyle", "lower_incisal_point"}) {
    const auto point = patient.landmarks.find(name);
    if (!point) continue;
    nearest = std::min(nearest, tree.nearest(*point).distance);
    named += (named.empty() ? "" : ", ") + std::string(name);
  }
  if (named.empty() || nearest <= far_mm) return;
  throw InputError(request.landmarks, named,
                   "at least " + std::to_string(static_cast<int>(nearest)) +
                       " mm from the mandible: the landmarks of another patient, or of another "
                       "unit or frame? Give the ones that belong to these surfaces");
}

}  // namespace condyle
