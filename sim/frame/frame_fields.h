#pragma once

#include "sim/frame/frame_state.h"

namespace condyle {

// Visits every field of a frame's state once, in a fixed order: hashing, writing and reading a
// frame are visitors. A visitor takes a plain value, or a list of plain values, of numbers and
// Eigen vectors. Frame is FrameState or const FrameState, and so on. Measured times, the lids and
// the hash are excluded.

template <class Visitor, class P>
void visit_pose(P& pose, Visitor&& visit) {
  visit(pose.R.coeffs());
  visit(pose.t);
}

template <class Visitor, class List, class VisitItem>
void visit_list(List& list, Visitor&& visit, VisitItem&& item) {
  visit.size_of(list);
  for (auto& each : list) item(each);
}

template <class Visitor, class List>
void visit_poses(List& poses, Visitor&& visit) {
  visit_list(poses, visit, [&](auto& pose) { visit_pose(pose, visit); });
}

template <class Visitor, class Contact>
void visit_contact(Contact& pair, Visitor&& visit) {
  visit(pair.part_a);
  visit(pair.part_b);
  visit(pair.touching);
  visit_list(pair.contacts, visit, [&](auto& contact) {
    visit(contact.point);
    visit(contact.normal);
  });
  visit(pair.distance_mm);
  visit(pair.witness_a);
  visit(pair.witness_b);
  visit(pair.triangle_a);
  visit(pair.triangle_b);
  visit(pair.depth_mm);
  visit(pair.rest_depth_mm);
  visit(pair.policy);
  visit(pair.distance_is_bound);
}

template <class Visitor, class Tissue>
void visit_tissue(Tissue& tissue, Visitor&& visit) {
  visit.values(tissue.nodes);
  visit_poses(tissue.X_CB, visit);
  visit_list(tissue.excitation, visit, [&](auto& value) { visit(value); });
  visit(tissue.iterations);
  visit(tissue.evaluations);
  visit(tissue.converged);
  visit(tissue.reused);
  visit(tissue.energy);
  visit(tissue.residual);
  visit(tissue.inverted_prisms);
  visit(tissue.penetration_mm);
  visit(tissue.slip_mm);
  visit(tissue.contact_error_mm);
}

template <class Visitor, class M>
void visit_measures(M& measures, Visitor&& visit) {
  visit(measures.incisor);
  visit(measures.left_condyle);
  visit(measures.right_condyle);
  visit(measures.opening_mm);
  visit(measures.incisal_displacement_mm);
  visit(measures.interincisal_mm);
  visit(measures.rotation_deg);
  visit(measures.protrusion_mm);
  visit(measures.laterotrusion_mm);
  visit(measures.midline_deviation_mm);
  visit(measures.left_condyle_travel_mm);
  visit(measures.right_condyle_travel_mm);
  visit(measures.helical_axis.known);
  visit(measures.helical_axis.direction);
  visit(measures.helical_axis.point);
  visit(measures.helical_axis.slide_mm);
}

template <class Visitor, class Frame>
void visit_frame(Frame& frame, Visitor&& visit) {
  visit(frame.time_s);
  visit_poses(frame.X_PB_target, visit);
  visit_poses(frame.poses.X_CB, visit);
  visit(frame.stopped);
  visit_list(frame.contacts.pairs, visit, [&](auto& pair) { visit_contact(pair, visit); });
  visit_poses(frame.contacts.at.X_CB, visit);
  visit_list(frame.contacts.outside_rest_overlap, visit,
             [&](auto& pair) { visit_contact(pair, visit); });
  visit_tissue(frame.tissue, visit);
  visit_measures(frame.measures, visit);
  visit_list(frame.muscles, visit, [&](auto& muscle) {
    visit(muscle.excitation);
    visit(muscle.activation);
    visit(muscle.length_mm);
    visit(muscle.speed_mm_s);
    visit(muscle.force_N);
  });
  visit.values(frame.face);
}

}  // namespace condyle
