#include "sim/dental_scan/scanned_arches.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "sim/case/tooth_labels.h"
#include "sim/dental_scan/carried_crowns.h"
#include "sim/dental_scan/close_scan.h"
#include "sim/occlusion/arches.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double unlike_arch_mm = 2.5;      // mean distance of an arch from another person's
constexpr double exchanged_fraction = 0.8;  // of the distance that the other arch's may be below
constexpr double tooth_reach_mm = 1.5;      // of a crown of the case from the scanned one

TriMesh moved(TriMesh mesh, const Pose& X) {
  for (auto& v : mesh.vertices) v = X * v;
  return mesh;
}

/// The crowns that a scan is registered to. throws: InputError.
const Part& crowns_of(const Case& patient, bool upper) {
  const BodyId body = upper ? patient.jaw.upper_arch : patient.jaw.lower_arch;
  const Part* teeth = patient.find(upper ? Role::upper_teeth : Role::lower_teeth, body);
  if (!teeth || teeth->mesh.empty())
    throw InputError(
        fmt::format("the case has no {0} teeth to register a scan to; import them with "
                    "--{0}-teeth, or make the case from a CT",
                    upper ? "upper" : "lower"));
  return *teeth;
}

/// The closed scan in the place of a part.
Part scanned_part(const DentalScan& scan, const Pose& X_CS, const ArchTarget& target,
                  const Part& before, std::vector<std::string>& notes) {
  const ClosedScan closed = close_scan(moved(scan.mesh, X_CS), -target.bite());
  Part part = with_tooth_labels(closed.mesh, before, tooth_reach_mm);
  notes.push_back(fmt::format(
      "{}: {} triangles of {}, {} hole{} closed, {} rim{} continued downward by 4 mm{}; {} teeth "
      "have a number",
      part.name, part.mesh.triangles.size(), scan.source, closed.holes,
      closed.holes == 1 ? "" : "s", closed.skirts, closed.skirts == 1 ? "" : "s",
      closed.closed ? ", closed" : ", still open at some edges", part.teeth.size()));
  return part;
}

/// Registration of one or both scans to the crowns of a case.
class ArchRegistration {
 public:
  ArchRegistration(const Case& patient, const ScannedArchesRequest& request)
      : patient_(patient), request_(request) {
    if (!request.upper && !request.lower)
      throw InputError("no dental scan is given; name one with --upper or --lower");
    for (const bool upper : {false, true})
      if (scan(upper))
        target_[upper].emplace(crowns_of(patient, upper));
      else if (const Part* other = patient.find(upper ? Role::upper_teeth : Role::lower_teeth))
        if (!other->mesh.empty()) target_[upper].emplace(*other);
  }

  const std::optional<DentalScan>& scan(bool upper) const {
    return upper ? request_.upper : request_.lower;
  }
  const ArchTarget& target(bool upper) const { return *target_[upper]; }

  ArchFit fit(bool upper, bool mirror_test = true) const {
    ArchFitRequest asked;
    asked.mirror_test = mirror_test;
    asked.picks = upper ? request_.upper_picks : request_.lower_picks;
    asked.landmarks = patient_.landmarks;
    asked.opposing = target_[!upper] ? &*target_[!upper] : nullptr;
    asked.threads = request_.threads;
    return fit_arch(*scan(upper), target(upper), asked);
  }

 private:
  const Case& patient_;
  const ScannedArchesRequest& request_;
  std::optional<ArchTarget> target_[2];  // lower, upper
};

void fit_scans(const ArchRegistration& registration, bool accept, int threads, ScannedArches& made,
               const Progress& progress) {
  for (const bool upper : {true, false}) {
    if (!registration.scan(upper)) continue;
    report(progress, upper ? "registering the upper arch" : "registering the lower arch",
           upper ? 0.1 : 0.5);
    const ArchFit fit = registration.fit(upper);
    if (const auto why =
            refusal(fit, *registration.scan(upper), registration.target(upper), accept);
        !why.empty())
      throw InputError(why);
    ArchFit& kept = (upper ? made.upper : made.lower).emplace(fit);
    kept.residual_mm =
        crown_distances(*registration.scan(upper), registration.target(upper), fit.X_CS, threads);
  }
}

