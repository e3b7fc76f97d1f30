// Exports as a user makes them: every file, a browser without a network, a full disk, a kill.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/picture.h"
#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

nlohmann::json index_of(const std::string& folder) {
  return nlohmann::json::parse(read_text(folder + "/export.json"));
}

std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(folder))
    all[entry.path().filename().string()] = entry.is_directory() ? "" : read_text(entry.path());
  return all;
}

/// A screenshot of a page in Chromium, whose every host name is blocked; empty without a browser.
Picture screenshot(const Folder& folder, const std::string& page, const std::string& moment) {
  const std::string file = folder / "shot.png";
  fs::remove(file);
  const std::string command =
      "timeout 120 chromium --headless=new --no-sandbox --use-angle=swiftshader "
      "--enable-unsafe-swiftshader --host-resolver-rules='MAP * ~NOTFOUND' --hide-scrollbars "
      "--window-size=900,700 --virtual-time-budget=4000 --user-data-dir='" +
      (folder / "browser") + "' --screenshot='" + file + "' 'file://" + page + "#" + moment +
      "' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0 ? Picture(file) : Picture();
}

bool has_browser() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

}  // namespace

TEST(Export, WritesEveryFileThatItLists) {
  const Folder folder;
  const std::string out = folder / "out";
  const auto outcome = condyle({"export", box_case(folder), "--motion", "open 10", "--at", "0.2",
                                "--fps", "10", "--out", out});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto index = index_of(out);
  EXPECT_EQ(index["units"], "mm");
  EXPECT_EQ(index["axes"], "LPS");
  EXPECT_GT(index["pose"]["opening_mm"].get<double>(), 1);
  std::map<std::string, nlohmann::json> listed;
  for (const auto& file : index["files"]) {
    listed[file["file"]] = file;
    EXPECT_TRUE(fs::exists(fs::path(out) / file["file"].get<std::string>())) << file;
  }
  for (const char* file : {"mandible.stl", "mandible.ply", "mandible.tfm", "patient.glb",
                           "page.html", "landmarks.mrk.json", "measures.mrk.json"})
    EXPECT_TRUE(listed.contains(file)) << file;
  EXPECT_EQ(contents(out).size(), listed.size() + 1);
  // A binary STL has 84 bytes and 50 for each triangle.
  EXPECT_EQ(fs::file_size(out + "/mandible.stl"),
            84 + 50 * listed["mandible.stl"]["triangles"].get<std::size_t>());
  EXPECT_FALSE(listed.contains("maxilla.tfm"));  // did not move
  for (const auto& [name, text] : contents(out))
    EXPECT_EQ(text.find(folder.path().string()), std::string::npos) << name;
}

// The opened jaw, imported again from what was exported.
TEST(Export, SurfacesAreReadBackWhereTheyLie) {
  const Folder folder;
  const std::string out = folder / "out", again = folder / "again";
  ASSERT_EQ(condyle({"export", box_case(folder), "--motion", "open 10", "--at", "0.2", "--out", out,
                     "--write", "ply,stl,glb,markups"})
                .code,
            0);
  for (const char* format : {"ply", "stl"}) {
    const auto import =
        condyle({"import", "meshes", "--mandible", out + "/mandible." + format, "--maxilla",
                 out + "/maxilla." + format, "--landmarks", out + "/landmarks.mrk.json", "--units",
                 "mm", "--frame", "LPS", "--out", again + format});
    ASSERT_EQ(import.code, 0) << import.err;
    const auto exported = condyle({"export", again + format, "--out",
                                   folder / (std::string("second") + format), "--write", "ply"});
    ASSERT_EQ(exported.code, 0) << exported.err;
    const auto first = index_of(out), second = index_of(folder / (std::string("second") + format));
    int compared = 0;
    for (const auto& a : first["files"])
      for (const auto& b : second["files"])
        if (a["file"] == b["file"] && a.contains("bounds"))
          for (const char* end : {"low_mm", "high_mm"})
            for (int k = 0; k < 3; ++k) {
              EXPECT_NEAR(a["bounds"][end][k].get<double>(), b["bounds"][end][k].get<double>(),
                          1e-4);
              ++compared;
            }
    EXPECT_EQ(compared, 12) << format;
  }
}

TEST(Export, ThePageMovesInABrowserWithoutANetwork) {
  ASSERT_TRUE(has_browser()) << "chromium, which tools/setup installs, is missing";
  const Folder folder;
  const std::string out = folder / "out";
  const auto outcome = condyle({"export", "--motion", "opening", "--fps", "15", "--write", "page",
                                "--triangles", "6000", "--out", out});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string page = out + "/page.html";
  const Picture rest = screenshot(folder, page, "opening=0&face=1"),
                open = screenshot(folder, page, "opening=40&face=1"),
                glass = screenshot(folder, page, "opening=40&face=0");
  ASSERT_FALSE(rest.empty());
  ASSERT_FALSE(open.empty());
  rest.save(kept_pictures() / "page_rest.png");
  open.save(kept_pictures() / "page_open.png");
  glass.save(kept_pictures() / "page_bones.png");
  // The picture is the middle; header and controls are above and below it.
  const Region middle{200, 120, 500, 400};
  EXPECT_TRUE(unlike(open, rest, 0.03, middle));
  EXPECT_TRUE(unlike(glass, open, 0.1, middle));
  const auto skin = [&](const Picture& picture) {
    int count = 0;
    for (std::size_t p = 0; p + 3 < picture.rgba.size(); p += 4)
      count += picture.rgba[p] > picture.rgba[p + 2] + 30;  // redder than blue: skin and bone
    return static_cast<double>(count) / (picture.width * picture.height);
  };
  EXPECT_GT(skin(rest), 0.1);
  EXPECT_GT(skin(glass), 0.25 * skin(open));  // the bones within it
}

