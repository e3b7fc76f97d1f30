#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/case/source_frame.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/support/places.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::joined;
using test::TempFolder;

/// A mandible of blocks in LPS: a chin piece in front, two bodies, two rami up to the condyles.
TriMesh blocks_jaw() {
  TriMesh jaw = test::cuboid({-15, -50, 5}, {15, -40, 40});
  for (const double side : {-1.0, 1.0}) {
    const auto box = [&](double inner, double outer, Vector3d low, Vector3d high) {
      low.x() = std::min(side * inner, side * outer),
      high.x() = std::max(side * inner, side * outer);
      jaw = joined(jaw, test::cuboid(low, high));
    };
    box(15, 45, {0, -45, 8}, {0, 30, 30});
    box(40, 50, {0, 20, 30}, {0, 38, 80});
  }
  return jaw;
}

/// The same surface as a file in `frame` and `units` would hold it.
TriMesh as_file(TriMesh mesh, const std::string& units, const std::string& frame) {
  const SourceFrame source = source_frame(units, frame);
  const Eigen::Matrix3d back = source.to_lps_mm().inverse();
  for (auto& v : mesh.vertices) v = back * v;
  if (source.mirrored()) flip(mesh);
  return mesh;
}

bool has_note(const Case& patient, const std::string& words) {
  return std::any_of(patient.notes.begin(), patient.notes.end(), [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

class Import : public testing::Test {
 protected:
  fs::path mesh(const std::string& name, const TriMesh& mesh) {
    write_ply(mesh, folder_.path() / name);
    return folder_.path() / name;
  }
  fs::path points(const std::string& rows) {
    return folder_.write("points.csv", "name,x_mm,y_mm,z_mm\n" + rows);
  }
  std::string refusal(const ImportRequest& request) {
    try {
      import_meshes(request);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "was imported";
    return "";
  }
  void expect_words(const std::string& message, const std::vector<const char*>& words) {
    for (const char* word : words)
      EXPECT_NE(message.find(word), std::string::npos) << message << "\n  lacks " << word;
  }
  TempFolder folder_;
};

TEST_F(Import, FreePartsAreCarriedByTheNearerBoneUnlessAssigned) {
  ImportRequest request;
  const auto at = [&](const std::string& name, const Vector3d& center) {
    return mesh(name, test::cuboid(center - Vector3d(4, 4, 4), center + Vector3d(4, 4, 4)));
  };
  request.files = {{Role::mandible, mesh("jaw.ply", blocks_jaw())},
                   {Role::maxilla, at("maxilla.ply", {0, -45, 60})},
                   {Role::segment, at("chin.ply", {0, -45, 0})},
                   {Role::segment, at("upper.ply", {0, -45, 70})},
                   {Role::transplant, at("fibula.ply", {30, -40, 33})}};
  request.name = "free";
  const Case patient = import_meshes(request);
  ASSERT_EQ(patient.parts.size(), 5u);
  const auto carrier = [](const Case& of, const std::string& name) {
    for (const auto& part : of.parts)
      if (part.name == name) return of.bodies[of.bodies[part.body].parent].name;
    return std::string("absent");
  };
  EXPECT_EQ(carrier(patient, "segment"), "mandible");
  EXPECT_EQ(carrier(patient, "segment-2"), "cranium");
  EXPECT_EQ(carrier(patient, "transplant"), "mandible");
  EXPECT_TRUE(has_note(patient, "segment-2: lies 2.0 mm from the cranium"));
  ImportRequest deep = request;
  deep.files[3] = {Role::segment, mesh("inner.ply", test::cuboid({-2, -47, 58}, {2, -43, 62}))};
  EXPECT_TRUE(has_note(import_meshes(deep), "segment-2: lies 2.0 mm deep inside the cranium"));
  request.parents = {{"segment-2", "mandible"}};
  EXPECT_EQ(carrier(import_meshes(request), "segment-2"), "mandible");
  request.parents = {{"segment-9", "mandible"}};
  expect_words(refusal(request), {"segment-9=mandible", "segment, segment-2, transplant"});
  request.parents = {{"segment", "transplant"}, {"transplant", "segment-2"}};
  const Case chain = import_meshes(request);
  EXPECT_EQ(carrier(chain, "segment"), "transplant");
  EXPECT_EQ(carrier(chain, "transplant"), "segment-2");
  EXPECT_TRUE(
      chain.bodies.is_within(*chain.bodies.find("segment"), *chain.bodies.find("segment-2")));
  request.parents = {{"segment", "transplant"}, {"transplant", "segment"}};
  expect_words(refusal(request), {"segment=transplant", "parents of each other"});
  request.parents = {{"segment", "tibia"}};
  expect_words(refusal(request), {"segment=tibia", "\"tibia\" is no body"});
}

TEST_F(Import, EveryUnitAndFrameImportsTheSamePatient) {
  const TriMesh jaw = blocks_jaw();
  int count = 0;
  for (const auto& frame : all_frames()) {
    const std::string units = all_units()[static_cast<std::size_t>(count++) % 4];
    SCOPED_TRACE(units + " " + frame);
    const Eigen::Matrix3d back = source_frame(units, frame).to_lps_mm().inverse();
    const auto row = [&](const char* name, const Vector3d& p) {
      const Vector3d q = back * p;
      return fmt::format("{},{},{},{}\n", name, q.x(), q.y(), q.z());
    };
    const Case patient = import_meshes(
        {{{Role::mandible, mesh("jaw.ply", as_file(jaw, units, frame))}},
         points(row("ltmj", {45, 29, 76}) + row("rtmj", {-45, 29, 76}) + row("L1", {0, -50, 40})),
         source_frame(units, frame),
         "x"});
    const TriMesh& found = patient.parts[0].mesh;
    ASSERT_EQ(found.vertices.size(), jaw.vertices.size());
    for (std::size_t i = 0; i < jaw.vertices.size(); ++i)
      ASSERT_LT((found.vertices[i] - jaw.vertices[i]).norm(), 1e-12 * 100);
    // Outward before and after a mirrored frame, without any repair.
    EXPECT_EQ(found.triangles.size(), jaw.triangles.size());
    EXPECT_TRUE(inspect(found).closed());
    EXPECT_NEAR(signed_volume(found), signed_volume(jaw), 1e-6);
    EXPECT_FALSE(has_note(patient, "turned"));
    EXPECT_LT((*patient.landmarks.find("left_condyle") - Vector3d(45, 29, 76)).norm(), 1e-10);
    EXPECT_EQ(patient.source.axes, frame);
    EXPECT_EQ(patient.source.units, units);
  }
  EXPECT_EQ(count, 48);
}

TEST_F(Import, AWrongUnitIsReportedWithTheRightOne) {
  const TriMesh jaw = blocks_jaw();  // 100 mm
  for (const auto& [real, declared] :
       {std::pair("m", "mm"), std::pair("mm", "m"), std::pair("mm", "cm"), std::pair("cm", "m"),
        std::pair("mm", "in")}) {
    const std::string message =
        refusal({{{Role::mandible, mesh("jaw.ply", as_file(jaw, real, "LPS"))}},
                 {},
                 source_frame(declared, "LPS"),
                 "x"});
    expect_words(message, {"jaw.ply", "a head is 100 to 300 mm", "did you mean --units"});
    EXPECT_NE(message.find(fmt::format("--units {}?", real)), std::string::npos) << message;
  }
  TriMesh small = test::sphere(1, 0.1), huge = test::sphere(1, 100'000);
  expect_words(refusal({{{Role::skull, mesh("s.ply", small)}}, {}, source_frame("mm", "LPS"), "x"}),
               {"0.2 mm wide", "--units m?"});
  expect_words(refusal({{{Role::skull, mesh("h.ply", huge)}}, {}, source_frame("m", "LPS"), "x"}),
               {"200000 m wide"});
  huge = test::sphere(1, 100);
  expect_words(refusal({{{Role::skull, mesh("h.ply", huge)}}, {}, source_frame("m", "LPS"), "x"}),
               {"200 m wide", "--units mm?"});
}

TEST_F(Import, AWrongFrameIsReportedWithOneThatFits) {
  const TriMesh jaw = blocks_jaw();
  const std::string marks = "ltmj,45,29,76\nrtmj,-45,29,76\nL1,0,-50,40\n";
  // By landmarks.
  expect_words(refusal({{{Role::mandible, mesh("jaw.ply", jaw)}},
                        points(marks),
                        source_frame("mm", "RAS"),
                        "x"}),
               {"--frame RAS", "to the right of", "did you mean --frame LPS?"});
  expect_words(refusal({{{Role::mandible, mesh("jaw.ply", jaw)}},
                        points("rtmj,-45,29,76\nL1,0,-50,40\n"),
                        source_frame("mm", "RAS"),
                        "x"}),
               {"in front of the incisal point", "--frame LPS?"});
  expect_words(refusal({{{Role::mandible, mesh("jaw.ply", jaw)}},
                        points(marks),
                        source_frame("mm", "LPI"),
                        "x"}),
               {"below the incisal point"});
  // By the mandible's shape alone: back to front, upside down, y up.
  for (const char* frame : {"RAS", "LPI", "LSA", "LAS"})
    expect_words(
        refusal({{{Role::mandible, mesh("jaw.ply", jaw)}}, {}, source_frame("mm", frame), "x"}),
        {frame, "rami", "did you mean --frame LPS?"});
  const auto refused = [](const char* units, const char* axes) {
    try {
      source_frame(units, axes);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  expect_words(refused("mm", "XYZ"), {"--frame \"XYZ\"", "LPS, RAS"});
  expect_words(refused("km", "LPS"), {"--units \"km\"", "mm, cm, m and in"});
}

TEST_F(Import, MissingPointsAreEstimatedAndReported) {
  const Case patient =
      import_meshes({{{Role::mandible, mesh("jaw.ply", blocks_jaw())},
                      {Role::maxilla, mesh("max.ply", test::cuboid({-20, -52, 42}, {20, 0, 60}))}},
                     {},
                     source_frame("mm", "LPS"),
                     "x"});
  EXPECT_LT((*patient.landmarks.find("left_condyle") - Vector3d(45, 29, 75)).norm(), 6);
  EXPECT_LT((*patient.landmarks.find("right_condyle") - Vector3d(-45, 29, 75)).norm(), 6);
  for (const char* name :
       {"left_condyle", "right_condyle", "lower_incisal_point", "upper_incisal_point"})
    EXPECT_TRUE(has_note(patient, std::string(name) + " is missing: estimated at")) << name;
}

TEST_F(Import, LandmarksOffThePatientAreRefusedAndMillimetresRecognised) {
  const auto jaw = mesh("jaw.ply", blocks_jaw());
  expect_words(refusal({{{Role::mandible, jaw}},
                        points("sto,0,-60,50\nfar,0,-300,50\n"),
                        source_frame("mm", "LPS"),
                        "x"}),
               {"points.csv", "line 3", "\"far\"", "units, frame"});
  // Meshes in metres beside a table whose columns say mm.
  const Case patient =
      import_meshes({{{Role::mandible, mesh("m.ply", as_file(blocks_jaw(), "m", "RAS"))}},
                     points("ltmj,-45,-29,76\nrtmj,45,-29,76\nL1,0,50,40\n"),
                     source_frame("m", "RAS"),
                     "x"});
  EXPECT_LT((*patient.landmarks.find("left_condyle") - Vector3d(45, 29, 76)).norm(), 1e-9);
  EXPECT_TRUE(has_note(patient, "taken in mm"));
  // Slicer's points define their own frame.
  const auto slicer =
      folder_.write("p.mrk.json", R"({"markups":[{"coordinateSystem":"RAS","controlPoints":[
    {"label":"ltmj","position":[-45,-29,76]},{"label":"rtmj","position":[45,-29,76]},{"label":"L1","position":[0,50,40]}]}]})");
  const Case other =
      import_meshes({{{Role::mandible, mesh("m.ply", as_file(blocks_jaw(), "m", "LSA"))}},
                     slicer,
                     source_frame("m", "LSA"),
                     "x"});
  EXPECT_LT((*other.landmarks.find("left_condyle") - Vector3d(45, 29, 76)).norm(), 1e-9);
}

TEST_F(Import, TeethFilesBecomeOnePartAndBonesPartsOfTheirOwn) {
  const auto bone = mesh("b.ply", test::sphere(2, 60));
  ImportRequest request;
  request.files = {{Role::skull, bone}, {Role::skull, bone}, {Role::skull, bone}};
  const std::size_t count = test::sphere(1, 4).triangles.size();
  for (const char* name : {"tooth_36.ply", "37.ply", "Crown-FDI46.ply"})
    request.files.push_back(
        {Role::lower_teeth,
         mesh(name, test::sphere(1, 4, {static_cast<double>(request.files.size()) * 10, 0, 0}))});
  const Case patient = import_meshes(request);
  ASSERT_EQ(patient.parts.size(), 4u);
  EXPECT_EQ(patient.parts[1].name, "skull-2");
  EXPECT_EQ(patient.parts[2].name, "skull-3");
  const Part& teeth = patient.parts[3];
  EXPECT_EQ(teeth.name, "lower-teeth");
  ASSERT_EQ(teeth.teeth.size(), 3u);
  EXPECT_EQ(teeth.teeth[0].fdi, 36);
  EXPECT_EQ(teeth.teeth[2].fdi, 46);
  EXPECT_EQ(teeth.teeth[2].first_triangle, static_cast<int>(2 * count));
  EXPECT_EQ(teeth.teeth[2].triangle_count, static_cast<int>(count));
  EXPECT_TRUE(has_note(patient, "lower-teeth (3 files): 240 triangles in 3 pieces, closed"));

  ImportRequest bad = request;
  bad.files.push_back({Role::lower_teeth, mesh("t_11.ply", test::sphere(1, 4))});
  expect_words(refusal(bad), {"t_11.ply", "tooth 11", "--upper-teeth"});
  bad.files.back() = {Role::lower_teeth, mesh("x36.ply", test::sphere(1, 4))};
  expect_words(refusal(bad), {"x36.ply", "tooth 36", "another file"});
  bad.files.back() = {Role::face, bone};
  bad.files.push_back({Role::face, bone});
  expect_words(refusal(bad), {"second face"});
  expect_words(refusal({{{Role::face, bone}}, {}, source_frame("mm", "LPS"), "x"}),
               {"no bone", "--skull, --maxilla or --mandible"});
  expect_words(
      refusal({{{Role::skull, folder_.path() / "no.stl"}}, {}, source_frame("mm", "LPS"), "x"}),
      {"no.stl", "no such file"});
}

TEST_F(Import, FlawsAreRepairedWherePossibleAndReported) {
  TriMesh flawed = test::unwelded(test::sphere(2, 60));
  flip(flawed);
  flawed.triangles.push_back(flawed.triangles[7]);
  flawed.triangles.emplace_back(3, 3, 4);
  flawed.vertices.emplace_back(1, 2, 3);
  const Case patient = import_meshes(
      {{{Role::skull, mesh("flawed.ply", flawed)}}, {}, source_frame("mm", "LPS"), "x"});
  const TriMesh& found = patient.parts[0].mesh;
  EXPECT_TRUE(inspect(found).closed());
  EXPECT_NEAR(signed_volume(found), signed_volume(test::sphere(2, 60)), 1e-6);
  EXPECT_EQ(found.vertices.size(), test::sphere(2, 60).vertices.size());
  for (const char* words : {"vertices welded", "1 triangle without area dropped",
                            "1 repeated triangle dropped", "320 triangles turned"})
    EXPECT_TRUE(has_note(patient, words)) << words;

  TriMesh open = test::sphere(2, 60);
  std::erase_if(open.triangles, [&](const auto& t) { return open.vertices[t[0]].z() > 50; });
  const Case holed =
      import_meshes({{{Role::skull, mesh("open.ply", open)}}, {}, source_frame("mm", "LPS"), "x"});
  const Topology topology = inspect(holed.parts[0].mesh);
  ASSERT_EQ(topology.boundary.size(), 1u);
  EXPECT_TRUE(
      has_note(holed, fmt::format("open: {} boundary edges in 1 rim", topology.boundary_edges)));
  const Vector3d rim = topology.boundary[0].box.center();
  EXPECT_GT(rim.z(), 40);
  EXPECT_TRUE(has_note(holed, fmt::format("{:.0f})", rim.z())));
  EXPECT_TRUE(has_note(holed, "are uncertain"));
}

class RealImport : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(data_)) GTEST_SKIP() << "real anatomy absent";
  }
  fs::path data_ = test::source_folder() / "../shared/data";
};

