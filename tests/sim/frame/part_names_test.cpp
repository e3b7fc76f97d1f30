#include "sim/frame/part_names.h"

#include <gtest/gtest.h>

#include <vector>

namespace condyle {
namespace {

TEST(PartNames, AreReadableWithoutFileSeparators) {
  EXPECT_EQ(readable_name("left_condyle_fossa"), "left condyle fossa");
  EXPECT_EQ(readable_name("transplant-2"), "transplant 2");
  EXPECT_EQ(display_name("upper_teeth"), "Upper teeth");
  EXPECT_EQ(readable_name("ans"), "ANS");
}

TEST(PartNames, InSentencesAreReadableAndInPathsStay) {
  const std::vector<std::string> names = {"mandible", "upper_teeth", "transplant-2", "left_fossa"};
  const auto readable = [&](const char* sentence) { return with_readable_names(sentence, names); };
  EXPECT_EQ(readable("left_fossa: starts 1.2 mm deep in upper_teeth; move left_fossa."),
            "left fossa: starts 1.2 mm deep in upper teeth; move left fossa.");
  EXPECT_EQ(readable("the part \"transplant-2\" (left_fossa, mandible) is open"),
            "the part \"transplant 2\" (left fossa, mandible) is open");
  for (const char* path :
       {"/data/left_fossa/case.json: is missing", "left_fossa.ply: is damaged", "/data/upper_teeth",
        "my_left_fossa is another name", "left_fossa_2 is another name"})
    EXPECT_EQ(readable(path), path);
}

}  // namespace
}  // namespace condyle
