#pragma once

#include <string>
#include <vector>

#include "sim/report/clearance.h"

namespace condyle {

/// Indices of all pairs, worst first: violated ones by what the motion does, then by what is wrong
/// at rest, then the others, nearest first.
std::vector<std::size_t> worst_first(const ClearanceCheck& check);

/// Indices of the pairs worth a picture, worst first: the violated ones, or all when none is.
std::vector<std::size_t> pairs_to_show(const ClearanceCheck& check, std::size_t most = 6);

/// The verdict in one sentence.
std::string summary_words(const ClearanceCheck& check);

/// What a pair did at its worst moment, in one sentence.
std::string worst_caption(const PairVerdict& pair);

/// Where distance has no sign, in one sentence; empty when both are closed.
std::string open_surface_words(const PairVerdict& pair);

/// How a part is moved out of another that it overlaps at rest, in one sentence.
std::string push_out_words(const PairVerdict& pair);

/// Clearance of each pair against opening (against time where the mouth hardly opens), the margin
/// as a line: opening drawn through, closing dashed, cut off above 12 mm. The worst eight pairs.
/// SVG text.
std::string clearance_svg(const ClearanceCheck& check);

/// The same of the coronoid processes; empty when none can be told.
std::string coronoid_svg(const ClearanceCheck& check);

/// Which teeth touch for how much of the motion, as a chart of the teeth. SVG text; empty without
/// separate teeth.
std::string teeth_svg(const ClearanceCheck& check);

/// A pair at its worst moment, ready to be drawn. Bones and teeth at rest in the cranium's frame;
/// the two of the pair have small triangles about the place of contact.
struct WorstView {
  std::vector<Part> parts;
  std::vector<float> distance_a, distance_b;  // of their vertices to the other, mm
};
WorstView worst_view(const Scene& scene, const PairVerdict& pair, int threads);

struct CheckPage {
  std::string patient, motion;
  std::vector<std::string> pictures;  // file of each pair's picture beside the page, or empty
  std::vector<std::string> notes;
};

/// One page for people, HTML without scripts; only the pictures are files of their own.
std::string check_page(const ClearanceCheck& check, const CheckPage& page);

}  // namespace condyle
