#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "render/window/recent_files.h"
#include "render/window/window.h"
#include "sim/contact/live_distances.h"
#include "sim/dynamics/jaw_let_go.h"
#include "sim/dynamics/let_go.h"
#include "sim/simulator/live.h"
#include "tools/background_work.h"
#include "tools/view_motion.h"
#include "tools/view_overlays.h"
#include "tools/view_recording.h"
#include "tools/window_words.h"

namespace condyle {

/// What goes on behind a window: loading, simulating, plotting, recording, each beside it, so that
/// the window answers at all times.
class ViewSession {
 public:
  ViewSession(Window& window, const ViewOptions& options, const CommonOptions& common);

  /// Loads the case in a folder, or the built-in patient when it is empty.
  void open_patient(const std::filesystem::path& folder);
  /// Opens what is named as if it were dropped into the window; the built-in patient when it is
  /// empty.
  void open(const std::filesystem::path& path);
  /// One turn: what the person wants goes out, what is ready comes in, the picture is drawn.
  void turn();

  /// The newest frame; none before the first.
  const FrameState* frame() const { return newest_ ? &*newest_ : nullptr; }
  /// What runs beside and is shown as progress; empty for nothing.
  const std::string& busy_with() const { return busy_with_; }
  /// Whether the window may go that the person has closed; asks them while a recording is made.
  bool may_close();
  /// Ends a recording. gives: what is there of it, as a sentence; empty when there was none.
  std::string stop_recording();

 private:
  using PatientPtr = std::shared_ptr<const ViewPatient>;
  using MotionPtr = std::shared_ptr<const ViewMotion>;

  void load(std::function<Case(const Progress&)> read, std::filesystem::path folder,
            std::string words);
  void take_patient();
  void want_motion(const MotionChoice& choice);
  void take_motion();
  void take_plots();
  // view_wishes.cpp:
  void record(std::shared_ptr<const ViewRecording> subject, Existing existing);
  void take_recording();
  void ask_about(const ViewRecorded& found);
  void take_let_go();
  void let_jaw_go(std::size_t body);
  void let_fall();
  void end_fall();
  void hold_fall();
  std::string name_of(const MovableBody& body) const;
  void drop_let_go(std::string_view why);
  std::string overtaken_by() const;
  void take_save();
  void carry_out(const wish::Open& wanted);
  void carry_out(const wish::Import& wanted);
  void carry_out(const wish::Record& wanted);
  void carry_out(const wish::StopRecording& wanted);
  void carry_out(const wish::ResumeRecording& wanted);
  void carry_out(const wish::ReplaceRecording& wanted);
  void carry_out(const wish::Quit& wanted);
  void carry_out(const wish::Cancel& wanted);
  void carry_out(const wish::LetGo& wanted);
  void carry_out(const wish::SaveCase& wanted);
  void carry_out(const wish::UseLandmarks& wanted);
  bool obeys_contact() const;
  WindowScene scene_of_patient() const;
  void show_scene();  // once more, with what is new
  void show_progress();
  void simulate(const ViewState& view);  // view_live.cpp
  void show(MotionPictures pictures);

