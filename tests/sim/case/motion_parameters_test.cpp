#include "sim/case/motion_parameters.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "tests/support/boxes.h"
#include "tests/support/program.h"

namespace condyle::test {

TEST(MotionParameters, SavedCasesKeepThem) {
  const Folder folder;
  Case patient = box_patient();
  patient.motion.bennett_deg = 11;
  patient.motion.inclination_right_deg = 52.5;
  patient.motion.chew_rate_hz = 1.2;
  save_case(patient, folder.path() / "case");
  const MotionParameters loaded = load_case(folder.path() / "case").motion;
  EXPECT_EQ(loaded.bennett_deg, 11);
  EXPECT_EQ(loaded.inclination_right_deg, 52.5);
  EXPECT_EQ(loaded.chew_rate_hz, 1.2);
  EXPECT_FALSE(loaded.inclination_left_deg);
}

TEST(MotionParameters, WrongOnesInACaseAreNamedWithTheirFileAndRange) {
  const Folder folder;
  const auto home = folder.path() / "case";
  save_case(box_patient(), home);
  const std::string good = read_text(home / "case.json");
  const auto expect_refused = [&](const std::string& motion, const std::string& word) {
    std::string text = good;
    text.insert(text.find('{') + 1, "\"motion\": " + motion + ",");
    write_text(home / "case.json", text);
    try {
      load_case(home);
      ADD_FAILURE() << motion;
    } catch (const InputError& error) {
      for (const std::string& part : {std::string("case.json"), std::string("motion"), word})
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect_refused("{\"bennett_deg\": 90}", "from 0 to 40");
  expect_refused("{\"bennett_deg\": \"ten\"}", "ten");
  expect_refused("{\"bennet_deg\": 9}", "bennett_deg");
  expect_refused("{\"bennett\": 9}", "bennett_deg");
  expect_refused("[1]", "object");
}

TEST(MotionParameters, NamesAndKeysAreUniqueAndCommandsComeBeforeTheCase) {
  std::set<std::string> names;
  for (const auto& entry : motion_parameter_names()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_LT(entry.low, entry.high);
    EXPECT_EQ(motion_parameter(entry.key()), &entry);
  }
  const MotionParameters both =
      MotionParameters{.hinge_deg = 5}.over({.hinge_deg = 9, .bennett_deg = 3});
  EXPECT_EQ(both.hinge_deg, 5);
  EXPECT_EQ(both.bennett_deg, 3);
}

}  // namespace condyle::test
