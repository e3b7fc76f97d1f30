#include "sim/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Problem = std::optional<StepProblem>;

constexpr double max_coordinate_mm = 1e4;
constexpr double max_reach_mm = 1000;
constexpr std::size_t max_text = 10000;

Problem point_problem(const std::string& item, const Vector3d& p) {
  if (p.allFinite() && p.cwiseAbs().maxCoeff() <= max_coordinate_mm) return std::nullopt;
  return StepProblem{item, fmt::format("is ({:g}, {:g}, {:g}); each coordinate must be a number "
                                       "from {:g} to {:g}",
                                       p.x(), p.y(), p.z(), -max_coordinate_mm, max_coordinate_mm)};
}

Problem direction_problem(const std::string& item, const Vector3d& v) {
  if (v.allFinite() && v.norm() > 1e-6 && v.norm() < 1e6) return std::nullopt;
  return StepProblem{
      item, fmt::format("is ({:g}, {:g}, {:g}), which is no direction", v.x(), v.y(), v.z())};
}

Problem length_problem(const std::string& item, double value, double least, double most) {
  if (value >= least && value <= most) return std::nullopt;
  return StepProblem{
      item, fmt::format("is {:g} mm; expected a length from {:g} to {:g}", value, least, most)};
}

Problem name_problem(const std::string& item, const std::string& name) {
  const auto printable = [](unsigned char c) { return c >= ' ' && c != 127; };
  if (!name.empty() && name.size() <= 100 && std::all_of(name.begin(), name.end(), printable))
    return std::nullopt;
  return StepProblem{
      item, "is \"" + name.substr(0, 40) + "\"; expected a name of 1 to 100 printable characters"};
}

Problem first_of(std::initializer_list<Problem> problems) {
  for (const auto& problem : problems)
    if (problem) return problem;
  return std::nullopt;
}

constexpr double least_size_mm = 0.1;

Problem problem_of_surface(const std::string& item, const PlanePatch& patch) {
  if (auto found = first_of({point_problem(item + ".point", patch.point),
                             direction_problem(item + ".normal", patch.normal)}))
    return found;
  if (const auto* radius = std::get_if<double>(&patch.reach))
    return length_problem(item + ".radius_mm", *radius, least_size_mm, max_reach_mm);
  const auto& rectangle = std::get<PatchRectangle>(patch.reach);
  if (auto found = first_of({direction_problem(item + ".axis", rectangle.axis),
                             length_problem(item + ".half_along_mm", rectangle.half_along_mm,
                                            least_size_mm, max_reach_mm),
                             length_problem(item + ".half_across_mm", rectangle.half_across_mm,
                                            least_size_mm, max_reach_mm)}))
    return found;
  if (!(patch.normal.normalized().cross(rectangle.axis.normalized()).norm() > 1e-3))
    return StepProblem{item + ".axis", "is parallel to the normal"};
  return std::nullopt;
}

Problem problem_of_surface(const std::string& item, const BentSheet& sheet) {
  if (sheet.polyline.size() < 2)
    return StepProblem{item + ".polyline", fmt::format("has {} points; at least 2 are required",
                                                       sheet.polyline.size())};
  for (std::size_t i = 0; i < sheet.polyline.size(); ++i)
    if (auto found = point_problem(fmt::format("{}.polyline[{}]", item, i), sheet.polyline[i]))
      return found;
  if (auto found =
          first_of({direction_problem(item + ".direction", sheet.direction),
                    length_problem(item + ".depth_mm", sheet.depth_mm, least_size_mm, max_reach_mm),
                    length_problem(item + ".overhang_mm", sheet.overhang_mm, 0, max_reach_mm)}))
    return found;
  for (std::size_t i = 1; i < sheet.polyline.size(); ++i) {
    const Vector3d along = sheet.polyline[i] - sheet.polyline[i - 1];
    if (!(along.cross(sheet.direction.normalized()).norm() > 1e-3))
      return StepProblem{fmt::format("{}.polyline[{}]", item, i),
                         "repeats the point before it, or lies behind it along the direction"};
  }
  return std::nullopt;
}

