#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_names.h"
#include "sim/case/source_frame.h"
#include "tests/engine/mesh_io/samples.h"

namespace condyle {
namespace {

using test::TempFolder;

std::string landmark_refusal(const std::filesystem::path& file) {
  try {
    read_landmarks(file);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << file << " was read";
  return "";
}

TEST(LandmarkNames, AliasesAreCaseAndSeparatorBlind) {
  for (const auto& [alias, name] : std::vector<std::pair<const char*, const char*>>{
           {"lowerincisor", "lower_incisal_point"},
           {"Lower Incisor", "lower_incisal_point"},
           {"L1 edge", "lower_incisal_point"},
           {"L1", "lower_incisal_point"},
           {"upperincisor", "upper_incisal_point"},
           {"U1-edge", "upper_incisal_point"},
           {"ltmj", "left_condyle"},
           {"RTMJ", "right_condyle"},
           {"left condyle", "left_condyle"},
           {"Condyle L", "left_condyle"},
           {"CondyleRight", "right_condyle"},
           {"TMJ_R", "right_condyle"},
           {"sto", "stomion"},
           {"Stomion", "stomion"},
           {"lchl", "left_cheilion"},
           {"rchl", "right_cheilion"},
           {"Ch L", "left_cheilion"},
           {"pog'", "soft_pogonion"},
           {"Pogonion'", "soft_pogonion"},
           {"pog", "pogonion"},
           {"prn", "pronasale"},
           {"LS", "labrale_superius"},
           {"li", "labrale_inferius"},
           {"Po R", "right_porion"},
           {"orbitale_left", "left_orbitale"},
           {"IOF L", "left_infraorbital_foramen"},
           {"Mental foramen R", "right_mental_foramen"},
           {"MF-L", "left_mental_foramen"},
           {"Lingula L", "left_lingula"},
           {"Zm R", "right_zygomaxillare"},
           {"U6 L", "upper_left_first_molar_mesiobuccal_cusp"},
           {"U6 mesiobuccal cusp R", "upper_right_first_molar_mesiobuccal_cusp"},
           {"U3 R", "upper_right_canine_tip"},
           {"L3 L", "lower_left_canine_tip"},
           {"R L3", "lower_right_canine_tip"},
           {"UR3", "upper_right_canine_tip"},
           {"LL6", "lower_left_first_molar_mesiobuccal_cusp"},
           {"L1 L", "lower_left_central_incisor_tip"},
           {"U1 apex R", "upper_right_central_incisor_apex"},
           {"13 tip", "upper_right_canine_tip"},
           {"46 MB apex", "lower_right_first_molar_mesiobuccal_apex"},
           {"Upper Left Canine Tip", "upper_left_canine_tip"},
           {"U1", "upper_incisal_point"},
           {"upper_incisal_point", "upper_incisal_point"}})
    EXPECT_EQ(canonical_landmark(alias), name) << alias;
}

TEST(LandmarkNames, OtherNamesStayTheirOwn) {
  EXPECT_EQ(canonical_landmark("lcondyle_geom"), "lcondyle_geom");
  EXPECT_EQ(canonical_landmark("ltmj_top"), "ltmj_top");
  EXPECT_EQ(canonical_landmark("lowerincisor_head"), "lowerincisor_head");
  EXPECT_EQ(canonical_landmark("hyoidRef"), "hyoid_ref");
  EXPECT_EQ(canonical_landmark("  My  Point #2 "), "my_point_2");
  EXPECT_EQ(canonical_landmark("-- '"), "");
  // A canonical name is unchanged.
  for (const char* name :
       {"left_condyle", "stomion", "hyoid_ref", "soft_pogonion", "my_point_2", "u9_l", "23"})
    EXPECT_EQ(canonical_landmark(name), name);
}

TEST(LandmarkNames, EveryKnownNameIsItsOwnAlias) {
  std::set<std::string> names;
  for (const auto& name : landmark_names()) {
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(canonical_landmark(name), name);
  }
  for (const int fdi : {11, 23, 36, 48}) {
    EXPECT_TRUE(names.count(tooth_landmark_names(fdi).tip)) << fdi;
    EXPECT_TRUE(names.count(tooth_landmark_names(fdi).apex)) << fdi;
  }
  EXPECT_EQ(tooth_landmark_names(23).apex, "upper_left_canine_apex");
  EXPECT_EQ(tooth_landmark_names(45).tip, "lower_right_second_premolar_buccal_cusp");
  for (const int fdi : {0, 10, 19, 51, -11})
    EXPECT_THROW(tooth_landmark_names(fdi), std::out_of_range);
}

TEST(Landmarks, CsvColumnsInAnyOrderWithQuotesAndWindowsLineEnds) {
  const TempFolder folder;
  const Landmarks found =
      read_landmarks(folder.write("a.csv",
                                  "\xef\xbb\xbfZ_mm,note,\"name\",x_mm,Y_MM\r\n3,\"a, "
                                  "\"\"b\"\"\",\"ltmj\",+1,-2e0\r\n\r\n6, ,Foo Bar,4,5\r\n"));
  ASSERT_EQ(found.points.size(), 2u);
  EXPECT_EQ(*found.find("left_condyle"), Eigen::Vector3d(1, -2, 3));
  EXPECT_EQ(*found.find("foo_bar"), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(read_landmarks(folder.write("b.csv", "name;x_mm;y_mm;z_mm\nsto;1;2;3")).points.size(),
            1u);
}

TEST(Landmarks, SlicerMarkupsBecomeLps) {
  const TempFolder folder;
  const auto file = [&](const std::string& system) {
    return folder.write("p.mrk.json", R"({"markups":[{"type":"Fiducial","coordinateSystem":)" +
                                          system +
                                          R"(,"coordinateUnits":"mm","controlPoints":[
      {"label":"L1 edge","position":[1,2,3],"positionStatus":"defined"},
      {"label":"later","position":[0,0,0],"positionStatus":"undefined"},
      {"label":"prn","position":[-4,5.5,6]}]}]})");
  };
  for (const char* lps : {"\"LPS\"", "\"1\"", "1"}) {
    const Landmarks found = read_landmarks(file(lps));
    ASSERT_EQ(found.points.size(), 2u);
    EXPECT_EQ(*found.find("lower_incisal_point"), Eigen::Vector3d(1, 2, 3));
  }
  for (const char* ras : {"\"RAS\"", "\"0\"", "0"})
    EXPECT_EQ(*read_landmarks(file(ras)).find("pronasale"), Eigen::Vector3d(4, -5.5, 6));
  EXPECT_NE(landmark_refusal(file("\"XYZ\""))
                .find("markups[0].coordinateSystem: the coordinate system \"XYZ\""),
            std::string::npos);
}

