// Muscles of the face in the built-in patient's tissue.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "engine/mesh/triangle_tree.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/expression.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct MuscledFace {
  Case patient;
  std::shared_ptr<const TissueModel> model;
  std::vector<FaceMuscle> muscles;

  explicit MuscledFace(bool with_muscles = true, Case of = test::builtin())
      : patient(std::move(of)) {
    part_lips(patient);
    TissueSettings settings;
    if (with_muscles) settings.face_muscles = muscles_of_face(patient);
    muscles = settings.face_muscles;
    model = build_tissue(patient, settings);
  }
  Vector3d moved(const TissueState& state, const char* landmark) const {
    const Vector3d at = *patient.landmarks.find(landmark);
    return carried_point(*model, state, at) - carried_point(*model, rest_tissue(*model), at);
  }
};

const MuscledFace& muscled_face() {
  static const MuscledFace face;
  return face;
}

/// The end of an expression in steps of 10 ms; the jaw moves down meanwhile.
TissueState state_of(const MuscledFace& face, const std::string& spec, int threads = 2,
                     double jaw_down_mm = 0) {
  const Expression expression = make_expression(spec, face.muscles);
  TissueState state = rest_tissue(*face.model);
  TissueWarmStart warm;
  TissueBudget budget;
  budget.threads = threads;
  for (int i = 1; i <= 60; ++i) {
    std::vector<Pose> poses;
    if (jaw_down_mm > 0)
      poses = {{}, {.R = Eigen::Quaterniond::Identity(), .t = {0, 0, -jaw_down_mm * i / 60}}};
    state = solve_tissue(*face.model, state, poses, budget, warm, expression.at(0.01 * i).muscles);
    EXPECT_EQ(state.inverted_prisms, 0) << spec << " at " << i;
    EXPECT_FALSE(state.reused) << spec << " at " << i;
  }
  return state;
}

TEST(FaceMuscles, WithoutExcitationChangeNothingBitForBit) {
  const MuscledFace& with = muscled_face();
  const MuscledFace without(false);
  ASSERT_GT(with.muscles.size(), 10u);
  const std::vector<double> none(with.muscles.size(), 0.0);
  const auto poses = test::jaw_at(Pose{.R = Eigen::Quaterniond::Identity(), .t = {0, -1, -3}});
  TissueWarmStart warm, warm_without;
  const TissueState a = solve_tissue(*with.model, rest_tissue(*with.model), poses, {}, warm, none);
  const TissueState b =
      solve_tissue(*without.model, rest_tissue(*without.model), poses, {}, warm_without);
  EXPECT_GT((a.nodes[0] - rest_tissue(*with.model).nodes[0]).norm() + a.iterations, 0);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.iterations, b.iterations);
}

// Source of the ranges: measured and simulated smiles, see expression_findings.cpp.
void expect_smile(const MuscledFace& face, const TissueState& smile) {
  EXPECT_LT(smile.penetration_mm, 0.2);
  for (const auto& [mark, sign] :
       {std::pair("left_cheilion", 1), std::pair("right_cheilion", -1)}) {
    const Vector3d moved = face.moved(smile, mark);
    EXPECT_GT(moved.norm(), 9) << mark;
    EXPECT_LT(moved.norm(), 14) << mark;
    const double angle = std::atan2(moved.z(), sign * moved.x()) * 180 / 3.14159265;
    EXPECT_GT(angle, 35) << mark;
    EXPECT_LT(angle, 60) << mark;
    EXPECT_GT(moved.y(), 0) << mark << ": back along the teeth";
  }
  const double wider =
      (face.moved(smile, "left_cheilion") - face.moved(smile, "right_cheilion")).x() /
      (*face.patient.landmarks.find("left_cheilion") -
       *face.patient.landmarks.find("right_cheilion"))
          .norm();
  EXPECT_GT(wider, 0.2);
  EXPECT_LT(wider, 0.35);
  const auto length = face_muscle_lengths(*face.model, smile),
             rest = face_muscle_lengths(*face.model, rest_tissue(*face.model));
  int zygomatic = 0;
  for (std::size_t m = 0; m < length.size(); ++m)
    if (face.muscles[m].kind == "zygomaticus_major") {
      ++zygomatic;
      EXPECT_GT(length[m] / rest[m], 0.82);
      EXPECT_LT(length[m] / rest[m], 0.89);
    }
  EXPECT_EQ(zygomatic, 2);
}