Problem problem_in(const CutStep& cut) {
  if (cut.osteotomy.empty() && cut.surfaces.empty())
    return StepProblem{"osteotomy", "is empty, and so are the surfaces; one of them is required"};
  if (!cut.osteotomy.empty())
    if (auto found = name_problem("osteotomy", cut.osteotomy)) return found;
  if (!cut.target.empty())
    if (auto found = name_problem("target", cut.target)) return found;
  if (cut.osteotomy.empty() && cut.target.empty())
    return StepProblem{"target", "is empty; surfaces without an osteotomy need the body they cut"};
  for (const auto& [name, value] : cut.parameters) {
    if (auto found = name_problem("parameters", name)) return found;
    if (!(std::abs(value) <= max_coordinate_mm))
      return StepProblem{"parameters." + name,
                         fmt::format("is {:g}; expected a number from {:g} to {:g}", value,
                                     -max_coordinate_mm, max_coordinate_mm)};
  }
  if (auto found = length_problem("kerf_mm", cut.kerf_mm, 0, max_kerf_mm)) return found;
  for (std::size_t i = 0; i < cut.surfaces.size(); ++i) {
    const std::string item = fmt::format("surfaces[{}]", i);
    if (auto found =
            std::visit([&](const auto& surface) { return problem_of_surface(item, surface); },
                       cut.surfaces[i]))
      return found;
  }
  if (cut.pieces.empty() && cut.osteotomy.empty())
    return StepProblem{"pieces", "is empty; a cut names what it makes"};
  for (std::size_t i = 0; i < cut.pieces.size(); ++i)
    if (auto found = name_problem(fmt::format("pieces[{}]", i), cut.pieces[i])) return found;
  return std::nullopt;
}

Problem problem_in(const MoveStep& step) {
  if (auto found = name_problem("segment", step.segment)) return found;
  try {
    if (const auto* move = std::get_if<ClinicalMove>(&step.move)) {
      if (!move->about.empty())
        if (auto found = name_problem("about", move->about)) return found;
      check_move(*move);
    } else {
      const Pose& X_CS = std::get<ExplicitMove>(step.move).X_CS;
      check_rotation(X_CS);
      return point_problem("translation_mm", X_CS.t);
    }
  } catch (const InputError& error) {
    return StepProblem{"", error.what()};
  }
  return std::nullopt;
}

Problem problem_in(const TrimStep& step) {
  if (auto found = name_problem("segment", step.segment)) return found;
  if (step.of.empty())
    return StepProblem{"of", "is empty; a trim names the segments that keep their bone"};
  for (std::size_t i = 0; i < step.of.size(); ++i) {
    const std::string item = fmt::format("of[{}]", i);
    if (auto found = name_problem(item, step.of[i])) return found;
    if (step.of[i] == step.segment) return StepProblem{item, "is the segment that is trimmed"};
    if (std::count(step.of.begin(), step.of.end(), step.of[i]) > 1)
      return StepProblem{item, "is named twice"};
  }
  return std::nullopt;
}

Problem problem_in(const NoteStep& note) {
  if (!note.text.empty() && note.text.size() <= max_text) return std::nullopt;
  return StepProblem{
      "text", fmt::format("has {} characters; expected 1 to {}", note.text.size(), max_text)};
}

Problem problem_in(const ResectStep& step) {
  const auto found = graft_step_problem(step);
  return found ? Problem({found->first, found->second}) : std::nullopt;
}

Problem problem_in(const GraftStep& step) {
  const auto found = graft_step_problem(step);
  return found ? Problem({found->first, found->second}) : std::nullopt;
}

/// The names of the bodies that a step makes.
std::vector<std::string> made_by(const PlanAction& action) {
  if (const auto* cut = std::get_if<CutStep>(&action)) return cut->pieces;
  if (const auto* graft = std::get_if<GraftStep>(&action)) return graft_bodies(*graft);
  return {};
}

/// The names of the segments that a step needs, in the step.
template <class Action>
auto segments_in(Action& action) {
  std::vector<decltype(&std::get<MoveStep>(action).segment)> used;
  if (auto* cut = std::get_if<CutStep>(&action)) used = {&cut->target};
  if (auto* move = std::get_if<MoveStep>(&action)) used = {&move->segment};
  if (auto* resection = std::get_if<ResectStep>(&action)) used = {&resection->segment};
  if (auto* graft = std::get_if<GraftStep>(&action)) used = {&graft->replaces};
  if (auto* trim = std::get_if<TrimStep>(&action)) {
    used = {&trim->segment};
    for (auto& other : trim->of) used.push_back(&other);
  }
  return used;
}

std::vector<PlanStep>::iterator step_with(Plan& plan, int id) {
  return plan.steps.begin() + (&step_of(plan, id) - plan.steps.data());
}

[[noreturn]] void refuse_step(const PlanStep& step, const std::string& problem) {
  throw InputError(step_name(step) + ": " + problem);
}