TEST_F(RealImport, CaseUbcWithTeethAsOneFileAndAsSixteen) {
  const fs::path ubc = data_ / "case-ubc";
  ImportRequest request{{{Role::maxilla, ubc / "maxilla_with_teeth_wrap_30k.ply"},
                         {Role::mandible, ubc / "mandible_8k.ply"},
                         {Role::upper_teeth, ubc / "upper_teeth.ply"},
                         {Role::lower_teeth, ubc / "lower_teeth.ply"}},
                        ubc / "markers.csv",
                        source_frame("mm", "LPS"),
                        "ubc"};
  const Case one = import_meshes(request);
  ASSERT_EQ(one.parts.size(), 4u);
  EXPECT_EQ(*one.landmarks.find("left_condyle"), Vector3d(51.7785, 31.4501, 79.6370));
  EXPECT_EQ(*one.landmarks.find("lower_incisal_point"), Vector3d(0, -46.9584, 41.7642));
  EXPECT_EQ(*one.landmarks.find("upper_incisal_point"), Vector3d(0, -48.3688, 43.4493));
  EXPECT_TRUE(has_note(
      one,
      "maxilla (maxilla_with_teeth_wrap_30k.ply): 29998 triangles in 1 piece, closed, 15.6 cm3"));
  EXPECT_TRUE(has_note(
      one, "lower-teeth (lower_teeth.ply): 16070 triangles in 16 pieces, closed, 5.1 cm3"));

  request.files.resize(2);
  for (const auto& [role, name] :
       {std::pair(Role::upper_teeth, "upper_teeth"), std::pair(Role::lower_teeth, "lower_teeth")}) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(ubc / name)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) request.files.push_back({role, file});
  }
  const Case many = import_meshes(request);
  ASSERT_EQ(many.parts.size(), 4u);
  for (const std::size_t part : {2u, 3u}) {
    EXPECT_EQ(many.parts[part].teeth.size(), 16u);
    EXPECT_EQ(mesh_hash(many.parts[part].mesh), mesh_hash(one.parts[part].mesh));
    EXPECT_EQ(
        std::accumulate(many.parts[part].teeth.begin(), many.parts[part].teeth.end(), 0,
                        [](int sum, const Tooth& tooth) { return sum + tooth.triangle_count; }),
        static_cast<int>(many.parts[part].mesh.triangles.size()));
  }
}