/// What became of a bone that reaches the crowns of a scan.
std::string trimming_note(const Part& bone, const BoneWithoutCrowns& rest, bool stays,
                          const std::string& scan) {
  if (rest.open_edges > 0)
    return fmt::format(
        "{}: it reaches the crowns of {}, but its surface is open at {} edges: the crowns that it "
        "carries stay",
        bone.name, scan, rest.open_edges);
  if (rest.inside_out)
    return fmt::format(
        "{}: it reaches the crowns of {}, but its triangles face inward: the crowns that it "
        "carries stay",
        bone.name, scan);
  if (stays)
    return fmt::format(
        "{}: all of it lies at the crowns of {}; it is the arch's only bone, and stays", bone.name,
        scan);
  if (rest.mesh.empty())
    return fmt::format("{}: all of it lay at the crowns of {}, and was removed", bone.name, scan);
  return fmt::format("{}: {:.3g} mm3 at the crowns of {} were removed", bone.name, rest.removed_mm3,
                     scan);
}

/// Removes the crowns that the bones of an arch carry besides its teeth.
std::vector<TrimmedBone> trim_bones(Case& patient, const DentalScan& scan, const Pose& X_CS,
                                    const Part& before, const Vector3d& bite,
                                    std::vector<std::string>& notes) {
  std::vector<TrimmedBone> bones;
  const TriMesh crowns = moved(scan.mesh, X_CS);
  const auto is_bone = [body = before.body](const Part& part) {
    return part.body == body && !is_teeth(part.role) && collides(part.role);
  };
  auto left = std::count_if(patient.parts.begin(), patient.parts.end(), is_bone);
  for (Part& part : patient.parts) {
    if (!is_bone(part)) continue;
    BoneWithoutCrowns rest = without_carried_crowns(part.mesh, {crowns, before.mesh, bite});
    if (rest.open_edges == 0 && !rest.inside_out && rest.removed_mm3 <= 0) continue;
    const bool stays = rest.mesh.empty() && left == 1;
    notes.push_back(trimming_note(part, rest, stays, scan.source));
    bones.push_back({part.name, stays ? 0 : rest.removed_mm3, rest.open_edges});
    if (stays) continue;
    if (rest.mesh.empty()) --left;
    part.mesh = std::move(rest.mesh);
  }
  std::erase_if(patient.parts,
                [&](const Part& part) { return is_bone(part) && part.mesh.empty(); });
  return bones;
}

}  // namespace

ScannedArches with_scanned_arches(Case patient, const ScannedArchesRequest& request,
                                  const Progress& progress) {
  ScannedArches made;
  const ArchRegistration registration(patient, request);
  fit_scans(registration, request.accept_residual, request.threads, made, progress);
  std::vector<std::string> notes;
  for (const bool upper : {true, false})
    if (const auto& fit = upper ? made.upper : made.lower)
      for (auto& note : fit_notes(*fit, *registration.scan(upper), registration.target(upper)))
        notes.push_back(std::move(note));
  report(progress, "bite", 0.9);
  if (made.upper && made.lower) {
    made.together = scanned_bite(request.upper->mesh, request.lower->mesh, made.upper->X_CS,
                                 registration.target(true).marks()[0].x());
    if (made.together->in_occlusion) {
      made.bite = bite_error(*made.upper, *made.lower, registration.target(false));
      patient.X_CM_bite = made.bite->X_CM;
      notes.push_back(fmt::format(
          "the scans lie in occlusion ({} places left, {} right): the lower arch, registered by "
          "itself, lies {:.2f} mm and {:.2f} degrees from where the upper one carries it; the "
          "scanned bite is stored, and occlude starts from it",
          made.together->left, made.together->right, made.bite->largest_mm,
          made.bite->rotation_deg));
    } else {
      notes.push_back("the scans do not lie in occlusion in one frame (" + made.together->why +
                      "): they hold no bite");
    }
  }
  report(progress, "closing the scans", 0.95);
  for (const bool upper : {true, false}) {
    const auto& fit = upper ? made.upper : made.lower;
    if (!fit) continue;
    (upper ? made.upper_bones : made.lower_bones) =
        trim_bones(patient, *registration.scan(upper), fit->X_CS, crowns_of(patient, upper),
                   registration.target(upper).bite(), notes);
    for (Part& part : patient.parts)
      if (&part == &crowns_of(patient, upper))
        part = scanned_part(*registration.scan(upper), fit->X_CS, registration.target(upper),
                            Part(part), notes);
  }
  patient.notes.insert(patient.notes.end(), notes.begin(), notes.end());
  made.notes = std::move(notes);
  made.patient = std::move(patient);
  return made;
}

