#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "tests/engine/mesh_io/samples.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

std::string refusal(const ImportRequest& request) {
  try {
    import_meshes(request);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_refused_with(const std::string& message, const std::vector<std::string>& words) {
  for (const auto& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << message << "\n  lacks " << word;
}

/// Upper and lower teeth as blocks between a maxilla and a mandible.
class JawOrder : public testing::Test {
 protected:
  JawOrder() {
    // A chin in front, two rami behind and above it.
    TriMesh jaw = test::cuboid({-40, -50, 5}, {40, -10, 30});
    for (const double x : {-50.0, 40.0})
      jaw = test::joined(jaw, test::cuboid({x, 10, 5}, {x + 10, 38, 80}));
    mandible_ = write("jaw.ply", jaw);
    maxilla_ = write("top.ply", test::cuboid({-40, -55, 50}, {40, 20, 90}));
    upper_ = write("up.ply", test::cuboid({-30, -50, 42}, {30, 0, 50}));
    lower_ = write("low.ply", test::cuboid({-30, -50, 32}, {30, 0, 41}));
  }
  fs::path write(const std::string& name, const TriMesh& mesh) {
    write_ply(mesh, folder_.path() / name);
    return folder_.path() / name;
  }
  ImportRequest request(const fs::path& maxilla, const fs::path& mandible, const fs::path& upper,
                        const fs::path& lower) const {
    ImportRequest made;
    made.files = {{Role::maxilla, maxilla},
                  {Role::mandible, mandible},
                  {Role::upper_teeth, upper},
                  {Role::lower_teeth, lower}};
    made.name = "order";
    return made;
  }
  test::TempFolder folder_;
  fs::path mandible_, maxilla_, upper_, lower_;
};

TEST_F(JawOrder, IsTakenAsItIsWhereItIsRight) {
  EXPECT_EQ(refusal(request(maxilla_, mandible_, upper_, lower_)), "");
}

TEST_F(JawOrder, ExchangedJawsAreRefusedWithWhatToWrite) {
  expect_refused_with(refusal(request(mandible_, maxilla_, upper_, lower_)),
                      {"top.ply", "exchanged", "--maxilla " + maxilla_.string(),
                       "--mandible " + mandible_.string()});
  expect_refused_with(refusal(request(mandible_, maxilla_, lower_, upper_)),
                      {"--maxilla", "exchanged"});
}

TEST_F(JawOrder, ExchangedTeethAreRefusedWithWhatToWrite) {
  expect_refused_with(refusal(request(maxilla_, mandible_, lower_, upper_)),
                      {"up.ply", "exchanged", "--upper-teeth " + upper_.string(),
                       "--lower-teeth " + lower_.string()});
}

TEST_F(JawOrder, TeethOfOneHeightAreDoubted) {
  const auto beside = write("beside.ply", test::cuboid({-30, -50, 42}, {30, 0, 49}));
  const Case patient = import_meshes(request(maxilla_, mandible_, upper_, beside));
  EXPECT_TRUE(std::any_of(patient.notes.begin(), patient.notes.end(), [](const auto& note) {
    return note.find("beside.ply are not exchanged") != std::string::npos;
  }));
}

TEST_F(JawOrder, ALowerIncisorFarAboveTheUpperOneIsRefused) {
  ImportRequest given = request(maxilla_, mandible_, upper_, lower_);
  given.landmarks = folder_.write("points.csv",
                                  "name,x_mm,y_mm,z_mm\nupper_incisal_point,0,-50,20\n"
                                  "lower_incisal_point,0,-50,41\n");
  expect_refused_with(refusal(given), {"lower_incisal_point", "21 mm above", "exchange"});
}

TEST(RealJawOrder, CaseUbcWithExchangedJawsOrTeethIsRefused) {
  const auto folder = test::real_data() / "case-ubc";
  if (!fs::exists(folder)) GTEST_SKIP() << "real anatomy absent";
  const auto maxilla = folder / "maxilla_with_teeth_wrap_30k.ply",
             mandible = folder / "mandible_8k.ply", upper = folder / "upper_teeth.ply",
             lower = folder / "lower_teeth.ply";
  for (const bool marked : {true, false}) {
    ImportRequest request;
    request.name = "mixed";
    if (marked) request.landmarks = folder / "markers.csv";
    request.files = {{Role::maxilla, mandible},
                     {Role::mandible, maxilla},
                     {Role::upper_teeth, lower},
                     {Role::lower_teeth, upper}};
    expect_refused_with(refusal(request), {"exchanged", "--mandible " + mandible.string()});
    request.files = {{Role::maxilla, maxilla},
                     {Role::mandible, mandible},
                     {Role::upper_teeth, lower},
                     {Role::lower_teeth, upper}};
    expect_refused_with(refusal(request), {"exchanged", "--lower-teeth " + lower.string()});
  }
}

}  // namespace
}  // namespace condyle
