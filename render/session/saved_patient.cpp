#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "render/session/patient_loader.h"
#include "render/session/saved/session_file.h"
#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/plan_file.h"
#include "sim/session/patient_files.h"

// The patient that a saved session refers to.

namespace condyle {
namespace {

Case source_case(const PatientSource& source, const Progress& progress) {
  if (const auto* built_in = std::get_if<BuiltInSource>(&source))
    return builtin_patient(parse_head_name(built_in->name), progress);
  if (const auto* stored = std::get_if<FolderSource>(&source)) return load_case(stored->folder);
  const auto& imported = std::get<SurfaceSource>(source);
  std::vector<FileRole> files;
  for (const auto& surface : imported.surfaces) files.push_back({surface.file, surface.role});
  return import_files(files, imported.units, imported.frame);
}

std::string words_of_changes(const std::vector<std::string>& changes) {
  constexpr std::size_t most = 4;
  const auto shown = std::vector<std::string>(
      changes.begin(), changes.begin() + static_cast<long>(std::min(most, changes.size())));
  std::string words = fmt::format("{}", fmt::join(shown, ", "));
  if (changes.size() > most) words += fmt::format(" and {} more", changes.size() - most);
  return words;
}

}  // namespace

PatientLoader::Loaded load_saved_patient(const std::filesystem::path& file,
                                         const SimulatorSettings& settings,
                                         const Progress& progress) {
  report(progress, "opening the session", 0);
  OpenedSession opened{.file = file, .saved = load_session(file)};
  SavedSession& saved = opened.saved;
  if (const auto* stored = std::get_if<FolderSource>(&saved.source))
    report(progress, "loading " + stored->folder.filename().string(), 0);
  PatientLoader::Loaded loaded{.patient = {}, .renewed = {}, .source = saved.source};
  Case patient = source_case(saved.source, progress);
  loaded.source_landmarks = patient.landmarks;
  if (saved.landmarks_replaced) patient.landmarks = saved.geometry.landmarks;
  loaded.geometry = geometry_of(patient);
  if (const auto compared = compare_geometry(saved.geometry, loaded.geometry);
      compared.match != CaseMatch::same)
    opened.notes.push_back("The patient has changed since the session was saved: " +
                           words_of_changes(compared.differences));
  const auto* stored = std::get_if<FolderSource>(&saved.source);
  const auto made = [&](const std::optional<Plan>& plan) {
    return make_session_patient(patient, stored ? stored->folder : std::filesystem::path{},
                                settings, progress, plan);
  };
  if (!saved.plan.empty() || saved.draft) try {
      loaded.patient = made(saved.plan.empty() ? *saved.draft : load_plan(saved.plan));
    } catch (const InputError& error) {
      opened.notes.push_back(std::string("The plan is left out. ") + error.what());
      saved.plan.clear();
      saved.draft.reset();
    }
  if (!loaded.patient) loaded.patient = made({});
  loaded.plan = saved.plan;
  loaded.opened = std::move(opened);
  return loaded;
}

void PatientLoader::open_session(const std::filesystem::path& file) {
  renewing_.reset();
  opens_session_ = true;
  makes_ct_ = false;
  job_.start([file, settings = state_.settings.simulator](const Progress& progress) {
    return load_saved_patient(file, settings, progress);
  });
}

}  // namespace condyle
