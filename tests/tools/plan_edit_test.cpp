// Commands that change a plan: undo and redo, order, notes, cuts in place.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace fs = std::filesystem;

namespace condyle::test {
namespace {

/// A plan with a genioplasty (step 1) and its move (step 2).
struct PlanEdit : testing::Test {
  const Folder folder;
  const std::string file = folder / "plan.json", out = folder / "out";

  void SetUp() override {
    done({"new", "--out", file, "--name", "chin"});
    done({"cut", file, "genioplasty"});
    done({"move", file, "chin", "forward", "6", "up", "1"});
  }
  static Outcome run(std::vector<std::string> words) {
    words.insert(words.begin(), "plan");
    return condyle(words);
  }
  static std::string done(const std::vector<std::string>& words) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << words[0] << ": " << outcome.err;
    return outcome.err;
  }
  std::string refused(const std::vector<std::string>& words) const {
    const std::string before = read_text(file);
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << words[0] << ": " << outcome.err;
    EXPECT_EQ(read_text(file), before);
    return outcome.err;
  }
  nlohmann::json plan() const { return nlohmann::json::parse(read_text(file)); }
  nlohmann::json apply() const {
    done({"apply", file, "--out", out});
    return nlohmann::json::parse(read_text(out + "/report.json"));
  }
};

void has_words(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

}  // namespace

TEST_F(PlanEdit, UndoneAndRedoneEditsAreReplayedToTheSameBits) {
  const std::string planned = read_text(file);
  apply();
  const std::string report = read_text(out + "/report.json"),
                    chin = read_text(out + "/segments/chin.ply");
  has_words(done({"edit", file, "1", "--set", "height_mm=12", "--kerf", "0.5"}), "kerf 0.5 mm");
  apply();
  EXPECT_NE(read_text(out + "/segments/chin.ply"), chin);
  has_words(done({"undo", file}), "undone: edit step 1 (cut genioplasty)");
  EXPECT_EQ(read_text(file), planned);
  apply();
  EXPECT_EQ(read_text(out + "/report.json"), report);
  EXPECT_EQ(read_text(out + "/segments/chin.ply"), chin);
  done({"undo", file});
  done({"undo", file});
  EXPECT_TRUE(plan()["steps"].empty());
  has_words(refused({"undo", file}), "plan.json: there is nothing to undo");
  has_words(done({"redo", file}), "redone: cut genioplasty");
  has_words(done({"redo", file}), "redone: move chin");
  EXPECT_EQ(read_text(file), planned);
  const Outcome json = condyle({"plan", "redo", file, "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["steps"][0]["cut"]["kerf_mm"], 0.5);
  has_words(refused({"redo", file}), "plan.json: there is nothing to redo");
  has_words(refused({"undo", folder / "absent.json"}), "absent.json: no such file");
}

TEST_F(PlanEdit, ADamagedHistoryIsSetAsideAndTheWorkGoesOn) {
  write_text(file + ".history", "{\"format\": ");
  const std::string note = done({"note", file, "remove", "teeth", "18", "and", "28"});
  has_words(note, "note: ");
  has_words(note, "plan.json.history.damaged");
  EXPECT_EQ(plan()["steps"][2]["note"], "remove teeth 18 and 28");
  has_words(done({"undo", file}), "undone: note");
  EXPECT_EQ(plan()["steps"].size(), 2u);
}

TEST_F(PlanEdit, ANewPlanInThePlaceOfAnotherIsUndone) {
  const std::string planned = read_text(file);
  done({"new", "built-in:class-iii", "--out", file});
  has_words(done({"undo", file}), "undone: new plan");
  EXPECT_EQ(read_text(file), planned);
}

TEST_F(PlanEdit, APlanForABuiltInHeadFindsItByItsName) {
  done({"new", "built-in:seed=3", "--out", file});
  has_words(done({"cut", file, "genioplasty"}), "chin:");
  done({"move", file, "chin", "forward", "4"});
  EXPECT_EQ(apply()["segments"][0]["name"], "chin");
  const Outcome checked = condyle({"check", "--plan", file, "--motion", "open 5", "--json"});
  EXPECT_NE(checked.code, 2) << checked.err;
}

TEST_F(PlanEdit, StepsAreReordered) {
  done({"note", file, "first", "of", "all"});
  has_words(done({"reorder", file, "3", "1"}), "3  note: first of all\n  1  cut genioplasty");
  EXPECT_EQ(plan()["steps"][0]["id"], 3);
  has_words(refused({"reorder", file, "2", "1"}), "needs \"chin\", which only step 1");
  has_words(refused({"reorder", file, "2", "4"}), "step 2 cannot be number 4 of 3 steps");
  has_words(refused({"reorder", file, "9", "1"}), "no step 9; its steps are 3, 1, 2");
  has_words(refused({"reorder", file, "2", "0"}), "POSITION");
  has_words(done({"undo", file}), "undone: reorder step 3 (note)");
}

TEST_F(PlanEdit, ACutIsChangedInPlaceAndTheMovesStay) {
  const auto moved = plan()["steps"][1];
  done({"edit", file, "1", "--set", "height_mm=12"});
  done({"edit", file, "1", "--kerf", "0.5", "--target", "mandible"});
  auto cut = plan()["steps"][0]["cut"];
  EXPECT_EQ(cut["parameters"]["height_mm"], 12);
  EXPECT_EQ(cut["kerf_mm"], 0.5);
  EXPECT_EQ(cut["target"], "mandible");
  EXPECT_EQ(plan()["steps"][1], moved);
  has_words(done({"edit", file, "1", "--set", "height_mm=default", "--pieces", "symphysis"}),
            "move symphysis: forward 6.0, up 1.0 mm; about pogonion");
  EXPECT_FALSE(plan()["steps"][0]["cut"].contains("parameters"));
  const auto report = apply();
  EXPECT_EQ(report["segments"][0]["name"], "symphysis");
  EXPECT_GT(report["movements"].size(), 0u);
  has_words(refused({"edit", file, "1"}), "give what is changed");
  has_words(refused({"edit", file, "2", "--kerf", "1"}), "step 2 (move symphysis) is no cut");
  has_words(refused({"edit", file, "7", "--kerf", "1"}), "no step 7");
  has_words(refused({"edit", file, "1", "--set", "heigth_mm=5"}), "height_mm");
  has_words(refused({"edit", file, "1", "--set", "height_mm=99"}), "expected 6 to 25 mm");
  has_words(refused({"edit", file, "1", "--target", "maxilla"}), "maxilla");
}

TEST_F(PlanEdit, ACutThatMakesOtherSegmentsNamesThem) {
  const std::string other = folder / "other.json";
  done({"new", "--out", other});
  done({"cut", other, "vault_panels"});
  has_words(done({"edit", other, "1", "--set", "columns=2"}),
            "makes strip, panel_left_1, panel_left_2, panel_right_1, panel_right_2;");
  done({"edit", other, "1", "--set", "columns=1"});
  done({"move", other, "panel_left", "up", "3"});
  const std::string before = read_text(other);
  const Outcome wrong = run({"edit", other, "1", "--set", "columns=2"});
  EXPECT_EQ(wrong.code, 2);
  has_words(wrong.err, "step 2 (move panel_left)");
  EXPECT_EQ(read_text(other), before);
}

TEST_F(PlanEdit, ACutBelowTheMarginsIsRememberedAndReported) {
  const std::string other = folder / "other.json";
  done({"new", "--out", other});
  done({"cut", other, "le_fort_2"});
  const std::string before = read_text(other);
  const std::vector<std::string> near = {"edit", other, "1", "--set", "foramen_margin_mm=4"};
  const Outcome refusal = run(near);
  EXPECT_EQ(refusal.code, 2);
  has_words(refusal.err, "cut le_fort_2 is not edited: ");
  has_words(refusal.err, "infraorbital foramen");
  EXPECT_EQ(read_text(other), before);
  auto allowed = near;
  allowed.push_back("--below-margins");
  done(allowed);
  has_words(read_text(other), "\"below_margins\": true");
  has_words(condyle({"plan", "show", other}).out, "below the least margins on request");
  has_words(condyle({"plan", "show", other, "--case", "built-in"}).out,
            "lies below the least margins, on request");
  done({"apply", other, "--out", out});
  const auto report = nlohmann::json::parse(read_text(out + "/report.json"));
  EXPECT_EQ(report["cuts"][0]["below_margins"], true);
  // It is requested anew for each change.
  has_words(run({"edit", other, "1", "--kerf", "0.5"}).err, "is not edited");
  done({"edit", other, "1", "--set", "foramen_margin_mm=default"});
  EXPECT_EQ(read_text(other), before);
}

TEST_F(PlanEdit, ApplyLeavesNoSegmentOfAnEarlierPlan) {
  apply();
  write_text(out + "/segments/mine.ply", "ply\n");
  write_text(out + "/segments/chin.txt", "notes\n");
  done({"edit", file, "1", "--pieces", "symphysis"});
  const auto report = apply();
  EXPECT_FALSE(fs::exists(out + "/segments/chin.ply"));
  EXPECT_TRUE(fs::exists(out + "/segments/symphysis.ply"));
  EXPECT_TRUE(fs::exists(out + "/segments/mine.ply"));
  EXPECT_TRUE(fs::exists(out + "/segments/chin.txt"));
  EXPECT_EQ(report["files"], nlohmann::json::array({"segments/symphysis.ply"}));
  // A report that names files elsewhere removes nothing there; one that is none, nothing at all.
  write_text(out + "/precious.ply", "ply\n");
  auto altered = report;
  altered["files"] = {"segments/../precious.ply", "precious.ply", "segments/mine.ply/.."};
  altered["segments"] = nlohmann::json::array();
  write_text(out + "/report.json", altered.dump());
  done({"undo", file});
  apply();
  EXPECT_TRUE(fs::exists(out + "/precious.ply"));
  write_text(out + "/report.json", "{\"plan\": \"x\", \"segments\": [{\"name\": \"mine\"}, 3]}");
  apply();
  EXPECT_TRUE(fs::exists(out + "/segments/mine.ply"));
  EXPECT_TRUE(fs::exists(out + "/segments/chin.ply"));
}

}  // namespace condyle::test
