#include "sim/tissue/placement.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double thin_mm = 0.5;     // skin nearer to bone than this has no tissue below it
constexpr double outward_mm = 120;  // through a whole skull
constexpr double most_of = 0.5, few_of = 0.1;

std::string percent(double fraction) {
  return std::to_string(static_cast<int>(std::lround(100 * fraction))) + " %";
}

}  // namespace

void check_placement(const CoarseSkin& skin, const Bones& bones, const std::vector<Column>& columns,
                     const ColumnSettings& settings, std::vector<std::string>& notes) {
  if (bones.cranium.empty() && bones.mandible.empty())
    throw InputError("face: there is no bone that soft tissue could be attached to");
  const double count = static_cast<double>(columns.size());
  int met = 0, thin = 0, behind = 0, overlapping = 0;
  double nearest = 1e9;
  for (std::size_t v = 0; v < columns.size(); ++v) {
    const Column& column = columns[v];
    const Vector3d& p = skin.mesh.vertices[v];
    for (const auto* bone : {&bones.cranium, &bones.mandible}) {
      if (bone->empty()) continue;
      nearest = std::min(nearest, bone->nearest(p).distance);
      if (bone->ray_cast(p - thin_mm * column.inward, -column.inward, outward_mm)) {
        ++behind;
        break;
      }
    }
    if (!column.support) continue;
    ++met;
    thin += column.met_depth < thin_mm;
    overlapping += column.met_depth < column.depth - thin_mm;
  }
  if (met > 0 && thin > most_of * met)
    throw InputError("face: " + percent(static_cast<double>(thin) / met) +
                     " of the skin lies on the bone (below " +
                     std::to_string(thin_mm).substr(0, 3) +
                     " mm), so the soft tissue has no thickness; is the face a bone's surface?");
  if (behind > most_of * count || (behind > few_of * count && behind > met))
    throw InputError(
        "face: " + percent(behind / count) +
        " of the skin around the jaw has bone outside it, so the face lies inside the "
        "skull, or its triangles are turned inside out; check that face and bones have "
        "the same unit and frame, and the direction of the face's triangles");
  if (met == 0)
    throw InputError(
        "face: no bone lies within " + std::to_string(std::lround(settings.march_mm)) +
        " mm below the skin (the nearest is " + std::to_string(std::lround(nearest)) +
        " mm away); check that face and bones are of the same patient, unit and frame");
  if (overlapping > 0)
    notes.push_back(std::to_string(overlapping) + " of " + std::to_string(columns.size()) +
                    " tissue columns reach into bone at rest, since at least " +
                    std::to_string(std::lround(settings.min_depth_mm)) +
                    " mm of tissue are needed: this overlap is allowed, but not more");
  if (met < few_of * count)
    notes.push_back("only " + percent(met / count) +
                    " of the skin around the jaw has bone below it: little holds the tissue");
}

void check_attachment(int to_cranium, int to_mandible, const Bones& bones,
                      std::vector<std::string>& notes) {
  if (to_cranium + to_mandible == 0)
    throw InputError(
        "soft tissue: nothing is attached to bone; attach some (--attach, or \"attachments\" in "
        "case.json)");
  if (to_cranium == 0 && !bones.cranium.empty())
    notes.push_back("no tissue is attached to the cranium");
  if (to_mandible == 0 && !bones.mandible.empty())
    notes.push_back("no tissue is attached to the mandible: the chin will not follow it");
}

}  // namespace condyle
