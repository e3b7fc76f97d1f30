#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <ctime>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "engine/core/atomic_output.h"
#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "render/gl/gl_context.h"
#include "render/output/contact_picture.h"
#include "render/recording/render_metadata.h"
#include "sim/frame/part_names.h"
#include "sim/operated/graft_path.h"
#include "sim/report/check_page.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/motion_options.h"

namespace condyle {
namespace {

struct CheckOptions {
  MotionOptions motion;
  std::filesystem::path out;
  double margin_mm = 0;
  int frames = 0;  // 0 = duration x fps
  double fps = 30;
};

const std::string picture_start = "worst-", picture_end = ".png";

/// Standard view from the side of the contact.
std::string overview_of(const PairMeasure& measure) {
  if (measure.side == "left" || measure.side == "right") return measure.side;
  return measure.side == "middle" ? "front" : "three-quarter";
}

Image picture_of(const Scene& scene, const PairVerdict& pair, int threads) {
  constexpr double min_mm = 45, max_mm = 90;
  const WorstView view = worst_view(scene, pair, threads);
  const auto& worst = pair.worst;
  ContactView place{.parts = view.parts,
                    .fixed = pair.a,
                    .moved = pair.b,
                    .fixed_values = view.distance_a,
                    .moved_values = view.distance_b,
                    .at = worst.poses,
                    .place = worst.measure.place,
                    .middle = worst.measure.middle,
                    .normal = worst.measure.normal,
                    .seen_mm = std::clamp(1.3 * worst.measure.size_mm, min_mm, max_mm),
                    .overview = overview_of(worst.measure),
                    .title = display_name(pair.a) + " and " + readable_name(pair.b),
                    .lines = {worst_caption(pair)}};
  if (const auto words = open_surface_text(pair); !words.empty()) place.lines.push_back(words);
  // Distant pairs get a wider scale, so that their nearest regions are visible.
  const double least = std::abs(worst.sample.signed_distance_mm());
  const double near_mm = least < 4 ? 5 : least < 9 ? 10 : least < 18 ? 20 : 50;
  return contact_picture(place, distance_colours({.near_mm = near_mm, .deepest_mm = 2}));
}

/// A name that is valid on every file system.
std::string file_of(const PairVerdict& pair) {
  std::string name = pair.a + "-" + pair.b;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  return picture_start + name + picture_end;
}

/// Draws the pairs that need a picture. Returns the file name for each pair, or an empty one.
std::vector<std::string> write_pictures(AtomicOutput& files, const Scene& scene,
                                        const ClearanceCheck& check, int threads,
                                        std::vector<std::string>& notes, const Progress& progress) {
  std::vector<std::string> names(check.pairs.size());
  std::optional<OffscreenContext> context;
  try {
    context.emplace();
  } catch (const MachineError& error) {
    notes.push_back(fmt::format("pictures are left out: {}", error.what()));
    return names;
  }
  const auto shown = pairs_to_show(check);
  if (const auto lacks = default_render_metadata(*context).shortfall();
      !shown.empty() && !lacks.empty())
    notes.push_back(lacks);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const auto& pair = check.pairs[shown[k]];
    report(progress, "drawing", static_cast<double>(k) / static_cast<double>(shown.size()));
    names[shown[k]] = file_of(pair);
    write_png(files.path(names[shown[k]]), picture_of(scene, pair, threads));
  }
  if (const auto total = pairs_to_show(check, check.pairs.size()).size(); total > shown.size())
    notes.push_back(fmt::format("the {} worst of {} pairs are drawn", shown.size(), total));
  return names;
}

/// Crowns that are part of the bones' surfaces may not touch either, unless a rule says so.
std::vector<std::string> notes_on_crowns(const Case& patient, const ClearanceCheck& check) {
  std::vector<std::string> notes;
  if (patient.find(Role::upper_teeth) || patient.find(Role::lower_teeth)) return notes;
  const auto body = [&](const std::string& name) {
    const auto part = std::find_if(patient.parts.begin(), patient.parts.end(),
                                   [&](const Part& p) { return p.name == name; });
    return part->body;
  };
  for (const auto& pair : check.pairs) {
    if (!pair.violated() || pair.rule.policy != PairPolicy::forbidden) continue;
    if (std::set{body(pair.a), body(pair.b)} !=
        std::set{patient.jaw.upper_arch, patient.jaw.lower_arch})
      continue;
    notes.push_back(fmt::format(
        "the case has no separate teeth: where crowns on {0} and {1} meet counts as bones that "
        "collide; --pair {0},{1},allowed lets them touch",
        pair.a, pair.b));
  }
  return notes;
}

/// "mandible 1f0c...": each part and the hash of its surface.
std::vector<std::string> surface_hashes(const Case& patient) {
  std::vector<std::string> hashes;
  for (const auto& part : patient.parts)
    hashes.push_back(fmt::format("{} {:016x}", part.name, mesh_hash(part.mesh)));
  return hashes;
}

/// Removes pictures of an earlier check.
void remove_other_pictures(const std::filesystem::path& folder,
                           const std::vector<std::string>& kept) {
  const std::set<std::string> names(kept.begin(), kept.end());
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(picture_start) && name.ends_with(picture_end) && !names.contains(name))
      std::filesystem::remove(entry.path(), none);
  }
}

