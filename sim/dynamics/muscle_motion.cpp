#include "sim/dynamics/muscle_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_table.h"
#include "sim/muscles/default_muscles.h"
#include "sim/muscles/excitations.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double muscles_each_s =
    0.005;  // interval of stored muscle states; poses are stored at every step
constexpr double longest_s = 600;
constexpr std::size_t largest_displacement = std::size_t{64} << 20;
constexpr double farthest_hyoid_mm = 100;
constexpr std::string_view by_file = "muscles:", inverse = "inverse:";

/// Result of a simulation.
struct Record {
  double step_s = 0;
  std::vector<Pose> X_CM;  // from rest on
  std::vector<MuscleStates> muscles;
  std::vector<Pose> X_CH;  // of the hyoid, at the times of the muscle states

  Pose pose(double time_s) const {
    const double position = std::clamp(time_s / step_s, 0.0, static_cast<double>(X_CM.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(position), X_CM.size() - 1);
    if (i + 1 == X_CM.size()) return X_CM[i];
    return interpolate(X_CM[i], X_CM[i + 1], position - static_cast<double>(i));
  }
  MuscleStates muscles_at(double time_s) const { return kept_at(muscles, time_s); }
  Pose hyoid(double time_s) const { return kept_at(X_CH, time_s); }

 private:
  template <class Value>
  static const Value& kept_at(const std::vector<Value>& kept, double time_s) {
    const double position = std::round(std::max(time_s, 0.0) / muscles_each_s);
    return kept[static_cast<std::size_t>(std::min(position, static_cast<double>(kept.size() - 1)))];
  }
};

std::function<Vector3d(double)> read_displacement(const std::filesystem::path& file) {
  auto content = read_file(file, largest_displacement);
  TextLines lines(content);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  std::vector<std::string> names;
  for (const auto field : fields_of(lines.line(), ',')) names.push_back(lower_case(field));
  std::vector<std::size_t> columns;
  for (const std::string column : {"time_s", "x_mm", "y_mm", "z_mm"}) {
    // In a table of several markers the hyoid's columns are prefixed: "hyoidRef_dx_mm".
    const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return name == column || (name.starts_with("hyoid") && name.ends_with(column));
    });
    if (found == names.end())
      throw InputError(file, lines.where(),
                       fmt::format("column {} is missing; a hyoid file has the header "
                                   "time_s,x_mm,y_mm,z_mm, or hyoid_x_mm and so on (found \"{}\")",
                                   column, shortened(lines.line())));
    columns.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  const NumberTable table = read_rows(file, lines, names, ',', columns);
  if (table.rows() < 2) throw InputError(file, "", "needs at least two rows");
  check_times(file, table, columns[0]);
  std::vector<double> times;
  std::array<std::vector<double>, 3> displacement;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    times.push_back(table.at(r, columns[0]) - table.at(0, columns[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      displacement[k].push_back(table.at(r, columns[k + 1]));
      if (std::abs(displacement[k].back()) > farthest_hyoid_mm)
        throw InputError(file, table.where(r, columns[k + 1]),
                         fmt::format("{} mm from rest exceeds the range of a hyoid ({} mm)",
                                     displacement[k].back(), farthest_hyoid_mm));
    }
  }
  const std::array<Pchip, 3> curves = {Pchip(times, displacement[0]), Pchip(times, displacement[1]),
                                       Pchip(times, displacement[2])};
  return [curves](double t) { return Vector3d(curves[0](t), curves[1](t), curves[2](t)); };
}

std::vector<std::string> notes_of(const Case& patient, const MuscleJaw& jaw,
                                  const MuscleMotionSettings& settings) {
  std::vector<std::string> notes;
  notes.push_back(fmt::format(
      "{} muscles {}, {} law; hyoid {}; mandible of {:.0f} g{}; condyles {}", jaw.muscles().size(),
      patient.muscles.empty() ? "of an average adult, fitted to the landmarks" : "of the patient",
      settings.law.law == MuscleLaw::peck ? "Peck" : "Hill",
      settings.hyoid == "free" || settings.hyoid == "fixed" ? settings.hyoid
                                                            : "prescribed by " + settings.hyoid,
      1000 * jaw.mass().mass_kg, patient.mechanics ? "" : " (from its surface)", jaw.guide()));
  if (!settings.teeth)
    notes.push_back("the bite is a plane through the back teeth at rest");
  else if (jaw.worn_mm() > jaw.world().settings().slop_mm)
    notes.push_back(
        fmt::format("crowns overlap at rest by {:.2f} mm and are treated as worn by that amount",
                    jaw.worn_mm()));
  return notes;
}

/// Steps to the end; `excite` gives the excitations at a time.
template <class Excite>
Motion simulate(const std::string& name, double duration_s, MuscleJaw& jaw, int threads,
                const Excite& excite) {
  if (duration_s > longest_s)
    throw InputError(fmt::format("{}: {} s exceed the limit of muscle-driven motion, {} s", name,
                                 duration_s, longest_s));
  auto record = std::make_shared<Record>();
  record->step_s = jaw.step_s();
  record->X_CM.push_back(jaw.pose());
  const auto steps = std::lround(duration_s / record->step_s);
  const auto keep = std::lround(muscles_each_s / record->step_s);
  for (long k = 0; k < steps; ++k) {
    if (!jaw.step(excite(static_cast<double>(k) * record->step_s), threads))
      throw InputError(
          fmt::format("{}: the simulation diverges at {:.3f} s; reduce the excitations", name,
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
  motion.recorded = true;  // contact is already included
  motion.target = [record](double time_s) { return record->pose(time_s); };
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
    jaw.hyoid_displacement = read_displacement(settings.hyoid);
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

Motion muscles_that_follow(const Motion& reference, const Case& patient,
                           const MuscleMotionSettings& settings, int threads) {
  MuscleJaw jaw(patient, jaw_settings(settings), threads);
  ExcitationFinder finder(patient, jaw, settings.finder);
  const double hold = settings.finder.hold_s;
  std::vector<double> excitations(jaw.muscles().size(), 0.0);
  double next_s = 0, squares = 0, most = 0;
  long count = 0;
  const Vector3d incisor = *patient.landmarks.find("lower_incisal_point");
  Motion motion = simulate(
      "inverse-" + reference.name, reference.duration_s, jaw, threads,
      [&](double time_s) -> const std::vector<double>& {
        if (time_s >= next_s - 1e-9) {
          excitations = finder.find(jaw, reference.target(time_s), reference.target(time_s + hold));
          next_s += hold;
        }
        const double miss = (jaw.pose() * incisor - reference.target(time_s) * incisor).norm();
        squares += miss * miss;
        most = std::max(most, miss);
        ++count;
        return excitations;
      });
  motion.expression = reference.expression;
  for (const std::string& note : reference.notes)
    motion.notes.push_back("prescribed motion: " + note);
  for (std::string& note : notes_of(patient, jaw, settings))
    motion.notes.push_back(std::move(note));
  motion.notes.push_back(fmt::format(
      "the incisal point tracks {} within {:.2f} mm (root mean square; maximum {:.2f} mm)",
      reference.name, count ? std::sqrt(squares / static_cast<double>(count)) : 0, most));
  return motion;
}

void check_motion(const std::string& spec, const MotionSettings& settings,
                  const MuscleMotionSettings& muscles) {
  jaw_settings(muscles);
  if (!spec.starts_with(by_file))
    check_motion(spec.starts_with(inverse) ? spec.substr(inverse.size()) : spec, settings);
  else if (const std::filesystem::path file = spec.substr(by_file.size());
           !std::filesystem::exists(file))
    throw InputError(file, "", "no such file");
}

void check_excitations(const std::string& spec, const Case& patient) {
  if (spec.starts_with(by_file)) read_excitations(spec.substr(by_file.size()), muscles_of(patient));
}

Motion motion_of(const std::string& spec, const Case& patient, const ContactModel& contacts,
                 const MotionSettings& opening, const MuscleMotionSettings& muscles, int threads) {
  if (spec.starts_with(by_file))
    return muscles_from_file(spec.substr(by_file.size()), patient, muscles, threads);
  if (spec.starts_with(inverse))
    return muscles_that_follow(make_motion(spec.substr(inverse.size()), patient, contacts, opening),
                               patient, muscles, threads);
  return make_motion(spec, patient, contacts, opening);
}

std::string excitations_csv(const Motion& motion) {
  // Rows are exact and held until the next: an open jaw amplifies the smallest difference.
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
