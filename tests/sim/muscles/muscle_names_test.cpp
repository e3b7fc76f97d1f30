#include "sim/muscles/muscle_names.h"

#include <gtest/gtest.h>

namespace condyle {
namespace {

TEST(MuscleNames, ShortNamesBeginWithTheSide) {
  Muscle m;
  m.name = "lsp";
  m.kind = "sp";
  m.full_name = "Superior Lateral Pterygoid";
  EXPECT_EQ(short_name(m), "L Sup. Lat. Pterygoid");
  m.name = "rsp";
  EXPECT_EQ(short_name(m), "R Sup. Lat. Pterygoid");
  m = {};
  m.name = "strap";
  EXPECT_EQ(short_name(m), "strap");
}

}  // namespace
}  // namespace condyle
