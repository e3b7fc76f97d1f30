#pragma once

#include <string>
#include <vector>

#include "sim/operation/operation.h"

namespace condyle {

/// Takes a segment with its teeth, gums, canals and rules from the patient into
/// `operated.resections`. A segment that does not exist is a problem.
void resect_segment(Operated& operated, const PlanStep& step);

/// Adds the pieces of a graft to the patient: the first hangs on the bone at the first face of the
/// defect, the others on the first. They may touch each other and that bone. What cannot be laid is
/// a problem.
void place_graft(Operated& operated, const Plan& plan, const PlanStep& step);

/// A face of a graft against the bone beside it.
struct GraftFaceReport {
  enum class Level { good, wide, very_wide, open };
  std::string piece = {}, other = {};  // names of bodies; other: of the bone, or of the next piece
  int face = 0;                        // of the piece: 0 its first, 1 its last
  FaceContact contact = {};
  double share = 0;  // of the smaller face that is in contact
  Level level = Level::good;
};

/// All faces of a graft at the planned positions, from first to last.
std::vector<GraftFaceReport> graft_faces(const Operated& operated, const GraftLayout& graft);

/// Bone and teeth that a graft overlaps at the planned positions by at least 0.1 mm: "fibula_1 and
/// mandible overlap by 0.4 mm".
std::vector<std::string> graft_overlaps(const Operated& operated, const GraftLayout& graft);

/// "resected: tumour, 19.3 cm³, with teeth 31, 32".
std::string resection_sentence(const Resection& resection);

/// A graft in sentences: pieces with lengths and saw cuts, faces, warnings.
std::vector<std::string> graft_sentences(const Operated& operated, const GraftLayout& graft);

}  // namespace condyle
