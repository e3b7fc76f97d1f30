#include "sim/case/import_muscles.h"

#include <fmt/format.h>

#include "engine/core/error.h"
#include "sim/case/muscle_table.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Temple and sternum lie outside the jaws.
constexpr double margin_mm = 150;

void check_near(const std::filesystem::path& file, const std::string& what, const Vector3d& p,
                const Box& box) {
  if (box.contains(p, margin_mm)) return;
  throw InputError(
      file, what,
      fmt::format("({:.0f}, {:.0f}, {:.0f}) mm lies more than {} mm from the surfaces: "
                  "check its unit (mm), frame and patient",
                  p.x(), p.y(), p.z(), margin_mm));
}

void turn(BoneMechanics& bone, const Matrix3d& axes) {
  bone.center = axes * bone.center;
  bone.inertia = axes * bone.inertia * axes.transpose();
}

}  // namespace

void import_muscles(const ImportRequest& request, const Box& box, Case& patient) {
  const Matrix3d& axes = request.source.axes_to_lps;
  if (!request.muscles.empty()) {
    patient.muscles = read_muscles(request.muscles, patient.notes);
    for (Muscle& muscle : patient.muscles) {
      muscle.origin = axes * muscle.origin;
      muscle.insertion = axes * muscle.insertion;
      for (const Vector3d& p : {muscle.origin, muscle.insertion})
        check_near(request.muscles, muscle.name, p, box);
    }
    patient.notes.push_back(fmt::format("muscles: {} from {}", patient.muscles.size(),
                                        request.muscles.filename().string()));
  }
  if (!request.mechanics.empty()) {
    patient.mechanics = read_mechanics(request.mechanics);
    turn(patient.mechanics->mandible, axes);
    check_near(request.mechanics, "jaw.com_mm", patient.mechanics->mandible.center, box);
    if (patient.mechanics->hyoid) turn(*patient.mechanics->hyoid, axes);
  }
}

}  // namespace condyle
