#include "sim/dynamics/muscle_motion.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "engine/core/error.h"
#include "sim/muscles/default_muscles.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

class MuscleMotion : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    patient_ = new Case(builtin_patient());
    contacts_ = new ContactModel(*patient_);
  }
  static void TearDownTestSuite() {
    delete contacts_;
    delete patient_;
  }
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("condyle_muscle_motion_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }
  Motion make(const std::string& spec, const MuscleMotionSettings& muscles = {}) const {
    return motion_of(spec, *patient_, *contacts_, {.parameters = {.opening_mm = 35}}, muscles, 2);
  }
  void expect_refused(const std::string& spec, const std::vector<std::string>& words,
                      const MuscleMotionSettings& muscles = {}) const {
    try {
      make(spec, muscles);
      FAIL() << spec;
    } catch (const InputError& error) {
      for (const auto& word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
  static Vector3d incisor() { return *patient_->landmarks.find("lower_incisal_point"); }

  static Case* patient_;
  static ContactModel* contacts_;
  std::filesystem::path folder_;
};
Case* MuscleMotion::patient_ = nullptr;
ContactModel* MuscleMotion::contacts_ = nullptr;

TEST_F(MuscleMotion, MusclesFollowAGivenOpening) {
  const Motion prescribed = make("opening"), found = make("inverse:opening");
  ASSERT_EQ(found.muscle_names.size(), 34u);
  EXPECT_NEAR(found.duration_s, prescribed.duration_s, 1e-3);
  double squares = 0, effort = 0, apart = 0;
  int count = 0;
  for (double t = 0; t <= prescribed.duration_s; t += 0.01, ++count) {
    squares += (found.target(t) * incisor() - prescribed.target(t) * incisor()).squaredNorm();
    const MuscleStates states = found.muscles(t);
    for (std::size_t m = 0; m < states.size(); m += 2) {
      EXPECT_GE(states[m].excitation, 0);
      EXPECT_LE(states[m].excitation, 1);
      effort = std::max(effort, states[m].excitation);
      // A symmetric opening by symmetric muscles.
      apart = std::max(apart, std::abs(states[m].excitation - states[m + 1].excitation));
    }
  }
  EXPECT_LT(std::sqrt(squares / count), 1);
  EXPECT_GT(effort, 0.02);
  EXPECT_LT(apart, 0.05);
  // The same excitations from a file, without feedback, have the same result: an open jaw would
  // magnify the least difference.
  const Motion again = make("muscles:" + write("found.csv", excitations_csv(found)));
  EXPECT_NEAR(again.duration_s, found.duration_s, 1e-9);
  for (double t = 0; t <= again.duration_s; t += 0.01)
    ASSERT_LT((again.target(t) * incisor() - found.target(t) * incisor()).norm(), 1e-6) << t;
}

TEST_F(MuscleMotion, MusclesThatFollowKeepTheNotesOfTheMotion) {
  const Motion prescribed = make("AU45 over 0.2"), found = make("inverse:AU45 over 0.2");
  ASSERT_FALSE(prescribed.notes.empty());
  for (const std::string& note : prescribed.notes)
    EXPECT_EQ(std::count(found.notes.begin(), found.notes.end(), "prescribed motion: " + note), 1)
        << note;
  EXPECT_GT(found.notes.size(), prescribed.notes.size());
}

TEST_F(MuscleMotion, FromAFileOfGroupsItOpensAndCloses) {
  const auto file =
      write("chew.csv", "time_s,open,close\n0,0,0\n0.1,0.15,0\n0.4,0.15,0\n0.5,0,0.1\n1,0,0.05\n");
  const Motion motion = make("muscles:" + file);
  EXPECT_TRUE(motion.recorded);
  EXPECT_EQ(motion.name, "chew");
  EXPECT_NEAR(motion.duration_s, 1, 1e-9);
  EXPECT_GT(incisor().z() - (motion.target(0.45) * incisor()).z(), 8);
  EXPECT_LT((motion.target(1) * incisor() - incisor()).norm(), 1);
  EXPECT_NEAR(motion.muscles(0.3)[16].excitation, 0.15, 0.02);  // an opener
  EXPECT_FALSE(motion.notes.empty());
}

TEST_F(MuscleMotion, AMusclesLengthIsTheDistanceOfItsEndsAlsoAtTheHyoid) {
  const auto file = write("open.csv", "time_s,open,close\n0,0,0\n0.1,0.15,0\n0.4,0.15,0\n");
  const std::string path =
      write("path.csv", "time_s,x_mm,y_mm,z_mm\n0,0,0,0\n0.2,2,5,-9\n1,2,5,-9\n");
  const std::vector<Muscle> muscles = muscles_of(*patient_);
  for (const std::string& hyoid : {path, std::string("free")}) {
    const Motion motion = make("muscles:" + file, {.hyoid = hyoid});
    ASSERT_TRUE(motion.hyoid);
    EXPECT_GT(motion.hyoid(0.4).t.norm(), 0.5) << "it moves";
    int of_the_hyoid = 0;
    for (const double t : {0.0, 0.1, 0.2, 0.4}) {
      const MuscleStates states = motion.muscles(t);
      const auto now = [&](MuscleBody body, const Vector3d& rest) -> Vector3d {
        if (body == MuscleBody::mandible) return motion.target(t) * rest;
        if (body == MuscleBody::hyoid) return motion.hyoid(t) * rest;
        return rest;
      };
      for (std::size_t m = 0; m < muscles.size(); ++m) {
        ASSERT_EQ(motion.muscle_names[m], muscles[m].name);
        of_the_hyoid += muscles[m].moves(MuscleBody::hyoid);
        // Stored muscle states are those at the beginning of their step of a millisecond.
        EXPECT_NEAR((now(muscles[m].origin_body, muscles[m].origin) -
                     now(muscles[m].insertion_body, muscles[m].insertion))
                        .norm(),
                    states[m].length_mm, 0.3)
            << muscles[m].name << " at " << t << " s, hyoid " << hyoid;
      }
    }
    EXPECT_GT(of_the_hyoid, 10);
  }
}

TEST_F(MuscleMotion, BadInputIsRefusedWithItsLocation) {
  expect_refused("muscles:" + (folder_ / "absent.csv").string(), {"absent.csv"});
  expect_refused("muscles:" + write("empty.csv", ""), {"empty.csv", "empty"});
  expect_refused("muscles:" + write("a.csv", "time_s,biceps\n0,1\n"),
                 {"a.csv", "line 1", "biceps"});
  expect_refused("muscles:" + write("b.csv", "time_s,close\n0,0\n5000,0\n"), {"5000", "600"});
  expect_refused("inverse:hopping", {"hopping"});
  const std::string good = "muscles:" + write("c.csv", "time_s,close\n0,0\n0.01,0\n");
  expect_refused(good, {"absent"}, {.hyoid = (folder_ / "absent").string()});
  expect_refused(good, {"h.csv", "line 1", "y_mm"},
                 {.hyoid = write("h.csv", "time_s,x_mm,z_mm\n0,0,0\n")});
  expect_refused(good, {"h.csv", "line 3", "y_mm", "700"},
                 {.hyoid = write("h.csv", "time_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,0,700,0\n")});
  Case nothing = *patient_;
  nothing.landmarks.points.erase("left_condyle");
  EXPECT_THROW(motion_of(good, nothing, *contacts_), InputError);
}

}  // namespace
}  // namespace condyle
