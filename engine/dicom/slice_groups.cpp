#include "engine/dicom/slice_groups.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/dicom/slice_pixels.h"

namespace condyle {
namespace {

constexpr double equal_direction = 1e-4;  // difference of cosines
constexpr double equal_spacing = 1e-4;    // relative
constexpr double equal_height_mm = 1e-3;

/// Numbers of the files of a group, which are in the order of their names.
using Members = std::vector<SliceHeader>;

Eigen::Vector3d normal_of(const SliceHeader& slice) {
  return slice.along_row.cross(slice.along_column);
}

bool have_equal_directions(const SliceHeader& a, const SliceHeader& b) {
  return (a.along_row - b.along_row).cwiseAbs().maxCoeff() <= equal_direction &&
         (a.along_column - b.along_column).cwiseAbs().maxCoeff() <= equal_direction;
}

bool have_equal_layout(const SliceHeader& a, const SliceHeader& b) {
  const auto close = [](double x, double y) { return std::abs(x - y) <= equal_spacing * x; };
  return a.pixels.rows == b.pixels.rows && a.pixels.columns == b.pixels.columns &&
         close(a.row_spacing_mm, b.row_spacing_mm) &&
         close(a.column_spacing_mm, b.column_spacing_mm) && have_equal_directions(a, b);
}

auto stem_of(const SliceHeader& slice) {
  return std::tie(slice.series, slice.study, slice.patient, slice.frame_of_reference,
                  slice.kernel_text, slice.modality, slice.is_scout, slice.pixels.samples);
}

/// Adds the slice to the first list whose first slice is alike, or to a new one.
template <class Alike>
void add_to_alike(std::vector<Members>& lists, const SliceHeader& slice, const Alike& alike) {
  const auto found = std::find_if(lists.begin(), lists.end(),
                                  [&](const Members& list) { return alike(list.front(), slice); });
  if (found == lists.end())
    lists.push_back({slice});
  else
    found->push_back(slice);
}

void sort_by_height(Members& slices) {
  if (slices.empty()) return;
  const Eigen::Vector3d normal = normal_of(slices.front());
  std::stable_sort(slices.begin(), slices.end(), [&](const SliceHeader& a, const SliceHeader& b) {
    return height_along(a, normal) < height_along(b, normal);
  });
}

/// Whether a slice of another size lies where the stack has none: within it or next to its ends.
bool fills_a_gap(const SliceHeader& odd, const Members& stack) {
  const Eigen::Vector3d normal = normal_of(stack.front());
  std::vector<double> heights;
  for (const SliceHeader& slice : stack) heights.push_back(height_along(slice, normal));
  std::sort(heights.begin(), heights.end());
  std::vector<double> steps;
  for (std::size_t i = 1; i < heights.size(); ++i) steps.push_back(heights[i] - heights[i - 1]);
  if (steps.empty()) return true;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  const double step = steps[steps.size() / 2], height = height_along(odd, normal);
  if (height < heights.front() - 1.5 * step || height > heights.back() + 1.5 * step) return false;
  return std::none_of(heights.begin(), heights.end(),
                      [&](double each) { return std::abs(each - height) < 0.5 * step; });
}

/// Moves slices of another size that belong into the largest stack to the bad ones.
void take_odd_slices(std::vector<Members>& stacks, std::size_t largest, Members& bad) {
  const Members& main = stacks[largest];
  for (std::size_t i = 0; i < stacks.size(); ++i) {
    Members& other = stacks[i];
    if (i == largest || 2 * other.size() >= main.size() ||
        !have_equal_directions(other.front(), main.front()) ||
        !std::all_of(other.begin(), other.end(),
                     [&](const SliceHeader& slice) { return fills_a_gap(slice, main); }))
      continue;
    for (SliceHeader& slice : other) {
      slice.problem =
          fmt::format("has {} x {} pixels of {:g} x {:g} mm, the others {} x {} of {:g} x {:g} mm",
                      slice.pixels.columns, slice.pixels.rows, slice.column_spacing_mm,
                      slice.row_spacing_mm, main.front().pixels.columns, main.front().pixels.rows,
                      main.front().column_spacing_mm, main.front().row_spacing_mm);
      bad.push_back(slice);
    }
    other.clear();
  }
}

/// Numbers the files by their names and names the bad ones.
void report_bad(Members& stack, const Members& bad, SliceGroup& group) {
  constexpr std::size_t most_named = 4;
  Members all = stack;
  all.insert(all.end(), bad.begin(), bad.end());
  const auto by_name = [](const SliceHeader& a, const SliceHeader& b) { return a.place < b.place; };
  std::sort(all.begin(), all.end(), by_name);
  for (SliceHeader& slice : stack)
    slice.number =
        static_cast<int>(std::lower_bound(all.begin(), all.end(), slice, by_name) - all.begin()) +
        1;
  std::size_t named = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!all[i].problem.empty() && named++ < most_named)
      group.problems.push_back(fmt::format("file {} of {} {}", i + 1, all.size(), all[i].problem));
  if (named > most_named)
    group.problems.push_back(fmt::format("so have {} more files", named - most_named));
}

/// Drops files that are there twice. Returns how many.
std::size_t drop_doubled(Members& sorted, const Eigen::Vector3d& normal) {
  Members kept;
  for (const SliceHeader& slice : sorted) {
    bool doubled = false;
    for (auto other = kept.rbegin(); other != kept.rend() && !doubled; ++other) {
      if (height_along(slice, normal) - height_along(*other, normal) > equal_height_mm) break;
      if (slice.instance != other->instance) continue;
      try {
        doubled = have_equal_pixels(slice, *other);
      } catch (const DicomDamage&) {
        doubled = false;
      }
    }
    if (!doubled) kept.push_back(slice);
  }
  const std::size_t dropped = sorted.size() - kept.size();
  sorted = std::move(kept);
  return dropped;
}

/// The first slice that lies where the one before it lies; the number of slices if there is none.
std::size_t first_at_one_position(const Members& sorted) {
  const Eigen::Vector3d normal = normal_of(sorted.front());
  std::size_t i = 1;
  while (i < sorted.size() &&
         height_along(sorted[i], normal) - height_along(sorted[i - 1], normal) > equal_height_mm)
    ++i;
  return i;
}

bool are_at_one_position(const Members& sorted) {
  const Eigen::Vector3d normal = normal_of(sorted.front());
  return height_along(sorted.back(), normal) - height_along(sorted.front(), normal) <=
         equal_height_mm;
}

/// The groups of a stack without bad files: one, or several where two slices lie at one position.
void add_stack(SliceGroup group, std::vector<SliceGroup>& groups) {
  Members& slices = group.slices;
  sort_by_height(slices);
  if (slices.size() < 2 || are_at_one_position(slices)) {
    groups.push_back(std::move(group));
    return;
  }
  if (const std::size_t dropped = drop_doubled(slices, normal_of(slices.front())); dropped > 0)
    group.notes.push_back(
        fmt::format("{} doubled file{} left out", dropped, dropped == 1 ? " was" : "s were"));
  const std::size_t at = first_at_one_position(slices);
  if (at == slices.size()) {
    groups.push_back(std::move(group));
    return;
  }
  std::vector<Members> parts;
  for (const SliceHeader& slice : slices)
    add_to_alike(parts, slice, [](const SliceHeader& a, const SliceHeader& b) {
      return a.image_type == b.image_type && a.acquisition == b.acquisition;
    });
  const bool parted = std::all_of(parts.begin(), parts.end(), [](const Members& part) {
    return part.size() > 1 && first_at_one_position(part) == part.size();
  });
  if (!parted) {
    group.problems.push_back(fmt::format("files {} and {} are different slices at one position",
                                         std::min(slices[at - 1].number, slices[at].number),
                                         std::max(slices[at - 1].number, slices[at].number)));
    groups.push_back(std::move(group));
    return;
  }
  for (Members& part : parts) {
    SliceGroup one{std::move(part), group.notes, group.problems};
    one.notes.push_back("separated by image type or acquisition from slices at the same positions");
    groups.push_back(std::move(one));
  }
}

void add_groups_of_stem(const Members& stem, std::vector<SliceGroup>& groups) {
  std::vector<Members> stacks;
  Members bad;
  for (const SliceHeader& slice : stem)
    if (slice.problem.empty())
      add_to_alike(stacks, slice, have_equal_layout);
    else
      bad.push_back(slice);
  if (stacks.empty()) {
    SliceGroup group;
    Members none;
    report_bad(none, bad, group);
    group.slices = bad;
    groups.push_back(std::move(group));
    return;
  }
  const auto largest = static_cast<std::size_t>(
      std::max_element(stacks.begin(), stacks.end(),
                       [](const Members& a, const Members& b) { return a.size() < b.size(); }) -
      stacks.begin());
  take_odd_slices(stacks, largest, bad);
  for (std::size_t i = 0; i < stacks.size(); ++i) {
    if (stacks[i].empty()) continue;
    SliceGroup group;
    report_bad(stacks[i], i == largest ? bad : Members{}, group);
    group.slices = std::move(stacks[i]);
    add_stack(std::move(group), groups);
  }
}

}  // namespace

double height_along(const SliceHeader& slice, const Eigen::Vector3d& normal) {
  return slice.position ? slice.position->dot(normal) : 0;
}

std::vector<SliceGroup> group_slices(std::vector<SliceHeader> slices) {
  std::vector<Members> stems;
  for (const SliceHeader& slice : slices)
    add_to_alike(stems, slice, [](const SliceHeader& a, const SliceHeader& b) {
      return stem_of(a) == stem_of(b);
    });
  std::vector<SliceGroup> groups;
  for (const Members& stem : stems) add_groups_of_stem(stem, groups);
  std::stable_sort(groups.begin(), groups.end(), [](const SliceGroup& a, const SliceGroup& b) {
    return a.slices.front().series_number < b.slices.front().series_number;
  });
  return groups;
}

}  // namespace condyle
