#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/report/clearance.h"
#include "sim/report/operation_comparison.h"

namespace condyle {

/// Indices of all pairs, worst first: rules broken by the motion, then rules broken at rest, then
/// the other pairs by increasing distance.
std::vector<std::size_t> worst_first(const ClearanceCheck& check);

/// Indices of the pairs to be drawn, worst first: the violated ones, or all pairs when none is.
std::vector<std::size_t> pairs_to_show(const ClearanceCheck& check, std::size_t most = 6);

/// The verdict in one sentence.
std::string summary_text(const ClearanceCheck& check);

/// Describes a pair at its worst moment in one sentence.
std::string worst_caption(const PairVerdict& pair);
/// Its parts: opening, rotation and time; side and regions.
std::string worst_moment(const PairVerdict& pair);
std::string worst_place(const PairVerdict& pair);

/// Says in one sentence where distance has no sign; empty when both surfaces are closed.
std::string open_surface_text(const PairVerdict& pair);

/// Says in one sentence how to separate a part from another that it overlaps at rest.
std::string push_out_text(const PairVerdict& pair);

/// Clearance of each pair against opening (against time where the mouth hardly opens), the margin
/// as a line: opening solid, closing dashed, clipped above 12 mm. The worst eight pairs.
/// SVG text.
std::string clearance_svg(const ClearanceCheck& check);

/// The same plot for the coronoid processes; empty when neither can be measured.
std::string coronoid_svg(const ClearanceCheck& check);

/// Chart of the teeth coloured by the fraction of the motion in which each touches. SVG text; empty
/// without separate teeth.
std::string teeth_svg(const ClearanceCheck& check);

/// A pair at its worst moment, prepared for drawing. Bones and teeth at rest in the cranium's
/// frame; the two surfaces of the pair are refined around the contact.
struct WorstView {
  std::vector<Part> parts;
  std::vector<float> distance_a, distance_b;  // from their vertices to the other part, mm
};
WorstView worst_view(const Scene& scene, const PairVerdict& pair, int threads);

struct CheckPage {
  std::string patient, motion;
  std::vector<std::string> pictures;  // file of each pair's picture beside the page, or empty
  std::vector<std::string> notes;
  std::string program = {};                // name and version
  std::string date = {};                   // of the check, UTC
  std::vector<std::string> surfaces = {};  // "mandible 1f0c...": each part, hash of its surface
  std::optional<OperationComparison> comparison = {};  // with the patient before an operation
};

/// One HTML page without scripts; only the pictures are separate files.
std::string check_page(const ClearanceCheck& check, const CheckPage& page);

}  // namespace condyle
