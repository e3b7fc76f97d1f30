#include "engine/dicom/slice_stack.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace condyle {
namespace {

constexpr double most_uneven = 0.01;    // of the step
constexpr double rounding_mm = 0.0101;  // of positions written with two decimals
constexpr double most_drift = 0.25;     // of the step, against an even grid
constexpr double least_tilt_degrees = 0.5;
constexpr double most_shift = 0.5;  // pixels
constexpr double same_position_mm = 1e-3;

/// The median of the steps between different positions; there is one.
double median_step(const std::vector<double>& steps) {
  std::vector<double> values;
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(values),
               [](double step) { return step > same_position_mm; });
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// "2 slices are missing between slices 12 and 13, at 30 and 37.5 mm".
std::string gap_words(const StackGeometry& stack, std::size_t i) {
  const double difference = stack.height_mm[i] - stack.height_mm[i - 1];
  const double whole = std::round(difference / stack.step_mm);
  const std::string place = fmt::format("between slices {} and {}, at {:.6g} and {:.6g} mm", i,
                                        i + 1, stack.height_mm[i - 1], stack.height_mm[i]);
  if (whole >= 2 && std::abs(difference - whole * stack.step_mm) <= 0.05 * stack.step_mm)
    return whole == 2 ? "a slice is missing " + place
                      : fmt::format("{:.0f} slices are missing {}", whole - 1, place);
  return fmt::format("the step is {:.4g} mm {}, where the median is {:.4g} mm", difference, place,
                     stack.step_mm);
}

void find_uneven(StackGeometry& stack, const std::vector<double>& steps) {
  const double tolerance = std::max(most_uneven * stack.step_mm, rounding_mm);
  int found = 0;
  double lowest = stack.step_mm, highest = stack.step_mm;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    lowest = std::min(lowest, steps[i]);
    highest = std::max(highest, steps[i]);
    if (std::abs(steps[i] - stack.step_mm) <= tolerance) continue;
    if (found++ == 0) stack.uneven = gap_words(stack, i + 1);
  }
  if (found > 1)
    stack.uneven = fmt::format(
        "the slices are uneven at {} places, with steps from {:.4g} to {:.4g} "
        "mm; the first: {}",
        found, lowest, highest, stack.uneven);
  if (found > 0) return;
  const double even = stack.height_mm.back() / static_cast<double>(steps.size());
  for (std::size_t i = 0; i < stack.height_mm.size(); ++i)
    if (std::abs(stack.height_mm[i] - even * static_cast<double>(i)) > most_drift * even) {
      stack.uneven =
          fmt::format("the steps change from {:.4g} to {:.4g} mm along the stack", lowest, highest);
      return;
    }
}

}  // namespace

StackGeometry stack_geometry(const std::vector<SliceHeader>& slices) {
  StackGeometry stack;
  if (slices.empty() || !slices.front().position || !slices.front().problem.empty()) return stack;
  const SliceHeader& first = slices.front();
  stack.normal = first.along_row.cross(first.along_column).normalized();
  std::vector<double> steps;
  double largest_shift = 0;
  for (const SliceHeader& slice : slices) {
    const Eigen::Vector3d from_first = slice.position.value_or(*first.position) - *first.position;
    stack.height_mm.push_back(stack.normal.dot(from_first));
    stack.shift_mm.emplace_back(first.along_row.dot(from_first),
                                first.along_column.dot(from_first));
    largest_shift =
        std::max({largest_shift, std::abs(stack.shift_mm.back().x()) / first.column_spacing_mm,
                  std::abs(stack.shift_mm.back().y()) / first.row_spacing_mm});
    if (stack.height_mm.size() > 1)
      steps.push_back(stack.height_mm.back() - stack.height_mm[stack.height_mm.size() - 2]);
  }
  if (std::none_of(steps.begin(), steps.end(), [](double step) { return step > same_position_mm; }))
    return stack;
  stack.step_mm = median_step(steps);
  stack.tilt_degrees =
      std::atan2(stack.shift_mm.back().norm(), stack.height_mm.back()) * 180 / std::numbers::pi;
  stack.sheared = stack.tilt_degrees > least_tilt_degrees || largest_shift > most_shift;
  find_uneven(stack, steps);
  return stack;
}

}  // namespace condyle
