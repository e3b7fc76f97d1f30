#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/core/error.h"
#include "sim/case/case_io.h"
#include "sim/dynamics/release_body.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

struct ReleaseOptions {
  std::filesystem::path patient, out;
  std::string part;  // empty: the only one that can be released
  std::vector<double> push_N;
  double friction = 0.3;
  std::vector<std::string> yielding;  // parts that yield when pushed
};

/// The first part of each body that can be released.
std::vector<std::size_t> pieces_of(const Case& patient) {
  std::vector<std::size_t> pieces;
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    if (collides(patient.parts[i].role) && patient.bodies.roams(patient.parts[i].body))
      pieces.push_back(i);
  return pieces;
}

std::size_t piece_named(const Case& patient, const std::string& name, const char* option) {
  const auto pieces = pieces_of(patient);
  std::string known;
  for (const std::size_t i : pieces) {
    if (name == patient.parts[i].name || (name.empty() && pieces.size() == 1)) return i;
    known += (known.empty() ? "" : ", ") + patient.parts[i].name;
  }
  if (pieces.empty())
    throw InputError(
        "the case has no segment or transplant to release; import one with --segment or "
        "--transplant");
  throw InputError(fmt::format("{} \"{}\": the segments and transplants of the case are {}", option,
                               name, known));
}

/// A part whose body was released, and its displacement.
struct Moved {
  std::size_t part;
  Pose X;
};

std::vector<Moved> moved_parts(const std::vector<std::size_t>& released, const Case& patient,
                               const Release& settled) {
  std::vector<Moved> moved;
  for (const std::size_t part : released)
    moved.push_back({part, pose_of(patient.parts[part], settled.poses)});
  return moved;
}

Json report_of(const Case& patient, const std::vector<Moved>& moved, const Release& settled) {
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

/// Contacts of a part, with the parts and regions that it touches.
std::string places_of(const Case& patient, int part, const Release& settled) {
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

int run_release(const ReleaseOptions& options, const CommonOptions& common) {
  constexpr int never_still = 1;
  ProgressBar bar(common);
  Case patient = open_patient(options.patient, common, bar);
  const std::size_t part = piece_named(patient, options.part, "--part");
  std::vector<std::size_t> released = {part};
  ReleaseSettings settings;
  settings.push_N = {options.push_N[0], options.push_N[1], options.push_N[2]};
  settings.friction = options.friction;
  for (const auto& name : options.yielding) {
    released.push_back(piece_named(patient, name, "--yields"));
    settings.yielding.push_back(patient.parts[released.back()].body);
  }
  bar.show("releasing", 0.5);
  const Release settled =
      release_body(patient, patient.parts[part].body, {}, settings, common.threads);
  bar.clear();
  const std::vector<Moved> moved = moved_parts(released, patient, settled);
  if (settled.rest.reached && !options.out.empty()) {
    for (const auto& [p, X] : moved) {
      patient.notes.push_back(fmt::format("{}: {}, now {:.1f} mm from its earlier place",
                                          patient.parts[p].name, p == part ? "released" : "pushed",
                                          X.t.norm()));
    }
    for (Part& each : patient.parts)
      if (const Pose& X = pose_of(each, settled.poses); !bit_identical(X, {}))
        for (auto& v : each.mesh.vertices) v = X * v;
    save_case(patient, options.out);
  }
  if (common.json) fmt::print("{}\n", report_of(patient, moved, settled).dump(2));
  if (common.prints_summary()) {
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

CLI::App& add_release(Commands& commands, const char* name) {
  const auto options = std::make_shared<ReleaseOptions>();
  CLI::App& command = commands.add(
      name, "Release a segment or transplant: it settles on the bone under a push",
      "condyle release mycase --part transplant --push 0,5,0 --out settled",
      [options](const CommonOptions& common) { return run_release(*options, common); });
  command.add_option("CASE", options->patient, "Folder with case.json")->required();
  command
      .add_option("--part", options->part,
                  "Name of the part (default: the only segment or transplant)")
      ->type_name("PART");
  command.add_option("--push", options->push_N, "Force to the left, back and up, N")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z")
      ->required();
  command
      .add_option("--yields", options->yielding,
                  "Another segment or transplant that is pushed along; may be repeated")
      ->type_name("PART");
  in_range(
      command.add_option("--friction", options->friction, "Coefficient of friction; default 0.3"),
      0, 2);
  command.add_option("--out", options->out, "Folder of the case with the parts where they settled")
      ->type_name("FOLDER");
  return command;
}

}  // namespace

void add_release(Commands& commands) {
  add_release(commands, "release");
  add_release(commands, "let-go").group("");  // hidden alias: its name up to version 0.1.7
}

}  // namespace condyle
