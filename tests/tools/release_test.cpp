// Release of a transplant on the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

/// A strut above the box patient's maxilla, with its lower side at a height.
std::string strut(const Folder& folder, const std::string& name, double z_mm) {
  const double low[] = {5, -60, z_mm}, high[] = {25, -54, z_mm + 4};
  std::string obj;
  for (int i = 0; i < 8; ++i) {
    obj += "v";
    for (int k = 0; k < 3; ++k) obj += " " + std::to_string((i >> k & 1) ? high[k] : low[k]);
    obj += "\n";
  }
  obj += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  write_text(folder / name, obj);
  return folder / name;
}

/// A case of the box patient's jaws and these transplants.
std::string case_with(const Folder& folder, const std::vector<std::string>& transplants) {
  write_box_patient(folder.path());
  std::vector<std::string> import = {"import", "meshes"};
  for (const std::string role : {"maxilla", "mandible"})
    import.insert(import.end(), {"--" + role, folder / (role + ".stl")});
  for (const auto& transplant : transplants)
    import.insert(import.end(), {"--transplant", transplant});
  import.insert(import.end(), {"--out", folder / "case"});
  EXPECT_EQ(condyle(import).code, 0);
  return folder / "case";
}

TEST(Release, ATransplantComesToLieOnBoneAndItsCaseIsSaved) {
  const Folder folder;
  const std::string patient = case_with(folder, {strut(folder, "strut.obj", 0.5)}),
                    out = folder / "settled";
  const auto outcome =
      condyle({"release", patient, "--push", "0,0,-5", "--out", out, "--json", "--quiet"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_TRUE(json["at_rest"]);
  EXPECT_LT(json["depth_mm"], 0.05);
  EXPECT_GE(json["contacts"].size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(out + "/case.json"));
  // Released again, it stays.
  // By the command's earlier name.
  const auto again = condyle({"let-go", out, "--push", "0,0,-5", "--json", "--quiet"});
  ASSERT_EQ(again.code, 0) << again.err;
  const auto after = nlohmann::json::parse(again.out);
  for (const auto& t : after["moved"][0]["translation_mm"]) EXPECT_NEAR(t.get<double>(), 0, 0.05);
}

TEST(Release, PartsPushEachOtherOntoTheBone) {
  const Folder folder;
  const std::string patient = case_with(
                        folder, {strut(folder, "lower.obj", 0.5), strut(folder, "upper.obj", 6)}),
                    out = folder / "settled";
  const auto outcome = condyle({"release", patient, "--part", "transplant-2", "--yields",
                                "transplant", "--push", "0,0,-5", "--out", out, "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("transplant-2: touches transplant at "), std::string::npos)
      << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_LT(json["depth_mm"], 0.05);
  ASSERT_EQ(json["moved"].size(), 2u);
  EXPECT_NEAR(json["moved"][0]["translation_mm"][2], -2, 0.1);
  EXPECT_NEAR(json["moved"][1]["translation_mm"][2], -0.5, 0.1);
  std::map<std::string, double> push_on;  // of all places, on what they lie
  for (const auto& contact : json["contacts"])
    push_on[contact["on"]] += contact["push_N"].get<double>();
  EXPECT_EQ(push_on.size(), 2u);
  for (const auto& [on, push_N] : push_on) EXPECT_NEAR(push_N, 5, 0.3) << on;
  const auto check = condyle({"check", out, "--motion", "open 1", "--out", folder / "check"});
  EXPECT_EQ(check.code, 0) << check.err;
}

TEST(Release, WhatStartsDeepInBoneIsRefusedAndNothingIsSaved) {
  const Folder folder;
  for (const double z_mm : {-3.0, -8.0}) {  // half in, and wholly
    const std::string patient = case_with(folder, {strut(folder, "deep.obj", z_mm)}),
                      out = folder / "settled";
    const auto outcome = condyle({"release", patient, "--push", "0,0,-5", "--out", out});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("mm deep in maxilla; move it out"), std::string::npos)
        << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(Release, BadInputIsRefusedWithWords) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& word) {
    std::vector<std::string> command = {"release", patient};
    command.insert(command.end(), more.begin(), more.end());
    const auto outcome = condyle(command);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  refused({"--push", "0,0,-5"}, "no segment or transplant");
  refused({"--push", "0,0"}, "--push");
  refused({}, "--push");
  refused({"--push", "0,0,-5", "--yields", "nobody"}, "no segment or transplant");
}

}  // namespace
}  // namespace condyle::test
