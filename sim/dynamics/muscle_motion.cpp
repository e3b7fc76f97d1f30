#include "sim/dynamics/muscle_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/muscles/excitations.h"
#include "sim/muscles/usual_muscles.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double muscles_each_s = 0.005;  // kept of the muscles; poses of every step
constexpr double longest_s = 600;
constexpr std::size_t largest_way = std::size_t{64} << 20;
constexpr double farthest_hyoid_mm = 100;

/// What a simulation left behind.
struct Record {
  double step_s = 0;
  std::vector<Pose> X_CM;  // from rest on
  std::vector<MuscleStates> muscles;
  std::vector<Pose> X_CH;  // of the hyoid, as often as the muscles

  Pose pose(double time_s) const {
    const double place = std::clamp(time_s / step_s, 0.0, static_cast<double>(X_CM.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), X_CM.size() - 1);
    if (i + 1 == X_CM.size()) return X_CM[i];
    return interpolate(X_CM[i], X_CM[i + 1], place - static_cast<double>(i));
  }
  MuscleStates muscles_at(double time_s) const { return kept_at(muscles, time_s); }
  Pose hyoid(double time_s) const { return kept_at(X_CH, time_s); }

 private:
  template <class Value>
  static const Value& kept_at(const std::vector<Value>& kept, double time_s) {
    const double place = std::round(std::max(time_s, 0.0) / muscles_each_s);
    return kept[static_cast<std::size_t>(std::min(place, static_cast<double>(kept.size() - 1)))];
  }
};

std::function<Vector3d(double)> read_way(const std::filesystem::path& file) {
  auto content = read_file(file, largest_way);
  TextLines lines(content);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  std::vector<std::string> names;
  for (const auto field : fields_of(lines.line(), ',')) names.push_back(lower_case(field));
  std::vector<std::size_t> columns;
  for (const std::string wanted : {"time_s", "x_mm", "y_mm", "z_mm"}) {
    // In a table of several marks the hyoid's columns say so: "hyoidRef_dx_mm".
    const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return name == wanted || (name.starts_with("hyoid") && name.ends_with(wanted));
    });
    if (found == names.end())
      throw InputError(file, lines.where(),
                       fmt::format("column {} is missing; the hyoid's way has the header "
                                   "time_s,x_mm,y_mm,z_mm, or hyoid_x_mm and so on (found \"{}\")",
                                   wanted, shortened(lines.line())));
    columns.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  const NumberTable table = read_rows(file, lines, names, ',', columns);
  if (table.rows() < 2) throw InputError(file, "", "needs two rows or more");
  check_times(file, table, columns[0]);
  std::vector<double> times;
  std::array<std::vector<double>, 3> way;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    times.push_back(table.at(r, columns[0]) - table.at(0, columns[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      way[k].push_back(table.at(r, columns[k + 1]));
      if (std::abs(way[k].back()) > farthest_hyoid_mm)
        throw InputError(file, table.where(r, columns[k + 1]),
                         fmt::format("{} mm from rest is farther than a hyoid goes ({} mm)",
                                     way[k].back(), farthest_hyoid_mm));
    }
  }
  const std::array<Pchip, 3> curves = {Pchip(times, way[0]), Pchip(times, way[1]),
                                       Pchip(times, way[2])};
  return [curves](double t) { return Vector3d(curves[0](t), curves[1](t), curves[2](t)); };
}

std::vector<std::string> notes_of(const Case& patient, const MuscleJaw& jaw,
                                  const MuscleMotionSettings& settings) {
  std::vector<std::string> notes;
  notes.push_back(fmt::format(
      "{} muscles {}, {} law; hyoid {}; mandible of {:.0f} g{}; condyles {}", jaw.muscles().size(),
      patient.muscles.empty() ? "of an average adult, put to the landmarks" : "of the patient",
      settings.law.law == MuscleLaw::peck ? "Peck" : "Hill",
      settings.hyoid == "free" || settings.hyoid == "fixed" ? settings.hyoid
                                                            : "moved as " + settings.hyoid,
      1000 * jaw.mass().mass_kg, patient.mechanics ? "" : " (from its surface)", jaw.guide()));
  if (!settings.teeth)
    notes.push_back("the bite is flat, at the back teeth as they meet at rest");
  else if (jaw.worn_mm() > jaw.world().settings().slop_mm)
    notes.push_back(fmt::format(
        "crowns overlap at rest by {:.2f} mm and are taken as worn by as much", jaw.worn_mm()));
  return notes;
}

