// Histories of plans: their bounds, and the file beside a plan in every state that a program, a
// person or a crash may leave.
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "sim/plan/plan_file.h"
#include "sim/plan/plan_history_file.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/sim/plan/plans.h"
#include "tests/support/program.h"

using namespace condyle;
using namespace condyle::test;

namespace {

namespace fs = std::filesystem;

Plan noted(const Plan& plan, const std::string& text) { return with_step(plan, NoteStep{text}); }

/// A folder with a plan that was saved with the notes "a", "b" and "c", one at a time.
struct PlanHistoryFile : testing::Test {
  const TempFolder folder;
  const fs::path file = folder.path() / "plan.json", beside = folder.path() / "plan.json.history";
  std::vector<Plan> plans = {sample_plan()};

  PlanHistoryFile() {
    save_edit(plans[0], file, "new plan");
    for (const char* text : {"a", "b", "c"}) {
      plans.push_back(noted(plans.back(), text));
      EXPECT_TRUE(save_edit(plans.back(), file, std::string("note ") + text).empty());
    }
  }

  std::string refusal(const std::function<void()>& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "was accepted";
    return "";
  }
  bool is_there(const std::string& name) const { return fs::exists(folder.path() / name); }
};

void expect_part(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

}  // namespace

TEST(PlanHistory, KeepsTheLast100Plans) {
  PlanHistory history{Plan{.name = "0"}};
  for (int i = 1; i <= 250; ++i) history.edit(Plan{.name = std::to_string(i)}, "edit");
  ASSERT_EQ(history.entries().size(), 100u);
  EXPECT_EQ(history.plan().name, "250");
  for (int i = 0; i < 99; ++i) EXPECT_TRUE(history.undo());
  EXPECT_FALSE(history.undo());
  EXPECT_EQ(history.plan().name, "151");
  std::vector<PlanHistory::Entry> many = history.entries();
  many.push_back(many.back());
  EXPECT_EQ(PlanHistory(many, 100).entries().front().plan.name, "152");
  EXPECT_EQ(PlanHistory(many, 0).entries().size(), 100u);
  EXPECT_EQ(PlanHistory(many, 0).plan().name, "151");
  EXPECT_THROW(PlanHistory(many, 101), InputError);
  EXPECT_THROW(PlanHistory({}, 0), InputError);
}

TEST(PlanHistory, StepsToNeighboursAlone) {
  PlanHistory history{Plan{.name = "0"}};
  for (const char* name : {"1", "2", "3"}) history.edit(Plan{.name = name}, name);
  EXPECT_TRUE(history.step_to(Plan{.name = "3"}));
  EXPECT_FALSE(history.step_to(Plan{.name = "1"}));
  EXPECT_EQ(history.now(), 3u);
  EXPECT_TRUE(history.step_to(Plan{.name = "2"}));
  EXPECT_EQ(history.redoable(), "3");
  EXPECT_TRUE(history.step_to(Plan{.name = "3"}));
  EXPECT_EQ(history.undoable(), "3");
}

TEST(PlanHistory, ItsTextReadsBackAndIsBounded) {
  PlanHistory history{sample_plan()};
  for (const char* text : {"a", "b", "c", "d"})
    history.edit(noted(history.plan(), text), std::string("note \"") + text + "\"\n");
  history.undo();
  const std::string text = history_json(history);
  const PlanHistory back = parse_history("h", text);
  EXPECT_EQ(back.entries(), history.entries());
  EXPECT_EQ(back.now(), 3u);
  EXPECT_EQ(history_json(back), text);
  // The oldest are left out first, then what was undone; the present plan stays.
  std::size_t kept = 5;
  for (const std::size_t most : {text.size() - 1000, text.size() / 2, std::size_t{1}}) {
    const std::string shorter = history_json(history, most);
    const PlanHistory rest = parse_history("h", shorter);
    EXPECT_LT(rest.entries().size(), kept);
    kept = rest.entries().size();
    EXPECT_EQ(rest.plan(), history.plan());
    EXPECT_TRUE(shorter.size() <= most || kept == 1) << most;
  }
  EXPECT_EQ(kept, 1u);
}

TEST_F(PlanHistoryFile, UndoAndRedoRestoreTheFileToTheByte) {
  std::vector<std::string> texts;
  for (const Plan& plan : plans) texts.push_back(plan_json(plan));
  EXPECT_EQ(read_text(file), texts[3]);
  for (int i = 2; i >= 0; --i) {
    EXPECT_EQ(undo_edit(file).edit, std::string("note ") + "abc"[i]);
    EXPECT_EQ(read_text(file), texts[i]);
  }
  expect_part(refusal([&] { undo_edit(file); }), "plan.json: there is nothing to undo");
  EXPECT_EQ(read_text(file), texts[0]);
  for (int i = 1; i <= 3; ++i) {
    const ReversedEdit redone = redo_edit(file);
    EXPECT_EQ(redone.edit, std::string("note ") + "abc"[i - 1]);
    EXPECT_EQ(redone.plan, plans[i]);
    EXPECT_EQ(read_text(file), texts[i]);
  }
  expect_part(refusal([&] { redo_edit(file); }), "plan.json: there is nothing to redo");
  undo_edit(file);
  const Plan other = noted(plans[2], "d");
  save_edit(other, file, "note d");
  EXPECT_THROW(redo_edit(file), InputError);
  EXPECT_EQ(undo_edit(file).plan, plans[2]);
}

TEST_F(PlanHistoryFile, APlanWithoutAHistoryBeginsOne) {
  fs::remove(beside);
  EXPECT_THROW(undo_edit(file), InputError);
  save_edit(noted(plans[3], "d"), file, "note d");
  EXPECT_EQ(undo_edit(file).plan, plans[3]);
  EXPECT_THROW(undo_edit(file), InputError);
}

// The history is written first: each state is the new history beside the earlier plan.
TEST_F(PlanHistoryFile, AnInterruptedCommandLeavesThePlanAndAllItsEdits) {
  const Plan next = noted(plans[3], "d");
  struct Command {
    const char* name;
    std::function<void()> run;
  };
  const std::vector<Command> commands = {{"edit", [&] { save_edit(next, file, "note d"); }},
                                         {"undo", [&] { undo_edit(file); }},
                                         {"redo", [&] { redo_edit(file); }}};
  for (const Command& command : commands) {
    for (int i = 0; i < 3; ++i) save_edit(plans[i + 1], file, std::string("note ") + "abc"[i]);
    if (command.name == std::string("redo")) undo_edit(file);
    const std::string before = read_text(file), history_before = read_text(beside);
    command.run();
    const std::string history = read_text(beside);
    ASSERT_NE(history, history_before);
    const auto interrupt = [&] {
      write_text(file, before);
      write_text(beside, history);
    };
    interrupt();
    const Plan plan = load_plan(file);
    EXPECT_EQ(undo_edit(file).plan, command.name == std::string("redo") ? plans[1] : plans[2])
        << command.name;
    EXPECT_EQ(redo_edit(file).plan, plan) << command.name;
    interrupt();
    if (command.name == std::string("undo")) {
      EXPECT_THROW(redo_edit(file), InputError);
    } else {
      EXPECT_EQ(redo_edit(file).plan, command.name == std::string("redo") ? plans[3] : next);
    }
    interrupt();
    EXPECT_TRUE(save_edit(noted(plan, "e"), file, "note e").empty());
    EXPECT_EQ(undo_edit(file).plan, plan) << command.name;
    EXPECT_EQ(undo_edit(file).plan, command.name == std::string("redo") ? plans[1] : plans[2]);
  }
}

TEST_F(PlanHistoryFile, AnEditByHandIsAnEntryOfItsOwn) {
  const Plan by_hand = noted(plans[3], "by hand"), next = noted(by_hand, "d");
  save_plan(by_hand, file);
  EXPECT_THROW(redo_edit(file), InputError);
  save_edit(next, file, "note d");
  EXPECT_EQ(undo_edit(file).plan, by_hand);
  EXPECT_EQ(undo_edit(file).edit, "edit by hand");
  EXPECT_EQ(load_plan(file), plans[3]);
  EXPECT_EQ(redo_edit(file).plan, by_hand);
  EXPECT_EQ(redo_edit(file).plan, next);
  // Right before an undo, and after one.
  save_plan(plans[0], file);
  EXPECT_EQ(undo_edit(file).plan, next);
  EXPECT_EQ(redo_edit(file).plan, plans[0]);
  // The layout alone is no edit.
  write_text(file, read_text(file) + "\n\n");
  EXPECT_EQ(undo_edit(file).plan, next);
}

TEST_F(PlanHistoryFile, DamagedAndForeignHistoriesAreSetAside) {
  const std::string whole = read_text(beside);
  Plan other_case = plans[3];
  other_case.geometry.parts[0].hash += 1;
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  std::vector<std::string> wrong = {"",
                                    "[]",
                                    "history\n",
                                    plan_json(plans[3]),
                                    history_json(PlanHistory(other_case)),
                                    replaced("\"version\": 1, \"now\"", "\"version\": 2, \"now\""),
                                    replaced("\"now\": 3", "\"now\": 4"),
                                    replaced("\"now\": 3", "\"now\": -1"),
                                    replaced("\"kerf_mm\": 0.7", "\"kerf_mm\": 70")};
  for (std::size_t size = 1; size + 3 < whole.size(); size += 997)
    wrong.push_back(whole.substr(0, size));
  ASSERT_GT(wrong.size(), 15u);
  int count = 0;
  for (const std::string& text : wrong) {
    const std::string aside =
        "plan.json.history.damaged" + (count > 0 ? "-" + std::to_string(count + 1) : "");
    save_plan(plans[3], file);
    write_text(beside, text);
    expect_part(refusal([&] { undo_edit(file); }), "it is set aside as " + aside);
    EXPECT_EQ(load_plan(file), plans[3]);
    EXPECT_EQ(read_text(folder.path() / aside), text);
    ++count;
    EXPECT_FALSE(is_there("plan.json.history"));
    write_text(beside, text);
    const auto notes = save_edit(noted(plans[3], "d"), file, "note d");
    ++count;
    ASSERT_EQ(notes.size(), 1u);
    expect_part(notes[0], "plan.json.history");
    EXPECT_EQ(undo_edit(file).plan, plans[3]);
    EXPECT_THROW(undo_edit(file), InputError);
  }
}

TEST_F(PlanHistoryFile, AFolderInThePlaceOfTheHistoryIsSetAside) {
  fs::remove(beside);
  fs::create_directories(beside / "inside");
  EXPECT_EQ(save_edit(noted(plans[3], "d"), file, "note d").size(), 1u);
  EXPECT_TRUE(is_there("plan.json.history.damaged/inside"));
  EXPECT_EQ(undo_edit(file).plan, plans[3]);
}

TEST_F(PlanHistoryFile, AHistoryThatCannotBeWrittenKeepsNobodyFromWork) {
  // The temporary name of the plan has room in a folder, that of its history has not.
  const fs::path longest = folder.path() / std::string(238, 'p');
  save_plan(plans[0], longest);
  const auto notes = save_edit(plans[1], longest, "note a");
  ASSERT_EQ(notes.size(), 1u);
  expect_part(notes[0], "the history of the plan is not saved");
  EXPECT_EQ(load_plan(longest), plans[1]);
}

TEST_F(PlanHistoryFile, UndoRestoresADamagedOrDeletedPlan) {
  write_text(file, plan_json(plans[3]).substr(0, 700));
  expect_part(refusal([&] { redo_edit(file); }), "plan.json: line ");
  const ReversedEdit restored = undo_edit(file);
  EXPECT_EQ(restored.plan, plans[3]);
  ASSERT_EQ(restored.notes.size(), 1u);
  expect_part(restored.notes[0], "it is set aside as plan.json.damaged");
  EXPECT_EQ(read_text(folder.path() / "plan.json.damaged"), plan_json(plans[3]).substr(0, 700));
  EXPECT_EQ(load_plan(file), plans[3]);
  fs::remove(file);
  EXPECT_EQ(undo_edit(file).plan, plans[3]);
  EXPECT_EQ(undo_edit(file).plan, plans[2]);
  // A new plan in the place of one that cannot be read.
  write_text(file, "{");
  EXPECT_EQ(save_edit(plans[0], file, "new plan").size(), 1u);
  EXPECT_TRUE(is_there("plan.json.damaged-2"));
  EXPECT_EQ(undo_edit(file).plan, plans[2]);
  fs::remove(beside);
  fs::remove(file);
  expect_part(refusal([&] { undo_edit(file); }), "no such file");
}

TEST_F(PlanHistoryFile, WhatCouldNotBeReadBackIsRefusedBeforeAnythingIsWritten) {
  const std::string before = read_text(file), history = read_text(beside);
  Plan garbled = plans[3];
  garbled.geometry.name = "\xff\xfe";
  EXPECT_THROW(save_edit(garbled, file, "nonsense"), InputError);
  EXPECT_EQ(read_text(file), before);
  EXPECT_EQ(read_text(beside), history);
}
