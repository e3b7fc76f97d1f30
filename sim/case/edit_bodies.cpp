#include "sim/case/edit_bodies.h"

#include <algorithm>
#include <utility>

#include "engine/core/error.h"

namespace condyle {

Case with_piece(Case patient, Part part, BodyId parent, BodyDriver driver) {
  if (std::any_of(patient.parts.begin(), patient.parts.end(),
                  [&](const Part& other) { return other.name == part.name; }))
    throw InputError(part.name + ": the patient already has a part of this name");
  patient.add_piece(std::move(part), parent, driver);
  return patient;
}

Case with_parent(Case patient, BodyId body, BodyId parent) {
  const std::vector<BodyId> number = patient.bodies.reparent(body, parent);
  const auto renumber = [&](BodyId& old) { old = number[index_of(old)]; };
  for (Part& part : patient.parts) renumber(part.body);
  for (Canal& canal : patient.canals) renumber(canal.body);
  for (BodyId* jaw : {&patient.jaw.upper_arch, &patient.jaw.lower_arch, &patient.jaw.left_condyle,
                      &patient.jaw.right_condyle})
    renumber(*jaw);
  return patient;
}

Case without_body(Case patient, BodyId body) {
  const JawBodies& jaw = patient.jaw;
  for (const BodyId of_jaw :
       {mandible_body, jaw.upper_arch, jaw.lower_arch, jaw.left_condyle, jaw.right_condyle})
    if (body == of_jaw && body != cranium_body)
      throw InputError(patient.bodies[body].name + ": is a body of the jaw and cannot be removed");
  const auto number = patient.bodies.remove(body);
  const auto goes = [&](const Part& part) { return part.body == body; };
  std::erase_if(patient.pair_rules, [&](const PairRule& rule) {
    return std::any_of(patient.parts.begin(), patient.parts.end(), [&](const Part& part) {
      return goes(part) && (part.name == rule.a || part.name == rule.b);
    });
  });
  std::erase_if(patient.parts, goes);
  std::erase_if(patient.canals, [&](const Canal& canal) { return canal.body == body; });
  for (Part& part : patient.parts) part.body = *number[index_of(part.body)];
  for (Canal& canal : patient.canals) canal.body = *number[index_of(canal.body)];
  for (BodyId* of_jaw : {&patient.jaw.upper_arch, &patient.jaw.lower_arch,
                         &patient.jaw.left_condyle, &patient.jaw.right_condyle})
    *of_jaw = *number[index_of(*of_jaw)];
  return patient;
}

}  // namespace condyle
