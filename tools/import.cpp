#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/contact/push_out_parts.h"
#include "tools/commands.h"

namespace condyle {

int run_import(const ImportOptions& options, const CommonOptions& common) {
  ImportRequest request = options.request;
  if (request.name.empty()) request.name = (options.out / "").parent_path().filename().string();
  Case patient = import_meshes(request);
  if (options.push_out) push_out_free_parts(patient);
  save_case(patient, options.out);
  if (common.json) {
    nlohmann::ordered_json json = {{"case", options.out.string()}, {"name", patient.name}};
    for (const auto& part : patient.parts)
      json["parts"].push_back({{"name", part.name},
                               {"role", role_name(part.role)},
                               {"triangles", part.mesh.triangles.size()}});
    json["landmarks"] = patient.landmarks.points.size();
    json["notes"] = patient.notes;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  if (!common.quiet) {
    for (const auto& note : patient.notes) fmt::print(stderr, "note: {}\n", note);
    const bool moves = patient.landmarks.find("lower_incisal_point") &&
                       std::any_of(patient.parts.begin(), patient.parts.end(),
                                   [](const Part& part) { return part.role == Role::mandible; });
    fmt::print(stderr, "{}: {} part{}, {} landmarks. Next: condyle {} {}{}\n", options.out.string(),
               patient.parts.size(), patient.parts.size() == 1 ? "" : "s",
               patient.landmarks.points.size(), moves ? "record" : "view", options.out.string(),
               moves ? " --motion opening --out out --film" : "");
  }
  return 0;
}

}  // namespace condyle
