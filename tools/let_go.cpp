#include "sim/dynamics/let_go.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

std::size_t free_part(const Case& patient, const std::string& name, const char* option) {
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
  throw InputError(
      fmt::format("{} \"{}\": the free parts of the case are {}", option, name, known));
}

/// A part that was let go, and how it moved.
struct Moved {
  std::size_t part;
  Pose X;
};

std::vector<Moved> moved_parts(const Case& patient, std::size_t pushed,
                               const LetGoSettings& settings, const LetGo& settled) {
  const auto free = free_parts(patient.parts);
  std::vector<Moved> moved;
  const auto add = [&](std::size_t part) {
    const auto place = std::find(free.begin(), free.end(), part) - free.begin();
    moved.push_back({part, settled.poses.X_CF.at(static_cast<std::size_t>(place))});
  };
  add(pushed);
  for (const std::size_t part : settings.yielding) add(part);
  return moved;
}

Json report_of(const Case& patient, const std::vector<Moved>& moved, const LetGo& settled) {
  const auto triple = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  const auto name = [&](int part) { return patient.parts[static_cast<std::size_t>(part)].name; };
  Json json = {{"part", patient.parts[moved[0].part].name},
               {"at_rest", settled.rest.reached},
               {"seconds", settled.rest.seconds},
               {"depth_mm", settled.rest.depth_mm},
               {"moved", Json::array()},
               {"contacts", Json::array()}};
  for (const auto& [part, X] : moved)
    json["moved"].push_back({{"part", patient.parts[part].name},
                             {"translation_mm", triple(X.t)},
                             {"quaternion_wxyz", {X.R.w(), X.R.x(), X.R.y(), X.R.z()}}});
  for (const auto& contact : settled.contacts)
    json["contacts"].push_back({{"part", name(contact.lies)},
                                {"on", name(contact.part)},
                                {"point_mm", triple(contact.point)},
                                {"normal", triple(contact.normal)},
                                {"gap_mm", contact.gap_mm},
                                {"push_N", contact.push_N}});
  return json;
}

/// The places where a part touches, and what is there.
std::string places_of(const Case& patient, int part, const LetGo& settled) {
  std::map<std::string, int> on;
  for (const auto& contact : settled.contacts) {
    if (contact.lies != part && contact.part != part) continue;
    const int other = contact.lies == part ? contact.part : contact.lies;
    ++on[patient.parts[static_cast<std::size_t>(other)].name];
  }
  std::string out;
  for (const auto& [name, count] : on)
    out += fmt::format("{}{} at {} place{}", out.empty() ? "" : ", ", name, count,
                       count == 1 ? "" : "s");
  return out.empty() ? "nothing" : out;
}

}  // namespace

int run_let_go(const LetGoOptions& options, const CommonOptions& common) {
  constexpr int never_still = 1;
  ProgressBar bar(common);
  Case patient = open_patient(options.patient, common, bar);
  const std::size_t part = free_part(patient, options.part, "--part");
  LetGoSettings settings;
  settings.push_N = {options.push_N[0], options.push_N[1], options.push_N[2]};
  settings.friction = options.friction;
  for (const auto& name : options.yielding)
    settings.yielding.push_back(free_part(patient, name, "--yields"));
  bar.show("letting go", 0.5);
  const LetGo settled = let_go(patient, part, {}, settings, common.threads);
  bar.clear();
  const std::vector<Moved> moved = moved_parts(patient, part, settings, settled);
  if (settled.rest.reached && !options.out.empty()) {
    for (const auto& [p, X] : moved) {
      for (auto& v : patient.parts[p].mesh.vertices) v = X * v;
      patient.notes.push_back(fmt::format("{}: {}, it came to lie {:.1f} mm away",
                                          patient.parts[p].name, p == part ? "let go" : "pushed",
                                          X.t.norm()));
    }
    save_case(patient, options.out);
  }
  if (common.json) fmt::print("{}\n", report_of(patient, moved, settled).dump(2));
  if (!common.quiet) {
    if (!settled.rest.reached)
      fmt::print(stderr,
                 "{}: did not come to rest on bone in {:.1f} s; push it elsewhere, or bring it "
                 "nearer\n",
                 patient.parts[part].name, settled.rest.seconds);
    else
      fmt::print(stderr, "lies still after {:.2f} s, at most {:.3f} mm deep\n",
                 settled.rest.seconds, settled.rest.depth_mm);
    for (const auto& [p, X] : moved) {
      if (!settled.rest.reached) break;
      fmt::print(stderr,
                 "{}: touches {}; moved by ({:.2f}, {:.2f}, {:.2f}) mm and turned by {:.1f} deg\n",
                 patient.parts[p].name, places_of(patient, static_cast<int>(p), settled), X.t.x(),
                 X.t.y(), X.t.z(), rotation_angle(X) * 180 / std::numbers::pi);
    }
    if (settled.rest.reached && !options.out.empty())
      fmt::print(stderr, "the case with {} is in {}\n", moved.size() > 1 ? "them" : "it",
                 options.out.string());
  }
  return settled.rest.reached ? 0 : never_still;
}

}  // namespace condyle
