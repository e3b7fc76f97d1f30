#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/session/session_state.h"

namespace condyle {

/// Loads patients concurrently with a session.
class PatientLoader {
 public:
  /// A loaded patient; `renewed`: the present one, rebuilt with these landmarks.
  struct Loaded {
    std::shared_ptr<const SessionPatient> patient;
    std::optional<std::vector<Landmark>> renewed;
    std::filesystem::path plan = {};  // file of its plan; empty: none
  };

  explicit PatientLoader(SessionState& state) : state_(state), job_(state.retired, state.waker()) {}

  /// Loads the case in a folder, or the built-in patient if it is empty.
  void open(const std::filesystem::path& folder);
  /// Imports surfaces, landmarks and muscles with their roles.
  void import(const request::Import& request);
  /// Rebuilds the session's patient with other landmarks.
  void renew(std::vector<Landmark> landmarks);
  void drop() { job_.drop(); }
  const auto& job() const { return job_; }
  /// The loaded patient; none if it is not ready, or if loading failed, which is reported.
  std::optional<Loaded> take();

 private:
  void start(std::function<Case(const Progress&)> read, std::filesystem::path folder,
             std::string words, std::filesystem::path plan = {});

  SessionState& state_;
  std::optional<std::vector<Landmark>> renewing_;
  std::filesystem::path plan_;  // of the patient that is being loaded
  Job<std::shared_ptr<const SessionPatient>> job_;
};

/// The patient's case with other landmarks.
Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks);

/// The landmarks of a case, each on the part that carries it.
std::vector<Landmark> landmarks_of(const Case& patient);

}  // namespace condyle
