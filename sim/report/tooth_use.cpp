#include "sim/report/tooth_use.h"

namespace condyle {

ToothContacts::ToothContacts(const Case& patient)
    : patient_(patient), arches_(patient.parts.size()) {
  for (std::size_t i = 0; i < patient.parts.size(); ++i) {
    const Part& part = patient.parts[i];
    if (!is_teeth(part.role) || part.mesh.empty()) continue;
    arches_[i] = std::make_unique<CollisionMesh>(part.mesh);
    for (const auto& tooth : part.teeth) {
      const auto first = part.mesh.triangles.begin() + tooth.first_triangle;
      numbers_.push_back(tooth.fdi);
      crowns_.push_back(
          {static_cast<int>(i),
           CollisionMesh({part.mesh.vertices, {first, first + tooth.triangle_count}, {}})});
    }
  }
}

std::vector<bool> ToothContacts::touching_at(const ContactSet& contacts,
                                             const BodyPoses& at) const {
  std::vector<bool> found(crowns_.size(), false);
  for (const auto& pair : contacts.pairs) {
    if (!pair.touching) continue;
    for (const auto& [own, other] :
         {std::pair(pair.part_a, pair.part_b), std::pair(pair.part_b, pair.part_a)}) {
      const auto& arch = arches_[static_cast<std::size_t>(other)];
      if (!arch) continue;
      const Pose X_own = pose_of(patient_.parts[static_cast<std::size_t>(own)], at),
                 X_other = pose_of(patient_.parts[static_cast<std::size_t>(other)], at);
      for (std::size_t i = 0; i < crowns_.size(); ++i)
        if (crowns_[i].part == own && !found[i])
          found[i] = touching(crowns_[i].surface, X_own, *arch, X_other);
    }
  }
  return found;
}

std::vector<ToothUse> tooth_use(const std::vector<int>& teeth,
                                const std::vector<std::vector<bool>>& touching) {
  std::vector<ToothUse> use;
  for (std::size_t i = 0; i < teeth.size(); ++i) {
    ToothUse tooth{teeth[i], 0, 0};
    bool before = false;
    for (const auto& frame : touching) {
      tooth.touching_frames += frame[i];
      tooth.touches += frame[i] && !before;
      before = frame[i];
    }
    use.push_back(tooth);
  }
  return use;
}

}  // namespace condyle
