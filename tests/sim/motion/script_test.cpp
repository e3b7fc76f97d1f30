#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "sim/motion/motion_script.h"

namespace condyle::test {
namespace {

/// The error message for a text.
std::string refusal(const std::string& text) {
  try {
    parse_motion_script(text, "a.motion");
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "\"" << text << "\" was taken";
  return {};
}

}  // namespace

TEST(MotionScript, ReadsMovementsOnLinesAndBetweenSemicolons) {
  const auto script = parse_motion_script(
      "\n# a comment; with a semicolon\nset bennett 10 deg\nOPEN 40mm over 1.5 s # wide\r\n"
      "close; protrude 6 mm at 30 mm/s ;; chew left 3 cycles rate 1.2 size 12 width 4\nhold .5\n"
      "left; right 7\nposselt over 8",
      "a.motion");
  EXPECT_EQ(script.parameters.bennett_deg, 10);
  ASSERT_EQ(script.statements.size(), 8u);
  EXPECT_EQ(script.statements[0].verb, Verb::open);
  EXPECT_EQ(script.statements[0].amount, 40);
  EXPECT_EQ(script.statements[0].duration_s, 1.5);
  EXPECT_EQ(script.statements[1].verb, Verb::close);
  EXPECT_FALSE(script.statements[1].amount);
  EXPECT_EQ(script.statements[2].speed_mm_s, 30);
  EXPECT_EQ(script.statements[3].verb, Verb::chew_left);
  EXPECT_EQ(script.statements[3].amount, 3);
  EXPECT_EQ(script.statements[3].rate_hz, 1.2);
  EXPECT_EQ(script.statements[3].size_mm, 12);
  EXPECT_EQ(script.statements[3].width_mm, 4);
  EXPECT_EQ(script.statements[4].amount, 0.5);
  EXPECT_FALSE(script.statements[5].amount);
  EXPECT_EQ(script.statements[6].verb, Verb::right);
  EXPECT_EQ(script.statements[7].duration_s, 8);
}

TEST(MotionScript, ReadsExpressionsAloneAndBesideTheJaw) {
  const auto script = parse_motion_script(
      "smile 0.8 over 0.5; open 10; AU12 left and au15 .3 right over 2 s and open 20 over 1;"
      "close at 10 and sad; neutral right; smile",
      "a.motion");
  ASSERT_EQ(script.statements.size(), 6u);
  const Statement& smile = script.statements[0];
  EXPECT_EQ(smile.verb, Verb::face);
  ASSERT_EQ(smile.face.size(), 1u);
  EXPECT_EQ(smile.face[0].expression, "smile");
  EXPECT_EQ(smile.face[0].strength, 0.8);
  EXPECT_TRUE(smile.face[0].left && smile.face[0].right);
  EXPECT_EQ(smile.face_duration_s, 0.5);
  EXPECT_TRUE(script.statements[1].face.empty());
  const Statement& both = script.statements[2];
  EXPECT_EQ(both.verb, Verb::open);
  EXPECT_EQ(both.amount, 20);
  EXPECT_EQ(both.duration_s, 1);
  EXPECT_EQ(both.face_duration_s, 2);
  ASSERT_EQ(both.face.size(), 2u);
  EXPECT_EQ(both.face[0].expression, "AU12");
  EXPECT_TRUE(both.face[0].left && !both.face[0].right);
  EXPECT_EQ(both.face[1].strength, 0.3);
  EXPECT_TRUE(!both.face[1].left && both.face[1].right);
  EXPECT_EQ(script.statements[3].verb, Verb::close);
  EXPECT_EQ(script.statements[3].speed_mm_s, 10);
  EXPECT_EQ(script.statements[3].face.size(), 1u);
  EXPECT_EQ(script.statements[4].face[0].expression, "");
  EXPECT_FALSE(script.statements[4].face[0].left);
  EXPECT_EQ(script.statements[5].face[0].strength, 1);
}

TEST(MotionScript, NamesLineAndWordOfASyntaxError) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong = {
      {"open forty", {"line 1", "word 2", "\"forty\"", "open"}},
      {"smile 1.5", {"line 1", "word 2", "\"1.5\"", "0 to 1"}},
      {"smile -0.1", {"\"-0.1\"", "0 to 1"}},
      {"close; smirk 0.5", {"\"smirk\"", "not a movement", "AU12"}},
      {"smile 0.5 up", {"word 3", "\"up\"", "left or right"}},
      {"smile left 8", {"word 3", "\"8\"", "left or right"}},
      {"smile over 0", {"\"0\"", "0.05 to 3600"}},
      {"smile and", {"\"and\"", "must be followed by"}},
      {"smile and smirk", {"\"smirk\"", "neither an expression nor a movement"}},
      {"open 10 and left 5", {"\"left\"", "not the name of an expression"}},
      {"open 10 and smile and close", {"\"close\"", "second movement"}},
      {"neutral 0.5", {"\"0.5\"", "not understood"}},
      {"blink and smile 0.5 left",
       {"word 3 \"smile\": a blink may be joined with a movement of the jaw only"}},
      {"smile and blink", {"\"blink\": a blink may be joined with a movement of the jaw only"}},
      {"blink over 1", {"word 2 \"over\": a blink takes no duration"}},
      {"blink 0.5 up", {"\"up\": is not understood", "movement of the jaw"}},
      {"blink 1.2", {"\"1.2\"", "0 to 1"}},
      {"close\n\nopne 40", {"line 3", "\"opne\"", "not a movement", "protrude"}},
      {"open 400", {"\"400\"", "range", "80 mm"}},
      {"open -3", {"\"-3\"", "range"}},
      {"open nan", {"\"nan\""}},
      {"open 4 cm", {"\"cm\"", "mm is expected"}},
      {"open 40 quickly", {"word 3", "\"quickly\"", "over"}},
      {"open 40 over", {"\"over\"", "followed by"}},
      {"open 40 over 0", {"\"0\"", "0.05"}},
      {"close 3", {"\"3\"", "takes no number"}},
      {"hold", {"seconds"}},
      {"hold 1 over 2", {"\"over\"", "seconds only"}},
      {"hinge", {"degrees"}},
      {"chew", {"left or right"}},
      {"chew both 3", {"\"both\"", "left or right"}},
      {"chew left 3 at 5", {"\"at\"", "rate"}},
      {"chew left many", {"\"many\"", "cycles"}},
      {"set", {"parameter"}},
      {"set bennet 10", {"\"bennet\"", "bennett"}},
      {"set bennett 99", {"\"99\"", "40 deg"}},
      {"set bennett 9 9", {"too many"}},
      {"open; set bennett 10", {"before the first movement"}},
      {"", {"a.motion", "no movement"}},
      {"# only words about it", {"no movement"}},
      {"\x01\xff", {"line 1"}}};
  for (const auto& [text, words] : wrong) {
    const std::string said = refusal(text);
    EXPECT_NE(said.find("a.motion"), std::string::npos) << said;
    for (const auto& word : words) EXPECT_NE(said.find(word), std::string::npos) << said;
  }
}

TEST(MotionScript, RandomTextIsAcceptedOrRefusedWithoutCrashing) {
  const std::vector<std::string> words = {"open", "40",   "close", ";",  "\n", "over", "1e9",  "-",
                                          "set",  "chew", "left",  "mm", "#",  "at",   "1e-9", ""};
  unsigned state = 7;
  for (int round = 0; round < 3000; ++round) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
      state = state * 1664525u + 1013904223u;
      text += words[(state >> 16) % words.size()] + ((state & 1024) ? " " : "");
    }
    try {
      EXPECT_FALSE(parse_motion_script(text, "noise").statements.empty());
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("noise"), std::string::npos);
    }
  }
}

TEST(MotionScript, EveryParameterCanBeSetByNameAndByKey) {
  for (const auto& entry : motion_parameter_names()) {
    const double value = 0.5 * (entry.low + entry.high);
    for (const auto& name : {entry.name, entry.key()}) {
      const auto script =
          parse_motion_script("set " + name + " " + std::to_string(value) + "\nclose", "a");
      for (const auto member : entry.values)
        EXPECT_NEAR((script.parameters.*member).value(), value, 1e-5) << name;
    }
  }
}

}  // namespace condyle::test