TEST(Export, AFullDiskLeavesTheEarlierFiles) {
  const Folder folder;
  const std::string out = folder / "out", patient = box_case(folder);
  ASSERT_EQ(condyle({"export", patient, "--out", out}).code, 0);
  const auto before = contents(out);
  const auto outcome =
      condyle({"export", patient, "--motion", "open 10", "--out", out}, {.file_mb = 0});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_EQ(contents(out), before);
}

TEST(Export, AKillLeavesTheEarlierFilesAndTheNextRunCleansUp) {
  const Folder folder;
  const std::string out = folder / "out", patient = box_case(folder);
  ASSERT_EQ(condyle({"export", patient, "--out", out}).code, 0);
  const auto before = contents(out);
  const std::vector<std::string> command = {"export", patient, "--motion", "open 10",
                                            "--at",   "0.2",   "--out",    out};
  const auto killed =
      condyle(command, {.kill_when = [&] { return fs::exists(out + "/.new.part"); }});
  ASSERT_EQ(killed.code, 128 + 9) << killed.err;
  auto after = contents(out);
  after.erase(".new.part");
  EXPECT_EQ(after, before);
  ASSERT_EQ(condyle(command).code, 0);
  EXPECT_FALSE(fs::exists(out + "/.new.part"));
  EXPECT_TRUE(fs::exists(out + "/mandible.tfm"));
}

TEST(Export, FilesThatAnEarlierExportListedAreRemovedOthersStay) {
  const Folder folder;
  const std::string out = folder / "out", patient = box_case(folder);
  ASSERT_EQ(condyle({"export", patient, "--out", out, "--write", "stl,ply"}).code, 0);
  write_text(out + "/mine.stl", "mine");
  ASSERT_EQ(condyle({"export", patient, "--out", out, "--write", "ply"}).code, 0);
  EXPECT_FALSE(fs::exists(out + "/mandible.stl"));
  EXPECT_TRUE(fs::exists(out + "/mandible.ply"));
  EXPECT_TRUE(fs::exists(out + "/mine.stl"));
}

TEST(Export, WrongWordsAreRefusedByName) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  const auto refused = [&](std::vector<std::string> more, const std::string& expected) {
    std::vector<std::string> words = {"export", patient, "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const auto outcome = condyle(words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << outcome.err;
  };
  refused({"--write", "stl,obj"}, "--write obj: unknown; known are stl");
  refused({"--at", "1"}, "--at 1");
  refused({"--motion", "open 10", "--at", "100"}, "--at 100");
  refused({"--plan", folder / "none.json"}, "none.json");
  refused({"--motion", "open 10", "--duration", "3600"}, "--fps 60: makes");
  write_text(folder / "file", "");
  const auto blocked = condyle({"export", patient, "--out", folder / "file/out"});
  EXPECT_EQ(blocked.code, 1) << blocked.err;
}

// The page says nothing of the person, even if case, plan and notes do.
TEST(Report, IsOneFileWithoutNamesOrRequests) {
  const Folder folder;
  const std::string patient = folder / "mustermann", plan = folder / "plan.json",
                    page = folder / "pages/plan.html";
  ASSERT_EQ(condyle({"phantom", "--out", patient}).code, 0);
  auto json = nlohmann::json::parse(read_text(patient + "/case.json"));
  json["name"] = "Erika </script><b>Mustermann";
  write_text(patient + "/case.json", json.dump());
  ASSERT_EQ(condyle({"plan", "new", patient, "--out", plan}).code, 0);
  ASSERT_EQ(condyle({"plan", "cut", plan, "genioplasty", "--kerf", "0.5", "--case", patient}).code,
            0);
  ASSERT_EQ(
      condyle({"plan", "move", plan, "chin", "forward", "6", "up", "1", "--case", patient}).code,
      0);
  ASSERT_EQ(condyle({"plan", "note", plan, "call", "Mrs", "Mustermann"}).code, 0);
  const auto outcome = condyle({"report", patient, "--plan", plan, "--out", page, "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string html = read_text(page);
  for (const char* never : {"ustermann", "<script", "http://", "https://", "<link", "file:"})
    EXPECT_EQ(html.find(never), std::string::npos) << never;
  EXPECT_EQ(html.find(folder.path().string()), std::string::npos);
  const auto facts = nlohmann::json::parse(outcome.out);
  for (const std::string& expected :
       {std::string("For research and education, not for clinical use."),
        facts["case_hash"].get<std::string>(), facts["plan_hash"].get<std::string>(),
        std::string("size: A4"), std::string("Genioplasty"), std::string("about pogonion"),
        std::string("<td>SNB</td>"), std::string("Danger zones"), std::string("Mouth opening"),
        std::string("Soft pogonion"), std::string("A note of the plan is left out"),
        std::string("Contacts and overlaps")})
    EXPECT_NE(html.find(expected), std::string::npos) << expected;
  std::size_t pictures = 0;
  for (auto at = html.find("<img"); at != std::string::npos; at = html.find("<img", at + 1)) {
    EXPECT_NE(html.substr(at, 80).find("src=\"data:image/png;base64,iVBOR"), std::string::npos);
    ++pictures;
  }
  EXPECT_EQ(pictures, 2u);
  // A failure keeps the page that is there.
  const auto full =
      condyle({"report", patient, "--plan", plan, "--out", page, "--no-prediction", "--no-motion"},
              {.file_mb = 0});
  EXPECT_EQ(full.code, 1) << full.err;
  EXPECT_EQ(read_text(page), html);
  EXPECT_EQ(condyle({"report", "--plan", plan, "--out", folder / "page.pdf"}).code, 2);
}

}  // namespace condyle::test
