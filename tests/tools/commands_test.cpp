// The program as people use it: real files, real pixels, exit codes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/tools/pose_file.h"

namespace condyle::test {
namespace {

namespace fs = std::filesystem;

using Row = std::map<std::string, double>;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

struct Trace {
  std::vector<Row> rows;
  std::vector<std::string> hashes;
  std::vector<std::string> bits;  // every row without its times of computation
};

Trace read_trace(const fs::path& file) {
  Trace trace;
  std::istringstream text(read_text(file));
  std::string line;
  std::getline(text, line);
  const auto names = split(line);
  while (std::getline(text, line)) {
    const auto cells = split(line);
    Row row;
    std::string bits;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == "state_hash")
        trace.hashes.push_back(cells[i]);
      else
        row[names[i]] = std::strtod(cells[i].c_str(), nullptr);
      if (!names[i].ends_with("_ms")) bits += cells[i] + ",";
    }
    trace.rows.push_back(row);
    trace.bits.push_back(bits);
  }
  return trace;
}

std::map<std::string, std::string> pictures(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(folder))
    all[entry.path().filename().string()] = read_text(entry.path());
  return all;
}

}  // namespace

TEST(Run, TraceRepeatsToTheBitForOneAndTwoThreads) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto trace = [&](const std::string& threads) {
    const std::string out = folder / ("out" + threads);
    EXPECT_EQ(condyle({"run", patient, "--motion", "opening", "--out", out, "--frames", "31",
                       "--threads", threads})
                  .code,
              0);
    return read_trace(out + "/trace.csv");
  };
  const auto one = trace("1"), two = trace("2");
  ASSERT_EQ(one.rows.size(), 31u);
  EXPECT_EQ(one.bits, two.bits);
  EXPECT_NE(one.hashes[3], one.hashes[9]);
  EXPECT_EQ(one.rows[0].at("time_s"), 0);
  EXPECT_EQ(one.rows[30].at("time_s"), 3);
  EXPECT_EQ(one.rows[0].at("opening_mm"), 0);
  EXPECT_NEAR(one.rows[30].at("opening_mm"), 0, 1e-9);
  double widest = 0;
  for (const auto& row : one.rows) widest = std::max(widest, row.at("opening_mm"));
  EXPECT_GT(widest, 25);
}

TEST(Run, RecordedPosesAreTheTracesPoses) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "nod.csv";
  const double angle = 0.2;
  std::ostringstream csv;
  csv.precision(17);
  csv << pose_header << "0,0,0,0,1,0,0,0\n0.5,1,-2,-3," << std::cos(angle / 2) << ','
      << std::sin(angle / 2) << ",0,0\n1,0,0,0,1,0,0,0\n";
  write_text(motion, csv.str());
  ASSERT_EQ(
      condyle({"run", patient, "--motion", motion, "--out", folder / "out", "--frames", "3"}).code,
      0);
  const auto row = read_trace(folder / "out/trace.csv").rows.at(1);
  EXPECT_EQ(row.at("ty_mm"), -2);
  // The incisal point (0, -92, -41) turned about x and moved, by hand.
  EXPECT_NEAR(row.at("incisor_y_mm"), -92 * std::cos(angle) + 41 * std::sin(angle) - 2, 1e-9);
  EXPECT_NEAR(row.at("incisor_z_mm"), -92 * std::sin(angle) - 41 * std::cos(angle) - 3, 1e-9);
  EXPECT_NEAR(row.at("rotation_deg"), angle * 180 / M_PI, 1e-9);
}

TEST(Run, PushedIntoBoneStopsWhenContactIsRespected) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "bite.csv";
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,0,6,1,0,0,0\n");
  ASSERT_EQ(condyle({"run", patient, "--motion", motion, "--out", folder / "free"}).code, 0);
  ASSERT_EQ(
      condyle({"run", patient, "--motion", motion, "--respect-contact", "--out", folder / "kept"})
          .code,
      0);
  EXPECT_NEAR(read_trace(folder / "free/trace.csv").rows.back().at("max_penetration_mm"), 5, 1e-6);
  const auto kept = read_trace(folder / "kept/trace.csv").rows.back();
  EXPECT_LE(kept.at("max_penetration_mm"), 0.02);
  EXPECT_NEAR(kept.at("tz_mm"), 1, 0.05);
  EXPECT_EQ(kept.at("stopped"), 1);
}

