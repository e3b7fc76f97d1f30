#include "sim/case/face_muscle_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/support/places.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

const std::string columns = "muscle,side,fibre,point,x_mm,y_mm,z_mm";
const std::string more = ",body,depth,spread_mm,max_force_N,shortening,law";

class FaceMuscleFiles : public testing::Test {
 protected:
  std::string refusal(const std::string& content) {
    try {
      read_face_muscles(folder_.write("f.csv", content));
    } catch (const InputError& error) {
      return error.what();
    }
    return "was read";
  }
  void expect_refused(const std::string& content, const std::vector<const char*>& words) {
    const std::string message = refusal(content);
    EXPECT_NE(message.find("f.csv"), std::string::npos) << message;
    for (const char* word : words)
      EXPECT_NE(message.find(word), std::string::npos) << message << "\n  lacks " << word;
  }
  test::TempFolder folder_;
};

TEST_F(FaceMuscleFiles, ATableReadsBackAsWritten) {
  const auto first = read_face_muscles(folder_.write(
      "f.csv", columns + more +
                   "\nZYG,left,1,0,52.25,-69.6,-5.6,cranium,,0,4,0.2,hill\n"
                   "ZYG,left,1,1,24,-90,-50,tissue,0.5,5,4,0.2,hill\n"
                   "ZYG,left,a,3,50,-70,-5.6,cranium,,0,4,0.2,hill\n"
                   "ZYG,left,a,7,24.1,-91,-50,,,5,4,0.2,hill\n"
                   "oom,both,1,1,0,-100,-40,,0.3,0,,,\noom,both,1,2,4,-100,-40,,0.3,0,,,\n"));
  ASSERT_EQ(first.muscles.size(), 2u);
  EXPECT_TRUE(first.has_bodies);
  const FaceMuscle& zygomaticus = first.muscles[0];
  EXPECT_EQ(zygomaticus.name, "left_zygomaticus_major");
  EXPECT_EQ(zygomaticus.law, FaceMuscleLaw::hill);
  ASSERT_EQ(zygomaticus.lines.size(), 2u);
  EXPECT_EQ(zygomaticus.lines[0][0].bone, cranium_body);
  EXPECT_FALSE(zygomaticus.lines[1][1].depth);
  EXPECT_EQ(first.muscles[1].name, "orbicularis_oris_marginal");
  EXPECT_EQ(first.muscles[1].limit_N, 0);
  EXPECT_TRUE(first.unused_columns.empty());
  const std::string text = face_muscles_csv(first.muscles);
  EXPECT_EQ(face_muscles_csv(read_face_muscles(folder_.write("g.csv", text)).muscles), text);
}

TEST_F(FaceMuscleFiles, AStrengthOfZeroInASavedCaseIsThatOfTheKind) {
  const auto file = folder_.write("f.csv", columns + more +
                                               "\nzyg,left,1,0,52,-70,-6,cranium,,0,0,0,bounded\n"
                                               "zyg,left,1,1,24,-90,-50,,0.5,5,0,0,bounded\n");
  const auto table = read_face_muscles(file, ZeroStrength::of_the_kind);
  ASSERT_EQ(table.muscles.size(), 1u);
  EXPECT_EQ(table.muscles[0].limit_N, 0);
  EXPECT_EQ(table.muscles[0].shortening, 0);
  EXPECT_THROW(read_face_muscles(file), InputError);
}

