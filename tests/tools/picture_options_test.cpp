// Options of `record`: hidden parts, overlays and texts of pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

class PictureOptions : public testing::Test {
 protected:
  Folder folder_;
  std::string patient_ = box_case(folder_);

  std::vector<std::string> command(const std::string& out,
                                   const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"record",   patient_,     "--motion", "open 20 over 0.1",
                                    "--frames", "2",          "--size",   "240x180",
                                    "--out",    folder_ / out};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// The second frame, opened.
  Picture opened(const std::string& out, const std::vector<std::string>& more) const {
    const auto outcome = condyle(command(out, more));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Picture(folder_ / (out + "/frames/000001.png"));
  }
};

TEST_F(PictureOptions, EachOfThemChangesThePicture) {
  const Picture plain = opened("plain", {});
  ASSERT_FALSE(plain.empty());
  EXPECT_TRUE(same_bytes(plain, opened("again", {})));
  int number = 0;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--clip", "left:5"},
           {"--clip", "0,0,0,0,-1,0", "--clip-open"},
           {"--clip", "left", "--clip-parts", "mandible"},
           {"--overlay", "ghost"},
           {"--overlay", "wireframe:mandible"},
           {"--overlay", "axes"},
           {"--overlay", "paths"},
           {"--overlay", "muscles"},
           {"--overlay", "scale"},
           {"--overlay", "letters"},
           {"--caption", "Opening {opening} mm|{motion} {time} s"},
           {"--wipe", "0.5"},
           {"--transparent"}}) {
    std::string words;
    for (const auto& word : more) words += word + " ";
    EXPECT_TRUE(unlike(opened("other" + std::to_string(number++), more), plain, 1e-4)) << words;
  }
  // Other antialiasing: nearly the same picture.
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--edges", "fxaa"}, {"--edges", "none", "--supersample", "2"}}) {
    const Picture smooth = opened("smooth" + std::to_string(number++), more);
    EXPECT_TRUE(unlike(smooth, plain, 0)) << more[1];
    EXPECT_TRUE(alike(smooth, plain, 0.06)) << more[1];
  }
}

TEST_F(PictureOptions, AGhostIsInTheKey) {
  opened("plain", {});
  opened("ghost", {"--overlay", "ghost"});
  const Picture plain(folder_ / "plain/frames/000000.png"),
      ghost(folder_ / "ghost/frames/000000.png");
  EXPECT_TRUE(unlike(ghost, plain, 1e-3)) << "nothing has moved yet: the key alone";
}

