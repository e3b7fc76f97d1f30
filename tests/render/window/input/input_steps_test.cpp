// Lists of inputs: what a step says, and what is refused.
#include "render/window/input/input_steps.h"

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Kind = InputStep::Kind;

TEST(InputSteps, EachLineIsAStep) {
  const auto steps = parse_input_steps(
      "# a comment\n\nsay Cut the upper jaw\nclick tab:Plan\nchoose plan-move maxilla\n"
      "  enter plan-file /a folder/plan.json \ndrag handle:P -12 3.5\nwheel plan-undo -5\n"
      "key ctrl+shift+z\nwait plan-step:1\r\npicture last",
      "list");
  ASSERT_EQ(steps.size(), 9u);
  EXPECT_EQ(steps[0].kind, Kind::say);
  EXPECT_EQ(steps[0].words, "Cut the upper jaw");
  EXPECT_EQ(steps[0].line, 3);
  EXPECT_EQ(steps[1].item, "tab:Plan");
  EXPECT_EQ(steps[2].item, "plan-move");
  EXPECT_EQ(steps[2].words, "maxilla");
  EXPECT_EQ(steps[3].words, "/a folder/plan.json");
  EXPECT_EQ(steps[4].right, -12);
  EXPECT_EQ(steps[4].down, 3.5);
  EXPECT_EQ(steps[5].down, -5);
  EXPECT_EQ(steps[6].words, "ctrl+shift+z");
  EXPECT_EQ(steps[7].item, "plan-step:1");
  EXPECT_EQ(steps[8].words, "last");
  EXPECT_EQ(steps[8].line, 11);
}

TEST(InputSteps, AWrongStepIsRefusedWithItsLine) {
  const auto words_of = [](const std::string& text) -> std::string {
    try {
      parse_input_steps("say first\n" + text, "my.steps");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(words_of("clik tab:Plan"),
            "my.steps, line 2: \"clik\" is not a step (did you mean \"click\"?)");
  EXPECT_EQ(words_of("click"), "my.steps, line 2: \"click\" needs the name of an item");
  EXPECT_EQ(words_of("choose plan-move"), "my.steps, line 2: \"choose\" needs words after it");
  EXPECT_EQ(words_of("drag handle:P 3"),
            "my.steps, line 2: \"drag\" needs two numbers, pixels to the right and down");
  EXPECT_EQ(words_of("wheel list five"), "my.steps, line 2: \"wheel\" needs a number of clicks");
  EXPECT_EQ(words_of("wheel list 1e9"),
            "my.steps, line 2: \"wheel\" needs a whole number of at most 100 clicks");
  EXPECT_EQ(words_of("picture ../x"),
            "my.steps, line 2: a picture has a name without a folder, not \"../x\"");
  EXPECT_EQ(words_of("click tab:Plan twice"),
            "my.steps, line 2: \"click\" does not take \"twice\"");
  EXPECT_EQ(words_of("key hyper+q").rfind("my.steps, line 2: \"hyper+q\" is not a key", 0), 0u);
}

TEST(InputSteps, TextsAreUnicode) {
  EXPECT_EQ(letters_of("jö€"), (std::vector<unsigned>{'j', 0xf6, 0x20ac}));
  EXPECT_EQ(letters_of("\U0001f9b7"), std::vector<unsigned>{0x1f9b7});
  EXPECT_EQ(letters_of("a\xff"
                       "b\xc3"),
            (std::vector<unsigned>{'a', 0xfffd, 'b', 0xfffd}));
}

TEST(InputSteps, KeysHaveTheirUsualNames) {
  EXPECT_EQ(named_key("m").key, GLFW_KEY_M);
  EXPECT_EQ(named_key("0").key, GLFW_KEY_0);
  EXPECT_EQ(named_key("Return").key, GLFW_KEY_ENTER);
  const NamedKey undo = named_key("ctrl+z");
  EXPECT_TRUE(undo.ctrl && !undo.shift && undo.key == GLFW_KEY_Z);
  EXPECT_TRUE(named_key("shift+Tab").shift);
  EXPECT_THROW(named_key("ctrl+"), InputError);
}

}  // namespace
}  // namespace condyle
