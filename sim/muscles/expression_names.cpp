#include "sim/muscles/expression_names.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <set>
#include <utility>

#include "engine/core/text_table.h"
#include "sim/case/face_muscle_table.h"

namespace condyle {
namespace {

/// The excitations of the muscles of the lids.
template <class Excitation>
auto lid_muscles(Excitation& of) {
  return std::array{&of.lids.left, &of.lids.right, &of.raise.left, &of.raise.right};
}

FaceExcitation limited(FaceExcitation excitation) {
  const auto limit = [](double& value) { value = std::clamp(value, 0.0, 1.0); };
  std::ranges::for_each(excitation.muscles, limit);
  for (double* of : lid_muscles(excitation)) limit(*of);
  return excitation;
}

}  // namespace

const std::vector<NamedExpression>& named_expressions() {
  static const std::vector<NamedExpression> all = {
      {"smile",
       "",
       {{"zygomaticus_major", 1},
        {"zygomaticus_minor", 0.6},
        {"levator_labii_superioris", 0.3},
        {"risorius", 0.3},
        {"orbicularis_oculi", 0.5}}},
      {"open-mouth-smile",
       "",
       {{"zygomaticus_major", 1},
        {"zygomaticus_minor", 0.6},
        {"levator_labii_superioris", 0.5},
        {"risorius", 0.3},
        {"depressor_labii_inferioris", 0.4},
        {"orbicularis_oculi", 0.5}}},
      {"sad",
       "",
       {{"depressor_anguli_oris", 0.8},
        {"mentalis", 0.3},
        {"frontalis_medial", 0.6},
        {"corrugator", 0.4}}},
      {"surprise",
       "",
       {{"frontalis_medial", 1}, {"frontalis_lateral", 1}, {std::string(lid_raiser), 0.7}}},
      {"disgust",
       "",
       {{"levator_labii_alaeque_nasi", 0.8}, {"levator_labii_superioris", 0.6}, {"procerus", 0.4}}},
      {"kiss",
       "",
       {{"orbicularis_oris_peripheral", 0.8},
        {"orbicularis_oris_marginal", 0.3},
        {"buccinator", 0.2},
        {"mentalis", 0.3}}},
      {"lips-shut",
       "",
       {{"orbicularis_oris_marginal", 0.7},
        {"risorius", 0.6},
        {"buccinator", 0.5},
        {"mentalis", 0.5}}},
      {"f",
       "",
       {{"orbicularis_oris_marginal", 0.3},
        {"risorius", 0.3},
        {"mentalis", 0.8},
        {"levator_labii_superioris", 0.4},
        {"levator_labii_alaeque_nasi", 0.3}}},
      {"AU1", "inner brow raiser", {{"frontalis_medial", 1}}},
      {"AU2", "outer brow raiser", {{"frontalis_lateral", 1}}},
      {"AU4", "brow lowerer", {{"corrugator", 1}, {"procerus", 1}}},
      {"AU5", "upper lid raiser", {{std::string(lid_raiser), 1}}},
      {"AU6", "cheek raiser", {{"orbicularis_oculi", 1}, {"orbicularis_oculi_superior", 1}}},
      {"AU9", "nose wrinkler", {{"levator_labii_alaeque_nasi", 1}}},
      {"AU10", "upper lip raiser", {{"levator_labii_superioris", 1}}},
      {"AU11", "nasolabial deepener", {{"zygomaticus_minor", 1}}},
      {"AU12", "lip corner puller", {{"zygomaticus_major", 1}}},
      {"AU13", "sharp lip puller", {{"levator_anguli_oris", 1}}},
      {"AU15", "lip corner depressor", {{"depressor_anguli_oris", 1}}},
      {"AU16", "lower lip depressor", {{"depressor_labii_inferioris", 1}}},
      {"AU17", "chin raiser", {{"mentalis", 1}}},
      {"AU20", "lip stretcher", {{"risorius", 1}}},
      {"AU22", "lip funneler", {{"orbicularis_oris_peripheral", 1}}},
      {"AU23", "lip tightener", {{"orbicularis_oris_marginal", 1}}},
      {"AU24", "lip pressor", {{"orbicularis_oris_marginal", 1}, {"mentalis", 0.5}}},
      {"AU43", "eyes closed", {{std::string(lid_closer), 1}}},
      {"AU45", "blink", {{std::string(lid_closer), 1}}},
  };
  return all;
}

const NamedExpression* find_expression(std::string_view name) {
  const std::string wanted = lower_case(name);
  for (const NamedExpression& each : named_expressions())
    if (lower_case(each.name) == wanted) return &each;
  return nullptr;
}

bool moves_upper_face(std::span<const ExpressionLevel> levels) {
  return std::any_of(levels.begin(), levels.end(), [](const ExpressionLevel& level) {
    const NamedExpression* expression = find_expression(level.name);
    return expression && std::max(level.left, level.right) > 0 &&
           std::any_of(expression->kinds.begin(), expression->kinds.end(),
                       [](const KindExcitation& of) { return pulls_upper_face(of.kind); });
  });
}

std::vector<std::string> builtin_expressions() {
  std::vector<std::string> names;
  for (const NamedExpression& each : named_expressions())
    if (!each.action_unit()) names.push_back(each.name);
  return names;
}

std::string list_expressions() {
  std::string names;
  for (const NamedExpression& each : named_expressions())
    names += (names.empty() ? "" : ", ") + each.name;
  return names;
}

FaceExcitation excitation_of(std::span<const ExpressionLevel> levels,
                             std::span<const FaceMuscle> muscles) {
  FaceExcitation sum{.muscles = std::vector<double>(muscles.size(), 0.0)};
  for (const ExpressionLevel& level : levels) {
    const NamedExpression* expression = find_expression(level.name);
    if (!expression) continue;
    for (const auto& [kind, value] : expression->kinds) {
      if (is_lid_muscle(kind)) {
        LidClosure& lids = kind == lid_closer ? sum.lids : sum.raise;
        lids.left += value * level.left;
        lids.right += value * level.right;
        continue;  // also where the case has such a muscle: lids are drawn only
      }
      for (std::size_t m = 0; m < muscles.size(); ++m) {
        if (muscles[m].kind != kind) continue;
        const double strength = muscles[m].name.starts_with("left_") ? level.left
                                : muscles[m].name.starts_with("right_")
                                    ? level.right
                                    : std::max(level.left, level.right);
        sum.muscles[m] += value * strength;
      }
    }
  }
  return limited(std::move(sum));
}

std::string missing_kinds(std::span<const ExpressionLevel> levels,
                          std::span<const FaceMuscle> muscles) {
  std::string expressions, kinds;
  std::set<std::string> missing;
  for (const ExpressionLevel& level : levels) {
    const NamedExpression* expression = find_expression(level.name);
    if (!expression || std::max(level.left, level.right) <= 0) continue;
    bool complete = true;
    for (const auto& of : expression->kinds) {
      if (is_lid_muscle(of.kind) ||
          std::any_of(muscles.begin(), muscles.end(),
                      [&](const FaceMuscle& muscle) { return muscle.kind == of.kind; }))
        continue;
      complete = false;
      if (missing.insert(of.kind).second) kinds += (kinds.empty() ? "" : ", ") + of.kind;
    }
    if (!complete) expressions += (expressions.empty() ? "" : ", ") + level.name;
  }
  if (kinds.empty()) return {};
  return expressions + ": the patient lacks muscles of the kinds " + kinds +
         ", as the case has none and landmarks for default ones are missing";
}

FaceExcitation added_excitations(FaceExcitation a, const FaceExcitation& b) {
  a.muscles.resize(std::max(a.muscles.size(), b.muscles.size()));
  for (std::size_t m = 0; m < b.muscles.size(); ++m) a.muscles[m] += b.muscles[m];
  const auto own = lid_muscles(a);
  const auto others = lid_muscles(b);
  for (std::size_t i = 0; i < own.size(); ++i) *own[i] += *others[i];
  return limited(std::move(a));
}

FaceExcitation between(FaceExcitation a, const FaceExcitation& b, double fraction) {
  assert(a.muscles.size() == b.muscles.size());
  const auto move = [&](double& from, double to) { from += fraction * (to - from); };
  for (std::size_t m = 0; m < a.muscles.size(); ++m) move(a.muscles[m], b.muscles[m]);
  const auto own = lid_muscles(a);
  const auto others = lid_muscles(b);
  for (std::size_t i = 0; i < own.size(); ++i) move(*own[i], *others[i]);
  return a;
}

}  // namespace condyle
