#include "sim/tissue/anatomy.h"

#include <algorithm>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TriMesh merged(const Case& patient, const auto& selects) {
  TriMesh all;
  for (const auto& part : patient.parts) {
    if (!selects(part)) continue;
    const int first = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
    for (const auto& t : part.mesh.triangles) all.triangles.emplace_back(t.array() + first);
  }
  return all;
}

}  // namespace

TriMesh jaw_mesh(const Case& patient, BodyId body) {
  return merged(patient,
                [body](const Part& part) { return collides(part.role) && part.body == body; });
}

Bones collect_bones(const Case& patient) {
  return {patient.jaw, TriangleTree(jaw_mesh(patient, patient.jaw.upper_arch)),
          TriangleTree(jaw_mesh(patient, patient.jaw.lower_arch)),
          TriangleTree(merged(patient, [](const Part& part) { return is_teeth(part.role); }))};
}

Anatomy read_anatomy(const Case& patient, std::vector<std::string>& notes) {
  Anatomy anatomy;
  const auto left = patient.landmarks.find("left_condyle");
  const auto right = patient.landmarks.find("right_condyle");
  const auto upper = patient.landmarks.find("upper_incisal_point");
  const auto lower = patient.landmarks.find("lower_incisal_point");

  Box box;  // of the mandible, or of the face when there is none
  for (const auto& part : patient.parts)
    if (part.body == patient.jaw.lower_arch && collides(part.role))
      box.add(bounding_box(part.mesh));
  if (box.empty()) box = bounding_box(patient.find(Role::face)->mesh);
  anatomy.mandible_low = box.low.z();
  anatomy.mandible_back = box.high.y();

  if (left && right) {
    anatomy.condyles = 0.5 * (*left + *right);
  } else {
    anatomy.condyles = Vector3d(box.center().x(), box.high.y() - 8, box.high.z() - 5);
    notes.push_back("condyle landmarks missing: taken from the top of the mandible's back edge");
  }
  if (upper && lower) {
    anatomy.incisors = 0.5 * (*upper + *lower);
  } else if (upper || lower) {
    anatomy.incisors = upper ? *upper : *lower;
  } else {
    anatomy.incisors =
        Vector3d(box.center().x(), box.low.y(), box.low.z() + 0.48 * (box.high.z() - box.low.z()));
    notes.push_back("incisal points missing: taken from the front of the mandible");
  }
  return anatomy;
}

}  // namespace condyle
