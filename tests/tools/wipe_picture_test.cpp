// Recordings of a planned patient beside the one before the operation.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

TEST(Record, LeftOfAWipeIsThePatientBeforeTheOperation) {
  const Folder folder;
  const std::string plan = folder / "plan.json";
  ASSERT_EQ(condyle({"plan", "new", "--out", plan}).code, 0);
  ASSERT_EQ(condyle({"plan", "cut", plan, "genioplasty"}).code, 0);
  ASSERT_EQ(condyle({"plan", "move", plan, "chin", "forward", "8"}).code, 0);
  const auto recorded = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words = {"record",     "--motion",        "rest",    "--frames",
                                      "1",          "--size",          "480x360", "--camera",
                                      "left",       "--surface-nodes", "150",     "--out",
                                      folder / name};
    words.insert(words.end(), options.begin(), options.end());
    const auto outcome = condyle(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Picture(folder / (name + "/frames/000000.png"));
  };
  const Picture uncut = recorded("uncut", {});
  const Picture before = recorded("before", {"--plan", plan, "--wipe", "1"});
  const Picture after = recorded("after", {"--plan", plan, "--wipe", "0"});
  EXPECT_TRUE(alike(before, uncut, 0.003));
  EXPECT_TRUE(unlike(after, before, 0.002)) << "the chin lies farther forward";
}

}  // namespace
}  // namespace condyle::test
