#include "sim/tissue/skin_region.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "tests/sim/tissue/plain_patient.h"

namespace condyle::test {
namespace {

TriMesh region_of(const Case& patient) {
  std::vector<std::string> notes;
  return cut_region(patient.find(Role::face)->mesh, patient.landmarks, read_anatomy(patient, notes),
                    false, notes)
      .mesh;
}

std::size_t borders(const Case& patient) { return border_loops(region_of(patient)).size(); }

/// The region ends below the eyes, at z 5.5 mm here.
TEST(SkinRegion, ABumpBelowItsBorderLeavesNoHole) {
  Case patient = plain_patient();
  EXPECT_EQ(borders(patient), 2u) << "its own, and the mouth";
  int bumps = 0;
  for (Part& part : patient.parts)
    for (auto& v : part.mesh.vertices)
      if (part.role == Role::face && std::abs(v.z() + 1.9) < 0.1 && v.x() > 10 && v.x() < 12) {
        v += Eigen::Vector3d(0, -3, 7.6);
        ++bumps;
      }
  ASSERT_EQ(bumps, 1);
  EXPECT_EQ(borders(patient), 2u);
  EXPECT_LT(bounding_box(region_of(patient)).high.z(), 6) << "the bump, and nothing else above";
}

}  // namespace
}  // namespace condyle::test