/// Segments exist only after the cut that makes them, and each is made once.
void check_order(const Plan& plan) {
  std::map<std::string, std::size_t> made;  // by which step
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    for (const auto& piece : made_by(plan.steps[i].action))
      if (const auto [known, is_new] = made.try_emplace(piece, i); !is_new)
        refuse_step(plan.steps[i], fmt::format("the piece \"{}\" is already made by {}", piece,
                                               step_name(plan.steps[known->second])));
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
    for (const std::string& used : used_segments(plan.steps[i].action)) {
      const auto maker = made.find(used);
      // A cut may give one of its pieces the name of what it cuts.
      const bool cuts = std::holds_alternative<CutStep>(plan.steps[i].action);
      if (maker == made.end() || maker->second < i || (cuts && maker->second == i)) continue;
      refuse_step(plan.steps[i], fmt::format("needs \"{}\", which only {} makes", used,
                                             step_name(plan.steps[maker->second])));
    }
}

/// A segment is resected once, and a graft takes the place of a resected one.
void check_resections(const Plan& plan) {
  std::map<std::string, std::size_t> resected;  // by which step
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    if (const auto* resection = std::get_if<ResectStep>(&plan.steps[i].action))
      if (const auto [known, is_new] = resected.try_emplace(resection->segment, i); !is_new)
        refuse_step(plan.steps[i],
                    fmt::format("\"{}\" is already resected by {}", resection->segment,
                                step_name(plan.steps[known->second])));
    if (const auto* graft = std::get_if<GraftStep>(&plan.steps[i].action))
      if (!resected.contains(graft->replaces))
        refuse_step(plan.steps[i], fmt::format("no step before it resects \"{}\", whose place the "
                                               "graft takes",
                                               graft->replaces));
  }
}

}  // namespace

std::string step_title(const PlanAction& action) {
  if (const auto* cut = std::get_if<CutStep>(&action))
    return "cut " + (cut->osteotomy.empty() ? cut->target : cut->osteotomy);
  if (const auto* move = std::get_if<MoveStep>(&action)) return "move " + move->segment;
  if (const auto* trim = std::get_if<TrimStep>(&action)) return "trim " + trim->segment;
  if (const auto* resection = std::get_if<ResectStep>(&action))
    return "resect " + resection->segment;
  if (const auto* graft = std::get_if<GraftStep>(&action)) return "graft " + graft->name;
  return "note";
}

std::string step_name(const PlanStep& step) {
  return fmt::format("step {} ({})", step.id, step_title(step.action));
}

const PlanStep& step_of(const Plan& plan, int id) {
  for (const auto& step : plan.steps)
    if (step.id == id) return step;
  std::vector<int> ids;
  for (const auto& step : plan.steps) ids.push_back(step.id);
  throw InputError(fmt::format(
      "the plan has no step {}; {}", id,
      ids.empty() ? "it is empty" : fmt::format("its steps are {}", fmt::join(ids, ", "))));
}

std::vector<std::string> used_segments(const PlanAction& action) {
  std::vector<std::string> used;
  for (const std::string* name : segments_in(action)) used.push_back(*name);
  return used;
}

std::optional<StepProblem> problem_of(const PlanAction& action) {
  return std::visit([](const auto& step) { return problem_in(step); }, action);
}

void check_plan(const Plan& plan) {
  if (const auto found = name_problem("name", plan.name))
    throw InputError("the plan's " + found->item + " " + found->problem);
  const double length = plan.reference.R_NC.norm();
  if (!(std::abs(length - 1) <= 1e-6))
    throw InputError(fmt::format(
        "the rotation of the head has the length {:g}; a unit quaternion is required", length));
  for (const auto& [name, point] : plan.geometry.landmarks.points)
    if (const auto found = point_problem("landmark " + name, point))
      throw InputError(found->item + " " + found->problem);
  std::set<int> ids;
  for (const auto& step : plan.steps) {
    if (step.id < 1 || !ids.insert(step.id).second)
      refuse_step(step, "its number must be positive and unique");
    if (const auto found = problem_of(step.action))
      refuse_step(step, found->item.empty() ? found->problem : found->item + " " + found->problem);
  }
  check_order(plan);
  std::set<std::string> zones;
  for (const PlanZone& zone : plan.zones) {
    if (const auto found = problem_of(zone))
      throw InputError(
          fmt::format("zone \"{}\": {} {}", zone.name.substr(0, 40), found->item, found->problem));
    if (!zones.insert(zone.name).second)
      throw InputError(fmt::format("the zone \"{}\" occurs twice", zone.name));
  }
  check_resections(plan);
}

