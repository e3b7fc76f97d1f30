#include "engine/core/similar_word.h"

#include <gtest/gtest.h>

#include <vector>

namespace condyle::test {

TEST(SimilarWord, SuggestsAWordThatDiffersByFewLetters) {
  const std::vector<std::string> known = {"opening", "protrusion", "rest"};
  EXPECT_EQ(suggestion("opning", known), " (did you mean \"opening\"?)");
  EXPECT_EQ(suggestion("Opening", known), " (did you mean \"opening\"?)");
  EXPECT_EQ(suggestion("protrution", known), " (did you mean \"protrusion\"?)");
  EXPECT_EQ(suggestion("rset", known), "") << "a short word with two wrong letters is another word";
  EXPECT_EQ(suggestion("yawn", known), "");
  EXPECT_EQ(suggestion("", known), "");
  EXPECT_EQ(suggestion("opening", {}), "");
}

}  // namespace condyle::test
