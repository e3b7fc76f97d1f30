// Soft-tissue settings that cannot be: one clear line with the option or file, the item and the
// value; exit code 2. Valid ones round-trip through a case.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

void expect_refused(const std::vector<std::string>& arguments,
                    const std::vector<std::string>& expected) {
  const auto outcome = condyle(arguments);
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const auto& word : expected)
    EXPECT_NE(outcome.err.find(word), std::string::npos)
        << "misses " << word << " in " << outcome.err;
}

TEST(TissueInput, OptionsOutOfRangeAreNamed) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto refused = [&](const std::string& option, const std::string& value,
                           const std::vector<std::string>& expected) {
    expect_refused({"run", patient, "--motion", "opening", "--out", folder / "out", option, value},
                   expected);
  };
  refused("--turgor", "1.5", {"turgor", "1.5"});
  refused("--turgor", "nan", {"turgor", "nan"});
  refused("--turgor", "0", {"turgor", "above 0", "not 0"});
  refused("--turgor", "-0.3", {"turgor", "-0.3"});
  refused("--lambda", "0", {"lambda", "0"});
  refused("--lambda", "1", {"lambda", "not 1"});
  refused("--layers", "4", {"layers", "4"});
  refused("--gravity", "0,0,0", {"direction of gravity is 0, 0, 0"});
  refused("--gravity", "0,nan,1", {"gravity", "nan"});
  refused("--gravity", "inf,0,1", {"gravity", "inf"});
  refused("--gravity", "down", {"--gravity", "down"});
  refused("--attach", "tibia,pogonion,10", {"--attach", "tibia"});
  refused("--attach", "mandible,pogonion,-4", {"radius", "-4"});
}

TEST(TissueInput, CasesNameTheFileTheItemAndTheValue) {
  const Folder folder;
  const std::string good = box_case(folder);
  const std::filesystem::path file = std::filesystem::path(good) / "case.json";
  const std::string json = read_text(file);
  const auto with = [&](const std::string& tissue) {
    write_text(file, "{\n \"tissue\": " + tissue + "," + json.substr(json.find('{') + 1));
  };
  const auto refused = [&](const std::string& tissue, std::vector<std::string> expected) {
    with(tissue);
    expected.push_back("case.json");
    expect_refused({"info", good}, expected);
  };
  refused("{\"turgor\": 7}", {"tissue.turgor", "7"});
  refused("{\"turgor\": 0}", {"turgor", "above 0"});
  refused("{\"turgor\": NaN}", {"line", "JSON"});
  refused("{\"turgor\": 1e999}", {"JSON", "1e999"});
  refused("{\"gravity\": [0, 0, 0]}", {"direction of gravity is 0, 0, 0"});
  refused("{\"gravity\": [0, 1e300, 0]}", {"tissue.gravity[1]", "1e+300"});
  refused("{\"layers\": [{\"share\": 1, \"modulus_MPa\": 0}]}", {"modulus", "not 0"});
  refused("{\"layers\": [{\"share\": 1, \"poisson\": 0.5}]}", {"Poisson", "0.5"});
  refused("{\"layers\": [{\"share\": 0}, {\"share\": 1}]}", {"share", "not 0"});
  refused("{\"attachments\": [{\"bone\": \"mandible\", \"centre\": [0, 0, 1e300]}]}",
          {"attachments[0].centre[2]", "1e+300"});
  refused("{\"lambda\": -1}", {"tissue.lambda", "-1"});
  refused("{\"stiffness\": 1}", {"stiffness", "turgor"});
  refused("{\"layers\": [{\"share\": 0.5}]}", {"tissue", "0.5"});
  refused("{\"layers\": [{\"share\": 1, \"modulus_MPa\": 1e9}]}", {"modulus_MPa", "layers[0]"});
  refused("{\"bond\": \"loose\"}", {"bond", "loose"});
  refused("{\"attachments\": [{\"bone\": \"rib\"}]}", {"attachments[0].bone", "rib"});
  with(
      "{\"layers\": 2, \"turgor\": 0.9, \"gravity\": [0, 0, -1], \"bond\": \"glued\", "
      "\"attachments\": [{\"bone\": \"mandible\", \"centre\": [1, 2, 3], \"radius_mm\": 12}]}");
  EXPECT_EQ(condyle({"info", good}).code, 0);
}

}  // namespace
}  // namespace condyle::test
