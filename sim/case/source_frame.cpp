#include "sim/case/source_frame.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "engine/core/error.h"

namespace condyle {
namespace {

struct Direction {
  char letter;
  int axis;  // of LPS
  double sign;
};
constexpr std::array<Direction, 6> directions = {
    {{'L', 0, 1}, {'R', 0, -1}, {'P', 1, 1}, {'A', 1, -1}, {'S', 2, 1}, {'I', 2, -1}}};

}  // namespace

double unit_mm(const std::string& units) {
  if (units == "mm") return 1;
  if (units == "cm") return 10;
  if (units == "m") return 1000;
  if (units == "in") return 25.4;
  throw InputError("--units \"" + units + "\" is unknown; mm, cm, m and in are known");
}

SourceFrame source_frame(const std::string& units, const std::string& frame) {
  SourceFrame result{.units = units, .axes = frame, .unit_mm = unit_mm(units)};
  result.axes_to_lps.setZero();
  for (char& c : result.axes) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::array<bool, 3> taken{};
  bool sound = frame.size() == 3;
  for (int k = 0; sound && k < 3; ++k) {
    const char letter = result.axes[static_cast<std::size_t>(k)];
    const auto found = std::find_if(directions.begin(), directions.end(),
                                    [&](const Direction& d) { return d.letter == letter; });
    sound = found != directions.end() && !taken[static_cast<std::size_t>(found->axis)];
    if (!sound) break;
    taken[static_cast<std::size_t>(found->axis)] = true;
    result.axes_to_lps(found->axis, k) = found->sign;
  }
  if (!sound)
    throw InputError(
        "--frame \"" + frame +
        "\" is no coordinate frame; give the directions of x, y and z with one letter each "
        "of L or R, A or P, S or I: LPS, RAS, LSA ...");
  return result;
}

const std::vector<std::string>& all_units() {
  static const std::vector<std::string> units = {"mm", "m", "cm", "in"};
  return units;
}

const std::vector<std::string>& all_frames() {
  static const auto frames = [] {
    // DICOM, Slicer and NIfTI, glTF (y up, facing z), then y up facing -z.
    std::vector<std::string> list = {"LPS", "RAS", "LSA", "RSP", "LAI", "RPI", "LIP", "RIA"};
    for (int order = 0; order < 6; ++order) {
      constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
      for (int signs = 0; signs < 8; ++signs) {
        std::string frame;
        for (const int axis : orders[order])
          frame += directions[static_cast<std::size_t>(2 * axis + ((signs >> axis) & 1))].letter;
        if (std::find(list.begin(), list.end(), frame) == list.end()) list.push_back(frame);
      }
    }
    return list;
  }();
  return frames;
}

}  // namespace condyle