TEST(Record, AFullDiskLeavesTheEarlierRecordingWhole) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto record = [&](const std::string& frames, const Limits& limits) {
    return condyle({"record", patient, "--motion", "opening", "--out", folder / "out", "--frames",
                    frames, "--size", "160x120"},
                   limits);
  };
  ASSERT_EQ(record("3", {}).code, 0);
  const auto before = pictures(folder / "out/frames");
  const std::string sheet = read_text(folder / "out/recording.json"),
                    trace = read_text(folder / "out/trace.csv");
  EXPECT_EQ(record("5", {.file_mb = 0}).code, 1);
  EXPECT_EQ(pictures(folder / "out/frames"), before);
  EXPECT_EQ(read_text(folder / "out/recording.json"), sheet);
  EXPECT_EQ(read_text(folder / "out/trace.csv"), trace);
  ASSERT_EQ(record("5", {}).code, 0);
  EXPECT_EQ(pictures(folder / "out/frames").size(), 5u);
  EXPECT_FALSE(fs::exists(folder / "out/.earlier"));
}

TEST(Record, ResumeRefusesAChangedMotionAndAChangedCamera) {
  const Folder folder;
  const std::string patient = box_case(folder), motion = folder / "nod.csv",
                    camera = folder / "camera.json";
  const auto record = [&](bool resume) {
    std::vector<std::string> command = {"record",   patient,        "--motion", motion,
                                        "--out",    folder / "out", "--frames", "4",
                                        "--camera", camera,         "--size",   "160x120"};
    if (resume) command.push_back("--resume");
    return condyle(command).code;
  };
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,0,-6,1,0,0,0\n");
  write_text(camera, "{\"distance_mm\": 500}");
  ASSERT_EQ(record(false), 0);
  EXPECT_EQ(record(true), 0);
  write_text(camera, "{\"distance_mm\": 501}");
  EXPECT_EQ(record(true), 2);
  write_text(camera, "{\"distance_mm\": 500}");
  write_text(motion, pose_header + "0,0,0,0,1,0,0,0\n1,0,0,-6.001,1,0,0,0\n");
  EXPECT_EQ(record(true), 2);
}

TEST(Record, AnotherLookOfTheSameMotionIsTheOneRecordedByItself) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto record = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> command = {"record",     patient,    "--motion", "opening", "--out",
                                        folder / out, "--frames", "3",        "--size",  "160x120"};
    command.insert(command.end(), more.begin(), more.end());
    return condyle(command);
  };
  const std::string bones = "maxilla:0.5,mandible";
  ASSERT_EQ(record("alone", {"--show", bones}).code, 0);
  ASSERT_EQ(record("all", {}).code, 0);
  const auto both = record("out", {"--also", folder / "other=" + bones});
  ASSERT_EQ(both.code, 0) << both.err;
  EXPECT_EQ(pictures(folder / "other/frames"), pictures(folder / "alone/frames"));
  EXPECT_EQ(pictures(folder / "out/frames"), pictures(folder / "all/frames"));
  EXPECT_NE(pictures(folder / "out/frames"), pictures(folder / "other/frames"));
  EXPECT_EQ(read_text(folder / "other/hashes.csv"), read_text(folder / "alone/hashes.csv"));
  EXPECT_EQ(read_trace(folder / "out/trace.csv").bits, read_trace(folder / "all/trace.csv").bits);
  EXPECT_NE(both.err.find("results are in " + std::string(folder / "out") + " and " +
                          std::string(folder / "other")),
            std::string::npos)
      << both.err;

  ASSERT_TRUE(fs::remove(folder / "other/frames/000001.png"));
  ASSERT_TRUE(fs::remove(folder / "out/frames/000002.png"));
  const auto resumed = record("out", {"--resume", "--also", folder / "other=" + bones});
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(pictures(folder / "other/frames"), pictures(folder / "alone/frames"));
  EXPECT_EQ(pictures(folder / "out/frames"), pictures(folder / "all/frames"));

  const auto refused = [&](const std::string& also) {
    const auto outcome = record("refused", {"--also", also});
    EXPECT_EQ(outcome.code, 2) << also;
    return outcome.err;
  };
  for (const std::string text : {"bones", "=bones", "glass="})
    EXPECT_NE(refused(text).find("--also " + text), std::string::npos);
  EXPECT_NE(refused(folder / "refused=" + bones).find("has that folder"), std::string::npos);
  EXPECT_NE(refused(folder / "x=tail").find("--also tail: unknown"), std::string::npos);
  EXPECT_NE(refused(folder / "x=bones:7").find("--also bones:7: the opacity"), std::string::npos);
  EXPECT_NE(refused(folder / "x=bones:0").find("nothing is left"), std::string::npos);
  EXPECT_NE(refused(folder / "x=bones,distance").find("the same map as --show"), std::string::npos);
}