void check_segments(const Plan& plan, const BodyTree& bodies) {
  std::vector<std::string> known;
  for (const auto& body : bodies.bodies()) known.push_back(body.name);
  std::map<std::string, std::string> resected;  // by which step
  for (const auto& step : plan.steps) {
    if (!std::holds_alternative<GraftStep>(step.action))
      for (const std::string& used : used_segments(step.action))
        if (const auto gone = resected.find(used); gone != resected.end())
          refuse_step(step, fmt::format("\"{}\" is resected by {}", used, gone->second));
    if (const auto* resection = std::get_if<ResectStep>(&step.action))
      resected[resection->segment] = step_name(step);
    for (const std::string& used : used_segments(step.action))
      if (!used.empty() && std::find(known.begin(), known.end(), used) == known.end())
        refuse_step(step, fmt::format("\"{}\" is neither a body of the case nor made by a cut "
                                      "before this step{}",
                                      used, suggestion(used, known)));
    const auto made = made_by(step.action);
    known.insert(known.end(), made.begin(), made.end());
  }
}

Plan with_step(Plan plan, PlanAction action) {
  int last = 0;
  for (const auto& step : plan.steps) last = std::max(last, step.id);
  plan.steps.push_back({last + 1, std::move(action)});
  check_plan(plan);
  return plan;
}

Plan with_replaced(Plan plan, int id, PlanAction action) {
  step_with(plan, id)->action = std::move(action);
  check_plan(plan);
  return plan;
}

Plan with_move(Plan plan, const MoveStep& move) {
  for (auto step = plan.steps.rbegin(); step != plan.steps.rend(); ++step)  // the last one counts
    if (const auto* known = std::get_if<MoveStep>(&step->action))
      if (known->segment == move.segment) return with_replaced(std::move(plan), step->id, move);
  return with_step(std::move(plan), move);
}

Plan without_step(Plan plan, int id) {
  plan.steps.erase(step_with(plan, id));
  check_plan(plan);
  return plan;
}

Plan with_reordered(Plan plan, int id, std::size_t position) {
  const auto from = step_with(plan, id);
  if (position >= plan.steps.size())
    throw InputError(fmt::format("step {} cannot be number {} of {} steps", id, position + 1,
                                 plan.steps.size()));
  PlanStep step = std::move(*from);
  plan.steps.erase(from);
  plan.steps.insert(plan.steps.begin() + static_cast<std::ptrdiff_t>(position), std::move(step));
  check_plan(plan);
  return plan;
}

Plan with_zone(Plan plan, PlanZone zone) {
  const auto known = std::find_if(plan.zones.begin(), plan.zones.end(),
                                  [&](const PlanZone& each) { return each.name == zone.name; });
  if (known != plan.zones.end())
    *known = std::move(zone);
  else
    plan.zones.push_back(std::move(zone));
  check_plan(plan);
  return plan;
}

Plan without_zone(Plan plan, const std::string& name) {
  std::vector<std::string> known;
  for (const PlanZone& zone : plan.zones) known.push_back(zone.name);
  if (std::erase_if(plan.zones, [&](const PlanZone& zone) { return zone.name == name; }) == 0)
    throw InputError(fmt::format(
        "the plan has no zone \"{}\"{}; {}", name, suggestion(name, known),
        known.empty() ? "it has none" : fmt::format("it has {}", fmt::join(known, ", "))));
  return plan;
}

Plan with_recut(Plan plan, int id, const CutStep& cut) {
  const auto at = step_with(plan, id);
  const auto* known = std::get_if<CutStep>(&at->action);
  if (!known) throw InputError(step_name(*at) + " is no cut");
  std::map<std::string, std::string> renamed;
  if (known->pieces.size() == cut.pieces.size())
    for (std::size_t i = 0; i < cut.pieces.size(); ++i) renamed[known->pieces[i]] = cut.pieces[i];
  at->action = cut;
  for (PlanStep& step : plan.steps) {
    if (step.id == id) continue;
    auto* move = std::get_if<MoveStep>(&step.action);
    for (std::string* used : segments_in(step.action)) {
      const auto found = renamed.find(*used);
      if (found == renamed.end() || found->second == *used) continue;
      // The point that a move is about by default depends on the segment's name.
      if (move)
        if (auto* words = std::get_if<ClinicalMove>(&move->move))
          words->about = point_name(*words, *used);
      *used = found->second;
    }
  }
  check_plan(plan);
  return plan;
}

}  // namespace condyle
