#include "sim/osteotomy/osteotomy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "sim/osteotomy/recipe.h"

namespace condyle {
namespace {

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = {le_fort_1_recipe(),
                                          le_fort_2_recipe(),
                                          le_fort_3_recipe(),
                                          sagittal_split_recipe(),
                                          vertical_ramus_recipe(),
                                          inverted_l_recipe(),
                                          body_recipe(),
                                          genioplasty_recipe(),
                                          vault_strip_recipe(),
                                          vault_panels_recipe(),
                                          barrel_staves_recipe(),
                                          bandeau_recipe(),
                                          segmental_resection_recipe()};
  return all;
}

const Recipe& recipe_named(const std::string& name) {
  for (const auto& recipe : recipes())
    if (recipe.name == name) return recipe;
  const auto known = osteotomy_names();
  throw InputError(fmt::format("unknown osteotomy \"{}\"{}; known: {}", name,
                               suggestion(name, known), fmt::join(known, ", ")));
}

/// The default of each parameter, replaced by the step's.
std::map<std::string, double> values_of(const Recipe& recipe, const CutStep& step) {
  std::map<std::string, double> values;
  std::vector<std::string> known;
  for (const auto& parameter : recipe.parameters) {
    values[parameter.name] = parameter.standard;
    known.push_back(parameter.name);
  }
  for (const auto& [name, value] : step.parameters) {
    const auto found =
        std::find_if(recipe.parameters.begin(), recipe.parameters.end(),
                     [&, &key = name](const OsteotomyParameter& p) { return p.name == key; });
    if (found == recipe.parameters.end())
      throw InputError(fmt::format("{} has no parameter \"{}\"{}; it has {}", recipe.name, name,
                                   suggestion(name, known), fmt::join(known, ", ")));
    if (!(value >= found->low && value <= found->high))
      throw InputError(fmt::format("{}: {} is {:g}; expected {:g} to {:g}{}", recipe.name, name,
                                   value, found->low, found->high,
                                   found->unit.empty() ? "" : " " + found->unit));
    values[name] = value;
  }
  return values;
}

bool is_bone(const Part& part) {
  return part.role == Role::skull || part.role == Role::maxilla || part.role == Role::mandible ||
         is_piece(part.role);
}

/// A bone of that name, or of the body of that name: the preferred one, where it is there.
const Part& target_part(const Case& patient, const std::string& target,
                        const std::string& preferred) {
  for (const auto& part : patient.parts)
    if (is_bone(part) && part.name == preferred && patient.bodies[part.body].name == target)
      return part;
  for (const auto& part : patient.parts)
    if (is_bone(part) && part.name == target) return part;
  for (const auto& part : patient.parts)
    if (is_bone(part) && patient.bodies[part.body].name == target) return part;
  std::vector<std::string> known;
  for (const auto& part : patient.parts)
    if (is_bone(part)) known.push_back(part.name);
  throw InputError(fmt::format("the case has no bone \"{}\"{}; it has {}", target,
                               suggestion(target, known), fmt::join(known, ", ")));
}

const Part& part_of(const Case& patient, Jaw jaw, const std::string& osteotomy) {
  const auto roles = jaw == Jaw::lower   ? std::vector{Role::mandible}
                     : jaw == Jaw::upper ? std::vector{Role::maxilla, Role::skull}
                                         : std::vector{Role::skull};
  for (const Role role : roles)
    if (const Part* part = patient.find(role)) return *part;
  // After an earlier cut, such as a sagittal split: the piece that carries the teeth.
  if (const Part* teeth = jaw == Jaw::lower ? patient.find(Role::lower_teeth) : nullptr)
    for (const Part& part : patient.parts)
      if (is_bone(part) && part.body == teeth->body) return part;
  throw InputError(fmt::format("{} needs a {}, which the case lacks", osteotomy,
                               jaw == Jaw::lower   ? "mandible"
                               : jaw == Jaw::upper ? "maxilla or skull"
                                                   : "skull"));
}

/// Names the segments as the step does: all of them in order, or some by their own names.
void name_segments(PlacedOsteotomy& placed, const std::vector<std::string>& names,
                   const std::string& osteotomy) {
  if (names.empty()) return;
  std::vector<std::string> own;
  for (const auto& segment : placed.segments) own.push_back(segment.name);
  const bool are_own = std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return std::find(own.begin(), own.end(), name) != own.end();
  });
  if (are_own) {
    std::erase_if(placed.segments, [&](const SegmentRule& segment) {
      return std::find(names.begin(), names.end(), segment.name) == names.end();
    });
    return;
  }
  if (names.size() != own.size())
    throw InputError(fmt::format("{} makes {}; the step names {} pieces", osteotomy,
                                 fmt::join(own, ", "), names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) placed.segments[i].name = names[i];
}

}  // namespace

std::vector<std::string> osteotomy_names() {
  std::vector<std::string> names;
  for (const auto& recipe : recipes()) names.push_back(recipe.name);
  return names;
}

std::vector<OsteotomyParameter> osteotomy_parameters(const std::string& name) {
  return recipe_named(name).parameters;
}

double default_kerf_mm(const std::string& osteotomy) { return recipe_named(osteotomy).kerf_mm; }

PlacedOsteotomy place_osteotomy(const Case& patient, const CutStep& step) {
  if (const auto problem = problem_of(step); problem && problem->item != "pieces")
    throw InputError(problem->item + " " + problem->problem);
  if (step.osteotomy.empty())
    return place_surfaces(step, target_part(patient, step.target, step.bone).name);
  const Recipe& recipe = recipe_named(step.osteotomy);
  auto values = values_of(recipe, step);
  const Part& bone = step.target.empty() ? part_of(patient, recipe.jaw, recipe.name)
                                         : target_part(patient, step.target, step.bone);
  if (!step.surfaces.empty()) return place_surfaces(step, bone.name);
  Site site{SurgicalAnatomy(patient, bone), std::move(values), step.kerf_mm};
  PlacedOsteotomy placed = recipe.place(site);
  placed.part = bone.name;
  placed.notes = site.anatomy.notes;
  placed.rooms = site.anatomy.rooms;
  for (Cut& cut : placed.cuts) cut.kerf_mm = step.kerf_mm;
  name_segments(placed, step.pieces, recipe.name);
  return placed;
}

int segment_of(const PlacedOsteotomy& placed, const Piece& piece) {
  for (std::size_t i = 0; i < placed.segments.size(); ++i) {
    const auto& sides = placed.segments[i].sides;
    bool matches = true;
    for (std::size_t cut = 0; cut < sides.size() && cut < piece.sides.size(); ++cut)
      matches = matches && (sides[cut] == CutSide::neither || sides[cut] == piece.sides[cut]);
    if (matches) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace condyle
