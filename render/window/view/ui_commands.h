#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/camera/camera.h"
#include "render/scene/scene_renderer.h"
#include "render/window/view/record_choice.h"
#include "sim/choice/ct_view.h"
#include "sim/choice/file_role.h"
#include "sim/choice/motion_choice.h"
#include "sim/choice/plan_view.h"
#include "sim/frame/before_operation.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// One-time requests of the user, carried out by the owner of the window.
namespace request {
/// Opens paths of any kind: a case folder, a motion, surfaces. None: the built-in patient.
struct Open {
  std::vector<std::filesystem::path> files;
};
struct Import {
  std::vector<FileRole> files;
  std::string units = "mm", frame = "LPS";
};
/// Records a film or pictures of the motion as the window shows it now.
struct Record {
  std::filesystem::path folder;
  int width = 1920, height = 1080;
  double frames_per_second = 30;
  bool film = true;
  // Names as on the command line, files of a view or a path of views, and the window's own two.
  std::vector<std::string> cameras = {own_camera};
  std::string caption = {};  // with placeholders in braces
  bool transparent = false;
  int supersampling = 1;
  RecordEdges edges = RecordEdges::msaa;
  Camera camera;  // the window's, in the cranium's frame
  Eigen::Vector3d upright = {
      0, 0, 1};  // axis of the turntable: the world's upright, in the cranium's frame
  PictureSettings picture;
  std::shared_ptr<const FrameState> kept = {};         // left of the wipe, if there is one
  std::shared_ptr<const BeforeOperation> before = {};  // if `kept` is the state before it
};
struct StopRecording {};
/// Resumes the recording that was stopped or found, with its existing pictures.
struct ResumeRecording {};
/// Replaces the recording found in the folder.
struct ReplaceRecording {};
/// Quits while a recording runs: it is stopped or completed first.
struct Quit {
  bool when_recorded = false;
};
/// Cancels background work other than a recording.
struct Cancel {};
/// Hands a body over to the dynamics, from the pose in which it is held.
struct Release {
  std::size_t body = 0;  // of the scene's
};
struct SaveCase {
  std::filesystem::path folder;
};
/// Rebuilds the simulation with the edited landmarks.
struct UseLandmarks {};
/// Edits the plan of the operation.
struct EditPlan {
  /// What the user has agreed to.
  enum class Consent { none, below_margins, whole_move, free_part };
  PlanEdit edit;
  Consent consent = Consent::none;
};
/// Shows what an edit of a cut would do; none: no longer.
struct PreviewCut {
  std::optional<PlanEdit> edit;
};
/// Shows the handles of a step of the plan; 0: none.
struct ShowHandles {
  int step = 0;
};
/// Makes a splint of the plan and saves it beside the plan.
struct MakeSplint {
  std::string choice;  // see PlanView
};
/// Removes the splint from the picture.
struct HideSplint {};
struct SavePlan {
  std::filesystem::path file;
};
/// Saves the state of the window: patient, plan, view.
struct SaveSession {
  std::filesystem::path file;
  bool replace = false;  // agreed: another file of this name
};
/// What becomes of the session that a window autosaved before it was killed.
struct Recover {
  enum class Answer { open, discard, later };
  Answer answer = Answer::later;
  std::filesystem::path file;
};
/// Shows the file dialog of the desktop.
struct Browse {
  enum class Purpose { open, save_session, record_folder };
  Purpose purpose = Purpose::open;
  std::filesystem::path start;  // the file or folder that it shows first
};
/// Reads a series of the CT that is imported.
struct ReadSeries {
  int number = 0;
  bool interpolate = false;  // slices that are missing or uneven
};
/// Shows what was chosen of the CT; of successive ones the last counts.
struct ShowCt {
  CtChoice choice;
};
/// Makes the patient of the CT as chosen last, in a new folder.
struct MakeCtPatient {
  std::filesystem::path folder;
};
/// Leaves the import of the CT.
struct CloseCt {};
}  // namespace request

using Request =
    std::variant<request::Open, request::Import, request::Record, request::StopRecording,
                 request::ResumeRecording, request::ReplaceRecording, request::Quit,
                 request::Cancel, request::Release, request::SaveCase, request::UseLandmarks,
                 request::EditPlan, request::PreviewCut, request::ShowHandles, request::MakeSplint,
                 request::HideSplint, request::SavePlan, request::SaveSession, request::Recover,
                 request::Browse, request::ReadSeries, request::ShowCt, request::MakeCtPatient,
                 request::CloseCt>;

/// A question to the user before something is done.
struct Question {
  struct Answer {
    std::string item, label;
    std::optional<Request> request = {};  // none: nothing is done
  };
  std::string title, words;
  std::vector<Answer> answers;             // Enter chooses the first, which loses nothing; Esc none
  std::optional<Request> unanswered = {};  // for Esc; none: nothing is done
};

}  // namespace condyle
