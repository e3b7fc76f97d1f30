#include "render/session/patient_loader.h"

#include <utility>

#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/plan_file.h"
#include "sim/session/patient_files.h"

namespace condyle {

void PatientLoader::start(std::function<Case(const Progress&)> read, std::filesystem::path folder,
                          std::string words, PatientSource source, std::filesystem::path plan) {
  renewing_.reset();
  opens_session_ = makes_ct_ = false;
  job_.start([read = std::move(read), folder = std::move(folder), words = std::move(words),
              settings = state_.settings.simulator, source = std::move(source),
              plan = std::move(plan)](const Progress& progress) {
    report(progress, words, 0);
    std::optional<Plan> planned;
    if (!plan.empty()) planned = load_plan(plan);
    Loaded loaded{
        .patient = make_session_patient(read(progress), folder, settings, progress, planned),
        .renewed = {},
        .plan = plan,
        .source = source};
    loaded.geometry = geometry_of(*loaded.patient->uncut);
    loaded.source_landmarks = loaded.geometry.landmarks;
    return loaded;
  });
}

void PatientLoader::open(const std::filesystem::path& folder) {
  const bool builtin = folder.empty() || is_head_name(folder.string());
  const HeadChoice choice = builtin ? parse_head_name(folder.string()) : HeadChoice{};
  start(
      [=](const Progress& progress) {
        return builtin ? builtin_patient(choice, progress) : load_case(folder);
      },
      builtin ? std::filesystem::path{} : folder,
      builtin ? "loading the patient" : "loading " + folder.filename().string(),
      builtin ? PatientSource{BuiltInSource{head_name(choice)}}
              : PatientSource{FolderSource{std::filesystem::absolute(folder)}},
      std::exchange(state_.settings.plan, {}));
}

void PatientLoader::import(const request::Import& request) {
  SurfaceSource source{.units = request.units, .frame = request.frame};
  for (const FileRole& one : request.files)
    if (!one.role.empty())
      source.surfaces.push_back({std::filesystem::absolute(one.file), one.role});
  start([request](
            const Progress&) { return import_files(request.files, request.units, request.frame); },
        {}, "reading the surfaces", std::move(source));
}

void PatientLoader::make_of_ct(const CtMaking& making) {
  start([making](const Progress& progress) { return make_ct_patient(making, progress); },
        making.folder, "making the patient",
        FolderSource{std::filesystem::absolute(making.folder)});
  makes_ct_ = true;
}

void PatientLoader::renew(std::vector<Landmark> landmarks) {
  start([patient = state_.patient,
         landmarks](const Progress&) { return with_landmarks(patient->scene.patient, landmarks); },
        state_.patient->folder, "making the patient with these landmarks", state_.source);
  renewing_ = std::move(landmarks);
}

std::optional<PatientLoader::Loaded> PatientLoader::take() {
  if (!job_.done()) return {};
  auto renewed = std::exchange(renewing_, std::nullopt);
  std::optional<Loaded> loaded;
  const char* title = renewed          ? "Cannot use these landmarks"
                      : opens_session_ ? "Cannot open the session"
                      : makes_ct_      ? "Cannot make a patient of this CT"
                                       : "Cannot open the patient";
  state_.try_or_report(title, [&] { loaded = job_.take(); });
  if (loaded) loaded->renewed = std::move(renewed);
  return loaded;
}

Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks) {
  patient.landmarks.points.clear();
  for (const auto& landmark : landmarks) patient.landmarks.points[landmark.name] = landmark.at_rest;
  return patient;
}

std::vector<Landmark> landmarks_of(const SessionPatient& patient) {
  std::vector<Landmark> landmarks;
  for (const auto& [name, at] : patient.scene.patient.landmarks.points) {
    const auto [part, vertex] = patient.surfaces->landmarks.at(name);
    landmarks.push_back({name, at, part, vertex});
  }
  return landmarks;
}

}  // namespace condyle
