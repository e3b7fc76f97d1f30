#include "sim/dynamics/muscle_jaw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/motion/recording.h"
#include "sim/muscles/excitations.h"
#include "sim/phantom/phantom.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

NumberTable table(const std::filesystem::path& file) {
  const std::string content = read_file(file);
  TextLines lines(content);
  lines.next();
  std::vector<std::string> names;
  for (const auto field : fields_of(lines.line(), ',')) names.emplace_back(field);
  return read_rows(file, lines, names, ',');
}

const Case& patient() {
  static const Case made = builtin_patient();
  return made;
}

std::vector<double> excite(const std::vector<Muscle>& muscles,
                           const std::map<std::string, double>& groups) {
  std::vector<double> out;
  for (const Muscle& muscle : muscles) {
    const auto found = groups.find(muscle.group);
    out.push_back(found == groups.end() ? 0.0 : found->second);
  }
  return out;
}

/// The chew to the right of a published model: its excitations, poses, forces and hyoid.
class RightChew : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto found = test::case_ubc(test::Driven::by_muscles);
    if (!found) GTEST_SKIP() << "real anatomy absent";
    chewer_ = *found;
    folder_ = test::real_data() / "case-ubc" / "trajectories";
    excitations_ =
        read_excitations(folder_ / "rightchew_excitation_from_knots.csv", chewer_.muscles);
    read_knots();
    recorded_ = read_recording(folder_ / "rightchew_jaw_pose.csv");
    marks_ = table(folder_ / "rightchew_marker_disp.csv");
  }
  void read_knots() {
    const std::string content = read_file(folder_ / "rightchew_excitation_knots.csv");
    TextLines lines(content);
    lines.next();
    while (lines.next()) {
      const auto fields = fields_of(lines.line(), ',');
      if (fields.size() > 2)
        knots_[std::string(fields[0])].emplace_back(std::stod(std::string(fields[1])),
                                                    std::stod(std::string(fields[2])));
    }
  }
  /// A curve through knots, with no slope at its ends: so the recorded excitations ran (all but 2 %
  /// of them lie within their rounding).
  double knotted(const std::string& name, double t) const {
    const auto found = knots_.find(name);
    if (found == knots_.end()) return 0;
    const auto& k = found->second;
    if (t <= k.front().first) return k.front().second;
    if (t >= k.back().first) return k.back().second;
    std::size_t i = 0;
    while (t > k[i + 1].first) ++i;
    const auto slope = [&](std::size_t j) {
      return j == 0 || j + 1 == k.size()
                 ? 0.0
                 : (k[j + 1].second - k[j - 1].second) / (k[j + 1].first - k[j - 1].first);
    };
    const double h = k[i + 1].first - k[i].first, u = (t - k[i].first) / h, w = 1 - u;
    return std::max(0.0, w * w * (1 + 2 * u) * k[i].second + u * w * w * h * slope(i) +
                             u * u * (1 + 2 * w) * k[i + 1].second - u * u * w * h * slope(i + 1));
  }
  /// As the recorded run had them: one mylohyoid a side, hyoid's muscles by one command, and a tone
  /// of 0.001 in all closers, which their recorded forces show from the start.
  std::vector<double> recorded_excitations(double t) const {
    std::vector<double> out;
    for (const Muscle& muscle : chewer_.muscles) {
      std::string name = muscle.name;
      if (muscle.kind == "am") name = name.substr(0, 1) + "my";
      if (muscle.kind == "pd" || muscle.kind == "sh") name = name.substr(0, 1) + "retracthyoid";
      const bool absent = muscle.kind == "pm" || muscle.kind == "oh" || muscle.kind == "th";
      out.push_back(absent ? 0 : knotted(name, t) + (muscle.group == "closer" ? 0.001 : 0));
    }
    return out;
  }
  Vector3d hyoid_way(double time_s) const {
    constexpr std::size_t hyoid = 10;  // its first column
    if (time_s <= 0) return Vector3d::Zero();
    const auto row =
        std::min(static_cast<std::size_t>(std::lround(time_s / 0.001)) - 1, marks_.rows() - 1);
    return {marks_.at(row, hyoid), marks_.at(row, hyoid + 1), marks_.at(row, hyoid + 2)};
  }
  /// Of the incisal point over the second.
  struct Chewed {
    double rms_mm = 0, drop_mm = 0, lateral_mm = 0;
  };
  Chewed chew(MuscleJawSettings settings) const {
    settings.law.law = MuscleLaw::peck;
    settings.bolus.side = BolusSettings::Side::right;
    settings.hyoid_way = [this](double t) { return hyoid_way(t); };
    MuscleJaw jaw(chewer_, settings);
    Chewed out;
    double squares = 0;
    for (int k = 0; k < 1000; ++k) {
      EXPECT_TRUE(jaw.step(recorded_excitations(k * 0.001)));
      const Vector3d here = jaw.pose() * incisor_;
      squares += (here - recorded_.wanted((k + 1) * 0.001) * incisor_).squaredNorm();
      out.drop_mm = std::max(out.drop_mm, incisor_.z() - here.z());
      out.lateral_mm = std::max(out.lateral_mm, -here.x());
    }
    out.rms_mm = std::sqrt(squares / 1000);
    return out;
  }

  Case chewer_;
  std::filesystem::path folder_;
  Excitations excitations_;
  std::map<std::string, std::vector<std::pair<double, double>>> knots_;  // s, excitation
  Motion recorded_;
  NumberTable marks_;
  Vector3d incisor_ = {0, -46.9584, 41.7642};  // of the recording
};

