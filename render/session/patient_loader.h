#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/session/session_state.h"
#include "sim/ct_session/ct_import.h"

namespace condyle {

/// A session read from its file.
struct OpenedSession {
  std::filesystem::path file;
  SavedSession saved;
  std::vector<std::string> notes = {};  // sentences on what had to be left out
};

/// Loads patients concurrently with a session.
class PatientLoader {
 public:
  /// A loaded patient; `renewed`: the present one, rebuilt with these landmarks.
  struct Loaded {
    std::shared_ptr<const SessionPatient> patient;
    std::optional<std::vector<Landmark>> renewed;
    std::filesystem::path plan = {};  // file of its plan; empty: none
    PatientSource source = {};
    Landmarks source_landmarks = {};
    CaseGeometry geometry = {};  // before the operation
    std::optional<OpenedSession> opened = {};
  };

  explicit PatientLoader(SessionState& state) : state_(state), job_(state.retired, state.waker()) {}

  /// Loads the case in a folder, or the built-in patient if it is empty.
  void open(const std::filesystem::path& folder);
  /// Imports surfaces, landmarks and muscles with their roles.
  void import(const request::Import& request);
  /// Makes the patient of a CT, and saves it in its folder.
  void make_of_ct(const CtMaking& making);
  /// Whether the work, or its result that was not taken yet, is a patient of a CT.
  bool makes_ct() const { return makes_ct_ && job_.active(); }
  /// Loads the patient of a session with its plan; what does not fit is left out and noted.
  void open_session(const std::filesystem::path& file);
  /// Rebuilds the session's patient with other landmarks.
  void renew(std::vector<Landmark> landmarks);
  void drop() { job_.drop(); }
  const auto& job() const { return job_; }
  /// The loaded patient; none if it is not ready, or if loading failed, which is reported.
  std::optional<Loaded> take();

 private:
  void start(std::function<Case(const Progress&)> read, std::filesystem::path folder,
             std::string words, PatientSource source, std::filesystem::path plan = {});

  SessionState& state_;
  std::optional<std::vector<Landmark>> renewing_;
  bool opens_session_ = false, makes_ct_ = false;
  Job<Loaded> job_;
};

/// Reads a session and loads its patient. throws: InputError if either cannot be read; a plan that
/// cannot be applied is left out and noted.
PatientLoader::Loaded load_saved_patient(const std::filesystem::path& file,
                                         const SimulatorSettings& settings,
                                         const Progress& progress);

/// The patient's case with other landmarks.
Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks);

/// The landmarks of a patient, each on the part that carries it.
std::vector<Landmark> landmarks_of(const SessionPatient& patient);

}  // namespace condyle
