// Files that the window reads and writes, and bones that are released.
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <algorithm>

#include "tests/support/file_drop.h"
#include "window_session.h"

namespace condyle::test {
namespace {

/// A folder on a separate disk of 1 MB, visible to this process and its children alone; where the
/// system forbids that, a folder like any other.
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& folder) : folder_(folder) {
    fs::create_directories(folder);
    const int own_names = geteuid() == 0 ? CLONE_NEWNS : CLONE_NEWUSER | CLONE_NEWNS;
    mounted_ = unshare(own_names) == 0 &&
               mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               mount("none", folder.c_str(), "tmpfs", 0, "size=1m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  std::string folder_;
  bool mounted_ = false;
};

TEST_F(WindowSession, FilesAreDroppedAndLandmarksPlacedRenamedAndSaved) {
  const std::string patient = box_case(folder_);
  write_text(folder_ / "down.csv",
             "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5,0,0,-10,1,0,0,0\n");
  start({patient, "--motion", "rest"});
  ASSERT_TRUE(wait_until(idle));

  // A motion, an unusable file, a patient, a single bone.
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "down.csv"}));
  EXPECT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && std::string(s["motion"]).ends_with("down.csv"); }));
  write_text(folder_ / "note.xyz", "nothing to open");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "note.xyz"}));
  ASSERT_TRUE(wait_for_item("error"));
  see("dropped-nonsense");
  click("close-error");
  ASSERT_TRUE(wait_for_item("error", false));
  EXPECT_TRUE(drop_files("Condyle", {patient}));
  EXPECT_TRUE(wait_until([](const Json& s) { return idle(s) && s["motion"] == "opening"; }));

  // A landmark: added, placed on the bone by a click, renamed, undone, saved.
  EXPECT_TRUE(press("a"));
  EXPECT_TRUE(press("b"));
  const int known = state()["landmarks"];
  write_into("landmark-name", "Chin point");
  click("landmark-add");
  ASSERT_TRUE(wait_until([&](const Json& s) { return s["landmarks"] == known + 1; }));
  const Region view = view_region();
  EXPECT_TRUE(xdotool(
      {"mousemove", px(view.x + 0.6 * view.width), px(view.y + 0.6 * view.height), "click", "1"}));
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s["landmark_mm"].contains("chin_point") &&
           std::abs(double(s["landmark_mm"]["chin_point"][1]) + 92) < 0.01;
  })) << state()["landmark_mm"].dump();
  see("landmark-placed");
  write_into("landmark-name", "Pogonion");
  click("landmark-rename");
  EXPECT_TRUE(wait_until([](const Json& s) { return s["landmark_mm"].contains("pogonion"); }));
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["landmark_mm"].contains("chin_point"); }));
  EXPECT_TRUE(press("ctrl+shift+z"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["landmark_mm"].contains("pogonion"); }));
  const Json placed = state()["landmark_mm"]["pogonion"];
  write_into("case-folder", folder_ / "saved");
  click("case-save");
  EXPECT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "saved/case.json"); }));
  // The saved case opens with the same landmarks.
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "saved"}));
  EXPECT_TRUE(wait_until([&](const Json& s) {
    return idle(s) && s["landmark_mm"].contains("pogonion") &&
           std::abs(double(s["landmark_mm"]["pogonion"][0]) - double(placed[0])) < 1e-3;
  }));

  // One bone alone: it can be viewed and moved. A face without any bone is refused.
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "mandible.stl"}));
  click("import-go");
  ASSERT_TRUE(
      wait_until([](const Json& s) { return idle(s) && !s["landmark_mm"].contains("pogonion"); }));
  see("bone-alone");
  EXPECT_TRUE(press("b"));
  EXPECT_TRUE(press("m"));
  ASSERT_TRUE(wait_for_item("handle:S"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto tip = rect("handle:S");
  drag(tip[0] + 3, tip[1] + 3, tip[0] + 3, tip[1] - 27);
  EXPECT_TRUE(wait_until([](const Json& s) {
    return s.contains("X_CM_wanted") && double(s["frame"]["mandible_mm"][2]) > 3;
  })) << state().dump();
  fs::copy_file(folder_ / "maxilla.stl", folder_ / "face.stl");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "face.stl"}));
  click("import-go");  // it waits for a bone
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(state()["items"].contains("import"));
  EXPECT_FALSE(state()["items"].contains("error"));
  see("no-bone");
  click("import-close");
  ASSERT_TRUE(wait_for_item("import", false));
  // Errors use the words of the window, not of the command line.
  const auto reported = [&](const std::string& words) {
    EXPECT_TRUE(wait_until([&](const Json& s) {
      return s.value("trouble", "").find(words) != std::string::npos;
    })) << state().value("trouble", "nothing was said");
    EXPECT_EQ(state().value("trouble", "").find("--"), std::string::npos);
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_for_item("error", false));
  };
  std::string metres;
  for (int i = 0; i < 8; ++i)
    metres += std::string("v ") + (i & 1 ? "0.05" : "-0.05") + (i & 2 ? " -0.01" : " -0.09") +
              (i & 4 ? " -0.05\n" : " -0.06\n");
  fs::create_directories(folder_ / "metres");
  write_text(folder_ / "metres/mandible.obj",
             metres + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "metres/mandible.obj"}));
  click("import-go");
  reported("choose as the unit of lengths m.");
  write_text(folder_ / "README.md", "# Notes\n");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "README.md"}));
  reported("README.md: cannot be opened: it is no session, no case folder");
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ALooseCaseIsChosenAtOnceInTheOpenDialog) {
  write_box_patient(folder_.path());
  write_text(folder_ / "notes.txt", "nothing of a patient");
  fs::copy_file(folder_ / "maxilla.stl", folder_ / "upper_teeth.stl");
  start({"--motion", "rest"});
  ASSERT_TRUE(wait_until(idle, 120));
  EXPECT_TRUE(press("ctrl+o"));
  write_into("open-path", folder_.path());  // no patient's folder: its files are listed
  ASSERT_TRUE(wait_for_item("file:mandible.stl"));
  const auto click_with = [&](const std::string& key, const std::string& item) {
    EXPECT_TRUE(xdotool({"keydown", key}));
    click(item);
    EXPECT_TRUE(xdotool({"keyup", key}));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // no double click
  };
  click("file:mandible.stl");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  click_with("shift", "file:upper_teeth.stl");
  click_with("ctrl", "file:upper_teeth.stl");
  see("three-of-a-case");
  EXPECT_TRUE(press("Return"));
  ASSERT_TRUE(wait_for_item("import"));
  see("roles-of-three");
  EXPECT_TRUE(state()["items"].contains("import-role:2"));
  EXPECT_FALSE(state()["items"].contains("import-role:3"));
  click("import-go");
  ASSERT_TRUE(wait_until([](const Json& s) {
    return idle(s) && s["edits"]["parts"].size() == 2 && s["landmark_mm"].contains("left_condyle");
  })) << state().dump();
  // Its folder, dropped, has the same effect, without the files that are no surfaces.
  EXPECT_TRUE(drop_files("Condyle", {folder_.path()}));
  EXPECT_TRUE(wait_for_item("import-role:3"));
  EXPECT_FALSE(state()["items"].contains("import-role:4"));
  click("import-close");
  EXPECT_TRUE(wait_for_item("import", false));
  // So is one that the command line names.
  EXPECT_TRUE(press("ctrl+q"));
  ASSERT_EQ(wait_for_end(), 0);
  start({folder_.path()});
  ASSERT_TRUE(wait_for_item("import-role:3")) << state().value("trouble", "nothing was said");
  see("named-folder");
  click("import-close");
  EXPECT_TRUE(wait_for_item("import", false));
  see("no-patient");
  click("open-files");
  EXPECT_TRUE(wait_for_item("open-path"));
  EXPECT_TRUE(press("Escape"));
  EXPECT_TRUE(wait_for_item("open-path", false));
  // So is one with a case.json that another program wrote; a table of muscles is known as such.
  write_text(folder_ / "case.json", R"({"name": "somebody", "parts": 3})");
  write_text(folder_ / "face_muscles.csv",
             "name,origin_body,insertion_body,ox_mm,oy_mm,oz_mm,ix_mm,iy_mm,iz_mm,max_force_N\n"
             "left_masseter,skull,mandible,40,-40,0,40,-30,-40,80\n"
             "right_masseter,skull,mandible,-40,-40,0,-40,-30,-40,80\n");
  EXPECT_TRUE(drop_files("Condyle", {folder_.path()}));
  ASSERT_TRUE(wait_for_item("import-role:4")) << state().value("trouble", "");
  see("roles-with-muscles");
  click("import-go");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return idle(s) && s["notes"].dump().find("2 from face_muscles.csv") != std::string::npos;
  })) << state()["notes"].dump()
      << state().value("trouble", "");
  // Notes have unit symbols.
  const std::string notes = state()["notes"].dump();
  EXPECT_NE(notes.find("rotation 28.1\u00b0"), std::string::npos) << notes;
  EXPECT_NE(notes.find("358.8 cm\u00b3"), std::string::npos) << notes;
  EXPECT_EQ(notes.find(" deg"), std::string::npos) << notes;
  // Impossible roles are refused before the patient is built, with a remedy.
  fs::create_directories(folder_ / "again");
  for (const char* name : {"mandible.stl", "marks.csv"})
    fs::copy_file(folder_ / name, fs::path(folder_ / "again") / name);
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "mandible.stl", folder_ / "again/mandible.stl"}));
  ASSERT_TRUE(wait_for_item("import-remark"));
  see("two-mandibles");
  click("import-close");
  ASSERT_TRUE(wait_for_item("import", false));
  // A second file of the same bone, by its name, is omitted unless the user chooses otherwise.
  for (const char* copy : {"mandible_8k.stl", "Mandible_with_teeth_wrap.stl"})
    fs::copy_file(folder_ / "mandible.stl", fs::path(folder_ / "again") / copy);
  EXPECT_TRUE(drop_files(
      "Condyle", {folder_ / "maxilla.stl", folder_ / "again/mandible_8k.stl",
                  folder_ / "again/mandible.stl", folder_ / "again/Mandible_with_teeth_wrap.stl"}));
  ASSERT_TRUE(wait_for_item("import-role:3"));
  see("the-same-bone");
  EXPECT_TRUE(state()["items"].contains("import-remark"));
  click("import-go");
  EXPECT_TRUE(wait_until([](const Json& s) { return idle(s) && s["edits"]["parts"].size() == 2; }));
  // A JSON file is no motion.
  write_text(folder_ / "foo.json", "{}");
  EXPECT_TRUE(drop_files("Condyle", {folder_ / "foo.json"}));
  ASSERT_TRUE(wait_for_item("error"));
  const std::string trouble = state()["trouble"];
  EXPECT_NE(trouble.find("foo.json: cannot be opened"), std::string::npos) << trouble;
  EXPECT_EQ(trouble.find("json.json"), std::string::npos) << trouble;
  click("close-error");
  ASSERT_TRUE(wait_for_item("import", false));
  EXPECT_TRUE(drop_files(
      "Condyle", {folder_ / "mandible.stl", folder_ / "marks.csv", folder_ / "again/marks.csv"}));
  ASSERT_TRUE(wait_for_item("import-remark"));
  click("import-go");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(state()["items"].contains("import")) << "it waits for one list of landmarks";
  click("import-role:2");
  click("import-role:2:");  // leave out
  ASSERT_TRUE(wait_for_item("import-remark", false));
  click("import-go");
  EXPECT_TRUE(wait_until([](const Json& s) { return idle(s) && s["edits"]["parts"].size() == 1; }));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ARecordingFromThePanelHasTheBitsOfTheCommandWithTheSameChoices) {
  const std::string boxes = box_case(folder_), motion = "open 5 over 0.2; close over 0.2";
  write_text(folder_ / "around.json",
             R"({"path": [{"view": "front"}, {"view": "left", "distance_mm": 300}]})");
  start({boxes, "--motion", motion});
  ASSERT_TRUE(wait_until(idle));
  click("tab:Record");
  click("record-height:720");
  click("record-rate:10");
  click("record-finer:2");
  write_into("record-caption", "Opening {opening} mm|{interincisal}, {time} s");
  click("record-transparent");
  click("record-film");
  // Several cameras: the list stays unfolded until it is folded.
  click("record-cameras");
  for (const char* camera : {"camera:view", "camera:front", "camera:upper-arch", "camera:file"})
    click(camera);
  see("cameras");
  EXPECT_TRUE(press("Escape"));
  ASSERT_TRUE(wait_for_item("camera:front", false));
  write_into("record-camera-file", folder_ / "around.json");
  write_into("record-folder", folder_ / "window");
  see("panel");
  click("record");
  const std::array<std::string, 3> cameras = {"front", "upper-arch", "around"};
  ASSERT_TRUE(wait_until(
      [&](const Json& s) {
        return idle(s) && std::all_of(cameras.begin(), cameras.end(), [&](const auto& camera) {
                 return fs::exists(folder_ / ("window/" + camera + "/hashes.csv"));
               });
      },
      90));
  const auto command =
      condyle({"record", boxes, "--motion", motion, "--fps", "10", "--size", "1280x720",
               "--supersample", "2", "--camera", "front,upper-arch," + (folder_ / "around.json"),
               "--transparent", "--caption", "Opening {opening} mm|{interincisal}, {time} s",
               "--overlay", "scale,letters", "--out", folder_ / "command"});
  ASSERT_EQ(command.code, 0) << command.err;
  for (const auto& camera : cameras) {
    const std::string hashes = read_text(folder_ / ("window/" + camera + "/hashes.csv"));
    EXPECT_GT(std::count(hashes.begin(), hashes.end(), '\n'), 4) << camera;
    EXPECT_EQ(hashes, read_text(folder_ / ("command/" + camera + "/hashes.csv"))) << camera;
  }
  EXPECT_NE(read_text(folder_ / "window/front/hashes.csv"),
            read_text(folder_ / "window/around/hashes.csv"));
  const Picture front(folder_ / "window/front/frames/000002.png");
  EXPECT_EQ(front.rgba[3], 0) << "no background";

  // Invalid choices are reported: an unknown placeholder, an invalid camera file.
  const auto refused = [&](const std::string& words) {
    click("record");
    EXPECT_TRUE(wait_until([&](const Json& s) {
      return s.value("trouble", "").find(words) != std::string::npos;
    })) << state().value("trouble", "nothing was said");
    EXPECT_EQ(state().value("trouble", "").find("--"), std::string::npos);
    EXPECT_TRUE(press("Return"));
    EXPECT_TRUE(wait_for_item("error", false));
  };
  write_into("record-width", "8192");
  click("record-finer:4");
  refused("at most 4096 pixels a side when drawn 4x finer");
  click("record-finer:2");
  click("record-height:720");
  write_into("record-caption", "{age}");
  refused("{age} is unknown");
  write_into("record-caption", "Once");
  write_text(folder_ / "around.json", "[]");
  refused("around.json: is not a JSON object");
  // This view, turning: no picture is like another.
  click("record-cameras");
  for (const char* camera : {"camera:turning", "camera:front", "camera:upper-arch", "camera:file"})
    click(camera);
  EXPECT_TRUE(press("Escape"));
  ASSERT_TRUE(wait_for_item("camera:front", false));
  write_into("record-folder", folder_ / "turning");
  click("record");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "turning/hashes.csv"); }, 60));
  EXPECT_TRUE(unlike(Picture(folder_ / "turning/frames/000000.png"),
                     Picture(folder_ / "turning/frames/000002.png"), 0.02));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(WindowSession, ATransplantIsMovedReleasedAndTheDiskIsFull) {
  write_box_patient(folder_.path());
  std::string strut;
  for (int i = 0; i < 8; ++i)
    strut += "v " + std::string(i & 1 ? "25" : "5") + (i & 2 ? " -54" : " -60") +
             (i & 4 ? " 6.5\n" : " 2.5\n");
  write_text(folder_ / "strut.obj",
             strut + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  const auto import =
      condyle({"import", "meshes", "--maxilla", folder_ / "maxilla.stl", "--mandible",
               folder_ / "mandible.stl", "--landmarks", folder_ / "marks.csv", "--transplant",
               folder_ / "strut.obj", "--out", folder_ / "case"});
  ASSERT_EQ(import.code, 0) << import.err;
  const SmallDisk disk(folder_ / "small");
  start({folder_ / "case", "--motion", "open 5 over 0.2; close over 0.2"});
  ASSERT_TRUE(wait_until(idle));
  const std::string notes = state()["notes"].dump();
  EXPECT_NE(notes.find("moves with it"), std::string::npos) << notes;
  EXPECT_EQ(notes.find("--"), std::string::npos) << "no options of the command line: " << notes;

  EXPECT_TRUE(press("a"));
  const Region view = view_region();  // farther off, so that the handles are within it
  EXPECT_TRUE(xdotool({"mousemove", px(view.x + view.width / 2), px(view.y + view.height / 2),
                       "click", "--repeat", "5", "5"}));
  EXPECT_TRUE(press("m"));
  ASSERT_TRUE(wait_for_item("body"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  choose_body("transplant");
  ASSERT_TRUE(wait_for_item("release-body"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto tip = rect("handle:S");
  drag(tip[0] + 3, tip[1] + 3, tip[0] + 3, tip[1] - 22);
  ASSERT_TRUE(wait_until([](const Json& s) { return double(s["body_mm"][2][2]) > 1; }));
  see("lifted");
  const double lifted = double(state()["body_mm"][2][2]);
  click("release-body");
  EXPECT_TRUE(wait_until([](const Json& s) {
    return idle(s) && std::abs(double(s["body_mm"][2][2]) + 2.5) < 0.1;
  })) << state()["body_mm"];
  EXPECT_GT(see("release-body"), 1e-4);
  EXPECT_TRUE(press("ctrl+z"));
  EXPECT_TRUE(wait_until(
      [&](const Json& s) { return std::abs(double(s["body_mm"][2][2]) - lifted) < 1e-3; }));

  // The recording has the strut at the hand's target.
  const auto record = [&](const std::string& folder) {
    write_into("record-folder", folder);
    click("record");
  };
  click("tab:Record");
  click("record-height:720");
  click("record-rate:10");
  record(folder_ / "lifted");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "lifted/film.mp4"); }));
  EXPECT_TRUE(press("ctrl+z"));
  ASSERT_TRUE(
      wait_until([](const Json& s) { return std::abs(double(s["body_mm"][2][2])) < 1e-6; }));
  record(folder_ / "reset-position");
  ASSERT_TRUE(wait_until(
      [&](const Json& s) { return idle(s) && fs::exists(folder_ / "reset-position/film.mp4"); }));
  EXPECT_TRUE(unlike(Picture(folder_ / "lifted/frames/000000.png"),
                     Picture(folder_ / "reset-position/frames/000000.png"), 2e-4));

  // The disk is full in the middle of a recording: a sentence, and the window continues.
  if (!disk.mounted()) {
    const rlimit limit{400000, 400000};
    ASSERT_EQ(prlimit(program(), RLIMIT_FSIZE, &limit, nullptr), 0);
  }
  click("record-height:2160");
  record(folder_ / "small/film");
  ASSERT_TRUE(wait_for_item("error"));
  see("disk-full");
  click("close-error");
  EXPECT_TRUE(press("space"));
  EXPECT_TRUE(wait_until([](const Json& s) { return s["playing"] == true; }));
  EXPECT_TRUE(press("ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

}  // namespace
}  // namespace condyle::test
