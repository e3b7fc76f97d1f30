#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/dicom/slice_groups.h"
#include "engine/dicom/slice_stack.h"
#include "engine/volume/volume.h"

namespace condyle {

enum class SeriesKind { volume, scout, one_slice, one_position, not_ct };
/// "CT", "scout", "one slice" and so on.
const char* series_kind_name(SeriesKind kind);

/// What is known of a series without its pixels. No text names a person, a date, a file or an
/// identifier.
struct CtSeries {
  int number = 0;  // from 1
  SeriesKind kind = SeriesKind::volume;
  std::string modality, kernel, manufacturer, coding;
  double kvp = 0, thickness_mm = 0;  // 0: not stated
  int slices = 0, rows = 0, columns = 0;
  double column_spacing_mm = 0, row_spacing_mm = 0;  // between columns, between rows
  double step_mm = 0;                                // between slices, along their normal
  double length_mm = 0;                              // of all slices, along their normal
  double tilt_degrees = 0;
  std::vector<std::string> notes;     // what is left out or corrected
  std::vector<std::string> problems;  // why it is refused
  std::string uneven;                 // why it is refused unless resampled; empty: it is even

  Eigen::Vector3d extent_mm() const {
    return {columns * column_spacing_mm, rows * row_spacing_mm, length_mm};
  }
  bool readable(bool resample) const { return problems.empty() && (resample || uneven.empty()); }
};

/// A series in one line: "CT, 210 slices of 512 x 512, ...".
std::string series_facts(const CtSeries& series);

struct CtFileCounts {
  int files = 0, slices = 0;
  int without_image = 0;  // DICOM files of other content
  int not_dicom = 0, empty = 0, damaged = 0;
};

struct CtRequest {
  int series = 0;         // 0: the default
  bool resample = false;  // slices with uneven steps are interpolated at the median step
  int threads = 2;
};

struct CtVolume {
  Volume volume;
  int series = 0;                  // 0: of a file
  std::vector<std::string> notes;  // what was left out or corrected
};

/// The CT series of a folder and of the folders in it, which is not followed through links.
/// Series are divided by identifier, patient, study, kernel, frame of reference, size and
/// orientation. No message names anything below the folder: files are named by their number in the
/// series, in the order of their names.
class CtFolder {
 public:
  /// Reads all headers. throws: InputError for a folder that does not exist or has more than
  /// 100,000 files.
  explicit CtFolder(const std::filesystem::path& folder, int threads = 2,
                    const Progress& progress = {});

  const std::vector<CtSeries>& series() const { return series_; }
  const CtFileCounts& counts() const { return counts_; }
  /// What was left out of the folder: "2 files are not DICOM".
  std::vector<std::string> notes() const;

  /// The largest series of CT that can be read with a step of at most 3 mm. throws: InputError
  /// with the reasons if there is none, and where several patients have one.
  int default_series(bool resample) const;

  /// Reads a series in Hounsfield units, LPS. Slices of a tilted gantry are shifted back by
  /// interpolation, into a larger lattice; what lies outside them is air. throws: InputError with
  /// the first problem.
  CtVolume read(const CtRequest& request, const Progress& progress = {}) const;

 private:
  void add_series(const SliceGroup& group);
  void note_shared_identifiers();

  std::filesystem::path folder_;
  std::vector<SliceGroup> groups_;         // as series_
  std::vector<StackGeometry> geometries_;  // as series_
  std::vector<CtSeries> series_;
  CtFileCounts counts_;
};

}  // namespace condyle
