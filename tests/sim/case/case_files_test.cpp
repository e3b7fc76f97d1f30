#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh/measure.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/case/edit_bodies.h"
#include "sim/case/pair_rules.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TempFolder;

Case sample() {
  Case patient;
  patient.name = "A \"patient\", é";
  patient.parts.push_back(
      {"mandible", Role::mandible, test::moved(test::sphere(2, 50), test::arbitrary_pose(1)), {}});
  TriMesh teeth = test::sphere(1, 4);
  const int one = static_cast<int>(teeth.triangles.size());
  teeth = test::joined(teeth, test::sphere(1, 4, {10, 0, 0}));
  patient.parts.push_back(
      {"lower-teeth", Role::lower_teeth, teeth, {{36, 0, one}, {37, one, one}}});
  patient.landmarks.points = {{"left_condyle", {1.0 / 3, 1e-300, -0.0}},
                              {"my_point", {5e8, 2.5, 0.1}}};
  patient.condylar_path = CondylarPath{{-1.0, 0.1, 12}, {0, 0.3, 1.0 / 7}};
  patient.source = source_frame("m", "LSA");
  patient.notes = {"one", "two \"quoted\"\nlines"};
  return patient;
}

std::string refusal(const fs::path& folder) {
  try {
    load_case(folder);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << folder << " was loaded";
  return "";
}

void expect_words(const std::string& message, const std::vector<const char*>& words) {
  for (const char* word : words)
    EXPECT_NE(message.find(word), std::string::npos) << message << "\n  lacks " << word;
}

TEST(CaseFiles, LoadingIsBitIdenticalToSaving) {
  const TempFolder folder;
  const Case saved = sample();
  save_case(saved, folder.path() / "a" / "case");
  const Case loaded = load_case(folder.path() / "a" / "case");
  EXPECT_EQ(loaded.name, saved.name);
  EXPECT_EQ(loaded.source.units, "m");
  EXPECT_EQ(loaded.source.axes, "LSA");
  EXPECT_EQ(loaded.notes, saved.notes);
  ASSERT_EQ(loaded.parts.size(), saved.parts.size());
  for (std::size_t i = 0; i < saved.parts.size(); ++i) {
    EXPECT_EQ(loaded.parts[i].name, saved.parts[i].name);
    EXPECT_EQ(loaded.parts[i].role, saved.parts[i].role);
    EXPECT_EQ(mesh_hash(loaded.parts[i].mesh), mesh_hash(saved.parts[i].mesh));
  }
  ASSERT_EQ(loaded.parts[1].teeth.size(), 2u);
  EXPECT_EQ(loaded.parts[1].teeth[1].fdi, 37);
  EXPECT_EQ(loaded.parts[1].teeth[1].first_triangle, saved.parts[1].teeth[1].first_triangle);
  ASSERT_EQ(loaded.landmarks.points.size(), 2u);
  for (const auto& [name, p] : saved.landmarks.points)
    EXPECT_EQ(std::memcmp(loaded.landmarks.find(name)->data(), p.data(), sizeof(p)), 0) << name;
  ASSERT_TRUE(loaded.condylar_path);
  EXPECT_EQ(loaded.condylar_path->forward_mm, saved.condylar_path->forward_mm);
  EXPECT_EQ(loaded.condylar_path->inferior_mm, saved.condylar_path->inferior_mm);
  EXPECT_EQ(load_case(folder.path() / "a" / "case" / "case.json").name, saved.name);
}

TEST(CaseFiles, TheScannedBiteIsStoredAndChecked) {
  const TempFolder folder;
  Case saved = sample();
  const Eigen::Affine3d moved = test::arbitrary_pose(3);
  saved.X_CM_bite = Pose{Eigen::Quaterniond(moved.rotation()).normalized(), moved.translation()};
  save_case(saved, folder.path() / "case");
  const Case loaded = load_case(folder.path() / "case");
  ASSERT_TRUE(loaded.X_CM_bite);
  EXPECT_EQ(loaded.X_CM_bite->t, saved.X_CM_bite->t);
  EXPECT_EQ(loaded.X_CM_bite->R.coeffs(), saved.X_CM_bite->R.coeffs());
  const fs::path file = folder.path() / "case" / "case.json";
  const json root = json::parse(read_file(file));
  for (const auto& [bite, words] :
       {std::pair(json{{"rotation", {1, 1, 0, 0}}, {"translation_mm", {0, 0, 0}}}, "no rotation"),
        std::pair(json{{"rotation", {1, 0, 0, 0}}, {"translation_mm", {0, 0}}}, "has 2 numbers"),
        std::pair(json{{"rotation", {1, 0, 0, 0}}}, "translation_mm")}) {
    json changed = root;
    changed["bite"] = bite;
    write_file(file, changed.dump());
    expect_words(refusal(folder.path() / "case"), {"case.json", "bite", words});
  }
}

/// The sample with two free parts and rules.
Case sample_with_free_parts() {
  Case patient = sample();
  patient.add_piece({"segment", Role::segment, test::sphere(1, 5), {}}, cranium_body);
  patient.add_piece({"transplant", Role::transplant, test::sphere(1, 5, {20, 0, 0}), {}},
                    mandible_body);
  patient.pair_rules = {{"mandible", "segment", PairPolicy::guided, std::nullopt, 0.1},
                        {"*", "transplant", PairPolicy::cut_face, {}, 0},
                        {"lower-teeth", "transplant", PairPolicy::forbidden, 1.0 / 3, 0}};
  return patient;
}

TEST(CaseFiles, FreePartsAndRulesRoundTrip) {
  const TempFolder folder;
  const Case saved = sample_with_free_parts();
  save_case(saved, folder.path() / "case");
  const Case loaded = load_case(folder.path() / "case");
  ASSERT_EQ(loaded.parts.size(), 4u);
  EXPECT_EQ(loaded.parts[2].role, Role::segment);
  EXPECT_EQ(loaded.bodies[loaded.parts[2].body].parent, cranium_body);
  EXPECT_EQ(loaded.parts[3].role, Role::transplant);
  EXPECT_EQ(loaded.bodies[loaded.parts[3].body].parent, mandible_body);
  EXPECT_EQ(loaded.bodies, saved.bodies);
  EXPECT_EQ(loaded.jaw, saved.jaw);
  ASSERT_EQ(loaded.pair_rules.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(loaded.pair_rules[i].a, saved.pair_rules[i].a);
    EXPECT_EQ(loaded.pair_rules[i].b, saved.pair_rules[i].b);
    EXPECT_EQ(loaded.pair_rules[i].policy, saved.pair_rules[i].policy);
    EXPECT_EQ(loaded.pair_rules[i].margin_mm, saved.pair_rules[i].margin_mm);
    EXPECT_EQ(loaded.pair_rules[i].gap_mm, saved.pair_rules[i].gap_mm);
  }
  Case broken = saved;
  broken.pair_rules[0].a = "mandibel";
  EXPECT_THROW(save_case(broken, folder.path() / "broken"), InputError);
  broken = saved;
  broken.pair_rules[0].margin_mm = std::nan("");
  EXPECT_THROW(save_case(broken, folder.path() / "broken"), InputError);
}

/// case.json as written by programs up to 0.1.7.
void write_as_version_1(const std::filesystem::path& folder, const Case& patient) {
  const auto file = folder / "case.json";
  json root = json::parse(read_file(file));
  root["version"] = 1;
  root.erase("bodies");
  root.erase("jaw");
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    root["parts"][i].erase("body");
    if (!is_piece(patient.parts[i].role)) continue;
    const BodyId parent = patient.bodies[patient.parts[i].body].parent;
    root["parts"][i]["carrier"] = patient.bodies[parent].name;
  }
  write_file(file, root.dump());
}

