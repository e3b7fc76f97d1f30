// Landmarks found on heads that are not the built-in patient, and surfaces that are no heads.
#include "sim/anatomy_fit/anatomy_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/phantom/phantom.h"
#include "tests/support/places.h"
#include "tools/bench/baseline/head_surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const Case& model() {
  static const Case patient = builtin_patient();
  return patient;
}

struct Errors {
  double median = 0, p95 = 0, worst = 0;  // of those that are not doubtful
  int sure = 0, doubtful = 0;
};

Errors errors_of(const AnatomyFit& fit, const HeadSurfaces& head) {
  Errors errors;
  std::vector<double> all;
  for (const auto& [name, mark] : fit.landmarks) {
    if (mark.doubtful)
      ++errors.doubtful;
    else
      all.push_back((mark.point - head.truth.at(name)).norm());
  }
  std::sort(all.begin(), all.end());
  errors.sure = static_cast<int>(all.size());
  if (all.empty()) return errors;
  errors.median = all[all.size() / 2];
  errors.p95 = all[all.size() * 95 / 100];
  errors.worst = all.back();
  return errors;
}

void expect_goals(const Errors& errors) {
  EXPECT_LT(errors.median, 1.0);
  EXPECT_LT(errors.p95, 4.0);
  EXPECT_LT(errors.worst, 8.0);
}

/// A closed surface around the origin; `stretch` of each direction.
TriMesh blob(const Vector3d& radii, double (*stretch)(const Vector3d&)) {
  constexpr int around = 120, down = 60;
  TriMesh mesh;
  for (int i = 0; i <= down; ++i)
    for (int j = 0; j < around; ++j) {
      const double a = M_PI * i / down, b = 2 * M_PI * j / around;
      const Vector3d d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.vertices.push_back(stretch(d) * radii.cwiseProduct(d));
    }
  for (int i = 0; i < down; ++i)
    for (int j = 0; j < around; ++j) {
      const int p = i * around + j, q = i * around + (j + 1) % around;
      mesh.triangles.emplace_back(p, p + around, q);
      mesh.triangles.emplace_back(q, p + around, q + around);
    }
  return mesh;
}