TEST_F(RealImport, CaseBadinAndEstimatesNearItsMarkers) {
  const fs::path badin = data_ / "case-badin";
  ImportRequest request{{{Role::maxilla, badin / "maxilla_capped.ply"},
                         {Role::mandible, badin / "mandible.ply"},
                         {Role::face, badin / "face_skin.ply"}},
                        badin / "markers.csv",
                        source_frame("mm", "LPS"),
                        "badin"};
  const Case given = import_meshes(request);
  EXPECT_EQ(*given.landmarks.find("left_condyle"), Vector3d(48.8226, 134.6582, 133.2749));
  EXPECT_TRUE(given.landmarks.find("lcondyle_geom"));
  EXPECT_TRUE(has_note(
      given,
      "face (face_skin.ply): 4122 triangles in 1 piece; open: 246 boundary edges in 6 rims"));
  request.landmarks.clear();
  const Case guessed = import_meshes(request);
  for (const char* name :
       {"left_condyle", "right_condyle", "lower_incisal_point", "upper_incisal_point"})
    EXPECT_LT((*guessed.landmarks.find(name) - *given.landmarks.find(name)).norm(), 8) << name;
  EXPECT_TRUE(guessed.landmarks.find("stomion"));
}

TEST_F(RealImport, AnotherPatientsLandmarksAreRefused) {
  const auto import_with = [&](const char* marks) {
    return import_meshes({.files = {{Role::mandible, data_ / "case-ubc/mandible_8k.ply"}},
                          .landmarks = data_ / marks / "markers.csv",
                          .name = "mixed"});
  };
  EXPECT_NO_THROW(import_with("case-ubc"));
  EXPECT_THROW(import_with("case-badin"), InputError);
}

