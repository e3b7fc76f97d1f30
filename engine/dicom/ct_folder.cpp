#include "engine/dicom/ct_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/dicom/assemble_volume.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t most_files = 100000;
constexpr int deepest_folder = 16;
constexpr double most_step_mm = 3;  // of the default series

/// All files of the folder, sorted by name.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(folder, "", "is not a folder");
  std::vector<fs::path> files;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                         error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (entry.depth() >= deepest_folder) entry.disable_recursion_pending();
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    if (files.size() > most_files)
      throw InputError(folder, "", fmt::format("has more than {} files", most_files));
  }
  if (error) throw InputError(folder, "", "cannot be listed: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

SeriesKind kind_of(const SliceGroup& group, const StackGeometry& geometry) {
  const SliceHeader& first = group.slices.front();
  if (!first.is_ct) return SeriesKind::not_ct;
  if (first.is_scout) return SeriesKind::scout;
  if (group.slices.size() == 1) return SeriesKind::one_slice;
  return geometry.step_mm == 0 && first.problem.empty() ? SeriesKind::one_position
                                                        : SeriesKind::volume;
}

/// Why a series of this kind is no volume; empty for CT.
std::string kind_problem(SeriesKind kind, const std::string& modality) {
  switch (kind) {
    case SeriesKind::volume:
      return "";
    case SeriesKind::scout:
      return "is a scout view, not a volume";
    case SeriesKind::one_slice:
      return "has one slice";
    case SeriesKind::one_position:
      return "has all slices at one position";
    case SeriesKind::not_ct:
      break;
  }
  return modality == "other" ? "is not CT" : "is " + modality + ", not CT";
}

std::string counted(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// In what two series differ that share an identifier.
std::string differences(const SliceHeader& a, const SliceHeader& b) {
  std::string words;
  const auto add = [&](bool differ, const char* what) {
    if (differ) words += (words.empty() ? "" : ", ") + std::string(what);
  };
  add(a.patient != b.patient, "patient");
  add(a.study != b.study, "study");
  add(a.kernel_text != b.kernel_text, "kernel");
  add(a.frame_of_reference != b.frame_of_reference, "frame of reference");
  add(a.modality != b.modality, "modality");
  add(a.pixels.rows != b.pixels.rows || a.pixels.columns != b.pixels.columns, "size");
  return words.empty() ? "kind of image" : words;
}

}  // namespace

const char* series_kind_name(SeriesKind kind) {
  switch (kind) {
    case SeriesKind::volume:
      return "CT";
    case SeriesKind::scout:
      return "scout";
    case SeriesKind::one_slice:
      return "one slice";
    case SeriesKind::one_position:
      return "one position";
    case SeriesKind::not_ct:
      break;
  }
  return "not CT";
}

CtFolder::CtFolder(const fs::path& folder, int threads, const Progress& progress)
    : folder_(folder) {
  constexpr std::size_t chunk = 64;
  const std::vector<fs::path> files = files_below(folder);
  std::vector<FileHeader> headers(files.size());
  for (std::size_t begin = 0; begin < files.size(); begin += chunk) {
    report(progress, "headers", static_cast<double>(begin) / static_cast<double>(files.size()));
    parallel_for(std::min(chunk, files.size() - begin), threads,
                 [&](std::size_t i) { headers[begin + i] = read_file_header(files[begin + i]); });
  }
  counts_.files = static_cast<int>(files.size());
  std::vector<SliceHeader> slices;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    headers[i].slice.place = static_cast<int>(i);
    switch (headers[i].kind) {
      case DicomFileKind::slice:
        ++counts_.slices;
        slices.push_back(std::move(headers[i].slice));
        break;
      case DicomFileKind::without_image:
        ++counts_.without_image;
        break;
      case DicomFileKind::not_dicom:
        ++counts_.not_dicom;
        break;
      case DicomFileKind::empty:
        ++counts_.empty;
        break;
      case DicomFileKind::damaged:
        ++counts_.damaged;
        break;
    }
  }
  groups_ = group_slices(std::move(slices));
  for (const SliceGroup& group : groups_) add_series(group);
  note_shared_identifiers();
}

void CtFolder::add_series(const SliceGroup& group) {
  const SliceHeader& first = group.slices.front();
  geometries_.push_back(stack_geometry(group.slices));
  const StackGeometry& geometry = geometries_.back();
  CtSeries one;
  one.number = static_cast<int>(series_.size()) + 1;
  one.kind = kind_of(group, geometry);
  one.modality = first.modality;
  one.kernel = first.kernel;
  one.manufacturer = first.manufacturer;
  one.coding = first.pixels.syntax ? first.pixels.syntax->name : "unknown";
  one.kvp = first.kvp;
  one.thickness_mm = first.thickness_mm;
  one.slices = static_cast<int>(group.slices.size());
  one.rows = first.pixels.rows;
  one.columns = first.pixels.columns;
  one.column_spacing_mm = first.column_spacing_mm;
  one.row_spacing_mm = first.row_spacing_mm;
  one.step_mm = geometry.step_mm;
  if (!geometry.height_mm.empty()) one.length_mm = geometry.height_mm.back() + geometry.step_mm;
  one.notes = group.notes;
  if (const std::string problem = kind_problem(one.kind, one.modality); !problem.empty())
    one.problems.push_back(problem);
  one.problems.insert(one.problems.end(), group.problems.begin(), group.problems.end());
  if (one.kind == SeriesKind::volume) {
    if (one.problems.empty()) one.uneven = geometry.uneven;
    if (geometry.sheared) {
      one.tilt_degrees = geometry.tilt_degrees;
      one.notes.push_back(
          fmt::format("the gantry is tilted by {:.1f} degrees: the slices are shifted back",
                      geometry.tilt_degrees));
    }
    if (first.pixels.syntax && first.pixels.syntax->lossy)
      one.notes.push_back("the compression may be lossy");
  }
  series_.push_back(std::move(one));
}

