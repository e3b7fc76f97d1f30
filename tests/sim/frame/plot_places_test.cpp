#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/frame/label_placement.h"

namespace condyle {
namespace {

TEST(Ticks, AreRoundAtLeastThreeAndAtMostTheRequestedNumber) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3, 3);
  int at_most = 0;
  for (const double span : {0.003, 0.7, 4.0, 61.0, 1234.0})
    for (const int most : {2, 5, 9})
      for (int i = 0; i < 20; ++i) {
        const double low = span * place(random);
        const Ticks found = ticks(low, low + span, most);
        const int count = static_cast<int>(found.values.size());
        EXPECT_GE(count, 3) << low << " and " << span;
        EXPECT_LE(count, std::max(most, 7));  // from two to three by a step of a fifth at worst
        at_most += count <= most;
        const double mantissa =
            found.step / std::pow(10, std::floor(std::log10(found.step) + 1e-9));
        EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 ||
                    std::abs(mantissa - 5) < 1e-6)
            << mantissa;
        for (const double v : found.values) {
          EXPECT_GE(v, low - 1e-6 * span);
          EXPECT_LE(v, low + span * (1 + 1e-6));
          EXPECT_NEAR(v / found.step, std::round(v / found.step), 1e-6);
        }
      }
  EXPECT_GT(at_most, 190);
  EXPECT_EQ(ticks(0, 3, 5).values, (std::vector<double>{0, 1, 2, 3}));
}

bool apart(const DrawnArea& a, const DrawnArea& b) {
  return a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
}

TEST(LabelPlacement, AreAsNearAsPossibleClearOfCurvesTextAndOutlines) {
  const DrawnArea axes{10, 20, 210, 140};
  LabelPlacement places(axes, 1);
  places.add_curve({{110, 0}, {110, 200}});  // up through the middle
  const DrawnArea box{90, 60, 104, 70};
  places.add_outline({{90, 60}, {104, 60}, {104, 70}, {90, 70}});
  std::vector<DrawnArea> taken;
  for (int i = 0; i < 6; ++i) {
    const auto at = places.take(40, 12, box);
    const DrawnArea words{at.x, at.y, at.x + 40, at.y + 12};
    EXPECT_GE(words.left, axes.left);
    EXPECT_LE(words.right, axes.right);
    EXPECT_GE(words.top, axes.top);
    EXPECT_LE(words.bottom, axes.bottom);
    EXPECT_TRUE(apart(words, {109, 0, 111, 200})) << i;
    EXPECT_TRUE(apart(words, box)) << i;
    for (const DrawnArea& other : taken) EXPECT_TRUE(apart(words, other)) << i;
    taken.push_back(words);
  }
  EXPECT_TRUE(!apart(taken[0], {84, 54, 110, 76})) << "beside what it names";
}

TEST(LabelPlacement, CoverTheLeastWhereNoSpaceIsFree) {
  LabelPlacement places({0, 0, 50, 40}, 1);
  for (int x = 0; x <= 50; x += 4) places.add_curve({{double(x), 0}, {double(x), 30}});
  const auto at = places.take(40, 12, {0, 0, 4, 4});
  EXPECT_GE(at.y + 12, 36);
}

}  // namespace
}  // namespace condyle
