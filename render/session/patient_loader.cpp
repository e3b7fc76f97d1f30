#include "render/session/patient_loader.h"

#include <utility>

#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/plan_file.h"
#include "sim/session/patient_files.h"

namespace condyle {

void PatientLoader::start(std::function<Case(const Progress&)> read, std::filesystem::path folder,
                          std::string words, std::filesystem::path plan) {
  renewing_.reset();
  plan_ = plan;
  job_.start([read = std::move(read), folder = std::move(folder), words = std::move(words),
              settings = state_.settings.simulator,
              plan = std::move(plan)](const Progress& progress) {
    report(progress, words, 0);
    std::optional<Plan> planned;
    if (!plan.empty()) planned = load_plan(plan);
    return make_session_patient(read(progress), folder, settings, progress, planned);
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
      std::exchange(state_.settings.plan, {}));
}

void PatientLoader::import(const request::Import& request) {
  start([request](
            const Progress&) { return import_files(request.files, request.units, request.frame); },
        {}, "reading the surfaces");
}

void PatientLoader::renew(std::vector<Landmark> landmarks) {
  start([patient = state_.patient,
         landmarks](const Progress&) { return with_landmarks(patient->scene.patient, landmarks); },
        state_.patient->folder, "making the patient with these landmarks");
  renewing_ = std::move(landmarks);
}

std::optional<PatientLoader::Loaded> PatientLoader::take() {
  if (!job_.done()) return {};
  auto renewed = std::exchange(renewing_, std::nullopt);
  std::optional<Loaded> loaded;
  state_.try_or_report(renewed ? "Cannot use these landmarks" : "Cannot open the patient", [&] {
    if (auto patient = job_.take()) loaded = {std::move(*patient), std::move(renewed), plan_};
  });
  return loaded;
}

Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks) {
  patient.landmarks.points.clear();
  for (const auto& landmark : landmarks) patient.landmarks.points[landmark.name] = landmark.at_rest;
  return patient;
}

std::vector<Landmark> landmarks_of(const Case& patient) {
  std::vector<Landmark> landmarks;
  for (const auto& [name, at] : patient.landmarks.points)
    landmarks.push_back(landmark_at(name, at, patient.parts));
  return landmarks;
}

}  // namespace condyle