std::string refusal(const AnatomyScan& scan) {
  try {
    fit_anatomy(scan, model());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(AnatomyFit, FindsLandmarksOfBoneAndSkinThatAreNotSeparated) {
  const HeadSurfaces head = scanned_head(model(), HeadPopulation::warped, 1);
  AnatomyScan scan;
  scan.bone = head.bone();
  scan.skin = head.skin;
  const AnatomyFit fit = fit_anatomy(scan, model());
  EXPECT_EQ(fit.frame, ScanFrame::lps);
  EXPECT_TRUE(fit.skull.present && fit.mandible.present && fit.skin.present);
  EXPECT_LT(fit.skull.rms_mm, 0.5);  // the noise is 0.15 mm a component
  EXPECT_EQ(fit.landmarks.size(), model().landmarks.points.size());
  const Errors errors = errors_of(fit, head);
  EXPECT_GT(errors.sure, 120);
  expect_goals(errors);
  ASSERT_TRUE(fit.find(Role::mandible));
  EXPECT_EQ(fit.find(Role::mandible)->part.mesh.vertices.size(),
            model().find(Role::mandible)->mesh.vertices.size());
  EXPECT_EQ(fit.canals.size(), model().canals.size());
}

TEST(AnatomyFit, MarksWhatAScanFromTheTeethToTheOrbitsLacks) {
  const HeadSurfaces head = scanned_head(model(), HeadPopulation::warped, 2);
  AnatomyScan scan;
  scan.bone = scanned_between(head.bone(), head, -70, 45);
  const AnatomyFit fit = fit_anatomy(scan, model());
  expect_goals(errors_of(fit, head));
  for (const char* name : {"vertex", "menton"}) {
    const ProposedLandmark& mark = fit.landmarks.at(name);
    EXPECT_TRUE(mark.doubtful && mark.outside_scan) << name;
    EXPECT_NE(mark.reason, "");
  }
  EXPECT_FALSE(fit.landmarks.at("nasion").doubtful);
}

TEST(AnatomyFit, FindsAJawByItselfWithTheSameBitsOnAnyNumberOfThreads) {
  const HeadSurfaces head = scanned_head(model(), HeadPopulation::seeded, 3);
  AnatomyScan scan;
  scan.mandible = head.mandible;
  const AnatomyFit fit = fit_anatomy(scan, model(), {.threads = 2}),
                   other = fit_anatomy(scan, model(), {.threads = 1});
  EXPECT_FALSE(fit.skull.present);
  EXPECT_EQ(fit.landmarks.count("nasion"), 0u);
  EXPECT_GT(errors_of(fit, head).sure, 20);
  expect_goals(errors_of(fit, head));
  EXPECT_EQ(mesh_hash(fit.parts[0].part.mesh), mesh_hash(other.parts[0].part.mesh));
  for (const auto& [name, mark] : fit.landmarks)
    EXPECT_EQ(mark.point, other.landmarks.at(name).point) << name;
}

TEST(AnatomyFit, ASkullWithoutAJawHasNoLandmarksOfAJaw) {
  const HeadSurfaces head = scanned_head(model(), HeadPopulation::seeded, 4);
  AnatomyScan scan;
  scan.bone = head.skull;
  // RAS coordinates: turned about the vertical axis.
  for (auto& v : scan.bone.vertices) v = {-v.x(), -v.y(), v.z()};
  const AnatomyFit fit = fit_anatomy(scan, model());
  EXPECT_FALSE(fit.mandible.present);
  EXPECT_EQ(fit.landmarks.count("menton"), 0u);
  EXPECT_EQ(fit.frame, ScanFrame::face_behind);
  ASSERT_FALSE(fit.notes.empty());
  EXPECT_NE(fit.notes[0].find("RAS"), std::string::npos);
  const Vector3d nasion = fit.landmarks.at("nasion").point, truth = head.truth.at("nasion");
  EXPECT_LT((nasion - Vector3d(-truth.x(), -truth.y(), truth.z())).norm(), 4);
}

TEST(AnatomyFit, RefusesWhatIsNoHead) {
  AnatomyScan scan;
  scan.source = "scan.ply";
  EXPECT_NE(refusal(scan).find("scan.ply: has no bone"), std::string::npos);
  scan.bone = blob({90, 90, 90}, [](const Vector3d&) { return 1.0; });
  EXPECT_NE(refusal(scan).find("no skull and no lower jaw"), std::string::npos);
  scan.bone = blob({45, 130, 40}, [](const Vector3d& d) {  // heel, ankle, toes
    return 1 + 0.25 * std::sin(3 * d.y()) + (d.y() < -0.5 ? 0.1 * std::sin(9 * d.x()) : 0);
  });
  EXPECT_NE(refusal(scan).find("no skull and no lower jaw"), std::string::npos);
}

TEST(AnatomyFit, RefusesAMirroredSurface) {
  AnatomyScan scan;
  scan.source = "scan.ply";
  scan.bone = scanned_head(model(), HeadPopulation::seeded, 5).mandible;
  for (auto& v : scan.bone.vertices) v.x() = -v.x();
  EXPECT_NE(refusal(scan).find("left and right are exchanged"), std::string::npos);
}

TEST(AnatomyFit, FindsPointsThatWereDigitisedOnRealJaws) {
  const auto data = test::source_folder() / "../shared/data";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "real anatomy absent";
  const auto check = [&](const std::string& folder, TriMesh AnatomyScan::*as,
                         const std::vector<std::string>& files,
                         const std::map<std::string, Vector3d>& known, double farthest_mm) {
    AnatomyScan scan;
    for (const auto& file : files) {
      const TriMesh mesh = read_mesh(data / folder / file);
      const auto first = static_cast<int>((scan.*as).vertices.size());
      (scan.*as).vertices.insert((scan.*as).vertices.end(), mesh.vertices.begin(),
                                 mesh.vertices.end());
      for (const auto& t : mesh.triangles)
        (scan.*as).triangles.push_back(t + Eigen::Vector3i::Constant(first));
    }
    const AnatomyFit fit = fit_anatomy(scan, model());
    EXPECT_LT(fit.mandible.rms_mm, 1);
    for (const auto& [name, p] : known)
      EXPECT_LT((fit.landmarks.at(name).point - p).norm(), farthest_mm) << folder << ", " << name;
  };
  // Other people, digitised by others: markers.csv.
  check("case-ubc", &AnatomyScan::mandible, {"mandible.ply", "lower_teeth.ply"},
        {{"lower_incisal_point", {0, -46.96, 41.76}},
         {"left_condylion", {51.78, 31.45, 83.64}},
         {"left_condyle", {51.78, 31.45, 79.64}},
         {"right_condyle", {-51.78, 31.45, 79.64}}},
        4);
  check("case-badin", &AnatomyScan::bone, {"mandible.ply"},
        {{"lower_incisal_point", {0, 55.46, 92.24}},
         {"left_condyle", {47.92, 138.31, 138.66}},
         {"right_condyle", {-47.92, 138.31, 138.66}}},
        4);
}

}  // namespace condyle
