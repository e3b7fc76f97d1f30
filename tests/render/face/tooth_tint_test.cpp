// Crowns of the built-in patient are yellower towards the gum and bluish at the incisal edge.
#include "render/face/tooth_tint.h"

#include <algorithm>
#include <limits>
#include <map>

#include "tests/render/face/opened_patient.h"

namespace condyle {
namespace {

const Part& arch(Role role) {
  const auto& parts = opened_patient().scene.patient.parts;
  return *std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.role == role; });
}

/// Blue over red of the vertices of a tooth at its edge and farthest from it, by its FDI number.
struct Blues {
  float edge, neck;
};
std::map<int, Blues> blues(const Part& part) {
  const auto tint = tooth_tint(part);
  EXPECT_EQ(tint.size(), part.mesh.vertices.size());
  const double down = part.role == Role::upper_teeth ? -1 : 1;
  std::map<int, Blues> found;
  for (const Tooth& tooth : part.teeth) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    Blues own{};
    for (int t = tooth.first_triangle; t < tooth.first_triangle + tooth.triangle_count; ++t)
      for (const int v : part.mesh.triangles[static_cast<std::size_t>(t)]) {
        const auto i = static_cast<std::size_t>(v);
        const double height = down * part.mesh.vertices[i].z();
        const float blue = tint[i].z() / tint[i].x();
        if (height > high) high = height, own.edge = blue;
        if (height < low) low = height, own.neck = blue;
      }
    found[tooth.fdi] = own;
  }
  return found;
}

TEST(ToothTint, CrownsAreYellowerTowardsTheGumAndIncisorsBluishAtTheirEdge) {
  for (const Role role : {Role::upper_teeth, Role::lower_teeth}) {
    const auto found = blues(arch(role));
    EXPECT_GE(found.size(), 14u);
    for (const auto& [fdi, blue] : found) {
      EXPECT_LT(blue.neck, blue.edge - 0.03f) << fdi;
      const int place = fdi % 10;
      EXPECT_GT(blue.edge, place <= 2 ? 1.02f : 0.9f) << fdi;
      EXPECT_LE(blue.edge, place <= 3 ? 1.1f : 1.0f) << fdi;
    }
    const int quadrant = role == Role::upper_teeth ? 10 : 40;
    EXPECT_LT(found.at(quadrant + 3).edge, found.at(quadrant + 1).edge);
    EXPECT_LT(found.at(quadrant + 3).neck, found.at(quadrant + 1).neck + 0.01f);
  }
}

TEST(ToothTint, OtherPartsHaveNone) {
  EXPECT_TRUE(tooth_tint(arch(Role::mandible)).empty());
  Part together = arch(Role::upper_teeth);
  together.teeth.clear();
  EXPECT_TRUE(tooth_tint(together).empty());
}

}  // namespace
}  // namespace condyle