TEST(CaseFiles, AFolderOfTheFirstFormatOpensWithTheSameBodies) {
  const TempFolder folder;
  const Case saved = sample_with_free_parts();
  save_case(saved, folder.path() / "case");
  write_as_version_1(folder.path() / "case", saved);
  const Case loaded = load_case(folder.path() / "case");
  EXPECT_EQ(loaded.bodies, saved.bodies);
  EXPECT_EQ(loaded.jaw, saved.jaw);
  ASSERT_EQ(loaded.parts.size(), saved.parts.size());
  for (std::size_t i = 0; i < saved.parts.size(); ++i)
    EXPECT_EQ(loaded.parts[i].body, saved.parts[i].body) << i;
}

/// The sample with free parts and a canal in the mandible and in the transplant.
Case sample_with_canals() {
  Case patient = sample_with_free_parts();
  patient.canals = {{"left_mandibular_canal",
                     mandible_body,
                     1.0 / 3 + 2.5,
                     {{1.0 / 3, 1e-300, -0.0}, {1, 2, 3}, {-1e5, 2, 3}}},
                    {"nerve", patient.parts[3].body, 2, {{0, 0, 0}, {0, 0, 1}}}};
  return patient;
}

TEST(CaseFiles, CanalsRoundTrip) {
  const TempFolder folder;
  const Case saved = sample_with_canals();
  save_case(saved, folder.path() / "case");
  const Case loaded = load_case(folder.path() / "case");
  ASSERT_EQ(loaded.canals.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(loaded.canals[i].name, saved.canals[i].name);
    EXPECT_EQ(loaded.canals[i].body, saved.canals[i].body);
    EXPECT_EQ(loaded.canals[i].diameter_mm, saved.canals[i].diameter_mm);
    ASSERT_EQ(loaded.canals[i].points.size(), saved.canals[i].points.size());
    for (std::size_t k = 0; k < saved.canals[i].points.size(); ++k) {
      const auto &a = loaded.canals[i].points[k], &b = saved.canals[i].points[k];
      EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(a)), 0) << i << " " << k;
    }
  }
  save_case(sample(), folder.path() / "case");
  EXPECT_TRUE(load_case(folder.path() / "case").canals.empty());
}