TEST(Json, GoesAloneToStandardOutput) {
  const Folder folder;
  const std::string patient = box_case(folder);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"info", patient, "--json"},
        {"run", patient, "--motion", "opening", "--out", folder / "out", "--frames", "3", "--json"},
        {"check", patient, "--json"}}) {
    const auto outcome = condyle(command);
    EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << command[0] << "\n" << outcome.out;
    EXPECT_EQ(outcome.err.find('\r'), std::string::npos) << "a progress bar without a terminal";
  }
  EXPECT_EQ(condyle({"info", patient, "--quiet"}).err, "");
}

TEST(Info, StatesTheMemoryOfTheSoftTissue) {
  const auto outcome = condyle({"info", "--tissue", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto tissue = nlohmann::json::parse(outcome.out)["tissue"];
  const double nodes = tissue["nodes"].get<double>();
  EXPECT_EQ(nodes, 2140);
  EXPECT_DOUBLE_EQ(tissue["bytes_per_node"].get<double>() * nodes, tissue["bytes"].get<double>());
  EXPECT_GT(tissue["bytes_per_node"].get<double>(), 500);  // positions along the opening alone: 312
  EXPECT_LT(tissue["bytes_per_node"].get<double>(), 6000);
  const auto& factors = tissue["stored_factors"];
  EXPECT_GE(factors["made"].get<int>(), 1);
  EXPECT_GT(factors["most"].get<int>(), factors["made"].get<int>());
  EXPECT_GT(factors["most_bytes"].get<double>(), factors["bytes"].get<double>());
  EXPECT_LT(factors["most_bytes"].get<double>(), 1 << 30);
  const auto text = condyle({"info", "--tissue"}).out;
  EXPECT_NE(text.find("soft tissue: 2140 nodes"), std::string::npos) << text;
  EXPECT_NE(text.find("stored factors: "), std::string::npos) << text;

  const Folder folder;
  const std::string faceless = box_case(folder);
  for (const auto& [arguments, named] :
       {std::pair{std::vector<std::string>{"info", faceless, "--tissue"}, "has no face"},
        {{"info", folder / "maxilla.stl", "--tissue"}, "maxilla.stl is not a case"},
        {{"info", "--surface-nodes", "600"}, "--tissue"},
        {{"info", "--tissue", "--surface-nodes", "7"}, "--surface-nodes"}}) {
    const auto refused = condyle(arguments);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find(named), std::string::npos) << refused.err;
  }
}

TEST(Info, ListsTheBodiesWithTheirMass) {
  const Folder folder;
  write_box_patient(folder.path());
  const std::string patient = folder / "case";
  ASSERT_EQ(
      condyle({"import", "meshes", "--maxilla", folder / "maxilla.stl", "--mandible",
               folder / "mandible.stl", "--transplant", folder / "mandible.stl", "--out", patient})
          .code,
      0);
  const auto bodies = nlohmann::json::parse(condyle({"info", patient, "--json"}).out)["bodies"];
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(bodies[1]["parent"], "cranium");
  EXPECT_EQ(bodies[1]["driver"], "motion");
  EXPECT_EQ(bodies[2]["parts"], nlohmann::json({"transplant"}));
  EXPECT_EQ(bodies[2]["driver"], "hand");
  EXPECT_GT(bodies[2]["mass_g"].get<double>(), 0);
  EXPECT_EQ(bodies[2]["mass_g"], bodies[1]["mass_g"]) << "the same bone twice";
  EXPECT_NE(condyle({"info", patient}).out.find("body transplant: on "), std::string::npos);
}

TEST(Record, KilledAtAnyMomentLeavesWholeFramesAndResumesToTheSameBits) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto command = [&](const std::string& out) {
    return std::vector<std::string>{"record", patient,      "--motion", "opening",
                                    "--out",  folder / out, "--frames", "40",
                                    "--size", "320x240",    "--film"};
  };
  ASSERT_EQ(condyle(command("whole")).code, 0);
  const auto whole = pictures(folder / "whole/frames");
  ASSERT_EQ(whole.size(), 40u);
  const std::string film = read_text(folder / "whole/film.mp4");
  ASSERT_GT(film.size(), 1000u);

  const auto frames_of = [&](const std::string& out) {
    std::size_t count = 0;
    std::error_code none_yet;
    for (fs::directory_iterator it(folder / (out + "/frames"), none_yet), end;
         !none_yet && it != end; it.increment(none_yet))
      ++count;
    return count;
  };
  int interrupted = 0;
  for (const std::size_t after : {1u, 7u, 20u, 33u}) {
    const std::string out = "killed" + std::to_string(after);
    const auto killed =
        condyle(command(out), {.kill_when = [&] { return frames_of(out) >= after; }});
    if (fs::exists(folder / (out + "/frames"))) {
      for (const auto& [name, png] : pictures(folder / (out + "/frames"))) {
        if (name.ends_with(".png") && name.front() != '.') {
          ASSERT_TRUE(whole.contains(name));
          EXPECT_EQ(png, whole.at(name)) << name;
        }
      }
    }
    if (killed.code == 0) continue;
    ++interrupted;
    auto resume = command(out);
    resume.push_back("--resume");
    const auto resumed = condyle(resume);
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(pictures(folder / (out + "/frames")), whole);
    EXPECT_EQ(read_text(folder / (out + "/film.mp4")), film);
    EXPECT_EQ(read_trace(folder / (out + "/trace.csv")).bits,
              read_trace(folder / "whole/trace.csv").bits);
  }
  EXPECT_GT(interrupted, 0);
}

