// Bad input: one clear line that names the file, the item and the value; the right exit code;
// bounded memory; earlier output intact.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

int lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

void expect_refused(const std::vector<std::string>& arguments, int code,
                    const std::vector<std::string>& expected, const Limits& limits = {}) {
  const auto outcome = condyle(arguments, limits);
  std::string command;
  for (const auto& argument : arguments) command += argument + " ";
  EXPECT_EQ(outcome.code, code) << command << "\n" << outcome.err;
  EXPECT_EQ(lines(outcome.err), 1) << command << "\n" << outcome.err;
  for (const auto& word : expected)
    EXPECT_NE(outcome.err.find(word), std::string::npos)
        << command << "\nmisses " << word << " in\n"
        << outcome.err;
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
}

class BadMesh : public ::testing::Test {
 protected:
  BadMesh() { write_box_patient(folder.path()); }
  void refused(const std::string& name, const std::string& content,
               const std::vector<std::string>& expected) {
    write_text(folder.path() / name, content);
    auto words = expected;
    words.push_back(name);
    expect_refused({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
                    folder / name, "--out", folder / "case"},
                   2, words, {.memory_mb = 2000});
    EXPECT_FALSE(fs::exists(folder / "case"));
  }
  Folder folder;
};

std::string ply(const std::string& vertices, const std::string& faces, long vertex_count,
                long face_count) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

}  // namespace