TEST(CaseFiles, CanalsThatCouldNotBeLoadedAreNotSaved) {
  const TempFolder folder;
  const auto expect_refused = [&](const std::function<void(Canal&)>& change) {
    Case broken = sample_with_canals();
    change(broken.canals[0]);
    EXPECT_THROW(save_case(broken, folder.path() / "broken"), InputError);
  };
  expect_refused([](Canal& canal) { canal.name = "nerve"; });
  expect_refused([](Canal& canal) { canal.name = "a b"; });
  expect_refused([](Canal& canal) { canal.body = BodyId{9}; });
  expect_refused([](Canal& canal) { canal.diameter_mm = 0; });
  expect_refused([](Canal& canal) { canal.diameter_mm = std::nan(""); });
  expect_refused([](Canal& canal) { canal.points.resize(1); });
  expect_refused([](Canal& canal) { canal.points[1] = canal.points[0]; });
  expect_refused([](Canal& canal) { canal.points[1].y() = std::nan(""); });
  EXPECT_FALSE(fs::exists(folder.path() / "broken"));
}

TEST(CaseFiles, CanalsFollowTheNumbersOfTheirBodies) {
  const Case patient = sample_with_canals();
  const BodyId transplant = patient.parts[3].body, segment = patient.parts[2].body;
  // The segment precedes the transplant, so the bodies are renumbered.
  const Case moved = with_parent(patient, segment, transplant);
  EXPECT_EQ(moved.bodies[moved.canals[1].body].name, "transplant");
  EXPECT_EQ(moved.canals[0].body, mandible_body);
  const Case one = without_body(patient, segment);
  EXPECT_EQ(one.bodies[one.canals[1].body].name, "transplant");
  EXPECT_EQ(without_body(patient, transplant).canals.size(), 1u);
}

TEST(CaseFiles, TheLastRuleThatFitsCounts) {
  Case patient = sample_with_free_parts();
  const auto policy = [&](int a, int b, const std::vector<PairRule>& more = {}) {
    return rule_for(patient, more, patient.parts[a], patient.parts[b]).policy;
  };
  EXPECT_EQ(policy(0, 2), PairPolicy::guided);
  EXPECT_EQ(policy(2, 0), PairPolicy::guided);  // in either order
  EXPECT_EQ(policy(0, 3), PairPolicy::cut_face);
  EXPECT_EQ(policy(1, 2), PairPolicy::forbidden);  // the default
  EXPECT_EQ(policy(0, 2, {{"segment", "*", PairPolicy::allowed, {}, 0}}), PairPolicy::allowed);
  patient.pair_rules.clear();
  EXPECT_EQ(policy(1, 3), PairPolicy::cut_face);  // the mandible's teeth carry the transplant
}

