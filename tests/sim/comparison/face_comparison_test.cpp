// Regions of a face, and distances between two faces that are known.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "sim/comparison/face_comparison_text.h"
#include "tests/support/builtin.h"

namespace condyle::test {
namespace {

MarkedFace builtin_face() { return {builtin().find(Role::face)->mesh, builtin().landmarks}; }

MarkedFace moved(MarkedFace face, const Pose& X) {
  for (auto& p : face.mesh.vertices) p = X * p;
  for (auto& [name, p] : face.landmarks.points) p = X * p;
  return face;
}

Pose small_pose() {
  Pose X;
  X.R = Eigen::AngleAxisd(0.07, Eigen::Vector3d(1, 2, -1).normalized());
  X.t = {4, -3, 6};
  return X;
}

const RegionDistances& row(const FaceComparison& comparison, const std::string& name) {
  for (const auto& each : comparison.rows)
    if (each.region == name) return each;
  throw std::logic_error("no region " + name);
}

/// The message of the InputError that this comparison ends with.
std::string refusal(const MarkedFace& predicted, const MarkedFace& after,
                    const FaceComparisonSettings& settings = {}) {
  try {
    compare_faces(predicted, after, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(FaceRegions, LieWhereTheirLandmarksSay) {
  const MarkedFace face = builtin_face();
  const auto regions = regions_of_face(face.mesh, face.landmarks);
  const auto at = [&](const Eigen::Vector3d& p) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < face.mesh.vertices.size(); ++i)
      if ((face.mesh.vertices[i] - p).norm() < (face.mesh.vertices[nearest] - p).norm())
        nearest = i;
    return regions[nearest];
  };
  const auto mark = [&](const char* name) { return *face.landmarks.find(name); };
  EXPECT_EQ(at(mark("pronasale")), FaceRegion::nose);
  EXPECT_EQ(at(mark("labrale_superius")), FaceRegion::upper_lip);
  EXPECT_EQ(at(mark("labrale_inferius")), FaceRegion::lower_lip);
  EXPECT_EQ(at(mark("soft_pogonion")), FaceRegion::chin);
  EXPECT_EQ(at(mark("soft_glabella")), FaceRegion::upper);
  EXPECT_EQ(at(mark("left_tragion") + Eigen::Vector3d(0, 40, 0)), FaceRegion::none);
  const Eigen::Vector3d beside(22, 15, 0);  // of the mouth's corner, on the cheek
  EXPECT_EQ(at(mark("left_cheilion") + beside), FaceRegion::left_cheek);
  EXPECT_EQ(at(mark("right_cheilion") + Eigen::Vector3d(-22, 15, 0)), FaceRegion::right_cheek);
}

TEST(CompareFaces, AFaceThatWasMovedIsRegisteredOnItself) {
  const MarkedFace face = builtin_face();
  MarkedFace other = moved(face, small_pose());
  other.landmarks = {};
  const FaceComparison comparison = compare_faces(face, other);
  EXPECT_LT(comparison.registration_rms_mm, 1e-5);
  EXPECT_LT(row(comparison, "whole").max_mm, 1e-4);
  EXPECT_GT(row(comparison, "whole").measured_share, 0.97);
  EXPECT_NEAR(row(comparison, "chin").share_below_2_mm, 1, 0);
}

TEST(CompareFaces, AnAdvancedChinIsMeasuredWithItsSign) {
  const MarkedFace face = builtin_face();
  const auto regions = regions_of_face(face.mesh, face.landmarks);
  const auto normals = vertex_normals(face.mesh);
  MarkedFace predicted = face;
  for (std::size_t i = 0; i < regions.size(); ++i)
    if (regions[i] == FaceRegion::chin) predicted.mesh.vertices[i] += 3 * normals[i];
  const FaceComparison comparison = compare_faces(predicted, face);
  const RegionDistances& chin = row(comparison, "chin");
  EXPECT_NEAR(chin.signed_median_mm, 3, 0.1);
  EXPECT_NEAR(chin.median_mm, 3, 0.1);
  EXPECT_LT(chin.share_below_2_mm, 0.1);
  EXPECT_LT(row(comparison, "nose").max_mm, 1e-6);
  const FaceComparison swapped = compare_faces(face, predicted);
  EXPECT_NEAR(row(swapped, "chin").signed_median_mm, -3, 0.1);
  EXPECT_LE(chin.median_mm, chin.p90_mm);
  EXPECT_LE(chin.p90_mm, chin.p95_mm);
  EXPECT_LE(chin.p95_mm, chin.max_mm);
}

TEST(CompareFaces, ByLandmarksAFarFaceComesBack) {
  const MarkedFace face = builtin_face();
  Pose far;
  far.R = Eigen::AngleAxisd(2, Eigen::Vector3d::UnitX());
  far.t = {800, 0, -300};
  const MarkedFace other = moved(face, far);
  for (const FaceAlignment alignment : {FaceAlignment::landmarks, FaceAlignment::surface})
    EXPECT_LT(row(compare_faces(face, other, {.alignment = alignment}), "whole").max_mm, 1e-4);
  EXPECT_NE(refusal(face, {other.mesh, {}}).find("mm from the predicted one"), std::string::npos);
}

TEST(CompareFaces, AnInwardSurfaceIsTurnedAndAScanEndsAtItsRim) {
  const MarkedFace face = builtin_face();
  MarkedFace scan{face.mesh, {}};
  std::erase_if(scan.mesh.triangles, [&](const Eigen::Vector3i& t) {
    return scan.mesh.vertices[static_cast<std::size_t>(t[0])].y() > -40;
  });
  flip(scan.mesh);
  const FaceComparison comparison = compare_faces(face, scan);
  ASSERT_EQ(comparison.notes.size(), 1u);
  EXPECT_LT(row(comparison, "whole").max_mm, 1e-4);
  EXPECT_LT(row(comparison, "upper face").measured_share, 0.8);
  EXPECT_GT(row(comparison, "nose").measured_share, 0.95);
}

TEST(CompareFaces, WrongInputIsRefusedWithItsReason) {
  const MarkedFace face = builtin_face();
  Pose none;
  MarkedFace metres = moved(face, none);
  for (auto& p : metres.mesh.vertices) p *= 0.001;
  EXPECT_NE(refusal(face, metres).find("--units m"), std::string::npos);
  EXPECT_NE(refusal({face.mesh, {}}, face).find("left_cheilion"), std::string::npos);
  EXPECT_NE(refusal(face, {face.mesh, {}}, {.alignment = FaceAlignment::landmarks}).find("0 are"),
            std::string::npos);
  const FaceComparison whole =
      compare_faces({face.mesh, {}}, {face.mesh, {}}, {.alignment = FaceAlignment::none});
  ASSERT_EQ(whole.rows.size(), 1u);
  EXPECT_EQ(whole.notes.size(), 1u);
  EXPECT_LT(whole.rows[0].max_mm, 1e-9);
}

TEST(CompareFaces, TableAndFilesHaveEveryRegionAndPoint) {
  const MarkedFace face = builtin_face();
  const FaceComparison comparison = compare_faces(face, face, {.alignment = FaceAlignment::none});
  const std::string text = face_comparison_text(comparison);
  for (const FaceRegion region : face_regions)
    EXPECT_NE(text.find(region_name(region)), std::string::npos);
  EXPECT_EQ(face_comparison_json(comparison)["regions"].size(), 8u);
  const std::string csv = face_comparison_csv(comparison, face.mesh);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            face.mesh.vertices.size() + 1);
}

}  // namespace condyle::test