TEST(Landmarks, BadFilesAreRefusedWithTheirLine) {
  const TempFolder folder;
  const std::string head = "name,x_mm,y_mm,z_mm\n";
  struct Bad {
    const char* name;
    std::string content;
    std::vector<const char*> words;
  };
  for (const auto& bad : std::vector<Bad>{
           {"a.csv", head + "sto,1,2,3\nltmj,1,nan,3\n", {"line 3", "y_mm", "\"nan\""}},
           {"b.csv", head + "sto,1,inf,3\n", {"line 2", "\"inf\""}},
           {"c.csv", head + "sto,1,,3\n", {"line 2", "y_mm", "\"\""}},
           {"d.csv", head + "sto,1,2\n", {"line 2", "3 fields", "4"}},
           {"e.csv", "name,x_mm,y_mm\nsto,1,2\n", {"line 1", "\"z_mm\" is missing"}},
           {"f.csv", "name,x,y,z\nsto,1,2,3\n", {"\"x_mm\" is missing"}},
           {"g.csv",
            head + "ltmj,1,2,3\nsto,0,0,0\nLeft Condyle,1,2,4\n",
            {"line 4", "left_condyle", "line 2"}},
           {"h.csv", head + "\"sto,1,2,3\n", {"line 2", "quote"}},
           {"i.csv", head + "--,1,2,3\n", {"line 2", "no letter"}},
           {"j.csv", head, {"contains no landmarks"}},
           {"k.csv", "", {"no header"}},
           {"l.csv", head + "sto,1 mm,2,3\n", {"line 2", "\"1 mm\""}},
           {"m.csv", "name,x_mm,x_mm,y_mm,z_mm\n", {"twice"}},
           {"n.dcm", head, {".csv"}},
           {"a.json", "{\n\"markups\": [\n}", {"line 3", "not valid JSON"}},
           {"b.json", "{}", {"\"markups\" is missing"}},
           {"c.json",
            R"({"markups":[{"controlPoints":[{"label":"a","position":[1,2]}]}]})",
            {"markups[0].controlPoints[0].position", "2 numbers"}},
           {"d.json",
            R"({"markups":[{"controlPoints":[{"label":"a","position":[1,2,null]}]}]})",
            {"position[2]", "null"}},
           {"e.json", std::string(100'000, '['), {"deeper"}}}) {
    const std::string message = landmark_refusal(folder.write(bad.name, bad.content));
    for (const char* word : bad.words)
      EXPECT_NE(message.find(word), std::string::npos) << message << " lacks " << word;
  }
  EXPECT_NE(landmark_refusal(folder.path() / "none.csv").find("no such file"), std::string::npos);
  EXPECT_NE(landmark_refusal(folder.path()).find("folder"), std::string::npos);
}

TEST(SourceFrame, AllFortyEightFramesAreSignedAxisOrders) {
  EXPECT_EQ(all_frames().size(), 48u);
  int mirrored = 0;
  for (const auto& frame : all_frames()) {
    const SourceFrame found = source_frame("mm", frame);
    mirrored += found.mirrored();
    EXPECT_EQ((found.to_lps_mm() * found.to_lps_mm().transpose()), Eigen::Matrix3d::Identity())
        << frame;
    // The file's first axis points where the first letter says.
    const std::string letters = "LRPASI";
    const auto at = letters.find(frame[0]);
    EXPECT_EQ(found.to_lps_mm().col(0)[static_cast<int>(at / 2)], at % 2 ? -1 : 1) << frame;
  }
  EXPECT_EQ(mirrored, 24);
  EXPECT_EQ(source_frame("cm", "ras").to_lps_mm() * Eigen::Vector3d(1, 2, 3),
            Eigen::Vector3d(-10, -20, 30));
  EXPECT_EQ(source_frame("m", "LSA").to_lps_mm() * Eigen::Vector3d(1, 2, 3),
            Eigen::Vector3d(1000, -3000, 2000));
  EXPECT_EQ(source_frame("in", "LPS").to_lps_mm()(2, 2), 25.4);
  for (const char* bad : {"", "LP", "LPSX", "LRS", "XYZ", "LLS"})
    EXPECT_THROW(source_frame("mm", bad), InputError) << bad;
  EXPECT_THROW(source_frame("km", "LPS"), InputError);
}

}  // namespace
}  // namespace condyle
