#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "render/session/saved/saved_session.h"
#include "render/window/front_end.h"
#include "sim/session/job.h"
#include "sim/session/session_motion.h"
#include "sim/session/session_patient.h"
#include "sim/session/session_splint.h"

namespace condyle {

/// What is drawn of a cut before it is made, in the cranium's frame at the shown rest.
struct CutOverlay {
  BodyId body = cranium_body;  // that carries it
  LineSet rims;
  std::map<std::string, GlassSheet> sheets;
};

/// State shared by the components of a session: the front end, and the loaded patient.
struct SessionState {
  FrontEnd& front_end;
  SessionSettings settings;

  std::shared_ptr<const SessionPatient> patient = {};  // none before the first is loaded
  std::shared_ptr<const SessionMotion> motion = {};    // none before the patient's first
  WindowScene scene = {};                              // as the front end shows it
  std::optional<FrameState> newest = {};               // the newest frame
  std::shared_ptr<const CutOverlay> cut_overlay = {};  // none: no cut is being drawn
  std::shared_ptr<const SessionSplint> splint = {};    // shown; none: no splint
  RetiredWork retired = {};
  // The files behind the patient, as a session refers to them:
  PatientSource source = {};
  Landmarks source_landmarks = {};     // as those files have them
  CaseGeometry geometry = {};          // of the patient before the operation
  std::filesystem::path session = {};  // its own file; empty: not saved

  /// Shows what has changed of the scene; the requested motion stays.
  void show_changes() {
    scene.motion = front_end.view().motion;
    front_end.update_scene(scene);
  }
  int threads() const { return settings.simulator.threads; }
  /// The callback with which background work reports news.
  auto waker() const {
    return [&front_end = front_end] { front_end.wake_up(); };
  }
  /// A sentence as the front end shows it, with readable names of the patient's parts and
  /// landmarks.
  std::string in_words(std::string sentence) const;
  std::string name_of(const MovableBody& body) const;

  /// Runs work and reports its exceptions under the title ("Cannot save the patient").
  template <class Work>
  void try_or_report(const std::string& title, const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      front_end.report_error(title, in_words(error.what()));
    }
  }
};

}  // namespace condyle
