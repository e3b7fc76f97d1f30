#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/dicom/ct_folder.h"
#include "engine/segmentation/tissue_levels.h"
#include "sim/choice/ct_view.h"
#include "sim/ct_case/ct_case.h"
#include "sim/ct_session/solid_picture.h"
#include "sim/session/job.h"

namespace condyle {

/// The scan that paths name: a folder with DICOM files, a volume file, or files of a DICOM series,
/// for which their folder is taken. None: they are no scan.
std::optional<std::filesystem::path> scan_of(const std::vector<std::filesystem::path>& files);

/// A volume as it is shown.
struct ReadScan {
  CtVolume ct;
  TissueLevels levels;
  std::shared_ptr<const SolidScan> solid;
};

/// New pictures of a volume; absent ones have not changed.
struct CtPictures {
  std::optional<std::array<CtSliceView, 3>> slices;
  std::shared_ptr<const CtPixels> solid;
};

/// A patient to be made of a scan.
struct CtMaking {
  std::shared_ptr<const ReadScan> scan;
  CtCaseRequest request;
  std::filesystem::path folder;  // of the case
};

/// Makes the patient, saves it in its folder and loads it from there. throws: InputError as
/// case_of_ct(), MachineError where it cannot be saved.
Case make_ct_patient(const CtMaking& making, const Progress& progress);

/// The import of a CT behind a front end: series are listed and read, and pictures drawn, in the
/// background.
class CtImport {
 public:
  CtImport(RetiredWork& retired, std::function<void()> notify, int threads)
      : threads_(threads), job_(retired, notify), drawing_(retired, std::move(notify)) {}

  /// Lists the series of a folder, or reads the volume of a file.
  void open(const std::filesystem::path& scan);
  /// Reads a series of the list, by its number. `interpolate`: slices that are missing or uneven,
  /// for which it is refused otherwise.
  void read(int series, bool interpolate = false);
  /// What the user has chosen; its pictures follow. Nothing without a volume.
  void choose(const CtChoice& choice);
  /// The patient as chosen, for make_ct_patient(); the view waits for it. throws: InputError for a
  /// folder that cannot take a case.
  CtMaking begin_making(const std::filesystem::path& folder);
  /// Making the patient was cancelled or has failed.
  void end_making();
  bool making() const { return view_ && view_->stage == CtStage::making; }
  /// Ends the work in the background. What was there before stays.
  void cancel();
  void close();

  /// Takes finished work. Returns whether the view has changed. throws: what ended the work, after
  /// which the view is as before the work; without one the import is closed.
  bool update();
  /// Whether pictures of the choice are still to come.
  bool drawing() const { return drawing_.active(); }
  /// None: nothing is imported.
  const std::shared_ptr<const CtView>& view() const { return view_; }
  const CtChoice& choice() const { return choice_; }

 private:
  /// Result of work in the background: one of them.
  struct Done {
    std::shared_ptr<const CtFolder> folder;
    std::shared_ptr<const ReadScan> scan;
    CtPictures pictures;  // of the scan as first shown
  };

 public:
  const Job<Done>& job() const { return job_; }

 private:
  void start_reading(int series, bool interpolate = false);
  void show(const std::function<void(CtView&)>& edit);
  void list_series(const CtFolder& folder);
  void show_scan(const Done& read);
  void draw(bool slices, bool solid);
  void show_pictures(CtPictures pictures);
  bool take_pictures();
  void stop_drawing();

  int threads_;
  int opened_ = 0;
  std::filesystem::path path_;
  std::shared_ptr<const CtFolder> folder_;  // none: of a file
  std::shared_ptr<const ReadScan> scan_;    // none: not read yet
  CtChoice choice_;
  std::shared_ptr<const CtView> view_;
  Job<Done> job_;
  Job<CtPictures> drawing_;
  bool slices_due_ = false, solid_due_ = false;  // to be drawn after the present drawing
};

}  // namespace condyle
