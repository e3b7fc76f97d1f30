#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/session/session_state.h"

namespace condyle {

/// Loads patients beside a session.
class PatientLoader {
 public:
  /// A patient that is ready; `renewed`: the one that was there, made anew with these landmarks.
  struct Loaded {
    std::shared_ptr<const SessionPatient> patient;
    std::optional<std::vector<Landmark>> renewed;
  };

  explicit PatientLoader(SessionState& state) : state_(state), job_(state.retired, state.waker()) {}

  /// The case in a folder, or the built-in patient when it is empty.
  void open(const std::filesystem::path& folder);
  /// Surfaces, landmarks and muscles with their roles.
  void import(const request::Import& request);
  /// The session's patient with other landmarks.
  void renew(std::vector<Landmark> landmarks);
  void drop() { job_.drop(); }
  const auto& job() const { return job_; }
  /// The patient that was loaded; none when it is not ready or failed, which is reported.
  std::optional<Loaded> take();

 private:
  void start(std::function<Case(const Progress&)> read, std::filesystem::path folder,
             std::string words);

  SessionState& state_;
  std::optional<std::vector<Landmark>> renewing_;
  Job<std::shared_ptr<const SessionPatient>> job_;
};

/// The patient's case with other landmarks.
Case with_landmarks(Case patient, const std::vector<Landmark>& landmarks);

/// The landmarks of a case, each on the part that carries it.
std::vector<Landmark> landmarks_of(const Case& patient);

}  // namespace condyle