TEST(FaceMuscles, ASmileIsThatOfHealthyPeople) {
  expect_smile(muscled_face(), state_of(muscled_face(), "smile"));
}

TEST(FaceMuscles, ASmileRaisesTheCheeks) {
  const MuscledFace& face = muscled_face();
  const TissueState smile = state_of(face, "smile");
  for (const char* side : {"left", "right"}) {
    const Vector3d at = *face.patient.landmarks.find(std::string(side) + "_orbitale") +
                        Vector3d(0, -6, -12);  // the skin before it
    const double up = (carried_point(*face.model, smile, at) -
                       carried_point(*face.model, rest_tissue(*face.model), at))
                          .z();
    EXPECT_GT(up, 1) << side;
    EXPECT_LT(up, 5) << side;
  }
}

TEST(FaceMuscles, AKissNarrowsTheMouthAndBringsTheLipsForward) {
  const MuscledFace& face = muscled_face();
  const TissueState kiss = state_of(face, "kiss");
  EXPECT_TRUE(kiss.converged);
  EXPECT_LT(kiss.penetration_mm, 0.2);
  EXPECT_LT(face.moved(kiss, "left_cheilion").x(), -2);
  EXPECT_GT(face.moved(kiss, "right_cheilion").x(), 2);
  EXPECT_LT(face.moved(kiss, "labrale_superius").y(), -1.5);
  EXPECT_LT(face.moved(kiss, "labrale_inferius").y(), -1.5);
}

/// Height of the lower lip's edge above its place at rest, in the middle.
double lower_lip_up(const MuscledFace& face, const TissueState& state) {
  constexpr double below_lip_line_mm = 1.5;
  const Vector3d at = *face.patient.landmarks.find("stomion") - Vector3d(0, 0, below_lip_line_mm);
  return (carried_point(*face.model, state, at) -
          carried_point(*face.model, rest_tissue(*face.model), at))
      .z();
}

/// Distances between the upper and the lower lip of the displayed face at 0, 5 and 10 mm from the
/// middle, on both sides. `jaw_down`: relaxed, with the jaw a little open; then the lower lip is
/// what goes with the jaw.
std::vector<double> lip_distances(const MuscledFace& face, const TissueState& jaw_down,
                                  const TissueState& state) {
  const TriMesh& rest = face.patient.find(Role::face)->mesh;
  const Vector3d stomion = *face.patient.landmarks.find("stomion");
  std::vector<Eigen::Vector3f> lowered, now;
  deform_face(*face.model, jaw_down, lowered);
  deform_face(*face.model, state, now);
  TriMesh lower, upper;
  for (const auto& p : now) lower.vertices.push_back(p.cast<double>());
  upper.vertices = lower.vertices;
  for (const Eigen::Vector3i& t : rest.triangles) {
    double down = 0;
    Vector3d centre = Vector3d::Zero();
    for (const int v : t) {
      centre += rest.vertices[static_cast<std::size_t>(v)] / 3;
      down += (rest.vertices[static_cast<std::size_t>(v)].z() -
               lowered[static_cast<std::size_t>(v)].z()) /
              3;
    }
    if ((centre - stomion).norm() < 25) (down > 1.25 ? lower : upper).triangles.push_back(t);
  }
  const TriangleTree tree(lower);
  std::vector<double> distances;
  for (const double aside : {0.0, 5.0, -5.0, 10.0, -10.0}) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3i& t : upper.triangles) {
      const Vector3d& at_rest = rest.vertices[static_cast<std::size_t>(t[0])];
      if (std::abs(at_rest.x() - stomion.x() - aside) > 2 || (at_rest - stomion).norm() > 15)
        continue;
      Vector3d centre = Vector3d::Zero();
      for (const int v : t) centre += upper.vertices[static_cast<std::size_t>(v)] / 3;
      nearest = std::min(nearest, tree.nearest(centre).distance);
    }
    distances.push_back(nearest);
  }
  return distances;
}

TEST(FaceMuscles, LipsShutOverAJawThatIsALittleOpenMeetAlongTheMouth) {
  const MuscledFace& face = muscled_face();
  const TissueState open = state_of(face, "smile:0", 2, 2.5);
  for (const double apart : lip_distances(face, open, open)) EXPECT_GT(apart, 2);
  for (const double apart : lip_distances(face, open, state_of(face, "lips-shut", 2, 2.5)))
    EXPECT_LT(apart, 0.2);
}

