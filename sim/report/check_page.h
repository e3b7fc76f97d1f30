#pragma once

#include <string>
#include <vector>

#include "sim/report/clearance.h"

namespace condyle {

/// Clearance of each pair against opening (against time where the mouth hardly opens), the margin
/// as a line: opening drawn through, closing dashed, cut off above 12 mm. SVG text.
std::string clearance_svg(const ClearanceCheck& check, double margin_mm);

/// What a pair did at its worst frame, in one sentence.
std::string worst_caption(const ClearanceCheck& check, const PairVerdict& pair);

/// Where distance has no sign, in one sentence; empty when both are closed.
std::string open_surface_words(const PairVerdict& pair);

/// A pair at its worst frame, ready to be drawn. Bones and teeth at rest in the cranium's frame;
/// the two of the pair have small triangles about the place of contact.
struct WorstView {
  std::vector<Part> parts;
  std::vector<float> distance_a, distance_b;  // of their vertices to the other, mm; see close look
};
WorstView worst_view(const Scene& scene, const PairVerdict& pair, int threads);

/// Indices of the pairs worth a picture, worst first: the violated ones, or all when none is.
std::vector<std::size_t> pairs_to_show(const ClearanceCheck& check, std::size_t most = 4);

struct CheckPage {
  std::string patient, motion;
  double margin_mm = 0;
  std::vector<std::string> pictures;  // file of each pair's picture beside the page, or empty
  std::vector<std::string> notes;
};

/// One page for people, HTML without scripts; only the pictures are files of their own.
std::string check_page(const ClearanceCheck& check, const CheckPage& page);

}  // namespace condyle
