#include "sim/case/muscle_table.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "engine/core/error.h"
#include "sim/case/jaw_mechanics.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

class MuscleFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("condyle_muscles_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  template <class Read>
  void expect_refused(const Read& read, const std::vector<std::string>& words) const {
    try {
      read();
      FAIL() << words.back();
    } catch (const InputError& error) {
      const std::string message = error.what();
      for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
  void expect_table_refused(const std::string& content, std::vector<std::string> words) const {
    words.push_back("m.csv");
    expect_refused(
        [&] {
          std::vector<std::string> notes;
          read_muscles(write("m.csv", content), notes);
        },
        words);
  }
  std::filesystem::path folder_;
};

const std::string header =
    "name,origin_body,insertion_body,ox_mm,oy_mm,oz_mm,ix_mm,iy_mm,iz_mm,max_force_N";
const std::string good = "\nlat,cranium,jaw,58,-9,144,38,8,58,158";

TEST_F(MuscleFiles, ATableReadsBackAsWritten) {
  std::vector<std::string> notes;
  const auto first = read_muscles(
      write("m.csv",
            header + ",opt_length_mm,max_length_mm,tendon_ratio,abbrev,group" + good +
                ",90.3547,114.7,0.5,at,closer\nta,ltarytenoid,rtarytenoid,0,0,0,1,0,0,20,,,,,\n" +
                "act,thyroid,cricoid,0,0,0,5,0,0,20,,,,,\n"),
      notes);
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("ta, act"), std::string::npos) << notes[0];
  EXPECT_EQ(first[0].kind, "at");
  EXPECT_EQ(first[0].passive_fraction, 0.015);
  const auto again = read_muscles(write("again.csv", muscles_csv(first)), notes);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].origin, first[0].origin);
  EXPECT_EQ(again[0].insertion_body, MuscleBody::mandible);
  EXPECT_EQ(again[0].optimal_length_mm, 90.3547);
  EXPECT_EQ(again[0].tendon_ratio, 0.5);
}

TEST_F(MuscleFiles, MissingLengthsFollowFromThePoints) {
  std::vector<std::string> notes;
  const auto muscles = read_muscles(write("m.csv", header + good + "\n"), notes);
  const double rest = (muscles[0].origin - muscles[0].insertion).norm();
  EXPECT_EQ(muscles[0].optimal_length_mm, rest);
  EXPECT_NEAR(muscles[0].max_length_mm, 1.3 * rest, 1e-9);
  EXPECT_EQ(muscles[0].kind, "lat");
}

TEST_F(MuscleFiles, ErrorsAreRefusedWithTheirLocation) {
  expect_table_refused("", {"empty"});
  expect_table_refused(header + "\n", {"no muscle"});
  expect_table_refused("name,origin_body" + good, {"line 1", "insertion_body"});
  expect_table_refused(header + ",name" + good + ",x", {"line 1", "name", "twice"});
  expect_table_refused(header + "\nlat,cranium,jaw,58,-9", {"line 2", "cut off"});
  expect_table_refused(header + good + good, {"line 3", "lat", "twice"});
  expect_table_refused(header + "\nlat,femur,jaw,58,-9,144,38,8,58,158", {"line 2", "femur"});
  expect_table_refused(header + "\nlat,cranium,jaw,58,nan,144,38,8,58,158",
                       {"line 2", "oy_mm", "nan"});
  expect_table_refused(header + "\nlat,cranium,jaw,58,9,144,38,8,58,-1", {"max_force_N", "-1"});
  expect_table_refused(header + "\nlat,cranium,jaw,58,9,144,58,9,144,1", {"line 2", "coincide"});
  expect_table_refused(header + "\nlat,cranium,jaw,58,9,14400,38,8,58,1", {"oz_mm", "14400"});
  expect_table_refused(header + "\nlat,cranium,maxilla,58,9,144,38,8,58,1", {"none"});
  expect_table_refused(header + ",max_length_mm" + good + ",20", {"max_length_mm", "20"});
}

TEST_F(MuscleFiles, MechanicsReadBackAsWrittenAndAreChecked) {
  const std::string text =
      R"({"jaw": {"mass_kg": 0.2, "com_mm": [0, -9.5, 36], "frame_damping": 60,
          "inertia_about_com_kg_mm2": [[182, 1, 2], [1, 92, 10], [2, 10, 125]]},
          "tmj": {"polyline_posterior_superior_offsets_mm_from_tmj_marker":
                  [[0, 0], [-3, -1.9], [-12, -5]]}})";
  const JawMechanics first = read_mechanics(write("j.json", text));
  EXPECT_EQ(first.mandible.drag_kg_s, 60);
  EXPECT_EQ(first.mandible.inertia(1, 2), 10);
  EXPECT_EQ(first.guide->forward_mm[2], 12);
  EXPECT_EQ(first.guide->inferior_mm[1], 1.9);
  EXPECT_FALSE(first.hyoid);
  const JawMechanics again = read_mechanics(write("k.json", mechanics_json(first)));
  EXPECT_EQ(again.mandible.center, first.mandible.center);
  EXPECT_EQ(again.mandible.inertia, first.mandible.inertia);
  EXPECT_EQ(again.guide->inferior_mm, first.guide->inferior_mm);

  const auto refused = [&](const std::string& from, const std::string& to,
                           std::vector<std::string> words) {
    std::string bad = text;
    ASSERT_NE(bad.find(from), std::string::npos);
    bad.replace(bad.find(from), from.size(), to);
    words.push_back("j.json");
    expect_refused([&] { read_mechanics(write("j.json", bad)); }, words);
  };
  refused("0.2", "-0.2", {"mass_kg", "-0.2"});
  refused("0.2", "\"heavy\"", {"mass_kg"});
  refused("[1, 92, 10]", "[1, -92, 10]", {"inertia", "positive"});
  refused("[1, 92, 10]", "[5, 92, 10]", {"inertia", "symmetric"});
  refused("[1, 92, 10]", "[1, 92]", {"inertia", "2 values"});
  refused("[-3, -1.9]", "[3, -1.9]", {"polyline", "forward"});
  expect_refused([&] { read_mechanics(write("j.json", "{}")); }, {"j.json", "jaw"});
  expect_refused([&] { read_mechanics(write("j.json", "not json")); }, {"j.json"});
}

TEST_F(MuscleFiles, ACaseKeepsItsMusclesAndMechanics) {
  const auto patient = test::case_ubc(test::Driven::by_muscles);
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  EXPECT_EQ(patient->muscles.size(), 34u);
  save_case(*patient, folder_ / "case");
  save_case(*patient, folder_ / "case");  // over itself
  const Case again = load_case(folder_ / "case");
  ASSERT_EQ(again.muscles.size(), 34u);
  for (std::size_t m = 0; m < 34; ++m) {
    EXPECT_EQ(again.muscles[m].name, patient->muscles[m].name);
    EXPECT_EQ(again.muscles[m].origin, patient->muscles[m].origin);
  }
  EXPECT_EQ(again.mechanics->mandible.inertia, patient->mechanics->mandible.inertia);
  EXPECT_EQ(again.mechanics->hyoid->mass_kg, 0.01);
}

}  // namespace
}  // namespace condyle
