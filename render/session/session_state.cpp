#include "render/session/session_state.h"

#include "render/session/window_words.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_names.h"
#include "sim/frame/part_names.h"

namespace condyle {

std::string SessionState::in_words(std::string sentence) const {
  std::vector<std::string> names = landmark_names();
  for (const Role role : {Role::upper_teeth, Role::lower_teeth, Role::upper_gums, Role::lower_gums})
    names.emplace_back(role_name(role));
  if (patient) {
    for (const Part& part : patient->scene.patient.parts) names.push_back(part.name);
    for (const auto& [name, at] : patient->scene.patient.landmarks.points) names.push_back(name);
  }
  return with_readable_names(in_window_words(std::move(sentence)), names);
}

std::string SessionState::name_of(const MovableBody& body) const {
  return readable_name(patient->scene.patient.parts[body.part].name);
}

}  // namespace condyle