TEST_F(PictureOptions, SeveralCamerasAndAPathAreRecordedAtOnce) {
  write_text(folder_ / "around.json",
             R"({"path": [{"view": "front"}, {"view": "left", "distance_mm": 300}]})");
  const auto outcome =
      condyle(command("many", {"--camera", "front,left," + folder_ / "around.json"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto frame = [&](const std::string& camera, const std::string& number) {
    return Picture(folder_ / ("many/" + camera + "/frames/00000" + number + ".png"));
  };
  EXPECT_TRUE(alike(frame("around", "0"), frame("front", "0"), 0));
  EXPECT_TRUE(unlike(frame("around", "1"), frame("left", "1"), 0.01));  // nearer
  EXPECT_TRUE(unlike(frame("around", "1"), frame("front", "1"), 0.01));
  // One camera alone gives the same bits.
  EXPECT_TRUE(same_bytes(opened("left", {"--camera", "left"}), frame("left", "1")));
  EXPECT_EQ(read_text(folder_ / "many/left/hashes.csv"), read_text(folder_ / "left/hashes.csv"));
}

TEST_F(PictureOptions, WrongOnesAreNamedWithWhatIsKnown) {
  write_text(folder_ / "bad.json", R"({"path": [{"view": "front", "at": 0.5}, {"at": 0.2}]})");
  write_text(folder_ / "odd.json", R"({"view": "front", "zoom": 2})");
  const std::map<std::string, std::pair<std::vector<std::string>, std::string>> cases = {
      {"side", {{"--clip", "sideways"}, "left, right, front, back, above or below"}},
      {"zero", {{"--clip", "0,0,0,0,0,0"}, "must not be zero"}},
      {"parts", {{"--clip", "left", "--clip-parts", "nose"}, "known are all"}},
      {"alone", {{"--clip-open"}, "need --clip"}},
      {"hole", {{"--cut-away", "nowhere,20"}, "no landmark nowhere"}},
      {"radius", {{"--cut-away", "0,0,0,-3"}, "above 0"}},
      {"overlay", {{"--overlay", "halo"}, "bone-springs"}},
      {"caption", {{"--caption", "{speed}"}, "{opening}"}},
      {"twice", {{"--camera", "front,front"}, "two cameras are named front"}},
      {"path", {{"--camera", folder_ / "bad.json"}, "must be later"}},
      {"key", {{"--camera", folder_ / "odd.json"}, "zoom"}},
      // Two samples are four on some drivers: the same command would draw different pictures.
      {"edges", {{"--edges", "msaa2"}, "msaa4"}}};
  for (const auto& [name, wrong] : cases) {
    const auto outcome = condyle(command(name, wrong.first));
    EXPECT_EQ(outcome.code, 2) << name;
    EXPECT_NE(outcome.err.find(wrong.second), std::string::npos) << name << ": " << outcome.err;
  }
}

TEST_F(PictureOptions, WhatTheDriverCannotDrawIsSaidInASentence) {
  auto too_large = command("large", {"--supersample", "4"});
  std::replace(too_large.begin(), too_large.end(), std::string("240x180"),
               std::string("8192x8192"));
  const auto large = condyle(too_large);
  EXPECT_EQ(large.code, 1);
  EXPECT_NE(large.err.find("8192x8192 are too large"), std::string::npos) << large.err;
  ::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", 1);
  const auto none = condyle(command("none", {}));
  ::unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("install libegl1"), std::string::npos) << none.err;
}

/// `condyle` with one of Mesa's software drivers, regardless of any card: softpipe, or zink, which
/// uses Vulkan as that of a card would.
Outcome condyle_with(const std::string& driver, const std::vector<std::string>& arguments) {
  const std::map<std::string, std::string> forced = {
      {"__EGL_VENDOR_LIBRARY_FILENAMES", "/usr/share/glvnd/egl_vendor.d/50_mesa.json"},
      {"LIBGL_ALWAYS_SOFTWARE", "1"},
      {driver == "zink" ? "MESA_LOADER_DRIVER_OVERRIDE" : "GALLIUM_DRIVER", driver}};
  for (const auto& [name, value] : forced) ::setenv(name.c_str(), value.c_str(), 1);
  auto outcome = condyle(arguments);
  for (const auto& [name, value] : forced) ::unsetenv(name.c_str());
  return outcome;
}

nlohmann::json drawn_with(const std::string& folder) {
  return nlohmann::json::parse(read_text(folder + "/report.json"))["pictures"];
}

TEST(Drivers, ThreeDrawThePatientAlike) {
  // The default driver (a card's, if there is one) and two others: bones, teeth, glassy skin,
  // shadows.
  const Folder folder;
  const auto record = [&](const std::string& out) {
    return std::vector<std::string>{"record",
                                    "--motion",
                                    "open 25 over 0.1",
                                    "--frames",
                                    "2",
                                    "--size",
                                    "480x480",
                                    "--edges",
                                    "fxaa",
                                    "--show",
                                    "skin:0.4,bones,teeth",
                                    "--no-tissue",
                                    "--out",
                                    folder / out};
  };
  const auto by_default = condyle(record("by_default"));
  ASSERT_EQ(by_default.code, 0) << by_default.err;
  for (const std::string driver : {"softpipe", "zink"}) {
    const auto other = condyle_with(driver, record(driver));
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_NE(drawn_with(folder / driver)["driver"].dump().find(driver), std::string::npos);
    EXPECT_EQ(drawn_with(folder / "by_default")["driver"].dump().find(driver), std::string::npos);
    for (const std::string frame : {"/frames/000000.png", "/frames/000001.png"})
      EXPECT_TRUE(alike(Picture(folder / ("by_default" + frame)),
                        Picture(folder / (driver + frame)), 0.0005))
          << driver;
  }
  EXPECT_TRUE(unlike(Picture(folder / "by_default/frames/000000.png"),
                     Picture(folder / "by_default/frames/000001.png"), 0.01));
}

TEST_F(PictureOptions, ResumedWithAnotherDriverTheReportNamesBoth) {
  ASSERT_EQ(condyle_with("softpipe", command("resumed", {"--edges", "fxaa"})).code, 0);
  const std::string before = drawn_with(folder_ / "resumed")["driver"];
  ASSERT_NE(before.find("softpipe"), std::string::npos);
  // All pictures exist already: the present driver drew none of them.
  ASSERT_EQ(condyle(command("resumed", {"--edges", "fxaa", "--resume"})).code, 0);
  EXPECT_EQ(drawn_with(folder_ / "resumed")["driver"], before);
  std::filesystem::remove(folder_ / "resumed/frames/000000.png");
  ASSERT_EQ(condyle(command("resumed", {"--edges", "fxaa", "--resume"})).code, 0);
  const std::string both = drawn_with(folder_ / "resumed")["driver"];
  EXPECT_TRUE(both.starts_with(before + "; ")) << both;
}

TEST_F(PictureOptions, SamplesThatTheDriverLacksAreReported) {
  const auto sampled = condyle_with("softpipe", command("sampled", {}));
  ASSERT_EQ(sampled.code, 0) << sampled.err;
  EXPECT_NE(sampled.err.find("requested 4 samples per pixel, the graphics driver (softpipe"),
            std::string::npos)
      << sampled.err;
  EXPECT_EQ(drawn_with(folder_ / "sampled")["samples"], 1);
  const auto smoothed = condyle_with("softpipe", command("smoothed", {"--edges", "fxaa"}));
  EXPECT_EQ(smoothed.err.find("samples per pixel"), std::string::npos) << smoothed.err;
  const auto by_default = condyle(command("by_default", {}));
  EXPECT_EQ(by_default.err.find("samples per pixel"), std::string::npos) << by_default.err;
  EXPECT_EQ(drawn_with(folder_ / "by_default")["samples"], 4);
  // Also for pictures of check.
  const std::vector<std::string> check = {
      "check", box_case(folder_), "--motion", "rest", "--margin", "5", "--out", folder_ / "check"};
  EXPECT_NE(condyle_with("softpipe", check).err.find("requested 4 samples"), std::string::npos);
  EXPECT_EQ(condyle(check).err.find("samples"), std::string::npos);
}

}  // namespace
}  // namespace condyle::test