TEST_F(BadMesh, MissingFile) {
  expect_refused(
      {"import", "meshes", "--mandible", folder / "nowhere.stl", "--out", folder / "case"}, 2,
      {"nowhere.stl", "no such file"});
}
TEST_F(BadMesh, EmptyFile) { refused("empty.ply", "", {"empty"}); }
TEST_F(BadMesh, Garbage) { refused("noise.stl", std::string(3000, '\x7f'), {}); }
TEST_F(BadMesh, Truncated) { refused("short.ply", ply("0 0 0\n1 0 0\n", "", 3, 1), {}); }
TEST_F(BadMesh, PromisesFourBillionVertices) {
  refused("huge.ply", ply("0 0 0\n", "", 4000000000, 1), {"4000000000"});
}
TEST_F(BadMesh, BinaryStlPromisesTooMuch) {
  std::string stl(84, '\0');
  const std::uint32_t count = 4000000000u;
  std::memcpy(stl.data() + 80, &count, 4);
  refused("huge.stl", stl + std::string(50, '\0'), {"4000000000"});
}
TEST_F(BadMesh, NotANumber) {
  refused("nan.ply", ply("0 0 0\nnan 0 0\n0 1 0\n", "3 0 1 2\n", 3, 1), {"nan"});
}
TEST_F(BadMesh, IndexOutOfRange) {
  refused("index.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "3 0 1 7\n", 3, 1), {"7"});
}
TEST_F(BadMesh, NoTriangles) {
  refused("points.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "", 3, 0), {"triangle"});
}
TEST_F(BadMesh, UnknownKind) { refused("jaw.docx", "hello", {"docx"}); }

TEST_F(BadMesh, WrongUnits) {
  expect_refused({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
                  folder / "mandible.stl", "--units", "m", "--out", folder / "case"},
                 2, {"units"});
  expect_refused({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
                  folder / "mandible.stl", "--units", "parsec", "--out", folder / "case"},
                 2, {"parsec"});
  expect_refused({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
                  folder / "mandible.stl", "--frame", "LLS", "--out", folder / "case"},
                 2, {"LLS"});
}

TEST(BadCase, RefusedWithTheReason) {
  const Folder folder;
  const std::string good = box_case(folder);
  expect_refused({"info", folder / "nowhere"}, 2, {"nowhere"});
  fs::create_directory(folder / "hollow");
  expect_refused({"info", folder / "hollow"}, 2, {"case.json"});
  const std::string json = read_text(good + "/case.json");
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string text = json;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text(good + "/case.json", text.replace(at, from.size(), to));
  };
  damaged("maxilla.ply", "../../etc/passwd");
  expect_refused({"info", good}, 2, {"case.json", "passwd"});
  damaged("{", "[");
  expect_refused({"info", good}, 2, {"case.json"});
  write_text(good + "/case.json", json);
  EXPECT_EQ(condyle({"info", good}).code, 0);
}

TEST(Volumes, AreDescribedOrRefused) {
  const Folder folder;
  const std::string header =
      "NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: 2 3 4\n"
      "space directions: (0.5,0,0) (0,0.6,0) (0,0,-2)\nendian: little\nencoding: raw\n"
      "space origin: (1,2,3)\n\n";
  std::string values(48, '\0');
  values[0] = 100;
  write_text(folder / "scan.nrrd", header + values);
  const auto described = condyle({"info", folder / "scan.nrrd"});
  EXPECT_EQ(described.code, 0);
  EXPECT_EQ(described.out,
            folder / "scan.nrrd" +
                ": 2 x 3 x 4 values, 0.5 x 0.6 x 2 mm apart, 1 x 2 x 8 mm in all; axes toward LPI; "
                "0 to 100 HU\n");
  const auto json = nlohmann::json::parse(condyle({"info", folder / "scan.nrrd", "--json"}).out);
  EXPECT_EQ(json["size"], nlohmann::json({2, 3, 4}));
  EXPECT_EQ(json["axes"][2], nlohmann::json({0, 0, -1}));
  write_text(folder / "half.nrrd", header + values.substr(0, 20));
  expect_refused({"info", folder / "half.nrrd"}, 2, {"half.nrrd", "20 bytes", "48"});
}

TEST(BadMotion, RefusedWithFileLineAndValue) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const std::string header = "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz\n";
  const std::map<std::string, std::pair<std::string, std::string>> motions = {
      {"empty.csv", {"", "empty.csv"}},
      {"columns.csv", {"time_s,tx_mm\n0,0\n1,0\n", "ty_mm"}},
      {"unsorted.csv", {header + "0,0,0,0,1,0,0,0\n2,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n", "line 4"}},
      {"nan.csv", {header + "0,0,0,0,1,0,0,0\n1,nan,0,0,1,0,0,0\n", "line 3"}},
      {"zero.csv", {header + "0,0,0,0,1,0,0,0\n1,0,0,0,0,0,0,0\n", "line 3"}},
      {"text.csv", {header + "0,0,0,0,1,0,0,0\n1,zero,0,0,1,0,0,0\n", "zero"}},
  };
  for (const auto& [name, motion] : motions) {
    write_text(folder / name, motion.first);
    expect_refused({"run", patient, "--motion", folder / name, "--out", folder / "out"}, 2,
                   {name, motion.second});
  }
  expect_refused({"run", patient, "--motion", "yawn", "--out", folder / "out"}, 2,
                 {"yawn", "opening"});
  expect_refused({"run", patient, "--motion", folder / "nowhere.csv", "--out", folder / "out"}, 2,
                 {"nowhere.csv"});
}

TEST(BadMotion, RefusedBeforeThePatientIsMade) {
  const Folder folder;
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const std::string earlier = cache ? cache : "";
  ::setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);  // the built-in patient is not there
  const std::string out = folder / "out";
  for (const char* command : {"run", "record"})
    expect_refused({command, "--motion", "opning", "--out", out}, 2, {"did you mean \"opening\"?"});
  expect_refused({"check", "--motion", "opning"}, 2, {"did you mean \"opening\"?"});
  for (const std::string motion : {"muscles:nowhere.csv", "nowhere.csv", "inverse:nowhere.csv"})
    expect_refused({"run", "--motion", motion, "--out", out}, 2, {"nowhere.csv"});
  expect_refused({"run", "--motion", "open 40; jump 3", "--out", out}, 2, {"jump"});
  EXPECT_FALSE(fs::exists(out)) << "nothing was begun";
  if (cache)
    ::setenv("XDG_CACHE_HOME", earlier.c_str(), 1);
  else
    ::unsetenv("XDG_CACHE_HOME");
}

