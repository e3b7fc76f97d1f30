// A laser scan of a built-in face, registered to the patient's skin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/face_scan/fuse_face.h"
#include "sim/phantom/phantom.h"
#include "sim/scanner/laser_scan.h"
#include "sim/scanner/scanner_noise.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

struct Scanned {
  FaceScan scan;
  Pose X_CS;  // the truth
  Landmarks landmarks;
};

const Case& patient() {
  static const Case built_in = builtin_patient();
  return built_in;
}

Scanned scanned_face(std::uint64_t seed = 3) {
  const LaserScan laser =
      scan_laser(patient(), {.columns = 300, .rows = 320, .seed = seed, .threads = 2});
  Scanned found;
  DepthMapRepair repair;
  found.scan.mesh = surface_of(laser.map, repair);
  found.X_CS = laser.X_SC.inverse();
  for (const char* name : {"pronasale", "left_cheilion", "right_cheilion", "left_exocanthion",
                           "right_exocanthion", "soft_pogonion", "subnasale"})
    found.landmarks.points[name] = laser.X_SC * *patient().landmarks.find(name);
  return found;
}

/// Largest distance between where two poses put the scan's vertices.
double farthest(const Scanned& scanned, const Pose& found) {
  double most = 0;
  for (const auto& v : scanned.scan.mesh.vertices)
    most = std::max(most, (found * v - scanned.X_CS * v).norm());
  return most;
}

std::string refusal(const FaceScan& scan, const Landmarks& landmarks, const Case& of = patient()) {
  try {
    register_face(scan, landmarks, of, "scan.json", 2);
  } catch (const InputError& error) {
    return error.what();
  }
  return "was registered";
}

TEST(FaceRegistration, FindsTheScanWithAndWithoutLandmarks) {
  const Scanned scanned = scanned_face();
  Landmarks observed = scanned.landmarks;
  std::uint64_t n = 0;
  for (auto& [name, p] : observed.points)
    for (int a = 0; a < 3; ++a) p[a] += 0.8 * normal_number(5, n++);
  const auto by_marks = register_face(scanned.scan, observed, patient(), "scan.json", 2);
  EXPECT_LT(farthest(scanned, by_marks.X_CS), 0.15);
  EXPECT_LT(by_marks.median_mm, 0.12);
  EXPECT_LT(by_marks.p95_mm, 0.6);
  EXPECT_EQ(by_marks.landmarks.size(), 7u);
  EXPECT_NEAR(*by_marks.fiducial_rms_mm, 1.1, 0.6);
  EXPECT_NEAR(*by_marks.target_rms_mm, 1.4, 0.7);
  ASSERT_TRUE(by_marks.mouth_opening_mm);
  EXPECT_LT(std::abs(*by_marks.mouth_opening_mm), 0.3);
  EXPECT_TRUE(by_marks.notes.empty()) << by_marks.notes.front();

  const auto by_axes = register_face(scanned.scan, {}, patient(), "scan.json", 1);
  EXPECT_LT(farthest(scanned, by_axes.X_CS), 0.15);
  EXPECT_FALSE(by_axes.fiducial_rms_mm);
}

TEST(FaceRegistration, HasTheSameBitsForAnyNumberOfThreads) {
  const Scanned scanned = scanned_face(4);
  const auto one = register_face(scanned.scan, {}, patient(), "scan.json", 1);
  const auto two = register_face(scanned.scan, {}, patient(), "scan.json", 2);
  EXPECT_EQ(one.X_CS.t, two.X_CS.t);
  EXPECT_EQ(one.X_CS.R.coeffs(), two.X_CS.R.coeffs());
}

TEST(FaceRegistration, AScanInRasCoordinatesIsTurned) {
  Scanned scanned = scanned_face();
  for (auto& v : scanned.scan.mesh.vertices) v = Vector3d(-v.x(), -v.y(), v.z());
  Pose turn;
  turn.R = Eigen::Quaterniond(0, 0, 0, 1);  // half a turn about z
  scanned.X_CS = scanned.X_CS * turn.inverse();
  const auto found = register_face(scanned.scan, {}, patient(), "scan.json", 2);
  EXPECT_LT(farthest(scanned, found.X_CS), 0.15);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_NE(found.notes.front().find("RAS"), std::string::npos);
}

/// A cheek swells by 5 mm.
TriMesh swollen(TriMesh mesh, const Pose& X_CM) {
  for (auto& v : mesh.vertices) {
    const Vector3d p = X_CM * v;
    v = X_CM.inverse() * (p + 5 * std::exp(-(p - Vector3d(48, -70, -40)).squaredNorm() / 400) *
                                  Vector3d(0.7, -0.7, 0));
  }
  return mesh;
}

Scanned mirror_image(Scanned scanned) {
  for (auto& v : scanned.scan.mesh.vertices) v.x() = -v.x();
  flip(scanned.scan.mesh);
  for (auto& [name, p] : scanned.landmarks.points) p.x() = -p.x();
  return scanned;
}

TEST(FaceRegistration, MirroredScansAreRefused) {
  Scanned scanned = scanned_face();
  scanned.scan.mesh = swollen(scanned.scan.mesh, scanned.X_CS);
  Case swollen_patient = patient();
  for (auto& part : swollen_patient.parts)
    if (part.role == Role::face) part.mesh = swollen(part.mesh, {});
  EXPECT_TRUE(register_face(scanned.scan, {}, swollen_patient, "scan.json", 2).notes.empty());
  const Scanned mirrored = mirror_image(scanned);
  EXPECT_NE(refusal(mirrored.scan, {}, swollen_patient).find("is mirrored"), std::string::npos)
      << refusal(mirrored.scan, {}, swollen_patient);
  EXPECT_NE(refusal(mirrored.scan, mirrored.landmarks).find("left and right are exchanged"),
            std::string::npos)
      << refusal(mirrored.scan, mirrored.landmarks);
}

