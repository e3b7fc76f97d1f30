#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/camera.h"
#include "render/scene_renderer.h"
#include "render/window/record_choice.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// How the jaw is wanted to move: what a command line says, as values.
struct MotionChoice {
  std::string spec;                           // a name, a file or movements in words
  std::map<std::string, double> parameters;   // by name, where they differ from the case's
  std::map<std::string, double> excitations;  // by group of muscles, where they are set by hand
  bool operator==(const MotionChoice&) const = default;
};

/// One number that shapes the motion, as the panel shows it.
struct MotionSetting {
  std::string name, label, unit, help;
  double low = 0, high = 1;              // what is accepted
  double usual_low = 0, usual_high = 0;  // published band of adults; none when equal
  double value = 0;                      // in use
  bool known = true;                     // false: what the patient's joints and teeth give
  std::optional<double> patients = {};   // that
};

/// One group of muscles: 0 to 1 of what it can do, or a share of what the motion's file says.
struct ExcitationSetting {
  std::string name, label;
  double high = 1, value = 0;
};

/// A surface, a list of landmarks or a table of muscles that shall become part of a patient.
struct FileRole {
  std::filesystem::path file;
  // "mandible", "upper-teeth", ..., "landmarks", "muscles", or empty: leave it out
  std::string role;
  // The role that its name tells, where another file of the same thing has it.
  std::string taken = {};
};

/// What the person asks for once. Whoever runs the window does it.
namespace wish {
/// Whatever it is: a case folder, a motion; several may be surfaces. None: the built-in patient.
struct Open {
  std::vector<std::filesystem::path> files;
};
struct Import {
  std::vector<FileRole> files;
  std::string units = "mm", frame = "LPS";
};
/// A film or pictures of the motion, all as the window shows it now.
struct Record {
  std::filesystem::path folder;
  int width = 1920, height = 1080;
  double frames_per_second = 30;
  bool film = true;
  // Names as a command line has them, files of a view or a path of views, and the window's own two.
  std::vector<std::string> cameras = {own_camera};
  std::string caption = {};  // with braces to fill in
  bool transparent = false;
  int supersampling = 1;
  RecordEdges edges = RecordEdges::msaa;
  Camera camera;                        // the window's, in the cranium's frame
  Eigen::Vector3d upright = {0, 0, 1};  // what it turns about: the room's, in the cranium's frame
  PictureSettings picture;
  std::shared_ptr<const FrameState> kept = {};  // left of the wipe, if there is one
};
struct StopRecording {};
/// The recording that was stopped or asked about goes on with the pictures that are there.
struct ResumeRecording {};
/// The recording that was asked about takes the place of what is in its folder.
struct ReplaceRecording {};
/// A recording is being made: it is stopped, or awaited.
struct Quit {
  bool when_recorded = false;
};
/// Ends what runs beside, other than a recording.
struct Cancel {};
/// Lets the dynamics take a free body from where the hand has it.
struct LetGo {
  std::size_t body = 0;  // of the scene's
};
struct SaveCase {
  std::filesystem::path folder;
};
/// Makes what is simulated anew with the landmarks as the person has them.
struct UseLandmarks {};
}  // namespace wish

using Wish = std::variant<wish::Open, wish::Import, wish::Record, wish::StopRecording,
                          wish::ResumeRecording, wish::ReplaceRecording, wish::Quit, wish::Cancel,
                          wish::LetGo, wish::SaveCase, wish::UseLandmarks>;

/// What a person is asked before something is done.
struct Question {
  struct Answer {
    std::string item, label;
    std::optional<Wish> wish = {};  // none: nothing is done
  };
  std::string title, words;
  std::vector<Answer> answers;  // Enter gives the first, which loses nothing; Esc gives none
};

}  // namespace condyle
