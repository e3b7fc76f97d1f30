// A CT in the window: from a folder of DICOM files to a mouth that opens.
#include <algorithm>

#include "tests/support/file_drop.h"
#include "tests/tools/window_session.h"

namespace condyle::test {
namespace {

constexpr double longest_s = 240;  // of background work on a busy machine

bool has_stage(const Json& s, const std::string& stage) {
  return s.contains("ct") && s["ct"]["stage"] == stage;
}

class WindowCt : public WindowSession {
 protected:
  /// The scan of the built-in head, in a folder whose name must not be shown.
  void write_scan() {
    const auto made = condyle(
        {"phantom", "--scan", "ct", "--voxel", "2", "--out", folder_ / "phantom", "--quiet"});
    ASSERT_EQ(made.code, 0) << made.err;
    fs::create_directories(folder_ / "scan");
    fs::rename(folder_ / "phantom/ct", fs::path(folder_ / "scan") / marker);
    fs::rename(folder_ / "phantom/ct.nrrd", folder_ / "head.nrrd");
  }
  bool wait_for_stage(const std::string& stage) {
    return wait_until([&](const Json& s) { return has_stage(s, stage); }, longest_s);
  }
  void close_error(const std::string& words) {
    EXPECT_TRUE(wait_until(
        [&](const Json& s) { return s.value("trouble", "").find(words) != std::string::npos; },
        longest_s))
        << state().value("trouble", "nothing was said");
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_for_item("error", false));
  }
  /// Clicks a slice at fractions of its width and height.
  void click_slice(const std::string& item, double across, double down) {
    const auto r = rect(item + ":slice");
    EXPECT_TRUE(
        xdotool({"mousemove", px(r[0] + across * r[2]), px(r[1] + down * r[3]), "click", "1"}));
  }
  /// Whether the picture of an item changes.
  bool changes(const std::string& item, const Picture& before) {
    const Region region = region_of(item);
    return wait_until(
        [&](const Json&) { return difference(before, display_picture(), region) > 2e-3; });
  }

