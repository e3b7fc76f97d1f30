#include "sim/motion/face_movements.h"

#include <algorithm>

#include "engine/core/error.h"
#include "sim/muscles/default_face_muscles.h"

namespace condyle {
namespace {

/// An expression ends what its sides show; an action unit does not.
void end_others(std::vector<ExpressionLevel>& levels, const FaceChange& change) {
  const NamedExpression* expression = find_expression(change.expression);
  if (expression && expression->action_unit()) return;
  for (ExpressionLevel& level : levels) {
    if (change.left) level.left = 0;
    if (change.right) level.right = 0;
  }
}

void begin(std::vector<ExpressionLevel>& levels, const FaceChange& change) {
  if (change.expression.empty()) return;
  auto found = std::find_if(levels.begin(), levels.end(),
                            [&](const auto& level) { return level.name == change.expression; });
  if (found == levels.end()) found = levels.insert(found, {.name = change.expression});
  // A blink does not open lids that are held further closed.
  const auto level_after = [&](double level) {
    return change.momentary ? std::max(level, change.strength) : change.strength;
  };
  if (change.left) found->left = level_after(found->left);
  if (change.right) found->right = level_after(found->right);
}

bool excites(const std::vector<ExpressionLevel>& levels) {
  return std::any_of(levels.begin(), levels.end(),
                     [](const auto& level) { return level.left > 0 || level.right > 0; });
}

}  // namespace

void FaceMovements::add(const Statement& statement, double start_s) {
  constexpr double closing_s = 0.1, closed_s = 0.04, opening_s = 0.17;
  std::vector<ExpressionLevel> levels = keys_.back().levels;
  if (!statement.face.empty() && statement.face.front().momentary) {
    begin(levels, statement.face.front());
    const std::vector<ExpressionLevel> before = keys_.back().levels;
    if (start_s > end_s()) keys_.push_back({start_s, before});
    keys_.push_back({start_s + closing_s, levels});
    keys_.push_back({start_s + closing_s + closed_s, levels});
    keys_.push_back({start_s + closing_s + closed_s + opening_s, before});
    return;
  }
  if (statement.verb == Verb::rest && statement.face.empty()) end_others(levels, {});
  for (const FaceChange& change : statement.face) end_others(levels, change);
  for (const FaceChange& change : statement.face) begin(levels, change);
  if (levels == keys_.back().levels) return;
  const double duration_s = statement.face_duration_s.value_or(
      statement.verb == Verb::rest && statement.duration_s ? *statement.duration_s
      : excites(levels)                                    ? expression_onset_s
                                                           : expression_release_s);
  if (start_s > end_s()) keys_.push_back({start_s, keys_.back().levels});
  keys_.push_back({start_s + duration_s, std::move(levels)});
}

void FaceMovements::finish(Motion& motion, const Case& patient) const {
  if (keys_.size() == 1) return;
  if (const std::string mark = missing_face_landmark(patient); !mark.empty())
    throw InputError(motion.name +
                     ": the patient has no muscles of the face for its expressions: the landmark " +
                     mark + " is missing");
  const Expression made = expression_through(motion.name, keys_, muscles_of_face(patient));
  motion.expression = made.at;
  motion.notes.insert(motion.notes.end(), made.notes.begin(), made.notes.end());
}

}  // namespace condyle
