#include "sim/plan/move_words.h"

#include <gtest/gtest.h>

#include <vector>

#include "engine/core/error.h"
#include "tests/sim/plan/marks.h"

using namespace condyle;
using namespace condyle::test;

namespace {

WrittenMove parse_words(const std::vector<std::string>& words) { return parse_move_words(words); }

std::string words_refusal(const std::vector<std::string>& words) {
  try {
    parse_words(words);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the words were accepted";
  return "";
}

}  // namespace

TEST(MoveWords, AreReadInAnyOrder) {
  const ClinicalMove move{.about = "upper_incisal_point",
                          .left_mm = -1,
                          .forward_mm = 4,
                          .up_mm = 2,
                          .roll_deg = -0.5,
                          .pitch_deg = 2.3,
                          .yaw_deg = 1};
  EXPECT_EQ(parse_words({"forward", "4", "up", "2", "right", "1", "pitch", "2.3", "yaw", "1",
                         "cant", "-0.5", "about", "upper_incisal_point"})
                .move,
            move);
  EXPECT_EQ(
      parse_words({"about U1 yaw 1, roll -0.5, pitch 2.3, left -1;", "impact 2,", "advance", "4"})
          .move,
      move);
  EXPECT_EQ(parse_words({"setback", "3", "down", "1", "about", "centroid"}).move,
            (ClinicalMove{.about = "centroid", .forward_mm = -3, .up_mm = -1}));
}

TEST(MoveWords, ASecondPointsHeightBecomesAPitch) {
  const Landmarks marks = upright_marks();
  const ClinicalFrame frame = clinical_frame(marks);
  const WrittenMove written = parse_words({"forward", "4", "up", "2", "pns", "up", "4"});
  ASSERT_TRUE(written.height);
  EXPECT_EQ(written.height->landmark, "pns");
  const ClinicalMove move = completed_move(written, "maxilla", marks, frame);
  const Eigen::Vector3d point = *marks.find("upper_incisal_point"), pns = *marks.find("pns");
  const Pose X = move_pose(move, frame, point);
  EXPECT_NEAR((X * point - point).y(), -4, 1e-9);
  EXPECT_NEAR((X * point - point).z(), 2, 1e-9);
  EXPECT_NEAR((X * pns - pns).z(), 4, 1e-9);
  EXPECT_THROW(completed_move(written, "distal", marks, frame), InputError);  // its centroid
  EXPECT_THROW(completed_move(parse_words({"up", "1", "about", "menton"}), "distal", marks, frame),
               InputError);
}

TEST(MoveWords, ErrorsNameTheWord) {
  const auto has = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  has(words_refusal({}), "empty");
  has(words_refusal({"forwrad", "4"}), "did you mean \"forward\"");
  has(words_refusal({"forward"}), "needs a number");
  has(words_refusal({"forward", "4mm"}), "\"4mm\" is not a number");
  has(words_refusal({"up", "nan"}), "not a number");
  has(words_refusal({"up", "1", "down", "2"}), "twice");
  has(words_refusal({"up", "1", "about"}), "about");
  has(words_refusal({"forward", "200"}), "200");
  has(words_refusal({"pitch", "2", "pns", "up", "4"}), "exclude");
}
