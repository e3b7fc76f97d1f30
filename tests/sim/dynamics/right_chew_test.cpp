// A published model's chew to the right, played as a user plays it: its table of muscles, mechanics
// and knots as they came, and beside the knots a file with the data that they lack.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/dynamics/muscle_motion.h"
#include "sim/motion/recording.h"
#include "sim/muscles/excitations.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// The recorded run had one mylohyoid per side; its closers pull with a tone of 0.001 from the
// start.
constexpr const char* sidecar = R"({"tone": {"close": 0.001}, "without": ["pm"], "until_s": 1})";

NumberTable table(const std::filesystem::path& file) {
  const std::string content = read_file(file);
  TextLines lines(content);
  lines.next();
  std::vector<std::string> names;
  for (const auto field : fields_of(lines.line(), ',')) names.emplace_back(field);
  return read_rows(file, lines, names, ',');
}

class RightChew : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto found = test::case_ubc(test::Driven::by_muscles);
    if (!found) GTEST_SKIP() << "real anatomy absent";
    chewer_ = *found;
    recorded_files_ = test::real_data() / "case-ubc" / "trajectories";
    folder_ = std::filesystem::temp_directory_path() /
              ("condyle_right_chew_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    knots_ = folder_ / "chew.csv";
    std::filesystem::copy_file(recorded_files_ / "rightchew_excitation_knots.csv", knots_);
    std::ofstream(folder_ / "chew.csv.json") << sidecar;
    recorded_ = read_recording(recorded_files_ / "rightchew_jaw_pose.csv");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Of the incisal point over the second.
  struct Chewed {
    double rms_mm = 0, descent_mm = 0, lateral_mm = 0;
  };
  template <class PoseAt>
  Chewed compared(const PoseAt& pose_at) const {
    Chewed out;
    double squares = 0;
    for (int k = 1; k <= 1000; ++k) {
      const double t = k * 0.001;
      const Vector3d here = pose_at(t) * incisor_;
      squares += (here - recorded_.target(t) * incisor_).squaredNorm();
      out.descent_mm = std::max(out.descent_mm, incisor_.z() - here.z());
      out.lateral_mm = std::max(out.lateral_mm, -here.x());
    }
    out.rms_mm = std::sqrt(squares / 1000);
    return out;
  }
  Chewed chew(const std::string& hyoid, bool teeth = true) const {
    MuscleMotionSettings settings;
    settings.law.law = MuscleLaw::peck;
    settings.bolus.side = BolusSettings::Side::right;
    settings.hyoid = hyoid;
    settings.teeth = teeth;
    const Motion motion = muscles_from_file(knots_, chewer_, settings);
    return compared(motion.target);
  }
  std::string recorded_hyoid() const {
    return (recorded_files_ / "rightchew_marker_disp.csv").string();
  }

  Case chewer_;
  std::filesystem::path recorded_files_, folder_, knots_;
  Motion recorded_;
  Vector3d incisor_ = {0, -46.9584, 41.7642};  // of the recording
};

TEST_F(RightChew, ClosersPullAsRecordedWhereTheJawWasRecorded) {
  const NumberTable forces = table(recorded_files_ / "rightchew_muscle_force_N.csv");
  const Excitations excitations =
      read_excitations(recorded_files_ / "rightchew_excitation_from_knots.csv", chewer_.muscles);
  const MuscleLawSettings peck{.law = MuscleLaw::peck};
  int closers = 0;
  for (std::size_t m = 0; m < chewer_.muscles.size(); ++m) {
    const Muscle& muscle = chewer_.muscles[m];
    if (muscle.group != "closer") continue;
    const auto column = static_cast<std::size_t>(
        std::find(forces.names.begin(), forces.names.end(), muscle.name) - forces.names.begin());
    ASSERT_LT(column, forces.names.size()) << muscle.name;
    const auto length = [&](double t) {
      return (recorded_.target(t) * muscle.insertion - muscle.origin).norm();
    };
    double squares = 0, peak = 0, recorded_peak = 0;
    for (std::size_t r = 0; r < forces.rows(); ++r) {
      const double t = forces.at(r, 0), h = 0.001;
      const double speed = (length(t) - length(t - h)) / h;
      const double excitation = excitations.at(t)[m];
      const double force =
          muscle_tension(muscle, peck, excitation, length(t), speed).at(excitation);
      squares += std::pow(force - forces.at(r, column), 2);
      peak = std::max(peak, force);
      recorded_peak = std::max(recorded_peak, forces.at(r, column));
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(forces.rows())), 0.5) << muscle.name;
    EXPECT_NEAR(peak, recorded_peak, 0.02 * recorded_peak + 0.2) << muscle.name;
    ++closers;
  }
  EXPECT_EQ(closers, 12);
}