TEST_F(RightChew, ClosersPullAsRecordedWhereTheJawWasRecorded) {
  const NumberTable forces = table(folder_ / "rightchew_muscle_force_N.csv");
  const MuscleLawSettings peck{.law = MuscleLaw::peck};
  int closers = 0;
  for (std::size_t m = 0; m < chewer_.muscles.size(); ++m) {
    const Muscle& muscle = chewer_.muscles[m];
    if (muscle.group != "closer") continue;
    const auto column = static_cast<std::size_t>(
        std::find(forces.names.begin(), forces.names.end(), muscle.name) - forces.names.begin());
    ASSERT_LT(column, forces.names.size()) << muscle.name;
    const auto length = [&](double t) {
      return (recorded_.wanted(t) * muscle.insertion - muscle.origin).norm();
    };
    double squares = 0, peak = 0, recorded_peak = 0;
    for (std::size_t r = 0; r < forces.rows(); ++r) {
      const double t = forces.at(r, 0), h = 0.001;
      const double speed = (length(t) - length(t - h)) / h;
      const double excitation = excitations_.at(t)[m];
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

// With the table of muscles and the damping as they are. The recorded run had no posterior
// mylohyoid.
TEST_F(RightChew, ExcitationsAloneLeadTheJawAlongTheRecordedPath) {
  std::erase_if(chewer_.muscles, [](const Muscle& muscle) { return muscle.kind == "pm"; });
  ASSERT_EQ(chewer_.mechanics->mandible.drag_kg_s, 20);
  using Mode = MuscleJawSettings::HyoidMode;
  const Chewed on_crowns = chew({.hyoid = Mode::prescribed});
  EXPECT_LT(on_crowns.rms_mm, 1.5);
  EXPECT_NEAR(on_crowns.drop_mm, 20.09, 0.15 * 20.09);
  EXPECT_NEAR(on_crowns.lateral_mm, 6.14, 0.15 * 6.14);
  const Chewed flat = chew({.hyoid = Mode::prescribed, .teeth = false});
  EXPECT_LT(flat.rms_mm, 1.5);
  // A hyoid that stays where it is costs somewhat less than a millimetre, a free one, without the
  // tissue that hangs it, somewhat more.
  const Chewed fixed = chew({.hyoid = Mode::fixed});
  EXPECT_LT(fixed.rms_mm, 2);
  EXPECT_NEAR(fixed.drop_mm, 20.09, 0.15 * 20.09);
  EXPECT_NEAR(fixed.lateral_mm, 6.14, 0.15 * 6.14);
  const Chewed free = chew({.hyoid = Mode::free});
  EXPECT_LT(free.rms_mm, 3);
  EXPECT_NEAR(free.drop_mm, 20.09, 0.15 * 20.09);
}

// Damping at the bone's frame, not at its centre of mass, makes the difference.
TEST_F(RightChew, DampingActsWhereItsFrameIs) {
  std::erase_if(chewer_.muscles, [](const Muscle& muscle) { return muscle.kind == "pm"; });
  MuscleJawSettings settings{.hyoid = MuscleJawSettings::HyoidMode::prescribed, .teeth = false};
  const double at_frame = chew(settings).rms_mm;
  settings.damped_at = chewer_.mechanics->mandible.center;
  EXPECT_GT(chew(settings).rms_mm, 1.5 * at_frame);
}

TEST(MuscleJaw, BitesHarderTheMoreItsClosersAreExcitedAndStaysStill) {
  double before = 0;
  for (const double excitation : {0.05, 0.2}) {
    MuscleJaw jaw(patient(), {});
    const auto closing = excite(jaw.muscles(), {{"closer", excitation}});
    for (int k = 0; k < 500; ++k) ASSERT_TRUE(jaw.step(closing));
    const Pose rest = jaw.pose();
    double push = 0, drift = 0;
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(jaw.step(closing));
      drift = std::max(drift,
                       (jaw.pose() * Vector3d(0, -92, -51) - rest * Vector3d(0, -92, -51)).norm());
    }
    for (const auto& contact : jaw.world().contacts()) push += contact.push_N;
    EXPECT_GT(push, 1.5 * before);
    EXPECT_LT(drift, 0.02) << excitation;
    // Isometric, near the optimal length: as strong as the muscles are.
    double pull = 0, most = 0;
    for (std::size_t m = 0; m < closing.size(); ++m) {
      if (jaw.muscles()[m].group != "closer") continue;
      pull += jaw.states()[m].force_N;
      most += jaw.muscles()[m].max_force_N * excitation;
    }
    EXPECT_NEAR(pull, most, 0.05 * most);
    before = push;
  }
  EXPECT_GT(before, 60);  // N
}

void chews_for_a_minute(MuscleJawSettings::HyoidMode hyoid) {
  MuscleJaw jaw(patient(),
                {.bolus = {.side = BolusSettings::Side::left}, .hyoid = hyoid, .teeth = false});
  const Vector3d incisor = *patient().landmarks.find("lower_incisal_point");
  std::vector<double> drops;  // of each cycle
  for (int k = 0; k < 60000; ++k) {
    const double phase = std::fmod(k / 700.0, 1.0);
    const auto now = excite(jaw.muscles(), {{"opener", phase < 0.4 ? 0.1 : 0.0},
                                            {"protruder_opener", phase < 0.4 ? 0.1 : 0.0},
                                            {"hyoid", phase < 0.4 ? 0.15 : 0.05},
                                            {"closer", phase > 0.45 && phase < 0.9 ? 0.1 : 0.01}});
    ASSERT_TRUE(jaw.step(now)) << k;
    if (k % 700 == 0) drops.push_back(0);
    drops.back() = std::max(drops.back(), incisor.z() - (jaw.pose() * incisor).z());
  }
  drops.pop_back();
  ASSERT_GT(drops.size(), 80u);
  for (std::size_t c = 5; c < drops.size(); ++c) EXPECT_NEAR(drops[c], drops[5], 0.1) << c;
  EXPECT_GT(drops[5], 1);
  EXPECT_LT(drops[5], 60);
  EXPECT_LT(jaw.hyoid_pose().t.norm(), 60);
}

TEST(MuscleJaw, AMinuteOfChewingNeitherDriftsNorFliesOff) {
  using Mode = MuscleJawSettings::HyoidMode;
  {
    SCOPED_TRACE("hyoid fixed");
    chews_for_a_minute(Mode::fixed);
  }
  SCOPED_TRACE("hyoid free");
  chews_for_a_minute(Mode::free);
}

TEST(MuscleJaw, AnySuddenExcitationStaysInBounds) {
  using Mode = MuscleJawSettings::HyoidMode;
  for (const Mode hyoid : {Mode::free, Mode::fixed})
    for (const MuscleLaw law : {MuscleLaw::peck, MuscleLaw::hill}) {
      MuscleJaw jaw(patient(), {.law = {.law = law}, .hyoid = hyoid, .teeth = false});
      for (int k = 0; k < 1500; ++k) {
        std::vector<double> wild;
        for (std::size_t m = 0; m < jaw.muscles().size(); ++m)
          wild.push_back((k / 100 + m * 7) % 3 == 0 ? 1.0 : 0.0);
        ASSERT_TRUE(jaw.step(wild));
        ASSERT_LT((jaw.pose() * Vector3d(0, -92, -51) - Vector3d(0, -92, -51)).norm(), 150);
        ASSERT_LT(jaw.hyoid_pose().t.norm(), 150);
      }
    }
}

TEST(MuscleJaw, TheSameBitsOnTwoThreads) {
  MuscleJaw one(patient(), {}, 1), two(patient(), {}, 2);
  const auto open = excite(one.muscles(), {{"opener", 0.2}, {"protruder_opener", 0.1}});
  const auto close = excite(one.muscles(), {{"closer", 0.1}});
  for (int k = 0; k < 400; ++k) {
    ASSERT_TRUE(one.step(k < 200 ? open : close, 1));
    ASSERT_TRUE(two.step(k < 200 ? open : close, 2));
    ASSERT_EQ(one.pose().t, two.pose().t);
    ASSERT_EQ(one.pose().R.coeffs(), two.pose().R.coeffs());
  }
}

TEST(Bolus, ResistsUntilItIsBittenThroughAndIsThereAgainAfterAWideOpening) {
  Bolus bolus({.side = BolusSettings::Side::left, .size_mm = 10, .resistance_N = 35}, {0, 0, 0},
              {0, 0, -1});
  const auto push = [&](double gap, double closing = 0) {
    return bolus.push_N({0, 0, -gap}, {0, 0, closing});
  };
  EXPECT_EQ(push(5), 0);  // nothing is eaten yet
  EXPECT_EQ(push(11), 0);
  EXPECT_NEAR(push(8), 7, 1e-9);
  EXPECT_NEAR(push(8, 100), 8, 1e-9);
  EXPECT_NEAR(push(8, -100), 7, 1e-9);
  EXPECT_NEAR(push(1), 31.5, 1e-9);
  EXPECT_EQ(push(0.2), 0);
  EXPECT_EQ(push(8), 0);  // crushed
  EXPECT_EQ(push(10.5), 0);
  EXPECT_NEAR(push(9), 3.5, 1e-9);
}

}  // namespace
}  // namespace condyle