  static constexpr const char* marker = "Jane_Doe_1950";
};

TEST_F(WindowCt, OpensTheMouthOfAFolderOfDicomFiles) {
  write_scan();
  start({box_case(folder_), "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));
  const std::string patient = state()["case"]["name"];

  // What is no scan leaves the patient where it is.
  fs::create_directories(folder_ / "wrong");
  write_text(folder_ / "wrong/photo.jpg", "no scan");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "wrong"}));
  close_error("wrong");
  write_text(folder_ / "cut.nrrd", read_text(folder_ / "head.nrrd").substr(0, 20000));
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "cut.nrrd"}));
  close_error("cut.nrrd");
  EXPECT_EQ(state()["case"]["name"], patient);
  EXPECT_FALSE(state().contains("ct"));

  // The series, of which the best is chosen: one click reads it.
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "scan"}));
  ASSERT_TRUE(wait_for_stage("series"));
  see("series");
  EXPECT_EQ(state().dump().find("Jane"), std::string::npos) << "a name below the folder is shown";
  EXPECT_EQ(state()["ct"]["best"], 0);
  EXPECT_NE(state()["ct"]["series"].dump().find("2 x 2 x 2 mm apart"), std::string::npos);
  click("ct-read");
  ASSERT_TRUE(wait_for_stage("slices"));
  see("slices");
  EXPECT_EQ(state().dump().find("Jane"), std::string::npos) << "a name below the folder is shown";
  const Json shown = state()["ct"];

  // The crosshair: a click moves it, the wheel scrolls.
  click_slice("ct-sagittal", 0.3, 0.75);
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return s["ct"]["slices"][0] != shown["slices"][0] && s["ct"]["slices"][1] != shown["slices"][1];
  }));
  EXPECT_EQ(state()["ct"]["slices"][2], shown["slices"][2]);
  const int axial = state()["ct"]["slices"][0];
  const auto r = rect("ct-axial");
  EXPECT_TRUE(xdotool({"mousemove", px(r[0] + r[2] / 2), px(r[1] + r[3] / 2), "click", "4", "click",
                       "4", "click", "5", "click", "4"}));
  EXPECT_TRUE(wait_until([&](const Json& s) { return s["ct"]["slices"][0] == axial + 2; }));
  const auto solid = rect("ct-solid");
  drag(solid[0] + 100, solid[1] + 150, solid[0] + 160, solid[1] + 150);
  EXPECT_TRUE(wait_until([&](const Json& s) { return s["ct"]["turn_deg"] != shown["turn_deg"]; }));

  // The threshold: outlines follow; the histogram's value comes back.
  see("crosshair");
  const Picture before = seen_;
  const auto bar = rect("ct-threshold");
  EXPECT_TRUE(
      xdotool({"mousemove", px(bar[0] + 0.6 * bar[2]), px(bar[1] + bar[3] / 2), "click", "1"}));
  EXPECT_TRUE(wait_until([](const Json& s) { return double(s["ct"]["threshold_hu"]) > 1000; }));
  EXPECT_TRUE(changes("ct-coronal", before));
  see("threshold");
  click("ct-threshold-reset");
  EXPECT_TRUE(
      wait_until([&](const Json& s) { return s["ct"]["threshold_hu"] == shown["threshold_hu"]; }));

  // Seeds: one in the air is named, and removed.
  click("ct-seed-jaw");
  click_slice("ct-sagittal", 0.02, 0.98);
  ASSERT_TRUE(wait_for_item("ct-seed-remark"));
  see("seed-in-air");
  click("ct-make");
  close_error("Seed 1: no bone above");
  click("ct-seed-undo");
  ASSERT_TRUE(wait_for_item("ct-seed-remark", false));

  // One on the bone of the chin is used.
  click_slice("ct-sagittal", 0.19, 0.82);
  EXPECT_TRUE(wait_until([](const Json& s) { return s["ct"]["seeds"] == 1; }));
  see("seed-on-chin");
  EXPECT_EQ(state()["ct"]["seed_remark"], "");

  // Making the patient is cancelled, and done.
  click("ct-make");
  ASSERT_TRUE(wait_for_stage("making"));
  click("cancel");
  ASSERT_TRUE(wait_for_stage("slices"));
  EXPECT_FALSE(fs::exists(folder_ / "scan-patient"));
  EXPECT_EQ(state()["case"]["name"], patient);
  EXPECT_EQ(state()["ct"]["seeds"], 1);
  click("ct-make");
  ASSERT_TRUE(wait_for_stage("making"));
  see_now("making");
  ASSERT_TRUE(wait_until(
      [](const Json& s) { return idle(s) && !s.contains("ct") && s["edits"]["parts"].size() == 5; },
      longest_s))
      << state().value("trouble", "nothing was said");
  see("patient");
  const Json made = state();
  EXPECT_EQ(made["case"]["folder"], folder_ / "scan-patient");
  EXPECT_TRUE(fs::exists(folder_ / "scan-patient/case.json"));
  EXPECT_NE(made["notes"].dump().find("landmarks are proposed"), std::string::npos);
  EXPECT_GT(int(made["landmarks"]), 100);
  EXPECT_EQ(made.dump().find("Jane"), std::string::npos) << "a name below the folder is shown";

  // The mouth opens.
  EXPECT_TRUE(press("k"));
  EXPECT_TRUE(press("space"));
  EXPECT_TRUE(
      wait_until([](const Json& s) { return double(s["frame"]["opening_mm"]) > 20; }, longest_s));
  EXPECT_TRUE(press("space"));
  see("open");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowCt, AScanIsNamedOnTheCommandLineOrChosenInTheDialog) {
  write_scan();
  start({folder_ / "head.nrrd"});
  ASSERT_TRUE(wait_for_stage("slices"));
  see("file");
  // Another one in its place, which lacks a slice: it is read once its slices may be interpolated.
  std::vector<fs::path> slices;
  for (const auto& entry : fs::directory_iterator(fs::path(folder_ / "scan") / marker))
    slices.push_back(entry.path());
  std::sort(slices.begin(), slices.end());
  fs::remove(slices[slices.size() / 2]);
  EXPECT_TRUE(press("ctrl+o"));
  write_into("open-path", fs::path(folder_ / "scan") / marker);
  click("open:scan");
  ASSERT_TRUE(wait_for_stage("series"));
  click("ct-series:1");
  see("uneven");
  click("ct-read");
  ASSERT_TRUE(wait_for_stage("slices"));
  click("ct-close");
  EXPECT_TRUE(wait_until([](const Json& s) { return !s.contains("ct"); }));
  EXPECT_TRUE(wait_for_item("open-files"));
  // A patient closes the CT.
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "head.nrrd"}));
  ASSERT_TRUE(wait_for_stage("slices"));
  EXPECT_TRUE(drop_files("Condyle", {box_case(folder_)}));
  EXPECT_TRUE(wait_until([](const Json& s) { return idle(s) && !s.contains("ct"); }, longest_s));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