  /// As the window says it, with names of the patient's parts and landmarks as people read them.
  std::string in_words(std::string sentence) const;
  /// Runs a piece of work, its trouble told as a sentence.
  template <class Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      window_.report_error(in_words(error.what()));
    }
  }
  template <class Result>
  std::unique_ptr<BackgroundWork<Result>> beside(
      std::function<Result(const Progress&)> work) const {
    return std::make_unique<BackgroundWork<Result>>(std::move(work), [] { Window::wake(); });
  }
  /// Ends work that is not wanted any more without waiting for it.
  template <class Result>
  void retire(std::unique_ptr<BackgroundWork<Result>>& work) {
    if (!work) return;
    work->cancel();
    end_with(std::shared_ptr<BackgroundWork<Result>>(std::move(work)));
  }
  /// Takes apart what runs, or is large, on a thread of its own; the patient that it works on stays
  /// as long.
  template <class Thing>
  void retire(std::shared_ptr<Thing>& thing) {
    if (!thing) return;
    struct Retired {
      PatientPtr patient;
      std::shared_ptr<Thing> thing;  // goes first
    };
    auto retired = std::make_shared<Retired>(Retired{patient_, std::move(thing)});
    end_with(std::make_shared<BackgroundWork<bool>>(
        [retired](const Progress&) {
          retired->thing.reset();
          retired->patient.reset();
          return true;
        },
        [] {}));
  }
  template <class Result>
  void end_with(std::shared_ptr<BackgroundWork<Result>> work) {
    ending_.push_back([work] { return work->done(); });
  }

  struct LetGoResult {
    std::size_t body;
    Pose in_carrier;  // of a free part, at rest
    std::string words;
    JawLetGo course;  // of a jaw
  };
  /// What was let go, and what the person wants of the patient meanwhile; otherwise it is
  /// overtaken.
  struct Loosed {
    MovableBody body;
    std::string name;
    Hands hands;
    MotionChoice motion;
    std::optional<double> opening_mm;
    double time_s = 0;
    std::optional<Hands> before = {};  // where it is wanted again if it cannot be let go

    static Loosed now(const MovableBody& body, std::string name, const ViewState& view) {
      return {body, std::move(name), view.hands, view.motion, view.opening_mm, view.time_s};
    }
  };
  /// A jaw that was let go and is on its way, as time runs.
  struct Falling {
    LetGoResult of;
    std::vector<double> shown_s;  // of each of its poses
    std::chrono::steady_clock::time_point start;
    Pose X_CM;  // by now
  };

  Window& window_;
  ViewOptions options_;
  CommonOptions common_;
  SimulatorSettings settings_;
  RecentFiles recent_;

  PatientPtr patient_;
  int opened_ = 0;  // patients so far; one that is made anew is the same
  std::optional<std::vector<Landmark>> renewing_;  // what is loading is this patient, with these
  MotionPtr motion_;
  MotionChoice asked_;  // the motion that is being made, or was made last
  WindowScene shown_;
  std::optional<FrameState> newest_;
  Hands moved_;
  std::optional<Falling> falling_;
  std::string busy_with_;
  std::shared_ptr<const LineSet> paths_;  // of the motion, as far as they are known
  std::optional<OverlayWish> overlaid_;   // what the window's overlays were made for
  bool map_sent_ = false, coloured_ = false, plots_due_ = false;
  PatientPtr ready_for_;  // whose bones are, or are being made, ready to slide

  struct Saved {
    int opened;
    std::vector<Landmark> landmarks;
    std::filesystem::path folder;
  };
  /// Plots as far as they are, from the thread that makes them.
  struct PlotPost {
    std::mutex mutex;
    std::optional<MotionPictures> pictures;
  };

  // The recording that is made or was asked about, and one that can go on.
  std::shared_ptr<const ViewRecording> recorded_, unfinished_;
  bool quit_when_recorded_ = false, quits_ = false;

  // What runs beside, last of all members: it ends first.
  std::vector<std::function<bool()>> ending_;  // whether it has ended
  std::shared_ptr<PlotPost> plot_post_;
  std::shared_ptr<LiveDistances> distances_;
  std::shared_ptr<LiveSimulation> simulation_;
  std::unique_ptr<BackgroundWork<PatientPtr>> loading_;
  std::unique_ptr<BackgroundWork<MotionPtr>> moving_;
  std::unique_ptr<BackgroundWork<bool>> readying_;  // bones to slide
  std::unique_ptr<BackgroundWork<MotionPictures>> plotting_;
  std::unique_ptr<BackgroundWork<ViewRecorded>> recording_;
  std::unique_ptr<BackgroundWork<LetGoResult>> letting_go_;
  Loosed loosed_;  // while it is being let go, or falls
  std::unique_ptr<BackgroundWork<Saved>> saving_;
};

}  // namespace condyle
