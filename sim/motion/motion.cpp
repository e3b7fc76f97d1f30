#include "sim/motion/motion.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/similar_word.h"
#include "sim/motion/face_movements.h"
#include "sim/motion/joint_fit.h"
#include "sim/motion/movements.h"
#include "sim/motion/opening.h"
#include "sim/motion/recording.h"

namespace condyle {
namespace {

constexpr double default_opening_s = 3;
constexpr std::size_t largest_script = std::size_t{1} << 20;
constexpr int threads = 2;

/// The built-in motions as motion scripts.
const std::vector<std::pair<std::string, std::string>>& builtin_scripts() {
  static const std::vector<std::pair<std::string, std::string>> scripts = {
      {"opening", ""},
      {"protrusion", "protrude; hold 0.2; close"},
      {"retrusion", "retrude over 0.4; hold 0.2; close over 0.4"},
      {"laterotrusion-left", "left; hold 0.2; close"},
      {"laterotrusion-right", "right; hold 0.2; close"},
      {"posselt", "posselt"},
      {"chewing-left", "chew left; hold 0.3"},
      {"chewing-right", "chew right; hold 0.3"},
      {"rest", "rest over 0.5; hold 2.5"}};
  return scripts;
}

/// A script as a caption: statements separated by ";", truncated if long.
std::string in_one_line(const std::string& words) {
  constexpr std::size_t most = 60;
  std::string line, gap;
  for (const char c : words) {
    if (c == '\n' || c == ';') {
      gap = "; ";
    } else if (std::isspace(static_cast<unsigned char>(c))) {
      if (gap.empty()) gap = " ";
    } else {
      if (!line.empty()) line += gap;
      gap.clear();
      line += c;
    }
  }
  if (line.size() > most) line = line.substr(0, line.find_last_of(' ', most)) + " ...";
  return line;
}

std::string ending_of(const std::string& spec) {
  std::string ending = std::filesystem::path(spec).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool looks_like_a_file(const std::string& spec) {
  const std::string ending = ending_of(spec);
  std::error_code ignored;
  return ending == ".csv" || ending == ".motion" ||
         (spec.find('/') != std::string::npos && spec.find(' ') == std::string::npos) ||
         std::filesystem::exists(spec, ignored);
}

void check(const MotionSettings& settings) {
  constexpr double longest_s = 3600;
  if (!(settings.duration_s >= 0 && settings.duration_s <= longest_s))
    throw InputError(
        fmt::format("motion duration {} s: give 0 (the natural duration) or at most {} s",
                    settings.duration_s, longest_s));
  for (const auto& entry : motion_parameter_names())
    for (const auto member : entry.values)
      if (const auto& value = settings.parameters.*member;
          value && !(*value >= entry.low && *value <= entry.high))
        throw InputError(fmt::format("{} {}: give {} to {} {}", entry.name, *value, entry.low,
                                     entry.high, entry.unit));
}

/// The motion with another duration.
Motion stretched(Motion motion, double duration_s) {
  if (duration_s <= 0 || motion.duration_s <= 0) return motion;
  const double fraction = motion.duration_s / duration_s;
  motion.target = [target = motion.target, fraction](double time_s) {
    return target(time_s * fraction);
  };
  if (motion.expression)
    motion.expression = [expression = motion.expression, fraction](double time_s) {
      return expression(time_s * fraction);
    };
  for (auto& phase : motion.phases) {
    phase.start_s /= fraction;
    phase.end_s /= fraction;
  }
  motion.duration_s = duration_s;
  return motion;
}

bool goes_aside(const std::vector<Statement>& statements) {
  return std::any_of(statements.begin(), statements.end(), [](const Statement& s) {
    return s.verb == Verb::left || s.verb == Verb::right || s.verb == Verb::posselt ||
           s.verb == Verb::chew_left || s.verb == Verb::chew_right;
  });
}

void add_inputs(Motion& motion, const JawJoints& joints, const MotionParameters& parameters) {
  for (const auto& entry : motion_parameter_names())
    if (entry.values.size() == 1 && parameters.*entry.values.front())
      motion.inputs.push_back({entry.name, entry.unit, *(parameters.*entry.values.front())});
  motion.inputs.push_back({"bonwill_distance", "mm", joints.bonwill_mm()});
  motion.inputs.push_back({"balkwill_angle", "deg", joints.balkwill_deg()});
}

void add_found(Motion& motion, const JawJoints& joints, const OpeningLimits& limits) {
  const double forward = limits.coupling.forward_mm(limits.widest_theta);
  std::vector<MotionInput> found = {
      {"opening", "mm", joints.opening_mm({limits.widest_theta, forward, forward, 0})},
      {"inclination_left", "deg", joints.inclination_deg(JawSide::left)},
      {"inclination_right", "deg", joints.inclination_deg(JawSide::right)}};
  if (const auto& fossae = joints.surfaces())  // mean of both sides
    found.push_back(
        {"disc_gap", "mm",
         0.5 * (fossae->rest_gap_mm(JawSide::left) + fossae->rest_gap_mm(JawSide::right))});
  for (const auto& one : found)
    if (std::none_of(motion.inputs.begin(), motion.inputs.end(),
                     [&](const auto& given) { return given.name == one.name; }))
      motion.found.push_back(one);
}

/// The statement of a script with the largest opening; null when none gives one.
const Statement* widest_open(const MotionScript* script) {
  const Statement* farthest = nullptr;
  if (script)
    for (const Statement& statement : script->statements)
      if (statement.verb == Verb::open && statement.amount &&
          (!farthest || *statement.amount > *farthest->amount))
        farthest = &statement;
  return farthest;
}

bool moves_face_only(const std::vector<Statement>& statements) {
  return std::any_of(statements.begin(), statements.end(),
                     [](const Statement& s) { return s.verb == Verb::face; }) &&
         std::all_of(statements.begin(), statements.end(), [](const Statement& s) {
           return s.verb == Verb::face || s.verb == Verb::hold;
         });
}

/// Expressions while the jaw stays as in the case; the jaw's joints are not needed.
Motion express(const std::string& name, const MotionScript& script, const Case& patient,
               const MotionSettings& settings) {
  FaceMovements face;
  double now_s = 0;
  Motion motion{.name = name, .target = [](double) { return Pose{}; }};
  for (const Statement& statement : script.statements) {
    const double start_s = now_s;
    face.add(statement, start_s);
    const bool holds = statement.verb == Verb::hold;
    now_s = std::max(start_s + (holds ? *statement.amount : 0), face.end_s());
    motion.phases.push_back({holds ? "hold" : "expression", start_s, now_s});
  }
  motion.duration_s = now_s;
  face.finish(motion, patient);
  return stretched(std::move(motion), settings.duration_s);
}

/// `round`: ends in the rest pose of the case, where that is not its bite.
Motion move(const std::string& name, const MotionScript* script, const Case& patient,
            const ContactModel& contacts, const MotionSettings& settings, bool round = false) {
  if (script && moves_face_only(script->statements))
    return express(name, *script, patient, settings);
  MotionParameters parameters = settings.parameters.over(patient.motion);
  if (script) parameters = script->parameters.over(parameters);
  const bool aside = script && goes_aside(script->statements);
  const auto joints = std::make_shared<const JawJoints>(
      patient, parameters, aside ? JointReach::aside : JointReach::straight, threads);
  std::vector<std::string> notes;
  const OpeningLimits limits =
      opening_limits(*joints, contacts, parameters, notes, settings.progress);
  // "open 50" raises the limit as "set opening 50" does, where no opening was set; a plain "open"
  // is unaffected.
  OpeningLimits reach = limits;
  std::optional<double> plain_opening;
  const double forward = limits.coupling.forward_mm(limits.widest_theta);
  const double max_mm = joints->opening_mm({limits.widest_theta, forward, forward, 0});
  if (const Statement* open = widest_open(script);
      open && !parameters.opening_mm && *open->amount > max_mm + 1e-6) {
    MotionParameters farther = parameters;
    farther.opening_mm = open->amount;
    notes = {fmt::format("open {:.6g} is requested; by default this jaw opens to {:.1f} mm",
                         *open->amount, max_mm)};
    try {
      reach = opening_limits(*joints, contacts, farther, notes, settings.progress);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", open->where, error.what()));
    }
    plain_opening = max_mm;
  }
  const auto guide = std::make_shared<BiteGuide>(patient, *joints, parameters);
  Movements movements(joints, guide, reach, parameters,
                      [&](const Pose& X_CM) { return bones_free(patient, contacts, X_CM); });
  FaceMovements face;
  if (script) {
    for (Statement statement : script->statements) {
      if (statement.verb == Verb::open && !statement.amount) statement.amount = plain_opening;
      face.add(statement, movements.now_s());
      movements.add(statement);
      movements.wait_until(face.end_s());
    }
    if (round && guide->bite_theta() != 0) movements.back("back to the start", {});
  } else {
    // Equal durations of opening and closing, with a pause between them.
    constexpr double stroke_fraction = 0.45;
    const double whole = settings.duration_s > 0 ? settings.duration_s : default_opening_s;
    Statement open{.verb = Verb::open, .duration_s = stroke_fraction * whole, .where = "opening"};
    if (parameters.speed_mm_s && settings.duration_s == 0) open.duration_s.reset();
    movements.add(open);
    movements.add(
        {.verb = Verb::hold, .amount = (1 - 2 * stroke_fraction) * whole, .where = "hold"});
    movements.back("closing", open.duration_s);
  }
  if (!guide->notes().empty()) notes.push_back(guide->notes());
  Motion motion = movements.finish(name);
  face.finish(motion, patient);
  motion.notes.insert(motion.notes.begin(), notes.begin(), notes.end());
  add_inputs(motion, *joints, parameters);
  add_found(motion, *joints, limits);
  return stretched(std::move(motion), settings.duration_s);
}

bool has_landmarks(const Case& patient) {
  return patient.landmarks.find("left_condyle") && patient.landmarks.find("right_condyle") &&
         patient.landmarks.find("lower_incisal_point");
}

}  // namespace

const std::vector<std::string>& builtin_motions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, script] : builtin_scripts()) all.push_back(name);
    return all;
  }();
  return names;
}