/// The same check of the patient before the operation; none without a plan.
std::optional<OperationComparison> comparison_of(const CheckOptions& options,
                                                 const CommonOptions& common, const Case& uncut,
                                                 const SimulatorSettings& settings,
                                                 const Scene& after, const Motion& motion,
                                                 const ClearanceCheck& check,
                                                 const Progress& progress) {
  if (options.motion.plan.empty() || is_insertion_path(options.motion.motion)) return std::nullopt;
  const Scene before = make_scene(uncut, settings, progress);
  const Motion motion_before = motion_of(options.motion, before, common.threads);
  const ClearanceCheck check_before =
      check_clearance(before, motion_before,
                      {.margin_mm = options.margin_mm, .sampling = {options.frames, options.fps}},
                      settings, progress);
  return compare_operation(before, motion_before, check_before, after, motion, check);
}

/// report.json with the comparison as "before_and_after".
std::string with_comparison(const std::string& report, const OperationComparison& comparison) {
  auto json = nlohmann::ordered_json::parse(report);
  json["before_and_after"] = comparison.json();
  return json.dump(2) + "\n";
}

int run_check(const CheckOptions& options, const CommonOptions& common) {
  constexpr int violation = 3;
  ProgressBar bar(common);
  check_motion(options.motion);
  auto settings = simulator_settings(options.motion, common);
  settings.contact.far_mm = std::numeric_limits<double>::infinity();  // every distance is plotted
  std::optional<AtomicOutput> files;
  if (!options.out.empty()) files.emplace(options.out);  // fails before the computation
  Case patient = open_patient(case_of(options.motion), common, bar);
  check_motion(options.motion, patient);
  const std::optional<Case> uncut =
      options.motion.plan.empty() ? std::nullopt : std::optional(patient);
  const Scene scene = scene_of(options.motion, std::move(patient), settings, bar.callback());
  print_notes(scene, options.motion.patient, common, bar);
  const Motion motion = motion_of(options.motion, scene, common.threads);
  const auto check = check_clearance(
      scene, motion, {.margin_mm = options.margin_mm, .sampling = {options.frames, options.fps}},
      settings, bar.callback());
  std::optional<OperationComparison> comparison;
  if (uncut)
    comparison =
        comparison_of(options, common, *uncut, settings, scene, motion, check, bar.callback());
  std::vector<std::string> pictures, notes = motion.notes;
  for (const auto& note : notes_on_crowns(scene.patient, check)) notes.push_back(note);
  if (files) pictures = write_pictures(*files, scene, check, common.threads, notes, bar.callback());
  bar.clear();
  std::string json = check.json(scene, motion, pictures, notes);
  if (comparison) json = with_comparison(json, *comparison);
  if (files) {
    CheckPage page{.patient = scene.patient.name,
                   .motion = motion.name,
                   .pictures = pictures,
                   .notes = scene.contacts.notes(),
                   .program = "Condyle " CONDYLE_VERSION,
                   .date = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr))),
                   .surfaces = surface_hashes(scene.patient),
                   .comparison = comparison};
    page.notes.insert(page.notes.end(), notes.begin(), notes.end());
    files->write("pairs.csv", check.pairs_csv);
    files->write("clearance.svg", clearance_svg(check));
    if (const auto svg = coronoid_svg(check); !svg.empty()) files->write("coronoid.svg", svg);
    if (const auto svg = teeth_svg(check); !svg.empty()) files->write("teeth.svg", svg);
    files->write("report.json", json);
    files->write("report.html", check_page(check, page));
    files->finish();
    remove_other_pictures(options.out, pictures);
  }
  if (common.json) fmt::print("{}", json);
  if (common.prints_summary()) {
    for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", check.text());
    if (comparison) fmt::print(stderr, "\n{}", comparison->text());
  }
  return check.violated() ? violation : 0;
}

}  // namespace

void add_check(Commands& commands) {
  const auto options = std::make_shared<CheckOptions>();
  options->motion.motion = "opening";
  options->motion.tissue.simulated = false;
  CLI::App& command =
      commands.add("check", "Check the bones for collisions and clearances along a motion",
                   "condyle check mycase --motion opening --margin 1 --out out; echo $?",
                   [options](const CommonOptions& common) { return run_check(*options, common); });
  add_motion(command, options->motion);
  command
      .add_option("--out", options->out,
                  "Folder for report.html with its pictures, report.json and pairs.csv")
      ->type_name("FOLDER");
  in_range(command.add_option("--margin", options->margin_mm,
                              "Clearance that bones must keep, mm; default 0"),
           0, 50);
  in_range(command.add_option("--frames", options->frames,
                              "Report the whole motion in this many frames, both ends included"),
           1, 100000);
  in_range(command.add_option("--fps", options->fps,
                              "Frames per second of the motion; default 30. Between them nothing "
                              "thicker than 0.1 mm passes through unseen"),
           0.1, 1000);
  add_pairs(command, options->motion);
  add_motion_details(command, options->motion);
}

}  // namespace condyle
