// From a virtual CT of a head to a case: surfaces, landmarks and motion of the patient it was made
// from.
#include "sim/ct_case/ct_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/phantom/phantom.h"
#include "sim/scanner/ct_scan.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double voxel_mm = 1.2;
const HeadChoice& scanned_choice() {
  static const HeadChoice choice = [] {
    HeadChoice other;
    other.seed = 4;
    return other;
  }();
  return choice;
}

CtScan scan_of_head() {
  CtSettings settings;
  settings.spacing_mm = Vector3d::Constant(voxel_mm);
  settings.noise_hu = 30;
  settings.threads = 2;
  return scan_ct(ScannedHead(scanned_choice()), settings);
}

const CtCase& imported() {
  static const CtCase made = case_of_ct(scan_of_head().volume, builtin_patient(), {.name = "scan"});
  return made;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

TEST(CtCase, HasClosedBonesTeethAndFace) {
  const Case& patient = imported().patient;
  EXPECT_EQ(patient.name, "scan");
  for (const Role role :
       {Role::skull, Role::mandible, Role::upper_teeth, Role::lower_teeth, Role::face}) {
    const Part* part = patient.find(role);
    ASSERT_TRUE(part) << static_cast<int>(role);
    const Topology found = inspect(part->mesh);
    EXPECT_TRUE(found.closed()) << part->name;
    EXPECT_GT(found.volume_mm3, 0) << part->name;
    EXPECT_EQ(part->body, default_body(role));
    if (is_teeth(role)) {
      EXPECT_GE(part->teeth.size(), 12u) << part->name;
    }
  }
}

TEST(CtCase, JawLiesWhereItWasScanned) {
  const ScannedHead head(scanned_choice());
  std::vector<double> errors;
  const Part& jaw = *imported().patient.find(Role::mandible);
  for (const Vector3d& v : jaw.mesh.vertices) errors.push_back(std::abs(head.lower_bone(v)));
  EXPECT_LT(quantile(errors, 0.5), 0.3);
  EXPECT_LT(quantile(errors, 0.9), 0.5 * voxel_mm);
  std::vector<double> of_face;
  for (const Vector3d& v : imported().patient.find(Role::face)->mesh.vertices)
    if (v.z() > -90 && v.y() < 0) of_face.push_back(std::abs(head.skin(v)));
  EXPECT_LT(quantile(of_face, 0.5), 0.3);
}

TEST(CtCase, ProposesTheLandmarks) {
  const Case truth = builtin_patient(scanned_choice());
  std::vector<double> errors;
  for (const auto& [name, mark] : imported().fit.landmarks) {
    const auto at = truth.landmarks.find(name);
    if (!at || mark.outside_scan) continue;
    errors.push_back((mark.point - *at).norm());
    if (!mark.doubtful) {
      EXPECT_LT(errors.back(), 8) << name;
    }
  }
  ASSERT_GT(errors.size(), 60u);
  EXPECT_LT(quantile(errors, 0.5), 1.5);
  EXPECT_LT(quantile(errors, 0.9), 5);
}

TEST(CtCase, ThickVoxelsKeepTheMouthAndTheBite) {
  CtSettings settings;
  settings.spacing_mm = Vector3d::Constant(1.5);
  settings.noise_hu = 40;
  settings.threads = 2;
  const CtCase made =
      case_of_ct(scan_ct(ScannedHead(), settings).volume, builtin_patient(), {.name = "scan"});
  const Case truth = builtin_patient();
  for (const char* name : {"stomion", "left_cheilion", "right_cheilion"})
    EXPECT_LT((made.fit.landmarks.at(name).point - *truth.landmarks.find(name)).norm(), 2) << name;
  // Crowns that touch in the scan are not deep in each other.
  ASSERT_TRUE(made.patient.find(Role::upper_teeth) && made.patient.find(Role::lower_teeth));
  const TriangleTree upper(made.patient.find(Role::upper_teeth)->mesh);
  double deepest = 0;
  for (const Vector3d& v : made.patient.find(Role::lower_teeth)->mesh.vertices)
    deepest = std::min(deepest, upper.signed_distance(v));
  EXPECT_GT(deepest, -0.3);
  // Its voxels are too large for the joints: there is a disc all the same, with a note.
  ASSERT_TRUE(made.patient.motion.disc_gap_front_mm);
  EXPECT_GE(*made.patient.motion.disc_gap_front_mm, 1);
  EXPECT_LE(*made.patient.motion.disc_gap_front_mm, 1.3);
  EXPECT_TRUE(std::any_of(made.patient.notes.begin(), made.patient.notes.end(), [](const auto& n) {
    return n.find("less than a voxel") != std::string::npos;
  }));
}

TEST(CtCase, SeedsMustLieInBone) {
  const Volume air = [] {
    Volume volume;
    volume.size = {40, 40, 40};
    volume.spacing_mm = Vector3d::Constant(4);
    volume.values.assign(64000, -1000);
    return volume;
  }();
  EXPECT_THROW(case_of_ct(air, builtin_patient(), {.source = "air.nrrd"}), InputError);
}

}  // namespace
}  // namespace condyle