/// With the jaw a little open, as at rest and in speech.
void expect_lip_closure(const MuscledFace& face, double jaw_down_mm) {
  const double relaxed = lower_lip_up(face, state_of(face, "smile:0", 2, jaw_down_mm));
  EXPECT_LT(relaxed, -0.6 * jaw_down_mm) << "the lip goes with the jaw";
  for (const char* name : {"lips-shut", "f"}) {
    SCOPED_TRACE(name);
    const TissueState state = state_of(face, name, 2, jaw_down_mm);
    EXPECT_LT(state.penetration_mm, 0.2);
    const double up = lower_lip_up(face, state);
    EXPECT_GT(up, relaxed + 0.5);
    EXPECT_LT(up, 3);
    if (name == std::string("f"))
      EXPECT_GT(face.moved(state, "labrale_superius").z(), 1) << "shows the incisors' edges";
    else
      EXPECT_LT(face.moved(state, "labrale_superius").z(), 0) << "meets the lower lip";
  }
}

TEST(FaceMuscles, LipsCloseAndTheLowerLipRisesToTheUpperTeeth) {
  expect_lip_closure(muscled_face(), 2.5);
}

const MuscledFace& measured_face() {
  static const MuscledFace face(true, test::case_badin(test::Faced::yes).value());
  return face;
}

TEST(FaceMuscles, AMeasuredPatientClosesHisLipsWithHisOwn) {
  if (!std::filesystem::exists(test::real_data() / "case-badin"))
    GTEST_SKIP() << "real anatomy absent";
  expect_lip_closure(measured_face(), 2.5);
}

/// A measured patient's own muscles, with the strengths of the built-in patient's.
TEST(FaceMuscles, AMeasuredPatientSmilesWithHisOwn) {
  if (!std::filesystem::exists(test::real_data() / "case-badin"))
    GTEST_SKIP() << "real anatomy absent";
  const MuscledFace& face = measured_face();
  for (const FaceMuscle& own : face.patient.face_muscles) EXPECT_EQ(own.limit_N, 0) << own.name;
  expect_smile(face, state_of(face, "smile"));
}

TEST(FaceMuscles, OneSideMovesThatCornerOnly) {
  const MuscledFace& face = muscled_face();
  const TissueState left = state_of(face, "smile:1:left");
  EXPECT_GT(face.moved(left, "left_cheilion").norm(), 8);
  EXPECT_LT(face.moved(left, "right_cheilion").norm(), 1.5);
}

TEST(FaceMuscles, SadnessDrawsTheCornersDown) {
  const MuscledFace& face = muscled_face();
  const TissueState sad = state_of(face, "sad");
  EXPECT_LT(face.moved(sad, "left_cheilion").z(), -2);
  EXPECT_LT(face.moved(sad, "right_cheilion").z(), -2);
}

TEST(FaceMuscles, AreBitIdenticalForOneAndTwoThreads) {
  const MuscledFace& face = muscled_face();
  EXPECT_EQ(state_of(face, "smile:0.6", 1).nodes, state_of(face, "smile:0.6", 2).nodes);
}

TEST(FaceMuscles, AreLeftOutWithoutTheirLandmarks) {
  Case patient = test::builtin();
  const auto kinds = [&](const std::string& kind) {
    const auto muscles = muscles_of_face(patient);
    return std::count_if(muscles.begin(), muscles.end(),
                         [&](const FaceMuscle& muscle) { return muscle.kind == kind; });
  };
  EXPECT_EQ(kinds("zygomaticus_minor"), 2);
  patient.landmarks.points.erase("left_malar");
  EXPECT_EQ(missing_face_landmark(patient), "left_malar");
  EXPECT_EQ(kinds("zygomaticus_minor"), 1);
  EXPECT_EQ(kinds("risorius"), 2);
  // Where the patient's own zygomaticus major begins, the landmark is known again.
  const Vector3d origin(52, -69.6, -5.6);
  patient.face_muscles = {
      {.name = "left_zygomaticus_major",
       .kind = "zygomaticus_major",
       .limit_N = 0,
       .shortening = 0,
       .lines = {{{.at = origin, .bone = cranium_body}, {.at = {24.5, -92.1, -50.1}}}}}};
  EXPECT_EQ(missing_face_landmark(patient), "");
  EXPECT_EQ(kinds("zygomaticus_minor"), 2);
  EXPECT_EQ(kinds("zygomaticus_major"), 1) << "own muscles replace default ones of their kind";
  EXPECT_GT(muscles_of_face(patient).front().limit_N, 0) << "that of its kind";
}

}  // namespace
}  // namespace condyle