namespace {

[[noreturn]] void refuse_motion(const std::string& spec) {
  throw InputError(fmt::format(
      "unknown motion \"{}\"{}; give one of {}, a motion script such as \"open 40; close; "
      "protrude 6\" or \"smile 0.8; rest\", a script file (*.motion), a recording, muscles:FILE or "
      "inverse:MOTION",
      spec, suggestion(spec, builtin_motions()), fmt::join(builtin_motions(), ", ")));
}

Motion motion_of(const std::string& spec, const Case& patient, const ContactModel& contacts,
                 const MotionSettings& settings) {
  check(settings);
  if (spec == "opening") return move(spec, nullptr, patient, contacts, settings);
  // Without landmarks, the rest position is the rest pose of the case.
  if (spec == "rest" && !has_landmarks(patient)) {
    const double duration_s = settings.duration_s > 0 ? settings.duration_s : default_opening_s;
    return {spec, duration_s, false, [](double) { return Pose{}; }, {}};
  }
  for (const auto& [name, text] : builtin_scripts())
    if (spec == name) {
      const MotionScript script = parse_motion_script(text, name);
      return move(name, &script, patient, contacts, settings, name != "rest");
    }
  if (looks_like_a_file(spec)) {
    if (ending_of(spec) != ".motion") {
      Motion motion = read_recording(spec);
      note_implausible_values(patient, motion);
      if (const auto fit = fit_joint(patient, motion))
        for (auto& note : describe(*fit)) motion.notes.push_back(std::move(note));
      return motion;
    }
    const MotionScript script = parse_motion_script(read_file(spec, largest_script), spec);
    return move(std::filesystem::path(spec).stem().string(), &script, patient, contacts, settings);
  }
  if (is_motion_script(spec)) {
    const MotionScript script = parse_motion_script(spec, "motion");
    return move(in_one_line(spec), &script, patient, contacts, settings);
  }
  refuse_motion(spec);
}

/// Whether a level of an expression in the motion's words is such; false for what is no motion in
/// words.
template <class Test>
bool any_level_of_words(const std::string& name, const Test& is_such) {
  // The motion that muscles follow keeps its expressions.
  constexpr std::string_view inverse = "inverse:";
  const std::string spec = name.starts_with(inverse) ? name.substr(inverse.size()) : name;
  const auto& names = builtin_motions();
  if (std::find(names.begin(), names.end(), spec) != names.end()) return false;
  const bool file = looks_like_a_file(spec);
  if (file ? ending_of(spec) != ".motion" : !is_motion_script(spec)) return false;
  const MotionScript script =
      parse_motion_script(file ? read_file(spec, largest_script) : spec, file ? spec : "motion");
  return std::any_of(script.statements.begin(), script.statements.end(), [&](const Statement& one) {
    return std::any_of(one.face.begin(), one.face.end(), [&](const FaceChange& change) {
      return is_such(ExpressionLevel{.name = change.expression, .left = change.strength});
    });
  });
}

}  // namespace