TEST(CaseFiles, EveryRoleHasItsOwnName) {
  for (const Role role : {Role::skull, Role::maxilla, Role::mandible, Role::upper_teeth,
                          Role::lower_teeth, Role::face, Role::eyes, Role::upper_gums,
                          Role::lower_gums, Role::tongue, Role::segment, Role::transplant})
    EXPECT_EQ(role_named(role_name(role)), role);
  EXPECT_FALSE(role_named("hat"));
  EXPECT_NE(known_roles().find("upper-teeth"), std::string::npos);
}

TEST(CaseFiles, SavingAgainReplacesTheWholeCaseAndLeavesNoOtherFiles) {
  const TempFolder folder;
  const fs::path home = folder.path() / "case";
  Case patient = sample();
  save_case(patient, home);
  patient.parts.pop_back();
  patient.landmarks.points.clear();
  save_case(patient, home);
  EXPECT_EQ(load_case(home).parts.size(), 1u);
  EXPECT_FALSE(fs::exists(home / "lower-teeth.ply"));
  EXPECT_FALSE(fs::exists(home / "landmarks.csv"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(home), {}), 2);
}

TEST(CaseFiles, AFailedSaveLeavesTheEarlierCaseWhole) {
  const TempFolder folder;
  const fs::path home = folder.path() / "case";
  save_case(sample(), home);
  Case broken = sample();
  broken.name = "broken";
  broken.parts[1].name = "../outside";
  EXPECT_THROW(save_case(broken, home), InputError);
  broken = sample();
  broken.parts[1].name = broken.parts[0].name;
  EXPECT_THROW(save_case(broken, home), InputError);
  broken = sample();
  broken.landmarks.points["stomion"] =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(save_case(broken, home), InputError);
  EXPECT_EQ(load_case(home).name, sample().name);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(CaseFiles, OtherFoldersAreNeverReplaced) {
  const TempFolder folder;
  fs::create_directory(folder.path() / "photos");
  folder.write("photos/cat.jpg", "cat");
  EXPECT_THROW(save_case(sample(), folder.path() / "photos"), InputError);
  EXPECT_TRUE(fs::exists(folder.path() / "photos" / "cat.jpg"));
  save_case(sample(), folder.path() / "case");
  folder.write("case/report.txt", "mine");
  EXPECT_THROW(save_case(sample(), folder.path() / "case"), InputError);
  EXPECT_EQ(read_file(folder.path() / "case" / "report.txt"), "mine");
  folder.write("file", "x");
  EXPECT_THROW(save_case(sample(), folder.path() / "file"), InputError);
  fs::create_directory(folder.path() / "empty");
  save_case(sample(), folder.path() / "empty");
  EXPECT_EQ(load_case(folder.path() / "empty").parts.size(), 2u);
}

/// A saved case whose case.json is changed by `change`.
class BadCase : public testing::Test {
 protected:
  BadCase() { save_case(sample(), home_); }
  void expect(const std::function<void(json&)>& change, const std::vector<const char*>& words) {
    json root = json::parse(good_.empty() ? good_ = read_file(home_ / "case.json") : good_);
    change(root);
    folder_.write("case/case.json", root.dump());
    expect_words(refusal(home_), words);
  }
  TempFolder folder_;
  fs::path home_ = folder_.path() / "case";
  std::string good_;
};

TEST_F(BadCase, FilesOutsideTheFolderAreRefused) {
  write_ply(test::sphere(1, 1), folder_.path() / "outside.ply");
  fs::create_symlink(folder_.path() / "outside.ply", home_ / "link.ply");
  fs::create_directory_symlink(folder_.path(), home_ / "up");
  for (const char* file : {"../outside.ply", "/etc/passwd", "a/../../outside.ply", ""})
    expect([&](json& root) { root["parts"][0]["file"] = file; },
           {"case.json", "parts[0].file", "its own folder"});
  for (const char* file : {"link.ply", "up/outside.ply"})
    expect([&](json& root) { root["parts"][0]["file"] = file; },
           {"parts[0].file", "leads out of the folder"});
  expect([](json& root) { root["landmarks"] = "../landmarks.csv"; },
         {"landmarks", "its own folder"});
  expect([](json& root) { root["parts"][0]["file"] = "gone.ply"; },
         {"parts[0].file", "gone.ply", "missing"});
}

TEST_F(BadCase, EveryWrongValueIsNamed) {
  expect([](json& root) { root["version"] = 99; }, {"version", "99", "newer version"});
  expect([](json& root) { root["version"] = "one"; }, {"version", "\"one\"", "whole number"});
  expect([](json& root) { root.erase("name"); }, {"\"name\" is missing"});
  expect([](json& root) { root["name"] = 7; }, {"name", "7", "text"});
  expect([](json& root) { root["parts"] = 7; }, {"parts", "list"});
  expect([](json& root) { root["parts"] = json::array(); }, {"parts", "empty"});
  expect([](json& root) { root["parts"][1] = "x"; }, {"parts[1]", "object"});
  expect([](json& root) { root["parts"][0]["role"] = "hat"; },
         {"parts[0].role", "\"hat\"", "skull, maxilla, mandible"});
  expect([](json& root) { root["parts"][1]["name"] = "mandible"; },
         {"parts[1].name", "\"mandible\"", "twice"});
  expect([](json& root) { root["parts"][0]["name"] = "a/b"; }, {"parts[0].name", "\"a/b\""});
  expect([](json& root) { root["parts"][1]["teeth"][0]["fdi"] = 19; },
         {"parts[1].teeth[0].fdi", "19"});
  expect([](json& root) { root["parts"][1]["teeth"][1]["fdi"] = 36; },
         {"parts[1].teeth[1].fdi", "twice"});
  expect([](json& root) { root["parts"][1]["teeth"][1]["first_triangle"] = 3; },
         {"teeth[1].first_triangle", "3"});
  expect([](json& root) { root["parts"][1]["teeth"][1]["triangle_count"] = 4'000'000'000u; },
         {"teeth[1].triangle_count", "4000000000"});
  expect(
      [](json& root) {
        root["condylar_path"]["drop_mm"] = {1, 2};
      },
      {"condylar_path", "3", "2"});
  expect([](json& root) { root["condylar_path"]["forward_mm"][1] = -5; },
         {"forward_mm[1]", "increase"});
  expect([](json& root) { root["condylar_path"]["forward_mm"][1] = nullptr; },
         {"forward_mm[1]", "null"});
  expect([](json& root) { root["notes"] = "x"; }, {"notes", "list"});
}

TEST_F(BadCase, WrongCarriersOfTheFirstFormatAreNamed) {
  const Case saved = sample_with_free_parts();
  save_case(saved, home_);
  write_as_version_1(home_, saved);
  expect([](json& root) { root["parts"][2]["carrier"] = "tibia"; },
         {"parts[2].carrier", "\"tibia\"", "cranium or mandible"});
  expect([](json& root) { root["parts"][0]["carrier"] = "cranium"; },
         {"parts[0].carrier", "only a segment or transplant"});
}

TEST_F(BadCase, WrongCarriersAndRulesAreNamed) {
  save_case(sample_with_free_parts(), home_);
  expect([](json& root) { root["parts"][2]["body"] = "tibia"; },
         {"parts[2].body", "the body \"tibia\" does not exist"});
  expect([](json& root) { root["bodies"][2]["parent"] = "transplant"; },
         {"bodies[2].parent", "the body \"transplant\" does not exist"});
  expect([](json& root) { root["bodies"][2]["name"] = "mandible"; },
         {"bodies[2].name", "\"mandible\""});
  expect([](json& root) { root["bodies"][0]["name"] = "world"; },
         {"bodies", "the first body must be the cranium"});
  expect([](json& root) { root["bodies"][2]["driver"] = "wind"; },
         {"bodies[2].driver", "\"wind\"", "fixed, motion, plan, hand or dynamics"});
  expect([](json& root) { root["jaw"]["lower_arch"] = "tibia"; }, {"jaw.lower_arch", "\"tibia\""});
  expect([](json& root) { root.erase("bodies"); }, {"\"bodies\" is missing"});
  expect([](json& root) { root["contact_pairs"] = 3; }, {"contact_pairs", "list"});
  expect([](json& root) { root["contact_pairs"][0]["a"] = "mandibel"; },
         {"contact_pairs[0].a", "\"mandibel\"", "mandible, lower-teeth, segment, transplant"});
  expect([](json& root) { root["contact_pairs"][1].erase("b"); }, {"\"b\" is missing"});
  expect([](json& root) { root["contact_pairs"][1]["policy"] = "maybe"; },
         {"contact_pairs[1].policy", "\"maybe\"", "forbidden, allowed, guided, cut-face"});
  expect([](json& root) { root["contact_pairs"][0]["margin_mm"] = -0.5; },
         {"contact_pairs[0].margin_mm", "-0.5", "from 0"});
  expect([](json& root) { root["contact_pairs"][0]["gap_mm"] = "wide"; },
         {"contact_pairs[0].gap_mm", "\"wide\"", "number"});
}

TEST_F(BadCase, WrongCanalsAreNamed) {
  save_case(sample_with_canals(), home_);
  expect([](json& root) { root["canals"] = 3; }, {"case.json", "canals", "list"});
  expect([](json& root) { root["canals"][0] = 3; }, {"canals[0]", "object"});
  expect([](json& root) { root["canals"][0]["colour"] = 3; }, {"canals[0]", "\"colour\""});
  expect([](json& root) { root["canals"][1]["name"] = "left_mandibular_canal"; },
         {"canals[1].name", "\"left_mandibular_canal\"", "twice"});
  expect([](json& root) { root["canals"][0]["name"] = "a/b"; }, {"canals[0].name", "\"a/b\""});
  expect([](json& root) { root["canals"][0]["body"] = "tibia"; },
         {"canals[0].body", "\"tibia\"", "does not exist"});
  expect([](json& root) { root["canals"][0].erase("diameter_mm"); },
         {"\"diameter_mm\" is missing"});
  expect([](json& root) { root["canals"][0]["diameter_mm"] = 0; },
         {"canals[0].diameter_mm", "is 0"});
  expect([](json& root) { root["canals"][0]["diameter_mm"] = 300; },
         {"canals[0].diameter_mm", "300"});
  expect(
      [](json& root) {
        root["canals"][0]["points"] = {{1, 2, 3}};
      },
      {"canals[0].points", "has 1 of the two or more"});
  expect(
      [](json& root) {
        root["canals"][0]["points"][1] = {1, 2};
      },
      {"canals[0].points[1]", "2 numbers"});
  expect([](json& root) { root["canals"][0]["points"][1][2] = "low"; },
         {"canals[0].points[1][2]", "\"low\"", "number"});
  expect([](json& root) { root["canals"][0]["points"][1] = root["canals"][0]["points"][0]; },
         {"canals[0].points[1]", "repeats"});
}

TEST_F(BadCase, AFolderWithoutACaseIsRefusedWithAdvice) {
  folder_.write("case/case.json", R"({"id":"case-ubc","roles":{"mandible":"mandible.ply"}})");
  expect_words(refusal(home_), {"case.json", "not a Condyle case", "condyle import meshes"});
  folder_.write("case/case.json", "[1,2,3]");
  expect_words(refusal(home_), {"not a Condyle case"});
  folder_.write("case/case.json", "{\n \"format\": \"condyle case\",\n \"version\": }\n");
  expect_words(refusal(home_), {"case.json: line 3", "not valid JSON"});
  folder_.write("case/case.json", "");
  expect_words(refusal(home_), {"not valid JSON"});
  folder_.write("case/case.json", R"({"format":"condyle case","version":1,"name":1e999})");
  expect_words(refusal(home_), {"not valid JSON"});
  folder_.write("case/case.json", std::string(1'000'000, '['));
  expect_words(refusal(home_), {"deeper"});
  fs::remove(home_ / "case.json");
  expect_words(refusal(home_), {"has no case.json", "condyle import meshes"});
  expect_words(refusal(folder_.path() / "none"), {"no such folder"});
  expect_words(refusal(folder_.write("file", "x")), {"is a file"});
}

TEST_F(BadCase, DamagedPartsAndLandmarksAreNamed) {
  folder_.write("case/mandible.ply", "ply\n");
  expect_words(refusal(home_), {"mandible.ply", "header"});
  save_case(sample(), folder_.path() / "other");
  folder_.write("other/landmarks.csv", "name,x_mm,y_mm,z_mm\na,1,2,3\nb,nan,2,3\n");
  expect_words(refusal(folder_.path() / "other"), {"landmarks.csv", "line 3", "nan"});
}

TEST(CaseFiles, OtherSharedDataIsNoCase) {
  const auto folder = test::source_folder() / "../shared/data/case-ubc";
  if (!fs::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  expect_words(refusal(folder), {"not a Condyle case", "condyle import meshes"});
}

}  // namespace
}  // namespace condyle
