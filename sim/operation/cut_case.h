#pragma once

#include "sim/operation/operation.h"
#include "sim/osteotomy/osteotomy.h"

namespace condyle {

/// What is divided with a bone.
enum class CutScope {
  all,  // teeth, gums, canals, smaller bodies and the rules of pairs
  bone  // nothing: for a preview
};

/// Cuts the bone of a placed osteotomy: its part becomes what stays with its body and the segments,
/// each on a body of its own with the cut body as parent. Teeth, gums, canals and smaller bodies go
/// with the piece that holds most of them; rules of the bone hold for all of its pieces, and pieces
/// may touch each other. Extends `operated.cuts` and `origin`, and changes `patient` alone besides.
/// throws: InputError for a bone that is missing or cannot be closed, a divided tooth, and names
/// that exist.
void cut_case(Operated& operated, const PlacedOsteotomy& placed, const PlanStep& step,
              CutScope scope = CutScope::all);

/// The names of the segments of a placed osteotomy in a step, by rule: those of the step, by
/// position, unless they are the rules' own.
std::vector<std::string> segment_names(const PlacedOsteotomy& placed, const CutStep& step);

}  // namespace condyle
