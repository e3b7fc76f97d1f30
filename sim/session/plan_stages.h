#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "sim/operated/operated_scene.h"
#include "sim/prediction/predictor.h"
#include "sim/session/session_patient.h"

namespace condyle {

/// Makes a session's patient anew after each edit of its plan, in the stages in which a front end
/// shows it: the pieces at once, then contact, then the face. Cuts and soft tissue are kept between
/// plans. Threads that share it wait for each other.
class PlanStages {
 public:
  using Made = std::shared_ptr<const SessionPatient>;

  /// `patient`: as loaded, with or without a plan.
  PlanStages(const SessionPatient& patient, SimulatorSettings settings);

  /// throws: InputError as apply_plan().
  Operated replay(const Plan& plan);
  /// The planned patient whose bones pass through each other, without its face.
  Made pieces(const Plan& plan, Operated operated) const;
  /// The same with contact and all findings. `earlier`: a patient whose collision models are reused
  /// where the bone is the same. throws: InputError as make_scene().
  Made with_contact(const SessionPatient& pieces, const Plan& plan, const SessionPatient& earlier,
                    const Progress& progress = {}) const;
  /// The same with the predicted face; SessionPatient::trouble where there is no solution.
  Made with_face(const SessionPatient& bones, const Plan& plan, const Progress& progress = {});

 private:
  const std::filesystem::path folder_;
  const std::shared_ptr<const Case> uncut_;
  const Case prepared_;  // with muscles
  const SimulatorSettings settings_;
  std::mutex replaying_, predicting_;
  std::optional<Plan> plan_;                  // replayed last
  Operated cuts_;                             // of it
  std::shared_ptr<const TissueModel> whole_;  // of the uncut patient; null: not built
  std::optional<Predictor> predictor_;
};

}  // namespace condyle