namespace {

/// The crowns of an arch lie where its scan is; nothing but the scan is known of it.
Part lone_part(const DentalScan& scan, const Pose& X_CS, const ArchTarget& target,
               std::vector<std::string>& notes) {
  Part unlabelled;
  unlabelled.role = target.upper() ? Role::upper_teeth : Role::lower_teeth;
  unlabelled.name = role_name(unlabelled.role);
  unlabelled.body = default_body(unlabelled.role);
  return scanned_part(scan, X_CS, target, unlabelled, notes);
}

/// Condyles of an average jaw: an equilateral triangle with the lower incisal edge, inclined to the
/// occlusal plane. source: Bonwill 1885, Balkwill 1866
void add_average_condyles(Case& patient, std::vector<std::string>& notes) {
  constexpr double bonwill_mm = 110, balkwill_rad = 22 * std::numbers::pi / 180;
  const Arches arches = find_arches(patient);
  patient.landmarks.points["upper_incisal_point"] = arches.upper.edge;
  patient.landmarks.points["lower_incisal_point"] = arches.lower.edge;
  const Vector3d middle = arches.lower.edge + 0.5 * std::sqrt(3.0) * bonwill_mm *
                                                  (std::sin(balkwill_rad) * arches.up -
                                                   std::cos(balkwill_rad) * arches.front);
  patient.landmarks.points["left_condyle"] = middle + 0.5 * bonwill_mm * arches.left;
  patient.landmarks.points["right_condyle"] = middle - 0.5 * bonwill_mm * arches.left;
  notes.push_back(
      "the condyles are those of an average jaw: Bonwill's triangle of 110 mm, 22 degrees to the "
      "occlusal plane (Balkwill)");
}

/// Refuses surfaces that resemble no arch, and arches that are exchanged.
void check_lone_fits(const ScannedArches& made, const ScannedArchesRequest& request) {
  double own = 0, exchanged = 0;
  for (const bool upper : {true, false}) {
    const auto& fit = upper ? made.upper : made.lower;
    if (!fit) continue;
    const DentalScan& scan = upper ? *request.upper : *request.lower;
    own += fit->mean_mm;
    exchanged += fit->exchanged_mm.value_or(fit->mean_mm);
    if (fit->mean_mm > unlike_arch_mm && !request.accept_residual)
      throw InputError(fmt::format(
          "{} does not resemble an arch of teeth: it lies {:.1f} mm from the built-in patient's at "
          "best; if it is one, use --accept",
          scan.source, fit->mean_mm));
  }
  if (exchanged < exchanged_fraction * own && !request.accept_residual)
    throw InputError(fmt::format(
        "the arches seem to be exchanged: {} the built-in patient's opposing arch better ({:.2f} "
        "against {:.2f} mm); if they are not, use --accept",
        request.upper && request.lower
            ? "the scans resemble"
            : (request.upper ? request.upper : request.lower)->source + " resembles",
        exchanged, own));
}

}  // namespace

ScannedArches case_of_scanned_arches(const ScannedArchesRequest& request, const Case& model,
                                     const Progress& progress) {
  ScannedArches made;
  const ArchRegistration registration(model, request);
  for (const bool upper : {true, false}) {
    if (!registration.scan(upper)) continue;
    report(progress, upper ? "turning the upper arch" : "turning the lower arch",
           upper ? 0.1 : 0.5);
    (upper ? made.upper : made.lower) = registration.fit(upper, false);
  }
  check_lone_fits(made, request);
  Case& patient = made.patient;
  const bool both = made.upper && made.lower;
  Pose X_upper = made.upper ? made.upper->X_CS : Pose{};
  Pose X_lower = made.lower ? made.lower->X_CS : Pose{};
  for (const auto* scan : {&request.upper, &request.lower})
    if (*scan) made.notes.insert(made.notes.end(), (*scan)->notes.begin(), (*scan)->notes.end());
  if (both) {
    made.together = scanned_bite(request.upper->mesh, request.lower->mesh, X_upper,
                                 registration.target(true).marks()[0].x());
    if (made.together->in_occlusion) {
      X_lower = X_upper;
      patient.X_CM_bite = Pose{};
      made.notes.push_back(
          fmt::format("the scans lie in occlusion ({} places left, {} right) and stay in it",
                      made.together->left, made.together->right));
    } else {
      made.notes.push_back("the scans do not lie in occlusion in one frame (" + made.together->why +
                           "): they lie as the built-in patient's arches do; occlude finds a bite");
    }
  }
  report(progress, "closing the scans", 0.9);
  if (request.upper)
    patient.parts.push_back(
        lone_part(*request.upper, X_upper, registration.target(true), made.notes));
  if (request.lower)
    patient.parts.push_back(
        lone_part(*request.lower, X_lower, registration.target(false), made.notes));
  if (both) add_average_condyles(patient, made.notes);
  patient.scan_opening_mm = 0;
  patient.notes = made.notes;
  return made;
}

}  // namespace condyle
