// The displacement map of the skin in a recording.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

TEST(Record, ColoursTheSkinByItsDisplacementFromRest) {
  const Folder folder;
  const auto outcome =
      condyle({"record", "--motion", "open 30 over 0.25", "--frames", "2", "--out", folder / "out",
               "--camera", "front", "--size", "350x400", "--show", "skin,displacement"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Picture rest(folder / "out/frames/000000.png"), open(folder / "out/frames/000001.png");
  ASSERT_FALSE(rest.empty());
  ASSERT_FALSE(open.empty());
  open.save(kept_pictures() / "ColoursTheSkinByItsDisplacementFromRest.png");
  // At rest everything has the colour for 0, dark violet. Opened, the chin is green, the forehead
  // unchanged.
  const auto violet = [](const std::uint8_t* p) { return p[2] > p[1] + 20 && p[1] < 60; };
  constexpr double forehead[] = {0.5, 0.25}, chin[] = {0.5, 0.72};
  EXPECT_TRUE(violet(rest.at(forehead[0], forehead[1])));
  EXPECT_TRUE(violet(rest.at(chin[0], chin[1])));
  EXPECT_TRUE(violet(open.at(forehead[0], forehead[1])));
  const auto* p = open.at(chin[0], chin[1]);
  EXPECT_GT(p[1], p[0] + 20) << int{p[0]} << ' ' << int{p[1]} << ' ' << int{p[2]};
}

}  // namespace
}  // namespace condyle::test
