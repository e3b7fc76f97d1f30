// The soft tissue of a motion in report.json, against the trace of the same motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

struct TissueOf {
  nlohmann::json report;                              // of the report
  std::map<std::string, std::vector<double>> traced;  // columns
};

TissueOf opened(const std::vector<std::string>& more) {
  const Folder folder;
  std::vector<std::string> arguments = {"run", "--motion", "open 20 over 0.15", "--frames",
                                        "4",   "--out",    folder / "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto outcome = condyle(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  TissueOf tissue;
  tissue.report = nlohmann::json::parse(read_text(folder / "out/report.json"))["tissue"];
  std::istringstream trace(read_text(folder / "out/trace.csv"));
  const auto cells = [&] {
    std::vector<std::string> list;
    std::string line, cell;
    std::getline(trace, line);
    for (std::istringstream row(line); std::getline(row, cell, ',');) list.push_back(cell);
    return list;
  };
  const auto names = cells();
  for (auto row = cells(); row.size() == names.size(); row = cells())
    for (std::size_t i = 0; i < row.size(); ++i)
      tissue.traced[names[i]].push_back(std::strtod(row[i].c_str(), nullptr));
  return tissue;
}

TEST(TissueReport, ReportsTheTissuesForcesAtRestAndItsSlip) {
  const TissueOf sliding = opened({}), glued = opened({"--glued"});
  for (const TissueOf* one : {&sliding, &glued}) {
    // In equilibrium at rest, to rounding: less than the weight of a grain of dust.
    const double force_N = one->report["at_rest"]["largest_force_N"];
    EXPECT_GT(force_N, 0);
    EXPECT_LT(force_N, 1e-9);
    const auto& slips = one->traced.at("tissue_slip_mm");
    ASSERT_EQ(slips.size(), 4u);
    EXPECT_EQ(slips.front(), 0);
    EXPECT_DOUBLE_EQ(one->report["max_slip_mm"], *std::max_element(slips.begin(), slips.end()));
  }
  // No farther than the bone moves below it.
  const double slip_mm = sliding.report["max_slip_mm"];
  EXPECT_GT(slip_mm, 3);
  EXPECT_LT(slip_mm, 20);
  EXPECT_LT(glued.report["max_slip_mm"], 0.6 * slip_mm);
}

}  // namespace
}  // namespace condyle::test
