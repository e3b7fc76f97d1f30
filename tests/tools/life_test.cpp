// Life of the face is in pictures alone, and only where it is asked for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "render/life/life_signs.h"
#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

/// When the lids are closed for the first time.
double closed_at() {
  double time_s = 0;
  while (life_signs(time_s).lids.left < 1) time_s += 0.001;
  return time_s + 0.01;
}

/// A motion that opens the jaw and ends with closed lids, in three frames.
std::vector<std::string> recording(const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> command = {
      "record",   "--motion", fmt::format("open 20 over {:.3f}", closed_at()),
      "--frames", "3",        "--camera",
      "front",    "--size",   "300x300",
      "--out",    out};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

/// The rows of trace.csv without the times of computation.
std::vector<std::string> measured(const fs::path& out) {
  std::istringstream text(read_text(out / "trace.csv"));
  std::vector<std::string> names, rows;
  std::string line, cell;
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::string row;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (rows.empty()) names.push_back(cell);
      if (!names.at(i).ends_with("_ms")) row += cell + ",";
    }
    rows.push_back(row);
  }
  return rows;
}

TEST(LifeOfTheFace, IsInPicturesAlone) {
  const Folder folder;
  const fs::path plain = fs::path(folder / "plain"), alive = fs::path(folder / "alive");
  Outcome done = condyle(recording(plain, {}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err.find("look only"), std::string::npos);
  done = condyle(recording(alive, {"--life", "--threads", "1"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find("note: look only"), std::string::npos) << done.err;

  ASSERT_EQ(measured(plain).size(), 4u);
  EXPECT_NE(measured(plain).front().find("state_hash"), std::string::npos);
  EXPECT_EQ(measured(plain), measured(alive));
  auto report = [](const fs::path& out) {
    auto all = nlohmann::json::parse(read_text(out / "report.json"));
    all.erase("stage_ms");
    return all;
  };
  auto without = report(plain), with = report(alive);
  EXPECT_TRUE(std::string(with["pictures"]["life"]).starts_with("look only"));
  EXPECT_FALSE(without["pictures"].contains("life"));
  without.erase("pictures");
  with.erase("pictures");
  EXPECT_EQ(without, with);
  const Picture last((plain / "frames/000002.png").string()),
      closed((alive / "frames/000002.png").string());
  EXPECT_TRUE(unlike(last, closed, 0.002));

  // A resumed picture is the same, whatever the number of threads.
  const std::string frame = read_text(alive / "frames/000002.png");
  fs::remove(alive / "frames/000002.png");
  done = condyle(recording(alive, {"--life", "--threads", "2", "--resume"}));
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(read_text(alive / "frames/000002.png"), frame);
  // But not a picture without life.
  done = condyle(recording(alive, {"--resume"}));
  EXPECT_EQ(done.code, 2);
}

TEST(LidsOfAnExpression, AreInPicturesAlone) {
  const Folder folder;
  const auto wink = [&](const char* name, const char* expression,
                        const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = {"record",  "--expression", expression,   "--frames",
                                        "3",       "--camera",     "front",      "--size",
                                        "300x300", "--out",        folder / name};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  };
  const auto recorded = [&](const std::vector<std::string>& command) {
    const Outcome done = condyle(command);
    EXPECT_EQ(done.code, 0) << done.err;
    return fs::path(command[10]);
  };
  const fs::path open = recorded(wink("open", "AU12:0")),
                 closed = recorded(wink("closed", "AU45", {"--threads", "1"})),
                 left = recorded(wink("left", "AU45:1:left")),
                 palsied = recorded(wink("palsied", "AU43", {"--weakness", "right:0"})),
                 raised = recorded(wink("raised", "AU5"));
  EXPECT_EQ(measured(open), measured(closed)) << "hashes, too";
  EXPECT_EQ(measured(open), measured(raised));
  EXPECT_EQ(read_text(open / "expression.csv"), read_text(closed / "expression.csv"));
  const auto last = [](const fs::path& out) {
    return Picture((out / "frames/000002.png").string());
  };
  EXPECT_TRUE(same_bytes(Picture((open / "frames/000000.png").string()),
                         Picture((closed / "frames/000000.png").string())));
  const Region right_half{0, 0, 150, 300}, left_half{150, 0, 150, 300};  // of the patient
  EXPECT_TRUE(unlike(last(open), last(closed), 0.002));
  EXPECT_TRUE(unlike(last(open), last(left), 0.001));
  EXPECT_TRUE(unlike(last(open), last(raised), 0.001));
  EXPECT_TRUE(alike(last(open), last(left), 0, right_half)) << "one eye stays open";
  EXPECT_TRUE(alike(last(closed), last(left), 0, left_half));
  EXPECT_TRUE(same_bytes(last(palsied), last(left))) << "a palsied lid stays open";
  const auto report = nlohmann::json::parse(read_text(closed / "report.json"));
  EXPECT_NE(report["motion"]["notes"].dump().find("upper lids is drawn only"), std::string::npos);
  EXPECT_FALSE(report["pictures"].contains("lids")) << "nothing is missing";

  const std::string frame = read_text(closed / "frames/000002.png");
  fs::remove(closed / "frames/000002.png");
  recorded(wink("closed", "AU45", {"--threads", "2", "--resume"}));
  EXPECT_EQ(condyle(wink("raised", "AU5:0.5", {"--resume"})).code, 2) << "another expression";
  EXPECT_EQ(read_text(closed / "frames/000002.png"), frame);
  EXPECT_EQ(condyle(wink("closed", "AU45:0.5", {"--resume"})).code, 2) << "another expression";

  write_text(folder / "high.csv", "time_s,AU45\n0,0\n1,1.2\n");
  const std::string high = folder / "high.csv";
  const Outcome refused = condyle(wink("high", high.c_str()));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("line 3, AU45"), std::string::npos) << refused.err;
}

TEST(LifeOfTheFace, IsRefusedInPicturesThatCompare) {
  const Folder folder;
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--wipe", "0.5"},
                                               {"--before-after"},
                                               {"--show", "distance"},
                                               {"--overlay", "patches"}}) {
    std::vector<std::string> options = {"--life"};
    options.insert(options.end(), more.begin(), more.end());
    const Outcome done = condyle(recording(folder / "out", options));
    EXPECT_EQ(done.code, 2) << more.front();
    EXPECT_NE(done.err.find("--life"), std::string::npos) << done.err;
  }
}

}  // namespace
}  // namespace condyle::test