bool motion_moves_upper_face(const std::string& name) {
  return any_level_of_words(name, [](const ExpressionLevel& level) {
    return moves_upper_face({&level, 1});
  });
}

bool motion_moves_lids(const std::string& name) {
  return any_level_of_words(name, [](const ExpressionLevel& level) {
    return excitation_of({&level, 1}, {}).moves_lids();
  });
}

void check_motion(const std::string& spec, const MotionSettings& settings) {
  check(settings);
  const auto& names = builtin_motions();
  if (std::find(names.begin(), names.end(), spec) != names.end()) return;
  if (looks_like_a_file(spec)) {
    if (ending_of(spec) == ".motion")
      parse_motion_script(read_file(spec, largest_script), spec);
    else
      read_recording(spec);
  } else if (is_motion_script(spec)) {
    parse_motion_script(spec, "motion");
  } else {
    refuse_motion(spec);
  }
}

Motion make_motion(const std::string& spec, const Case& patient, const ContactModel& contacts,
                   const MotionSettings& settings) {
  Motion motion = motion_of(spec, patient, contacts, settings);
  if (!patient.has_parts(patient.jaw.lower_arch))
    motion.notes.insert(
        motion.notes.begin(),
        "no part of this case moves with the mandible (there is no mandible and there are no "
        "lower teeth or gums): no surface moves; openings are those of landmarks");
  return motion;
}

}  // namespace condyle
