// A section through the built-in patient in a recording.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

TEST(Record, ASectionThroughTheOpenMouthIsHollowBetweenPalateAndTongue) {
  const Folder folder;
  const auto outcome = condyle({"record", "--motion", "open 40 over 0.3", "--frames", "2", "--out",
                                folder / "out", "--camera", "left", "--size", "640x360", "--clip",
                                "left", "--surface-nodes", "150"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Picture open(folder / "out/frames/000001.png");
  ASSERT_FALSE(open.empty());
  const auto* throat = open.at(0.55, 0.65);
  const auto flesh_in = [&](double x0, double x1, double y0, double y1) {
    int flesh = 0, all = 0;
    for (double x = x0; x < x1; x += 0.004)
      for (double y = y0; y < y1; y += 0.004, ++all) {
        const auto* p = open.at(x, y);
        flesh += std::abs(p[0] - throat[0]) < 4 && std::abs(p[1] - throat[1]) < 4;
      }
    return static_cast<double>(flesh) / all;
  };
  EXPECT_LT(throat[0], throat[2] + 30);                 // a neutral colour
  EXPECT_LT(open.at(0.465, 0.82)[0], 20);               // the airway below the larynx
  EXPECT_LT(flesh_in(0.395, 0.45, 0.51, 0.57), 0.02);   // between palate and tongue
  EXPECT_LT(flesh_in(0.385, 0.395, 0.56, 0.62), 0.02);  // and behind the lips
  EXPECT_GT(flesh_in(0.52, 0.6, 0.55, 0.85), 0.99);     // throat and neck
  EXPECT_GT(flesh_in(0.355, 0.37, 0.44, 0.48), 0.99);   // behind the nose
}

}  // namespace
}  // namespace condyle::test
