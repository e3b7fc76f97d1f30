#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/osteotomy/danger_zones.h"
#include "sim/plan/movement_table.h"
#include "sim/plan/plan.h"

namespace condyle {

/// A bone that a cut made: a segment, or what stays with the body that was cut.
struct CutPiece {
  std::string body;  // its name in the tree
  std::string part;
  double volume_mm3 = 0;
  int pieces = 1;   // separate ones
  int slivers = 0;  // of these, with less than sliver_mm3
  bool stays = false;
};

/// What a cut step did to its bone.
struct CutReport {
  int step = 0;       // its id in the plan
  std::string title;  // "cut le_fort_1"
  std::string bone;   // part that was cut
  std::vector<std::string> cuts;
  std::vector<CutOutcome> outcomes;            // by cut
  std::vector<std::pair<int, int>> crossings;  // cuts whose walls cross in the bone
  std::vector<CutPiece> pieces;                // what stays comes first
  std::vector<DangerFinding> dangers;          // zones near the cut faces, nearest first
  double volume_mm3 = 0;                       // of the bone before it
  double kerf_volume_mm3 = 0;
  int turned = 0;              // triangles of cut faces that face backward
  bool below_margins = false;  // allowed by the step
  std::vector<std::string> notes;

  /// Whether the cut comes nearer to a root, canal or foramen than the least margin.
  bool is_dangerous() const;
  /// Deviation of the pieces and the kerf from the bone, in percent of it.
  double volume_error_percent() const;
};

/// Where the surface of a cut bone comes from.
struct SurfaceOrigin {
  std::string part;           // of the uncut case
  std::vector<int> triangle;  // of that part, by face; -1 on cut faces and closed holes
  std::vector<int> made_by;   // id of the step that made a cut face; 0 on the bone's surface
};

/// Bodies that a muscle connects.
struct MuscleOwners {
  BodyId origin = cranium_body, insertion = cranium_body;
};

/// A patient with the cuts and moves of a plan.
struct Operated {
  Case patient;            // with segments and their bodies, all at the uncut rest
  BodyPoses poses;         // planned, from the uncut rest
  std::vector<Pose> X_PB;  // the same in the parents' frames, see placed()
  std::vector<CutReport> cuts;
  LandmarkOwners owners;                        // after the cuts
  std::vector<MuscleOwners> muscles;            // of the patient's muscles, in their order
  std::map<std::string, SurfaceOrigin> origin;  // by part, of bones that a cut changed
  std::vector<std::string> notes;
  std::vector<std::string> problems;  // steps that could not be done, for people
};

/// Replays a plan: each cut in order on what the cuts before it left, then of each segment the last
/// move. Teeth, gums, canals and smaller bodies go with the piece that holds most of them. The
/// empty plan returns the same case. A segment that a cut does not part is listed in `problems`, as
/// are the steps that need it.
/// throws: InputError for a plan of another case, what check_plan() and place_osteotomy() refuse,
/// bone that cannot be closed, and a tooth that a cut divides.
Operated apply_plan(const Case& patient, const Plan& plan);

/// The two halves of it. The cuts alone, with all bodies at rest; the plan is checked as a whole.
/// throws: InputError as apply_plan().
Operated apply_cuts(const Case& patient, const Plan& plan);
/// What apply_cuts() returned, with the bodies moved by a plan for which
/// have_same_cuts() holds.
/// throws: InputError as apply_plan().
Operated with_moves(Operated cuts, const Plan& plan);
/// Whether plans differ in moves, notes and the head's reference only.
bool have_same_cuts(const Plan& a, const Plan& b);

/// X_CS of a segment of an operated patient by a move. throws: InputError as apply_plan().
Pose planned_pose(const Operated& operated, const Plan& plan, const MoveStep& step);

/// The point at rest about which a move turns a segment. throws: InputError as apply_plan().
Eigen::Vector3d rotation_point(const Operated& operated, const std::string& segment,
                               const ClinicalMove& move);

/// The patient after the operation: surfaces, landmarks, canals and muscles at their planned
/// positions, which are its new rest. The face is as before.
Case operated_case(const Operated& operated);

}  // namespace condyle