TEST(Record, InterruptedFromTheKeyboardItStatesHowToResume) {
  const Folder folder;
  const std::string patient = box_case(folder);
  const auto command = [&](bool resume) {
    std::vector<std::string> words = {"record", patient,        "--motion", "opening",
                                      "--out",  folder / "out", "--frames", "60"};
    if (resume) words.push_back("--resume");
    return words;
  };
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder / "out");
    const auto ended = condyle(
        command(false), {.kill_when = [&] { return fs::exists(folder / "out/frames/000002.png"); },
                         .kill_signal = signal});
    EXPECT_EQ(ended.code, 128 + signal) << "as any program that is interrupted";
    EXPECT_NE(ended.err.find("the same command with --resume"), std::string::npos) << ended.err;
    EXPECT_NE(ended.err.find(folder / "out"), std::string::npos) << ended.err;
  }
  const auto resumed = condyle(command(true));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_NE(resumed.err.find("were kept"), std::string::npos) << resumed.err;
  EXPECT_EQ(resumed.err.find("--resume"), std::string::npos) << resumed.err;
}

TEST(Info, ListsTheContentsOfAFile) {
  const Folder folder;
  write_box_patient(folder.path());
  const auto outcome = condyle({"info", folder / "mandible.stl", "--json"});
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["triangles"], 12);
  EXPECT_TRUE(json["closed"].get<bool>());
}

}  // namespace condyle::test
