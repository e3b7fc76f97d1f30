// A transplant that is let go over the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

/// The box patient's surfaces with a strut above the maxilla's.
std::string with_strut(const Folder& folder) {
  write_box_patient(folder.path());
  const double low[] = {5, -60, 0.5}, high[] = {25, -54, 4.5};
  std::string obj;
  for (int i = 0; i < 8; ++i) {
    obj += "v";
    for (int k = 0; k < 3; ++k) obj += " " + std::to_string((i >> k & 1) ? high[k] : low[k]);
    obj += "\n";
  }
  obj += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  write_text(folder / "strut.obj", obj);
  return folder / "strut.obj";
}

TEST(LetGo, ATransplantComesToLieOnBoneAndItsCaseIsSaved) {
  const Folder folder;
  const std::string strut = with_strut(folder), patient = folder / "case", out = folder / "settled";
  std::vector<std::string> import = {"import", "meshes"};
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    for (const std::string role : {"maxilla", "mandible"})
      if (name == role + ".stl") {
        import.push_back("--" + role);
        import.push_back(entry.path().string());
      }
  }
  ASSERT_EQ(import.size(), 6u);
  import.insert(import.end(), {"--transplant", strut, "--out", patient});
  ASSERT_EQ(condyle(import).code, 0);
  const auto outcome =
      condyle({"let-go", patient, "--push", "0,0,-5", "--out", out, "--json", "--quiet"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["at_rest"]);
  EXPECT_LT(json["depth_mm"], 0.05);
  EXPECT_GE(json["contacts"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(out + "/case.json"));
  // Where it lies now, it stays.
  const auto again = condyle({"let-go", out, "--push", "0,0,-5", "--json", "--quiet"});
  ASSERT_EQ(again.code, 0) << again.err;
  for (const auto& t : nlohmann::json::parse(again.out)["translation_mm"])
    EXPECT_NEAR(t.get<double>(), 0, 0.05);
}

TEST(LetGo, BadInputIsRefusedWithWords) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& word) {
    std::vector<std::string> command = {"let-go", patient};
    command.insert(command.end(), more.begin(), more.end());
    const auto outcome = condyle(command);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  refused({"--push", "0,0,-5"}, "no segment or transplant");
  refused({"--push", "0,0"}, "--push");
  refused({}, "--push");
}

}  // namespace
}  // namespace condyle::test
