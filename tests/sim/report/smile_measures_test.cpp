// Teeth that lips show, by geometry made by hand.
#include "sim/report/smile_measures.h"

#include <gtest/gtest.h>

#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double half_width = 25, corner_z = -55, rows_mm = 6;

/// Two flat lips 50 mm wide: the upper one ends at `upper_z`, the lower one at `lower_z`.
struct FlatLips {
  TriMesh face;
  MouthOutline mouth;

  FlatLips(double upper_z, double lower_z) {
    mouth.right_corner = add(-half_width, corner_z);
    mouth.left_corner = add(half_width, corner_z);
    mouth.upper = lip(upper_z, rows_mm);
    mouth.lower = lip(lower_z, -rows_mm);
  }
  LipMargins margins() const {
    std::vector<Eigen::Vector3f> vertices;
    for (const Vector3d& vertex : face.vertices) vertices.push_back(vertex.cast<float>());
    // As triangles of the lips at rest, here of a nearly closed mouth.
    return lip_margins(lip_surfaces(FlatLips(-54, -56).face, mouth), vertices);
  }

 private:
  int add(double x, double z) {
    face.vertices.emplace_back(x, -100, z);
    return static_cast<int>(face.vertices.size()) - 1;
  }
  /// A strip from the margin with the corners to a row beyond it; returns the margin.
  std::vector<int> lip(double z, double beyond) {
    std::vector<int> chain, margin{mouth.right_corner}, row;
    for (double x = -20; x <= 20; x += 5) chain.push_back(add(x, z));
    margin.insert(margin.end(), chain.begin(), chain.end());
    margin.push_back(mouth.left_corner);
    for (double x = -half_width; x <= half_width; x += 5) row.push_back(add(x, z + beyond));
    for (std::size_t i = 0; i + 1 < margin.size(); ++i) {
      face.triangles.emplace_back(margin[i], margin[i + 1], row[i]);
      face.triangles.emplace_back(margin[i + 1], row[i + 1], row[i]);
    }
    return chain;
  }
};

/// Teeth 13 to 23 as boxes 10 mm high, 6 mm wide, with their edges at z -56, and gums above them.
Case toothed(bool with_gums = true) {
  Case patient;
  patient.jaw.upper_arch = mandible_body;  // any body that moves
  Part teeth{.name = "upper_teeth", .role = Role::upper_teeth, .mesh = {}, .teeth = {}};
  teeth.body = patient.jaw.upper_arch;
  double x = -18;
  for (const int fdi : {13, 12, 11, 21, 22, 23}) {
    teeth.teeth.push_back({fdi, static_cast<int>(teeth.mesh.triangles.size()), 12});
    teeth.mesh = test::joined(teeth.mesh, test::box({x, -95, -56}, {x + 6, -85, -42}));
    x += 6;
  }
  patient.parts.push_back(teeth);
  if (with_gums)
    patient.parts.push_back({"upper_gums",
                             Role::upper_gums,
                             test::box({-20, -95.5, -46}, {20, -84, -36}),
                             {},
                             teeth.body});
  return patient;
}

SmileMeasures measured(double upper_z, double lower_z, const Case& patient = toothed(),
                       double arch_up_mm = 0) {
  Pose moved;
  moved.t.z() = arch_up_mm;
  const std::vector<Pose> X_CB = {Pose{}, moved};
  return smile_measures(patient, FlatLips(upper_z, lower_z).margins(), X_CB);
}

TEST(SmileMeasures, ToothAndGumShowAreHeightsBelowTheUpperLip) {
  const SmileMeasures low = measured(-50, -60);
  ASSERT_EQ(low.teeth.size(), 6u);
  EXPECT_EQ(low.teeth[0].fdi, 13);
  EXPECT_EQ(low.teeth[3].fdi, 21);
  for (const ToothShow& tooth : low.teeth) {
    EXPECT_NEAR(tooth.show_mm, 6, 1e-4) << tooth.fdi;
    ASSERT_TRUE(tooth.crown_mm) << tooth.fdi;
    EXPECT_NEAR(*tooth.crown_mm, 10, 0.06) << tooth.fdi;
    EXPECT_EQ(tooth.gum_mm(), 0) << tooth.fdi;
  }
  EXPECT_NEAR(*low.incisor_show_mm, 6, 1e-4);
  EXPECT_NEAR(*low.crown_fraction, 0.6, 0.01);
  EXPECT_EQ(low.line, SmileLine::low);

  const SmileMeasures average = measured(-47, -60);
  EXPECT_NEAR(*average.incisor_show_mm, 9, 1e-4);
  EXPECT_EQ(average.line, SmileLine::average);

  const SmileMeasures high = measured(-44, -60);
  EXPECT_NEAR(*high.incisor_show_mm, 12, 1e-4);
  EXPECT_NEAR(*high.gum_show_mm, 2, 0.06);
  EXPECT_EQ(high.crown_fraction, 1);
  EXPECT_EQ(high.line, SmileLine::high);
}

TEST(SmileMeasures, ALipBelowTheEdgeCoversTheTeeth) {
  const SmileMeasures covered = measured(-57, -60);
  EXPECT_NEAR(*covered.incisor_show_mm, -1, 1e-4);
  EXPECT_EQ(covered.crown_fraction, 0);
  EXPECT_FALSE(covered.buccal_corridor);
}

TEST(SmileMeasures, AnImpactedArchShowsLess) {
  const SmileMeasures impacted = measured(-50, -60, toothed(), 4);
  EXPECT_NEAR(*impacted.incisor_show_mm, 2, 1e-4);
  EXPECT_NEAR(*impacted.teeth[2].crown_mm, 10, 0.06);
}

TEST(SmileMeasures, TheBuccalCorridorIsTheWidthWithoutTeeth) {
  EXPECT_NEAR(*measured(-50, -60).buccal_corridor, 1 - 36.0 / 50, 1e-4);
  EXPECT_FALSE(measured(-56.5, -56.6).buccal_corridor) << "the lips hide the teeth";
}

TEST(SmileMeasures, WithoutGumsOrSeparateTeethTheShowRemains) {
  const SmileMeasures bare = measured(-50, -60, toothed(false));
  EXPECT_NEAR(*bare.incisor_show_mm, 6, 1e-4);
  EXPECT_FALSE(bare.gum_show_mm || bare.line);
  Case whole = toothed();
  whole.parts[0].teeth.clear();
  EXPECT_FALSE(measured(-50, -60, whole).incisor_show_mm);
  whole.landmarks.points["upper_incisal_point"] = {0, -95, -56};
  EXPECT_NEAR(*measured(-50, -60, whole, 1).incisor_show_mm, 5, 1e-4);
}

TEST(SmileMeasures, TheMarginIsTheLowestPointOfTheLipAtEachPlace) {
  FlatLips lips(-50, -60);
  // A droop of the left half of the upper lip by 3 mm, as in palsy.
  for (const int vertex : lips.mouth.upper)
    if (Vector3d& at = lips.face.vertices[static_cast<std::size_t>(vertex)]; at.x() > 0)
      at.z() -= 3;
  const SmileMeasures drooping = smile_measures(toothed(), lips.margins(), {});
  EXPECT_NEAR(drooping.teeth[0].show_mm, 6, 1e-4);
  EXPECT_NEAR(drooping.teeth[5].show_mm, 3, 1e-4);
}

}  // namespace
}  // namespace condyle