void CtFolder::note_shared_identifiers() {
  for (std::size_t a = 0; a < groups_.size(); ++a)
    for (std::size_t b = 0; b < groups_.size(); ++b) {
      const SliceHeader &one = groups_[a].slices.front(), &other = groups_[b].slices.front();
      if (a != b && one.series == other.series)
        series_[a].notes.push_back(
            fmt::format("has the identifier of series {}, but differs from it in: {}",
                        series_[b].number, differences(one, other)));
    }
}

std::vector<std::string> CtFolder::notes() const {
  std::vector<std::string> notes;
  if (counts_.not_dicom > 0)
    notes.push_back(counted(counts_.not_dicom, "file is not DICOM", "files are not DICOM"));
  if (counts_.empty > 0)
    notes.push_back(counted(counts_.empty, "file is empty", "files are empty"));
  if (counts_.damaged > 0)
    notes.push_back(counted(counts_.damaged, "DICOM file is damaged and belongs to no known series",
                            "DICOM files are damaged and belong to no known series"));
  if (counts_.without_image > 0)
    notes.push_back(
        counted(counts_.without_image, "DICOM file has no image", "DICOM files have no image"));
  return notes;
}

int CtFolder::default_series(bool resample) const {
  const CtSeries* best = nullptr;
  const auto values = [](const CtSeries& one) {
    return static_cast<double>(one.slices) * one.rows * one.columns;
  };
  std::set<std::uint64_t> patients;
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const CtSeries& one = series_[i];
    if (!one.readable(resample) || one.step_mm > most_step_mm) continue;
    patients.insert(groups_[i].slices.front().patient);
    if (!best || values(one) > values(*best)) best = &one;
  }
  if (patients.size() > 1)
    throw InputError(
        folder_, "",
        fmt::format("holds series of {} patients: choose one by its number", patients.size()));
  if (best) return best->number;
  if (series_.empty())
    throw InputError(
        folder_, "",
        fmt::format("holds no DICOM image among {}", counted(counts_.files, "file", "files")));
  constexpr int most_reasons = 8;
  std::string reasons;
  for (const CtSeries& one : series_) {
    if (one.number > most_reasons) {
      reasons += "; and so on";
      break;
    }
    reasons += fmt::format("{} series {} {}", one.number > 1 ? ";" : "", one.number,
                           !one.problems.empty() ? one.problems.front()
                           : !one.readable(resample)
                               ? "is uneven: " + one.uneven
                               : fmt::format("has a step of {:.3g} mm, above {:.0f} mm: it is read "
                                             "when chosen by its number",
                                             one.step_mm, most_step_mm));
  }
  throw InputError(folder_, "", "no series can be taken by default:" + reasons);
}

CtVolume CtFolder::read(const CtRequest& request, const Progress& progress) const {
  const int number = request.series == 0 ? default_series(request.resample) : request.series;
  if (number < 1 || number > static_cast<int>(series_.size()))
    throw InputError(folder_, fmt::format("series {}", number),
                     fmt::format("does not exist; there are {}", series_.size()));
  const auto at = static_cast<std::size_t>(number - 1);
  const CtSeries& one = series_[at];
  const std::string item = fmt::format("series {}", number);
  if (!one.problems.empty()) throw InputError(folder_, item, one.problems.front());
  if (!one.uneven.empty() && !request.resample)
    throw InputError(folder_, item, one.uneven + ": resample it to read it");
  CtVolume read{{}, number, one.notes};
  try {
    read.volume = assemble_volume(groups_[at].slices, geometries_[at], request.threads, progress);
  } catch (const DicomDamage& damage) {
    throw InputError(folder_, item, damage.what());
  }
  if (!one.uneven.empty()) {
    read.notes.push_back(one.uneven);
    read.notes.push_back(
        fmt::format("the slices were resampled at a step of {:.4g} mm", one.step_mm));
  }
  return read;
}

std::string series_facts(const CtSeries& series) {
  const Eigen::Vector3d extent = series.extent_mm();
  std::string facts =
      fmt::format("{}, {} slice{} of {} x {}", series_kind_name(series.kind), series.slices,
                  series.slices == 1 ? "" : "s", series.columns, series.rows);
  if (series.step_mm > 0)
    facts += fmt::format(", {:.3g} x {:.3g} x {:.3g} mm apart, {:.0f} x {:.0f} x {:.0f} mm in all",
                         series.column_spacing_mm, series.row_spacing_mm, series.step_mm,
                         extent.x(), extent.y(), extent.z());
  if (!series.kernel.empty()) facts += ", kernel " + series.kernel;
  if (series.kvp > 0) facts += fmt::format(", {:g} kVp", series.kvp);
  if (!series.manufacturer.empty()) facts += ", " + series.manufacturer;
  return facts + ", " + series.coding;
}

}  // namespace condyle