TEST_F(RealImport, OpenAndForeignSurfacesAreNotedCorrectly) {
  // One of its 119,831 triangles has no area, two small holes are closed, ten rims stay.
  const Case skull = import_meshes(
      {{{Role::skull, data_ / "ct-cranium/skull_iso300.ply"}}, {}, source_frame("mm", "LPS"), "x"});
  EXPECT_TRUE(has_note(skull,
                       "skull (skull_iso300.ply): 119836 triangles in 1 piece; open: 492 boundary "
                       "edges in 10 rims"));
  EXPECT_TRUE(has_note(skull, "2 small holes closed"));
  const Case maxilla = import_meshes(
      {{{Role::maxilla, data_ / "case-ubc/maxilla.ply"}}, {}, source_frame("mm", "LPS"), "x"});
  EXPECT_TRUE(has_note(maxilla, "in 3 pieces; open: 2186 boundary edges in 10 rims"));
  EXPECT_TRUE(has_note(maxilla, "14 edges of three or more triangles"));
  const fs::path head = data_ / "scan-leeperrysmith";
  const Case ply = import_meshes(
      {{{Role::skull, head / "head_lps_mm.ply"}}, {}, source_frame("mm", "LPS"), "x"});
  const Case obj = import_meshes(
      {{{Role::skull, head / "head_lps_mm.obj"}}, {}, source_frame("mm", "LPS"), "x"});
  const Case glb = import_meshes(
      {{{Role::skull, head / "LeePerrySmith.glb"}}, {}, source_frame("m", "LSA"), "x"});
  for (const auto* patient : {&ply, &obj, &glb})
    EXPECT_TRUE(has_note(*patient, "17672 triangles in 1 piece, closed"));
  EXPECT_LT((bounding_box(glb.parts[0].mesh).high - bounding_box(ply.parts[0].mesh).high).norm(),
            0.01);
  // As a face it has its own colours, on the same surface in smaller triangles.
  const Case scan = import_meshes(
      {{{Role::face, head / "head_lps_mm.obj"}, {Role::skull, head / "head_lps_mm.ply"}},
       {},
       source_frame("mm", "LPS"),
       "x"});
  EXPECT_TRUE(has_note(scan, "coloured by the texture of head_lps_mm.obj (1024x1024)"));
  const TriMesh& face = scan.find(Role::face)->mesh;
  EXPECT_EQ(face.colors.size(), face.vertices.size());
  EXPECT_GT(face.triangles.size(), 50000u);
  EXPECT_NEAR(surface_area(face), surface_area(ply.parts[0].mesh), 1e-3 * surface_area(face));
}

}  // namespace
}  // namespace condyle
