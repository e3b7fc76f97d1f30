#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/case/case.h"
#include "sim/frame/body_poses.h"
#include "sim/graft/face_contact.h"
#include "sim/graft/graft.h"
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
  std::vector<DangerFinding> dangers;  // of zones that remain, near the cut faces, nearest first
  double volume_mm3 = 0;               // of the bone before it
  double kerf_volume_mm3 = 0;
  int turned = 0;              // triangles of cut faces that face backward
  bool below_margins = false;  // allowed by the step
  std::vector<std::string> notes;
  std::vector<std::string> rooms;  // between the teeth of interdental cuts

  /// Whether the cut comes nearer to a root, canal or foramen than the least margin.
  bool is_dangerous() const;
  /// Whether the cut is dangerous, or does not go through though it should.
  bool needs_attention() const;
  /// Deviation of the pieces and the kerf from the bone, in percent of it.
  double volume_error_percent() const;
};

/// What a trim step removed from its segment.
struct TrimReport {
  int step = 0;         // its id in the plan
  std::string title;    // "trim distal"
  std::string segment;  // body
  std::string part;     // the bone that was trimmed
  struct Share {
    std::string of;         // the segment that keeps its bone
    double volume_mm3 = 0;  // removed beyond its cut faces
  };
  std::vector<Share> shares;
  double fragments_mm3 = 0;  // of pieces below sliver_mm3 that it set loose, removed too
  int fragments = 0;
  double before_mm3 = 0, after_mm3 = 0;  // volume of the bone
  int pieces = 1;                        // separate ones that remain
  std::vector<DangerFinding> dangers;    // as those of cuts
  bool below_margins = false;            // allowed by the step
  std::vector<std::string> notes;

  double removed_mm3() const;
  bool is_dangerous() const;
  /// Deviation of what remains and was removed from the bone before it, in percent.
  double volume_error_percent() const;
};

/// A saw cut that was made, in the cranium's frame at rest.
struct SawCut {
  int step = 0;
  Cut cut;
};

/// Where the surface of a cut bone comes from.
struct SurfaceOrigin {
  std::string part;           // of the uncut case
  std::vector<int> triangle;  // of that part, by face; -1 on cut faces and closed holes
  std::vector<int> made_by;   // id of the step that made a cut or trimmed face; 0 on the surface
};

/// A segment that left the patient.
struct Resection {
  int step = 0;  // its id in the plan
  std::string segment = {};
  std::vector<Part> parts = {};  // bone, teeth and gums, at the uncut rest
  TriMesh bone = {};
  SurfaceOrigin origin = {};  // of the bone
  double volume_mm3 = 0;
  std::vector<int> teeth = {};  // FDI numbers
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
  std::vector<TrimReport> trims;
  std::vector<Resection> resections;
  std::vector<GraftLayout> grafts;
  std::vector<DangerZone> own_zones;                  // of the plan
  std::vector<SawCut> saw_cuts;                       // of all steps, in order
  std::map<std::string, std::vector<CutSide>> sides;  // by body, of the first saw cuts; others
                                                      // passed it by
  LandmarkOwners owners;                              // after the cuts
  std::set<std::string> resected_landmarks;           // nearer to resected bone or teeth
  std::vector<MuscleOwners> muscles;                  // of the patient's muscles, in their order
  std::map<std::string, SurfaceOrigin> origin;        // by part, of bones that a cut changed
  std::vector<std::string> notes;
  std::vector<std::string> problems;  // steps that could not be done, for people
};

/// Replays a plan: each cut and resection in order on what those before it left, then the grafts,
/// then of each segment the last move, then the trims. Teeth, gums, canals and smaller bodies go
/// with the piece that holds most of them. The empty plan returns the same case. A segment that a
/// cut does not part is listed in `problems`, as are the steps that need it. throws: InputError for
/// a plan of another case, what check_plan() and place_osteotomy() refuse, bone that cannot be
/// closed, and a tooth that a cut divides.
Operated apply_plan(const Case& patient, const Plan& plan);

/// The two halves of it. Cuts, resections and grafts alone, with all bodies at rest; the plan is
/// checked as a whole.
/// throws: InputError as apply_plan().
Operated apply_cuts(const Case& patient, const Plan& plan);
/// What apply_cuts() returned, moved and trimmed by a plan for which have_same_cuts() holds.
/// throws: InputError as apply_plan().
Operated with_moves(Operated cuts, const Plan& plan);
/// Whether plans differ in moves and notes only; false where one has trims, which follow the moves.
bool have_same_cuts(const Plan& a, const Plan& b);

/// X_CS of a segment of an operated patient by a move. throws: InputError as apply_plan().
Pose planned_pose(const Operated& operated, const Plan& plan, const MoveStep& step);

/// The point at rest about which a move turns a segment. throws: InputError as apply_plan().
Eigen::Vector3d rotation_point(const Operated& operated, const std::string& segment,
                               const ClinicalMove& move);

/// The landmarks at the planned positions, or at others from the uncut rest, without those of
/// resected bone and teeth.
Landmarks planned_landmarks(const Operated& operated);
Landmarks landmarks_at(const Operated& operated, const BodyPoses& poses);

/// The landmarks at the uncut rest, without those of resected bone and teeth.
Landmarks present_landmarks(const Operated& operated);

/// Removes findings of the patient's teeth and foramina that were resected; the plan's own zones
/// remain.
void drop_resected_zones(const Operated& operated, std::vector<DangerFinding>& findings);

/// Displacements by the plan, or at other positions, without landmarks of resected bone and teeth.
MovementTable planned_movements(const Operated& operated, const ClinicalFrame& frame);
MovementTable movements_at(const Operated& operated, const ClinicalFrame& frame,
                           const BodyPoses& poses);

/// The patient after the operation: surfaces, landmarks, canals and muscles at their planned
/// positions, which are its new rest. The face is as before. Landmarks of resected bone are absent,
/// except those by which a motion of the jaw is measured.
Case operated_case(const Operated& operated);

}  // namespace condyle