TEST_F(RightChew, ExcitationsAloneMoveTheJawAlongTheRecordedPath) {
  ASSERT_EQ(chewer_.mechanics->mandible.drag_kg_s, 20);  // as in the file
  const Chewed on_crowns = chew(recorded_hyoid());
  EXPECT_LT(on_crowns.rms_mm, 1.5);
  EXPECT_NEAR(on_crowns.descent_mm, 20.09, 0.15 * 20.09);
  EXPECT_NEAR(on_crowns.lateral_mm, 6.14, 0.15 * 6.14);
  EXPECT_LT(chew(recorded_hyoid(), false).rms_mm, 1.5);
  // A hyoid that stays where it is costs somewhat less than a millimetre, a free one, without the
  // tissue that hangs it, somewhat more.
  const Chewed fixed = chew("fixed");
  EXPECT_LT(fixed.rms_mm, 2);
  EXPECT_NEAR(fixed.descent_mm, 20.09, 0.15 * 20.09);
  EXPECT_NEAR(fixed.lateral_mm, 6.14, 0.15 * 6.14);
  const Chewed free = chew("free");
  EXPECT_LT(free.rms_mm, 3);
  EXPECT_NEAR(free.descent_mm, 20.09, 0.15 * 20.09);
  EXPECT_NEAR(free.lateral_mm, 6.14, 0.25 * 6.14);  // beyond the 15 % of the others
}

// Damping at the bone's frame, not at its centre of mass, makes the difference.
TEST_F(RightChew, DampingActsWhereItsFrameIs) {
  const Excitations excitations = read_excitations(knots_, chewer_.muscles);
  MuscleJawSettings settings{.law = {.law = MuscleLaw::peck},
                             .bolus = {.side = BolusSettings::Side::right},
                             .hyoid = MuscleJawSettings::HyoidMode::fixed,
                             .teeth = false,
                             .without = excitations.without};
  const auto rms = [&] {
    MuscleJaw jaw(chewer_, settings);
    return compared([&](double t) {
             EXPECT_TRUE(jaw.step(excitations.at(t - jaw.step_s())));
             return jaw.pose();
           })
        .rms_mm;
  };
  const double at_frame = rms();
  settings.damped_at = chewer_.mechanics->mandible.center;
  EXPECT_GT(rms(), 1.3 * at_frame);
}

TEST_F(RightChew, AMinuteOfItOnCrownsRepeatsItself) {
  const Excitations excitations = read_excitations(knots_, chewer_.muscles);
  MuscleJaw jaw(chewer_, {.law = {.law = MuscleLaw::peck},
                          .bolus = {.side = BolusSettings::Side::right},
                          .hyoid = MuscleJawSettings::HyoidMode::fixed,
                          .without = excitations.without});
  std::vector<Vector3d> ends;  // of the incisal point, cycle by cycle
  std::vector<double> drops;
  for (int cycle = 0; cycle < 60; ++cycle) {
    drops.push_back(0);
    for (int k = 0; k < 1000; ++k) {
      ASSERT_TRUE(jaw.step(excitations.at(k * 0.001))) << cycle;
      drops.back() = std::max(drops.back(), incisor_.z() - (jaw.pose() * incisor_).z());
    }
    ends.emplace_back(jaw.pose() * incisor_);
  }
  for (std::size_t c = 2; c < ends.size(); ++c) {
    EXPECT_NEAR(drops[c], drops[2], 0.05) << c;
    EXPECT_LT((ends[c] - ends[2]).norm(), 0.05) << c;
  }
  EXPECT_NEAR(drops[2], 20.09, 0.2 * 20.09);
}

}  // namespace
}  // namespace condyle
