#include "sim/dynamics/let_go.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

std::size_t free_part(const Case& patient, const std::string& name) {
  const auto free = free_parts(patient.parts);
  std::string known;
  for (const std::size_t i : free) {
    if (name == patient.parts[i].name || (name.empty() && free.size() == 1)) return i;
    known += (known.empty() ? "" : ", ") + patient.parts[i].name;
  }
  if (free.empty())
    throw InputError(
        "the case has no segment or transplant to let go; import one with --segment "
        "or --transplant");
  throw InputError("--part \"" + name + "\": the free parts of the case are " + known);
}

nlohmann::ordered_json report_of(const Case& patient, std::size_t part, const LetGo& settled,
                                 const Pose& X) {
  const auto triple = [](const Eigen::Vector3d& v) {
    return nlohmann::ordered_json{v.x(), v.y(), v.z()};
  };
  nlohmann::ordered_json json = {{"part", patient.parts[part].name},
                                 {"at_rest", settled.rest.reached},
                                 {"seconds", settled.rest.seconds},
                                 {"depth_mm", settled.rest.depth_mm},
                                 {"translation_mm", triple(X.t)},
                                 {"quaternion_wxyz", {X.R.w(), X.R.x(), X.R.y(), X.R.z()}},
                                 {"contacts", nlohmann::ordered_json::array()}};
  for (const auto& contact : settled.contacts)
    json["contacts"].push_back({{"on", patient.parts[static_cast<std::size_t>(contact.part)].name},
                                {"point_mm", triple(contact.point)},
                                {"normal", triple(contact.normal)},
                                {"gap_mm", contact.gap_mm},
                                {"push_N", contact.push_N}});
  return json;
}

}  // namespace

int run_let_go(const LetGoOptions& options, const CommonOptions& common) {
  constexpr int never_still = 1;
  ProgressBar bar(common);
  Case patient = open_patient(options.patient, common, bar);
  const std::size_t part = free_part(patient, options.part);
  LetGoSettings settings;
  settings.push_N = {options.push_N[0], options.push_N[1], options.push_N[2]};
  settings.friction = options.friction;
  bar.show("letting go", 0.5);
  const LetGo settled = let_go(patient, part, {}, settings, common.threads);
  bar.clear();
  const auto free = free_parts(patient.parts);
  const Pose X = settled.poses.X_CF.at(
      static_cast<std::size_t>(std::find(free.begin(), free.end(), part) - free.begin()));
  const auto json = report_of(patient, part, settled, X);
  if (settled.rest.reached && !options.out.empty()) {
    for (auto& v : patient.parts[part].mesh.vertices) v = X * v;
    patient.notes.push_back(fmt::format("{}: let go, it came to lie {:.1f} mm away",
                                        patient.parts[part].name, X.t.norm()));
    save_case(patient, options.out);
  }
  if (common.json) fmt::print("{}\n", json.dump(2));
  if (!common.quiet) {
    if (!settled.rest.reached)
      fmt::print(stderr, "{}: did not come to rest in {:.1f} s; push it elsewhere\n",
                 patient.parts[part].name, settled.rest.seconds);
    else
      fmt::print(stderr,
                 "{}: lies still after {:.2f} s on {} places, at most {:.3f} mm deep; moved by "
                 "({:.2f}, {:.2f}, {:.2f}) mm and turned by {:.1f} deg\n",
                 patient.parts[part].name, settled.rest.seconds, settled.contacts.size(),
                 settled.rest.depth_mm, X.t.x(), X.t.y(), X.t.z(),
                 rotation_angle(X) * 180 / 3.14159265358979);
    if (settled.rest.reached && !options.out.empty())
      fmt::print(stderr, "the case with it is in {}\n", options.out.string());
  }
  return settled.rest.reached ? 0 : never_still;
}

}  // namespace condyle