TEST(FaceRegistration, AMirroredScanOfANearlySymmetricFaceIsNoted) {
  const Scanned mirrored = mirror_image(scanned_face());
  const auto found = register_face(mirrored.scan, {}, patient(), "scan.json", 2);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_NE(found.notes[0].find("may be mirrored"), std::string::npos);
}

TEST(FaceRegistration, LandmarksOfAnotherFrameAreRefused) {
  const Scanned scanned = scanned_face();
  Landmarks ras;
  for (const auto& [name, p] : scanned.landmarks.points)
    ras.points[name] = Vector3d(-p.x(), -p.y(), p.z());
  EXPECT_NE(refusal(scanned.scan, ras).find("RAS"), std::string::npos)
      << refusal(scanned.scan, ras);
  Landmarks far = scanned.landmarks;
  far.points["pronasale"].y() -= 80;
  EXPECT_NE(refusal(scanned.scan, far).find("pronasale"), std::string::npos);
}

TEST(FaceRegistration, AnOpenMouthIsNoted) {
  Scanned scanned = scanned_face();
  // The chin turns about the joints by 6 degrees, from the lower lip on.
  const Vector3d joint = *patient().landmarks.find("left_condyle");
  const double lip = patient().landmarks.find("stomion")->z();
  const Eigen::AngleAxisd turn(6 * M_PI / 180, Vector3d::UnitX());
  for (auto& v : scanned.scan.mesh.vertices) {
    const Vector3d p = scanned.X_CS * v;
    const double weight = std::clamp((lip - p.z()) / 10, 0.0, 1.0);
    const Vector3d axis(0, joint.y(), joint.z());
    v = scanned.X_CS.inverse() * (p + weight * (axis + turn * (p - axis) - p));
  }
  const auto found = register_face(scanned.scan, {}, patient(), "scan.json", 2);
  ASSERT_TRUE(found.mouth_opening_mm);
  EXPECT_GT(*found.mouth_opening_mm, 5);
  EXPECT_LT(*found.mouth_opening_mm, 13);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_NE(found.notes[0].find("more open"), std::string::npos);
}

TEST(FaceRegistration, AnotherThingIsRefused) {
  FaceScan ball;
  FaceDepthMap map;
  map.width = 80;
  map.height = 40;
  map.height_mm = 120;
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      map.depth_mm.push_back(
          static_cast<float>(std::sqrt(62.0 * 62 - std::pow(map.row_height(row), 2))));
  DepthMapRepair repair;
  ball.mesh = surface_of(map, repair);
  EXPECT_NE(refusal(ball, {}).find("scan.json"), std::string::npos) << refusal(ball, {});
  Case bones;
  try {
    register_face(ball, {}, bones, "scan.json", 1);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no face"), std::string::npos);
  }
}

TEST(FaceFusion, TheSkinTakesOverShapeAndColours) {
  const Scanned scanned = scanned_face();
  Case coarse = patient();
  for (auto& part : coarse.parts)
    if (part.role == Role::face) {
      part.mesh.colors.clear();
      for (std::size_t i = 0; i < part.mesh.vertices.size(); ++i)  // as rough as a CT
        for (int a = 0; a < 3; ++a)
          part.mesh.vertices[i][a] += 0.3 * normal_number(8, 3 * i + static_cast<std::size_t>(a));
    }
  const auto found = register_face(scanned.scan, {}, coarse, "scan.json", 2);
  const FaceFusion fusion = fuse_face(scanned.scan, found, 2, coarse);
  EXPECT_GT(fusion.covered, 0.25);
  const TriMesh& face = coarse.find(Role::face)->mesh;
  ASSERT_EQ(face.colors.size(), face.vertices.size());
  const TriMesh& truth = patient().find(Role::face)->mesh;
  const TriangleTree tree(truth), scan_tree(scanned.scan.mesh);
  std::vector<double> distances, colours;
  const Pose X_SC = found.X_CS.inverse();
  for (std::size_t i = 0; i < face.vertices.size(); ++i) {
    const Vector3d& p = face.vertices[i];
    if (scan_tree.nearest(X_SC * p, 0.3).triangle < 0 || p.y() > -60) continue;
    const SurfacePoint at = tree.nearest(p);
    distances.push_back(at.distance);
    Eigen::Vector3f colour = Eigen::Vector3f::Zero();
    for (int k = 0; k < 3; ++k)
      colour += static_cast<float>(at.barycentric[k]) *
                truth.colors[static_cast<std::size_t>(
                    truth.triangles[static_cast<std::size_t>(at.triangle)][k])];
    colours.push_back((colour - face.colors[i]).norm());
  }
  ASSERT_GT(distances.size(), 5000u);
  std::sort(distances.begin(), distances.end());
  std::sort(colours.begin(), colours.end());
  EXPECT_LT(distances[distances.size() / 2], 0.15);
  EXPECT_LT(distances[distances.size() * 95 / 100], 0.35);
  EXPECT_LT(colours[colours.size() / 2], 0.03);
}

}  // namespace
}  // namespace condyle::test