TEST_F(FaceMuscleFiles, BadRowsAreRefusedByLineColumnAndValue) {
  expect_refused("", {"empty"});
  expect_refused("muscle,side,fibre,point,x_mm,y_mm\n", {"z_mm", "missing"});
  expect_refused(columns + "\n", {"no muscle"});
  const auto rows = [&](const std::string& all) { return columns + more + "\n" + all; };
  const std::string good = "zyg,left,1,0,1,2,3,cranium,,0,4,0.2,\n";
  expect_refused(rows(good), {"left_zygomaticus_major", "one point"});
  expect_refused(rows(good + "zyg,left,1,0,1,2,9,,,0,4,0.2,\n"), {"line 3, point", "0"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,3,,,0,4,0.2,\n"), {"line 3", "one before it"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,x,,,0,4,0.2,\n"), {"line 3, z_mm", "x"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,9,nose,,0,4,0.2,\n"), {"line 3, body", "nose"});
  expect_refused(
      rows(good + "zyg,left,1,1,1,2,9,mandible,,0,4,0.2,\n" + "zyg,left,1,2,1,2,15,,,0,4,0.2,\n"),
      {"line 4, body", "only the ends"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,9,,1.5,0,4,0.2,\n"), {"depth", "1.5"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,9,,,0,5,0.2,\n"), {"max_force_N", "differs"});
  expect_refused(rows("zyg,left,1,0,1,2,3,,,0,4,0.9,\n"), {"line 2, shortening", "0.9"});
  expect_refused(rows("zyg,left,1,0,1,2,3,,,0,4,0.2,spring\n"), {"law", "spring", "hill"});
  expect_refused(rows("zyg,up,1,0,1,2,3,,,0,4,0.2,\n"), {"line 2, side", "up", "left"});
  expect_refused(rows("flap,left,1,0,1,2,3,,,0,,,\n"), {"max_force_N", "left_flap"});
  expect_refused(rows("zyg,left,1,0,1,2,3,,,0,0,0.2,\n"), {"line 2, max_force_N", "above 0"});
  expect_refused(rows("zyg,left,1,0,1,2,3,,,0,4,0,\n"), {"line 2, shortening", "above 0"});
  expect_refused(rows(good + "zyg,left,1,1,1,2,9,,,0,4,0.2,\nzyg,left,2,0,1,2,3,,,0,4,0.2,\n" +
                      "zyg,left,2,1,1,2,9,,,0,4,0.2,\nzyg,left,1,2,1,2,20,,,0,4,0.2,\n"),
                 {"line 6, fibre", "appears twice"});
}

/// A box of bone below a skin that faces forward (-y) at y = -60.
class FaceMuscleImports : public FaceMuscleFiles {
 protected:
  Case import(const std::string& rows, bool with_bodies = true) {
    write_ply(test::cuboid({-60, -50, -20}, {60, 60, 100}), folder_.path() / "skull.ply");
    write_ply(test::cuboid({-70, -60, -80}, {70, 70, 110}), folder_.path() / "face.ply");
    return import_meshes(
        {.files = {{Role::skull, folder_.path() / "skull.ply"},
                   {Role::face, folder_.path() / "face.ply"}},
         .landmarks = folder_.write("m.csv",
                                    "name,x_mm,y_mm,z_mm\nleft_cheilion,25,-60,-40\n"
                                    "right_cheilion,-25,-60,-40\nstomion,0,-60,-40\n"),
         .name = "box",
         .face_muscles =
             folder_.write("f.csv", columns + (with_bodies ? ",body\n" : "\n") + rows)});
  }
  void expect_import_refused(const std::string& rows, const std::vector<const char*>& words) {
    try {
      import(rows);
      FAIL() << rows;
    } catch (const InputError& error) {
      for (const char* word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
};

TEST_F(FaceMuscleImports, EndsAreCompletedWhereTheFileDoesNotNameThem) {
  const Case patient = import(
      "ZYG,left,1,0,30,-55,-30\nZYG,left,1,1,50,-51,20\n"
      "OOM,left,1,0,0,-58,-35\nOOM,left,1,1,20,-58,-40\nOOM,left,2,0,0,-58,-45\n"
      "OOM,left,2,1,20,-58,-40\nOOM,right,1,0,0,-58,-35\nOOM,right,1,1,-20,-58,-40\n"
      "OOM,right,2,0,0,-58,-45\nOOM,right,2,1,-20,-58,-40\n",
      false);
  ASSERT_EQ(patient.face_muscles.size(), 2u);
  const auto& fibre = patient.face_muscles[0].lines[0];
  EXPECT_EQ(fibre.front().at, Vector3d(50, -51, 20));
  EXPECT_EQ(fibre.front().bone, cranium_body);
  EXPECT_EQ(fibre.back().at, Vector3d(26.5, -55, -39.5));  // the modiolus
  EXPECT_GT(fibre.back().spread_mm, 0);
  for (std::size_t i = 1; i < fibre.size(); ++i)
    EXPECT_LT((fibre[i].at - fibre[i - 1].at).norm(), 6.01);
  EXPECT_EQ(patient.face_muscles[1].name, "orbicularis_oris_marginal");
  ASSERT_EQ(patient.face_muscles[1].lines.size(), 1u);
  EXPECT_EQ(patient.face_muscles[1].lines[0].front().at,
            patient.face_muscles[1].lines[0].back().at);
}

// The skull's front is at y = -50, the face's at -60.
TEST_F(FaceMuscleImports, MusclesOfTheBrowsBeginOnTheBoneWhicheverEndComesFirst) {
  const Case patient = import(
      "COR,left,1,0,12,-58,50\nCOR,left,1,1,3,-50.5,40\n"
      "FRM,left,1,0,20,-58,50\nFRM,left,1,1,20,-55,90\n"
      "OCS,left,1,0,10,-51,40\nOCS,left,1,1,25,-58,52\nOCS,left,1,2,40,-51,40\n",
      false);
  const auto fibre = [&](const char* name) {
    for (const FaceMuscle& muscle : patient.face_muscles)
      if (muscle.name == name) return muscle.lines.front();
    throw std::out_of_range(name);
  };
  EXPECT_EQ(fibre("left_corrugator").front().at, Vector3d(3, -50.5, 40));
  EXPECT_EQ(fibre("left_corrugator").front().bone, cranium_body);
  EXPECT_EQ(fibre("left_corrugator").back().bone, std::nullopt);
  EXPECT_EQ(fibre("left_frontalis_medial").front().at.z(), 90);
  EXPECT_EQ(fibre("left_orbicularis_oculi_superior").front().bone, cranium_body);
  EXPECT_EQ(fibre("left_orbicularis_oculi_superior").back().bone, cranium_body);
}

bool has_muscle_note(const Case& patient, const std::string& words) {
  return std::any_of(patient.notes.begin(), patient.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

TEST_F(FaceMuscleImports, FibresAreNotLedToTheMouthFromFarAway) {
  try {
    import("ZYG,left,1,0,50,-51,20\nZYG,left,1,1,40,-52,-5\n", false);
    FAIL();
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* words : {"left_zygomaticus_major, fibre 1", "left corner", "37 mm"})
      EXPECT_NE(message.find(words), std::string::npos) << message;
  }
}

TEST_F(FaceMuscleImports, FibresThroughTheAirwayAreNoted) {
  const std::string ends[] = {"ris,left,1,0,50,-59,-40,tissue\n",
                              "ris,left,1,2,26,-59,-40,tissue\n"};
  EXPECT_FALSE(
      has_muscle_note(import(ends[0] + "ris,left,1,1,40,-50,-40,tissue\n" + ends[1]), "airway"));
  EXPECT_TRUE(has_muscle_note(import(ends[0] + "ris,left,1,1,35,-20,-40,tissue\n" + ends[1]),
                              "left_risorius, fibre 1 (35 mm deep"));
}

TEST_F(FaceMuscleImports, ColumnsThatAreNotUsedAreNoted) {
  const FaceMuscleTable table = read_face_muscles(
      folder_.write("g.csv", columns + ",max_force,full_name\nzyg,left,1,0,1,2,3,9,z\n"
                                       "zyg,left,1,1,1,2,9,9,z\n"));
  EXPECT_EQ(table.unused_columns, std::vector<std::string>{"max_force"});
}

TEST_F(FaceMuscleImports, WhatIsNoMuscleOfThisFaceIsRefused) {
  expect_import_refused("ZYG,left,1,0,50,-51,20,cranium\nZYG,left,1,1,30,-80,-30,tissue\n",
                        {"f.csv", "left_zygomaticus_major, fibre 1", "outside the skin"});
  expect_import_refused("ZYG,left,1,0,50,-40,-70,cranium\nZYG,left,1,1,30,-55,-30,tissue\n",
                        {"on no bone", "cranium is 5"});
  expect_import_refused("ZYG,left,1,0,50,-51,20,cranium\nZYG,left,1,1,0,5,0,tissue\n",
                        {"65 mm from the skin"});
  const Case through =
      import("zyg,left,1,0,50,-51,20\nzyg,left,1,1,40,-30,0\nzyg,left,1,2,30,-55,-30\n", false);
  EXPECT_TRUE(std::any_of(through.notes.begin(), through.notes.end(), [](const std::string& note) {
    return note.find("pass through bone: left_zygomaticus_major") != std::string::npos;
  }));
}

TEST_F(FaceMuscleImports, AreSavedWithTheCase) {
  const Case patient = import("ZYG,left,1,0,50,-51,20,cranium\nZYG,left,1,1,30,-55,-30,tissue\n");
  save_case(patient, folder_.path() / "case");
  const Case loaded = load_case(folder_.path() / "case");
  EXPECT_EQ(face_muscles_csv(loaded.face_muscles), face_muscles_csv(patient.face_muscles));
  save_case(loaded, folder_.path() / "case");  // the table is part of the case
}

TEST(RealFaceMuscles, CaseBadinHasEighteenFibresASide) {
  const fs::path badin = test::real_data() / "case-badin";
  if (!fs::exists(badin)) GTEST_SKIP() << "real anatomy absent";
  const Case patient = import_meshes({.files = {{Role::maxilla, badin / "maxilla_capped.ply"},
                                                {Role::mandible, badin / "mandible.ply"},
                                                {Role::face, badin / "face_skin.ply"}},
                                      .landmarks = badin / "markers.csv",
                                      .name = "badin",
                                      .face_muscles = badin / "face_muscles.csv"});
  std::size_t fibres = 0;
  for (const FaceMuscle& muscle : patient.face_muscles) {
    EXPECT_TRUE(is_face_muscle_kind(muscle.kind)) << muscle.kind;
    const bool loop = face_muscle_side(muscle) == "both";
    // Two arcs a side are one loop.
    fibres += muscle.lines.size() * (loop ? 4 : 1);
    for (const auto& fibre : muscle.lines)
      EXPECT_EQ(fibre.front().bone.has_value(), !loop && muscle.kind != "risorius");
    if (muscle.kind.starts_with("depressor") || muscle.kind == "mentalis") {
      EXPECT_EQ(muscle.lines[0][0].bone, mandible_body) << muscle.name;
    } else if (muscle.kind.starts_with("levator") || muscle.kind.starts_with("zygo")) {
      EXPECT_EQ(muscle.lines[0][0].bone, cranium_body) << muscle.name;
    }
  }
  EXPECT_EQ(fibres, 36u);
}

}  // namespace
}  // namespace condyle
