// Results of a run with glued and with sliding tissue.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

TEST(TissueBond, ReportsOfGluedAndSlidingRunsGiveConvergenceAndSlip) {
  const Folder folder;
  const auto tissue = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run", "--motion", "open 15; close", "--frames",
                                       "16",  "--out",    folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = condyle(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(read_text(folder / (name + "/report.json"))).at("tissue");
  };
  const auto sliding = tissue("sliding", {}), glued = tissue("glued", {"--glued"});
  for (const auto* report : {&sliding, &glued}) {
    EXPECT_EQ(report->at("frames_not_converged"), 0);
    EXPECT_EQ(report->at("frames_with_inverted_prisms"), 0);
    EXPECT_LT(report->at("max_penetration_mm"), 0.2);
  }
  EXPECT_GT(glued.at("attached_to_mandible"), sliding.at("attached_to_mandible"));
  const double slip = sliding.at("max_slip_mm"), glued_slip = glued.at("max_slip_mm");
  EXPECT_GT(slip, 2);
  EXPECT_LT(glued_slip, slip);
  const auto gap = [](const nlohmann::json& report) {
    return report.at("at_widest_opening").at("lip_gap_mm").get<double>();
  };
  EXPECT_GT(std::abs(gap(sliding) - gap(glued)), 0.05);
}

}  // namespace
}  // namespace condyle::test
