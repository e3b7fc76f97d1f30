#pragma once

#include "engine/core/archive.h"
#include "sim/tissue/model.h"

namespace condyle {

// The plan of a model, and what a built model holds, without what follows from it and from the
// patient: muscles, factors, SIMD batches, surfaces and the face at rest.

template <>
struct IsFlat<CarriedPoint> : std::true_type {
  static_assert(sizeof(CarriedPoint) == 2 * CarriedPoint::capacity * 4 + 4);
};

template <class Archive>
void fields(Archive& archive, TissueLayer& layer) {
  archive(layer.fraction, layer.modulus_MPa, layer.poisson, layer.mass_kg);
}

template <class Archive>
void fields(Archive& archive, AttachmentRegion& region) {
  archive(region.bone, region.attached, region.landmark, region.centre, region.radius_mm);
}

template <class Archive>
void fields(Archive& archive, TissuePlan& plan) {
  archive(plan.layer_count, plan.layers, plan.turgor, plan.lambda, plan.down, plan.bond,
          plan.attachments);
}

template <class Archive>
void fields(Archive& archive, SpringPrismMesh& mesh) {
  archive(mesh.node_count, mesh.spring_a, mesh.spring_b, mesh.rest_length, mesh.stiffness,
          mesh.anchor_node, mesh.anchor_stiffness, mesh.prisms, mesh.rest_volume,
          mesh.volume_weight, mesh.may_touch, mesh.compression_ratio, mesh.lambda,
          mesh.barrier_fraction, mesh.barrier_weight, mesh.spring_layer, mesh.spring_sheet,
          mesh.node_mass_kg);
}

template <class Archive>
void fields(Archive& archive, TissueMesh& mesh) {
  archive(mesh.columns, mesh.sheets, mesh.cut_from, mesh.triangles, mesh.rest, mesh.elements);
}

template <class Archive>
void fields(Archive& archive, BodyWeight& weight) {
  archive(weight.body, weight.weight);
}

template <class Archive>
void fields(Archive& archive, TissueSupport& support) {
  archive(support.anchor, support.kind, support.anchor_offset, support.node, support.node_force,
          support.held_force);
}

template <class Archive>
void fields(Archive& archive, MeshPoint& point) {
  archive(point.node, point.weight, point.count);
}

template <class Archive>
void fields(Archive& archive, Flap& flap) {
  archive(flap.points, flap.allowance);
}

template <class Archive>
void fields(Archive& archive, TissueContact::Lip& lip) {
  fields(archive, static_cast<Flap&>(lip));
  archive(lip.body, lip.edge, lip.facing);
}

template <class Archive>
void fields(Archive& archive, Obstacle& obstacle) {
  archive(obstacle.body, obstacle.extent.low, obstacle.extent.high, obstacle.shift,
          obstacle.allowance, obstacle.near_at_rest, obstacle.front_guided);
}

template <class Archive>
void fields(Archive& archive, TissueContact& contact) {
  archive(contact.points, contact.obstacles, contact.front, contact.lower_lip, contact.upper,
          contact.lower, contact.fold.chin, contact.fold.throat, contact.lip_points_left_out,
          contact.firmness);
}

template <class Archive>
void fields(Archive& archive, OpeningPath& path) {
  archive(path.condyles, path.step_rad, path.nodes);
}

template <class Archive>
void fields(Archive& archive, FaceDisplay& display) {
  Anatomy& anatomy = display.region.anatomy;
  HandleSet& handles = display.handles;
  archive(anatomy.condyles, anatomy.incisors, anatomy.mandible_low, anatomy.mandible_back,
          display.region.floor_z, display.region.upper_face, display.region.forehead_z,
          display.fissure, display.corner_reach_mm, handles.node, handles.first_neighbour,
          handles.neighbour, handles.inverse_spread, handles.ring, display.handle_evened,
          display.handle_side, display.carried_vertex, display.carried, display.carried_from,
          display.face_side);
}

template <class Archive>
void fields(Archive& archive, TissueSummary& summary) {
  archive(summary.nodes, summary.springs, summary.prisms, summary.layers,
          summary.attached_to_cranium, summary.attached_to_mandible, summary.boundary,
          summary.lips_cut, summary.lip_points_left_out, summary.rest_overlap_mm,
          summary.rest_force_N, summary.rest_move_mm, summary.notes);
}

}  // namespace condyle