TEST(BadCommand, RefusedWithTheValue) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  expect_refused({"dance"}, 2, {"dance", "record"});
  expect_refused({"run", patient, "--motion", "opening"}, 2, {"--out"});
  expect_refused({"run", patient, "--motion", "opening", "--out", out, "--frames", "0"}, 2,
                 {"--frames", "0"});
  expect_refused({"run", patient, "--motion", "opening", "--out", out, "--frames", "-3"}, 2,
                 {"--frames"});
  expect_refused({"run", patient, "--motion", "opening", "--out", out, "--fps", "0"}, 2, {"--fps"});
  expect_refused({"record", patient, "--motion", "opening", "--out", out, "--size", "0x720"}, 2,
                 {"0x720"});
  expect_refused({"record", patient, "--motion", "opening", "--out", out, "--size", "big"}, 2,
                 {"big"});
  expect_refused({"record", patient, "--motion", "opening", "--out", out, "--camera", "moon"}, 2,
                 {"moon"});
  expect_refused({"record", patient, "--motion", "opening", "--out", out, "--show", "soul"}, 2,
                 {"soul"});
  expect_refused({"run", patient, "--motion", "opening", "--out", out, "--threads", "0"}, 2,
                 {"--threads"});
  for (const char* option : {"--fps", "--opening", "--duration"})
    expect_refused({"run", patient, "--motion", "opening", "--out", out, option, "nan"}, 2,
                   {option, "nan"});
  expect_refused({"check", patient, "--margin", "nan"}, 2, {"--margin", "nan"});
  for (const auto& [rule, expected] : std::map<std::string, std::string>{
           {"maxilla,mandible", "A,B,POLICY"},
           {"maxilla,mandible,maybe", "forbidden, allowed, guided, cut-face"},
           {"maxilla,mandible,guided,gap=nan", "nan"},
           {"maxilla,mandible,forbidden,margin=-1", "-1"},
           {"maxilla,mandible,forbidden,width=1", "width=1"},
           {"maxilla,mandibel,forbidden", "maxilla, mandible"}}) {
    expect_refused({"check", patient, "--pair", rule}, 2, {"mandib", expected});
    expect_refused({"run", patient, "--motion", "opening", "--out", out, "--pair", rule}, 2,
                   {expected});
  }
  for (const auto& [carrier, reported] : std::map<std::string, std::string>{
           {"transplant", "NAME=mandible"},
           {"graft=mandible", "\"graft\"; there are transplant"},
           {"transplant=head", "\"head\" is no body; there are cranium, mandible, transplant"}})
    expect_refused({"import", "meshes", "--mandible", folder / "mandible.stl", "--transplant",
                    folder / "maxilla.stl", "--carrier-of", carrier, "--out", out},
                   2, {carrier, reported});
  expect_refused({"import"}, 2, {});
  EXPECT_EQ(condyle({"--help"}).code, 0);
  EXPECT_EQ(condyle({"record", "--help"}).code, 0);
  EXPECT_NE(condyle({"record", "--help"}).out.find("Example"), std::string::npos);
}

TEST(BadOutput, UnwritableOrFullFolderLeavesEarlierOutput) {
  const Folder folder;
  const std::string patient = box_case(folder), out = folder / "out";
  write_text(folder / "file", "in the way");
  expect_refused({"run", patient, "--motion", "opening", "--out", folder / "file"}, 1, {"file"});
  ASSERT_EQ(condyle({"run", patient, "--motion", "opening", "--out", out, "--frames", "5"}).code,
            0);
  const std::string trace = read_text(out + "/trace.csv"), report = read_text(out + "/report.json");
  ASSERT_EQ(lines(trace), 6);
  const auto full = condyle({"run", patient, "--motion", "opening", "--out", out, "--frames", "5"},
                            {.file_mb = 0});
  EXPECT_EQ(full.code, 1) << full.err;
  EXPECT_EQ(read_text(out + "/trace.csv"), trace);
  EXPECT_EQ(read_text(out + "/report.json"), report);
  expect_refused({"run", patient, "--motion", "opening", "--out", "/proc/nowhere"}, 1,
                 {"/proc/nowhere"});
}

}  // namespace condyle::test