/// Steps to the end; `excite` tells the excitations at a time.
template <class Excite>
Motion simulate(const std::string& name, double duration_s, MuscleJaw& jaw, int threads,
                const Excite& excite) {
  if (duration_s > longest_s)
    throw InputError(fmt::format("{}: {} s; at most {} s are simulated with muscles", name,
                                 duration_s, longest_s));
  auto record = std::make_shared<Record>();
  record->step_s = jaw.step_s();
  record->X_CM.push_back(jaw.pose());
  const auto steps = std::lround(duration_s / record->step_s);
  const auto keep = std::lround(muscles_each_s / record->step_s);
  for (long k = 0; k < steps; ++k) {
    if (!jaw.step(excite(static_cast<double>(k) * record->step_s), threads))
      throw InputError(fmt::format(
          "{}: at {:.3f} s the muscles pull so hard that the jaw would fly off; excite less", name,
          static_cast<double>(k) * record->step_s));
    record->X_CM.push_back(jaw.pose());
    if (k % keep == 0) {
      record->muscles.push_back(jaw.states());
      record->X_CH.push_back(jaw.hyoid_pose());
    }
  }
  if (record->muscles.empty()) {
    record->muscles.push_back(jaw.states());
    record->X_CH.push_back(jaw.hyoid_pose());
  }
  Motion motion;
  motion.name = name;
  motion.duration_s = static_cast<double>(steps) * record->step_s;
  motion.recorded = true;  // contact has had its say
  motion.wanted = [record](double time_s) { return record->pose(time_s); };
  motion.muscles = [record](double time_s) { return record->muscles_at(time_s); };
  motion.hyoid = [record](double time_s) { return record->hyoid(time_s); };
  for (const Muscle& muscle : jaw.muscles()) motion.muscle_names.push_back(muscle.name);
  return motion;
}

}  // namespace

MuscleJawSettings jaw_settings(const MuscleMotionSettings& settings) {
  using Mode = MuscleJawSettings::HyoidMode;
  MuscleJawSettings jaw{.law = settings.law, .bolus = settings.bolus, .teeth = settings.teeth};
  if (settings.hyoid == "free") {
    jaw.hyoid = Mode::free;
  } else if (settings.hyoid == "fixed") {
    jaw.hyoid = Mode::fixed;
  } else {
    jaw.hyoid = Mode::prescribed;
    jaw.hyoid_way = read_way(settings.hyoid);
  }
  return jaw;
}

Motion muscles_from_file(const std::filesystem::path& file, const Case& patient,
                         const MuscleMotionSettings& settings, int threads) {
  const Excitations excitations = read_excitations(file, muscles_of(patient));
  MuscleJawSettings how = jaw_settings(settings);
  how.without = excitations.without;
  MuscleJaw jaw(patient, how, threads);
  Motion motion = simulate(file.stem().string(), excitations.duration_s, jaw, threads,
                           [&](double time_s) { return excitations.at(time_s); });
  motion.notes = notes_of(patient, jaw, settings);
  if (!excitations.without.empty())
    motion.notes.push_back(
        fmt::format("without the muscles {}", fmt::join(excitations.without, " ")));
  return motion;
}

Motion muscles_that_follow(const Motion& wanted, const Case& patient,
                           const MuscleMotionSettings& settings, int threads) {
  MuscleJaw jaw(patient, jaw_settings(settings), threads);
  ExcitationFinder finder(patient, jaw, settings.finder);
  const double hold = settings.finder.hold_s;
  std::vector<double> excitations(jaw.muscles().size(), 0.0);
  double next_s = 0, squares = 0, most = 0;
  long count = 0;
  const Vector3d incisor = *patient.landmarks.find("lower_incisal_point");
  Motion motion = simulate(
      "inverse-" + wanted.name, wanted.duration_s, jaw, threads,
      [&](double time_s) -> const std::vector<double>& {
        if (time_s >= next_s - 1e-9) {
          excitations = finder.find(jaw, wanted.wanted(time_s), wanted.wanted(time_s + hold));
          next_s += hold;
        }
        const double miss = (jaw.pose() * incisor - wanted.wanted(time_s) * incisor).norm();
        squares += miss * miss;
        most = std::max(most, miss);
        ++count;
        return excitations;
      });
  motion.notes = notes_of(patient, jaw, settings);
  motion.notes.push_back(fmt::format(
      "the incisal point follows {} within {:.2f} mm (root mean square; {:.2f} at most)",
      wanted.name, count ? std::sqrt(squares / static_cast<double>(count)) : 0, most));
  return motion;
}

Motion motion_of(const std::string& spec, const Case& patient, const ContactModel& contacts,
                 const MotionSettings& opening, const MuscleMotionSettings& muscles, int threads) {
  constexpr std::string_view by_file = "muscles:", inverse = "inverse:";
  if (spec.starts_with(by_file))
    return muscles_from_file(spec.substr(by_file.size()), patient, muscles, threads);
  if (spec.starts_with(inverse))
    return muscles_that_follow(make_motion(spec.substr(inverse.size()), patient, contacts, opening),
                               patient, muscles, threads);
  return make_motion(spec, patient, contacts, opening);
}

std::string excitations_csv(const Motion& motion) {
  // Each row holds until the next, to the bit: an open jaw magnifies the least difference.
  std::string text = "# interpolation: step\ntime_s";
  for (const auto& name : motion.muscle_names) text += "," + name;
  text += "\n";
  const auto rows = std::lround(motion.duration_s / muscles_each_s);
  for (long r = 0; r <= rows; ++r) {
    const double time_s = static_cast<double>(r) * muscles_each_s;
    text += fmt::format("{:.3f}", time_s);
    for (const MuscleState& state : motion.muscles(time_s))
      text += fmt::format(",{}", state.excitation);
    text += "\n";
  }
  return text;
}

}  // namespace condyle
