#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "render/session/file_dialog.h"
#include "render/session/live_session.h"
#include "render/session/patient_loader.h"
#include "render/session/plan_session.h"
#include "render/session/preview_session.h"
#include "render/session/recording_session.h"
#include "render/session/release_session.h"
#include "render/session/saving_session.h"
#include "sim/ct_session/ct_import.h"
#include "sim/session/recent_files.h"

namespace condyle {

/// A patient in a front end: loading, simulation, plots, recording and saving, each on its own
/// threads, so that the front end always responds.
class ViewSession {
 public:
  /// The front end must outlive the session.
  ViewSession(FrontEnd& front_end, const SessionSettings& settings);

  /// Begins: opens a path as if it were dropped onto the front end; the built-in patient if it is
  /// empty. If a session can be recovered, the user is asked before.
  void begin(const std::filesystem::path& path);
  /// Ends as the user asked: there is nothing to recover.
  void end() { saving_session_.end(); }
  /// One turn: carries out requests, takes finished results, draws the picture.
  void turn();

  /// The newest frame; none before the first.
  const FrameState* frame() const { return state_.newest ? &*state_.newest : nullptr; }
  /// Background work shown as progress; empty for none.
  const std::string& busy_with() const { return busy_with_; }
  /// Whether the front end may close as requested; asks the user while a recording runs.
  bool may_close() { return recording_.may_close(); }
  /// Ends a recording. Returns its state as a sentence; empty if there was none.
  std::string stop_recording() { return recording_.finish(); }

 private:
  struct Saved {
    int opened;
    std::vector<Landmark> landmarks;
    std::filesystem::path folder;
  };

  // session_requests.cpp:
  void open(const std::filesystem::path& path);
  void carry_out(const Request& request);
  void open_files(const std::vector<std::filesystem::path>& files);
  void open_file(const std::filesystem::path& file);
  void cancel();
  void save(const std::filesystem::path& folder);
  void take_save();
  void save_plan(const std::filesystem::path& file);
  void recover(const request::Recover& answer);
  void take_chosen_files();
  void take_saved_session();

  // ct_requests.cpp:
  void open_scan(const std::filesystem::path& scan);
  void make_ct_patient(const std::filesystem::path& folder);
  void take_ct();
  void show_ct();
  void close_ct();

  void take_patient();
  void take_plan();
  void install(std::shared_ptr<const SessionPatient> patient, std::string_view why);
  void show_new_patient(const OpenedSession* opened);
  void show_opened_session(const OpenedSession& opened);
  void resume_view();
  void show_planned_patient(const std::map<std::string, PartView>& earlier,
                            const std::string& chosen, bool new_parts);
  void extend_face(const ViewState& view);
  void show_renewed_patient(const std::vector<Landmark>& landmarks);
  void want_motion(const MotionChoice& choice);
  void take_motion();
  void keep_motion();
  void prepare_sliding();
  bool obeys_contact() const;
  std::optional<std::size_t> drawn_part_now(const DrawnCut& drawn) const;
  WindowScene scene_of_patient() const;
  void use_clinical_axes(std::vector<MovableBody>& bodies) const;
  void show_scene();  // again, after changes
  std::string lacking_for_face();
  std::vector<std::string> notes() const;
  void follow_expression();
  void show_progress();

  /// A part of the patient before an edit of its plan.
  struct EarlierPart {
    std::string name;
    std::size_t vertices = 0;
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();  // its first vertex
  };

  SessionState state_;
  std::vector<EarlierPart> drawn_parts_;
  RecentFiles recent_;
  int opened_ = 0;      // number of patients so far; a rebuilt one is the same
  MotionChoice asked_;  // the motion in preparation, or the last one
  std::shared_ptr<const SessionPatient> ready_for_;  // whose bones are, or are being, prepared
  std::string busy_with_;
  std::filesystem::path first_path_;  // that begin() was asked to open
  std::optional<ViewState> resumed_;  // of an opened session, until its motion is there

  PatientLoader loader_;
  CtImport ct_;
  PlanSession plan_;
  Job<std::shared_ptr<const SessionMotion>> moving_;
  std::string lacking_for_face_;  // as noted of the face
  struct LidsNote {
    std::weak_ptr<const SessionPatient> of;
    std::string text;
  };
  LidsNote lids_note_;               // from the first slider or motion that moves lids on
  bool motion_lifts_brows_ = false;  // the present motion, see TissueSettings::upper_face
  bool motion_moves_lids_ = false;
  std::shared_ptr<const SessionPatient> face_asked_for_;  // when the upper face was added
  Job<bool> readying_;                                    // bones to slide
  Job<Saved> saving_;
  PreviewSession preview_;
  RecordingSession recording_;
  ReleaseSession release_;
  LiveSession live_;
  SavingSession saving_session_;
  FileDialog dialog_;
};

}  // namespace condyle
