#include "sim/ct_session/ct_import.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "engine/volume/volume_files.h"
#include "sim/case/case_io.h"
#include "sim/ct_session/slice_picture.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

constexpr int solid_pixels = 360;
constexpr double lowest_bone_hu = -200, highest_bone_hu = 2500;  // as --threshold is useful

/// The name without the ending of a volume.
std::string stem_of(const fs::path& scan) {
  std::string name = scan.filename().string();
  for (const char* ending : {".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".nii"})
    if (name.ends_with(ending) && name.size() > std::string(ending).size())
      return name.substr(0, name.size() - std::string(ending).size());
  return name;
}

/// A new folder beside the scan, or in the user's home where the scan lies on a disc that cannot be
/// written.
fs::path folder_for_patient(const fs::path& scan) {
  std::error_code ignored;
  const fs::path whole = (fs::absolute(scan, ignored) / "").lexically_normal().parent_path();
  const std::string name = stem_of(whole) + "-patient";
  fs::path above = whole.parent_path();
  const char* home = std::getenv("HOME");
  if (::access(above.c_str(), W_OK) != 0 && home) above = home;
  fs::path folder = above / name;
  for (int i = 2; fs::exists(folder, ignored); ++i) folder = above / fmt::format("{}-{}", name, i);
  return folder;
}

/// throws: InputError where the folder cannot take a new case, before the work begins.
void check_new_folder(const fs::path& folder) {
  if (folder.empty())
    throw InputError("the patient needs a folder: type one that does not exist yet");
  std::error_code ignored;
  if (fs::exists(folder, ignored) &&
      !(fs::is_directory(folder, ignored) && fs::is_empty(folder, ignored)))
    throw InputError(folder, "", "exists already: the patient needs a new or an empty folder");
  fs::path above = fs::absolute(folder, ignored);
  while (!fs::exists(above, ignored) && above.has_relative_path()) above = above.parent_path();
  if (!fs::is_directory(above, ignored) || ::access(above.c_str(), W_OK) != 0)
    throw InputError(folder, "", "cannot be written: choose another folder for the patient");
}

/// Whether a value within 4 mm of the point is as high as bone.
bool is_near_bone(const Volume& volume, const Eigen::Vector3d& point, double threshold_hu) {
  constexpr double reach_mm = 4;  // as seed_labels() searches
  const Eigen::Vector3d at =
      (volume.axes.transpose() * (point - volume.origin)).cwiseQuotient(volume.spacing_mm);
  std::array<int, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const double reach = reach_mm / volume.spacing_mm[axis];
    low[a] = std::max(0, static_cast<int>(std::ceil(at[axis] - reach)));
    high[a] = std::min(volume.size[a] - 1, static_cast<int>(std::floor(at[axis] + reach)));
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i)
        if (volume.at(i, j, k) >= threshold_hu &&
            (volume.position(i, j, k) - point).norm() <= reach_mm)
          return true;
  return false;
}

/// On seeds that are not on bone; empty if all are.
std::string remark_on_seeds(const Volume& volume, const CtChoice& choice) {
  std::string numbers;
  int count = 0;
  for (std::size_t i = 0; i < choice.seeds.size(); ++i) {
    if (is_near_bone(volume, choice.seeds[i].position, choice.threshold_hu)) continue;
    numbers += fmt::format("{}{}", count++ == 0 ? "" : ", ", i + 1);
  }
  if (count == 0) return {};
  return fmt::format("{} {}: no bone above {:.0f} HU within 4 mm; remove {}",
                     count == 1 ? "Seed" : "Seeds", numbers, choice.threshold_hu,
                     count == 1 ? "it" : "them");
}

CtChoice first_choice(const ReadScan& scan) {
  return {.cross = centre_of(scan.ct.volume), .threshold_hu = scan.levels.low_bone()};
}

CtPictures pictures_of(const ReadScan& scan, const CtChoice& choice, bool slices, bool solid,
                       int threads) {
  CtPictures pictures;
  const SliceLevels levels{choice.threshold_hu, scan.levels.skin()};
  if (slices) pictures.slices.emplace();
  for (std::size_t i = 0; slices && i < 3; ++i)
    (*pictures.slices)[i] =
        draw_slice(scan.ct.volume, static_cast<SliceSide>(i), choice.cross, levels, threads);
  if (solid)
    pictures.solid = std::make_shared<const CtPixels>(scan.solid->picture(
        solid_pixels, choice.threshold_hu, choice.turn_deg, choice.tilt_deg, threads));
  return pictures;
}

}  // namespace

std::optional<fs::path> scan_of(const std::vector<fs::path>& files) {
  if (files.empty()) return {};
  const fs::path& one = files.front();
  std::error_code ignored;
  if (fs::is_directory(one, ignored)) return holds_dicom(one) ? std::optional(one) : std::nullopt;
  if (is_volume_file(one)) return one;
  if (!is_dicom_file(one)) return {};
  const fs::path folder = fs::absolute(one, ignored).parent_path();
  return folder;
}

Case make_ct_patient(const CtMaking& making, const Progress& progress) {
  const Case model = builtin_patient(progress);
  CtCase made = case_of_ct(making.scan->ct.volume, model, making.request, progress);
  const auto& notes = making.scan->ct.notes;
  made.patient.notes.insert(made.patient.notes.begin(), notes.begin(), notes.end());
  report(progress, "saving the patient", 0.97);
  save_case(made.patient, making.folder);
  return load_case(making.folder);
}

void CtImport::show(const std::function<void(CtView&)>& edit) {
  auto view = view_ ? std::make_shared<CtView>(*view_) : std::make_shared<CtView>();
  edit(*view);
  view_ = std::move(view);
}

void CtImport::open(const fs::path& scan) {
  close();
  path_ = scan;
  std::error_code ignored;
  const bool is_folder = fs::is_directory(scan, ignored);
  show([&](CtView& view) {
    view.opened = ++opened_;
    view.name = (scan / "").parent_path().filename().string();
    view.case_folder = folder_for_patient(scan);
    if (!is_folder) {
      view.series = {{.number = 0, .facts = "One volume", .readable = true}};
      view.best = 0;
    }
  });
  if (!is_folder) return start_reading(0);
  job_.start([scan, threads = threads_](const Progress& progress) {
    report(progress, "listing the series", 0);
    const Progress listing = [&](std::string_view, double fraction) {
      report(progress, "listing the series", fraction);
    };
    return Done{.folder = std::make_shared<const CtFolder>(scan, threads, listing),
                .scan = {},
                .pictures = {}};
  });
}

void CtImport::read(int series, bool interpolate) {
  if (!view_ || making() || !folder_) return;
  const auto known = std::find_if(view_->series.begin(), view_->series.end(),
                                  [&](const CtSeriesItem& one) { return one.number == series; });
  if (known != view_->series.end()) start_reading(series, interpolate);
}

void CtImport::start_reading(int series, bool interpolate) {
  scan_.reset();
  stop_drawing();
  show([](CtView& view) { view.stage = CtStage::reading; });
  job_.start([path = path_, folder = folder_, series, interpolate,
              threads = threads_](const Progress& progress) {
    report(progress, "reading the scan", 0);
    const Progress reading = [&](std::string_view, double fraction) {
      report(progress, "reading the scan", 0.8 * fraction);
    };
    const CtRequest request{.series = series, .resample = interpolate, .threads = threads};
    auto scan = std::make_shared<ReadScan>();
    scan->ct = folder ? folder->read(request, reading) : ct_volume(path, request, reading);
    report(progress, "reading the scan", 0.8);
    scan->levels = tissue_levels(scan->ct.volume, path.string());
    scan->solid =
        std::make_shared<const SolidScan>(scan->ct.volume, scan->levels.low_bone(), threads);
    report(progress, "drawing the slices", 0.95);
    CtPictures pictures = pictures_of(*scan, first_choice(*scan), true, true, threads);
    return Done{.folder = {}, .scan = std::move(scan), .pictures = std::move(pictures)};
  });
}

void CtImport::list_series(const CtFolder& folder) {
  show([&](CtView& view) {
    view.stage = CtStage::series;
    view.notes = folder.notes();
    for (const CtSeries& one : folder.series()) {
      CtSeriesItem item{one.number, series_facts(one), one.notes, one.readable(false)};
      for (const std::string& problem : one.problems) item.remarks.push_back("refused: " + problem);
      if (!one.uneven.empty()) item.remarks.push_back("uneven: " + one.uneven);
      item.uneven = one.readable(true) && !one.readable(false);
      view.series.push_back(std::move(item));
    }
    try {
      const int best = folder.default_series(false);
      for (std::size_t i = 0; i < view.series.size(); ++i)
        if (view.series[i].number == best) view.best = static_cast<int>(i);
    } catch (const InputError& error) {
      view.no_best = error.what();
    }
  });
}

/// Draws pictures of the present choice, after those that are being drawn.
void CtImport::draw(bool slices, bool solid) {
  slices_due_ |= slices;
  solid_due_ |= solid;
  if (drawing_.active() || !(slices_due_ || solid_due_)) return;
  drawing_.start([scan = scan_, choice = choice_, slices = std::exchange(slices_due_, false),
                  solid = std::exchange(solid_due_, false), threads = threads_](const Progress&) {
    return pictures_of(*scan, choice, slices, solid, threads);
  });
}

void CtImport::stop_drawing() {
  drawing_.drop();
  slices_due_ = solid_due_ = false;
}

void CtImport::show_pictures(CtPictures pictures) {
  show([&](CtView& view) {
    if (pictures.slices) view.slices = std::move(*pictures.slices);
    if (pictures.solid) view.solid = std::move(pictures.solid);
  });
}

bool CtImport::take_pictures() {
  if (!drawing_.done()) return false;
  std::optional<CtPictures> pictures;
  try {
    pictures = drawing_.take();
  } catch (...) {
    draw(false, false);
    throw;
  }
  draw(false, false);
  if (!pictures) return false;
  show_pictures(std::move(*pictures));
  return true;
}

void CtImport::show_scan(const Done& read) {
  scan_ = read.scan;
  choice_ = first_choice(*scan_);
  show([&](CtView& view) {
    view.stage = CtStage::slices;
    view.volume_notes = scan_->ct.notes;
    view.first = view.chosen = choice_;
    view.lowest_hu = lowest_bone_hu;
    view.highest_hu = highest_bone_hu;
    ++opened_;
    view.opened = opened_;  // choices of another volume are void
  });
  show_pictures(read.pictures);
}

void CtImport::choose(const CtChoice& choice) {
  if (!scan_ || !view_ || choice == choice_) return;
  const bool threshold = choice.threshold_hu != choice_.threshold_hu;
  const bool slices = threshold || choice.cross != choice_.cross;
  const bool solid =
      threshold || choice.turn_deg != choice_.turn_deg || choice.tilt_deg != choice_.tilt_deg;
  choice_ = choice;
  show([&](CtView& view) {
    view.chosen = choice_;
    view.seed_remark = remark_on_seeds(scan_->ct.volume, choice_);
  });
  draw(slices, solid);
}

CtMaking CtImport::begin_making(const fs::path& folder) {
  if (!scan_) throw InputError("no scan has been read yet");
  if (const std::string remark = remark_on_seeds(scan_->ct.volume, choice_); !remark.empty())
    throw InputError(remark);
  check_new_folder(folder);
  CtMaking making{.scan = scan_, .request = {}, .folder = folder};
  CtCaseRequest& request = making.request;
  request.name = (folder / "").parent_path().filename().string();
  request.source = path_.string();
  request.threads = threads_;
  if (choice_.threshold_hu != view_->first.threshold_hu)
    request.threshold_hu = choice_.threshold_hu;
  for (const CtSeed& seed : choice_.seeds)
    request.seeds.push_back({seed.position, seed.in_jaw ? mandible_label : skull_label});
  show([](CtView& view) { view.stage = CtStage::making; });
  return making;
}

void CtImport::end_making() {
  if (making()) show([](CtView& view) { view.stage = CtStage::slices; });
}

void CtImport::cancel() {
  if (!job_.active()) return;
  job_.drop();
  if (!folder_) return close();
  show([](CtView& view) { view.stage = CtStage::series; });
}

void CtImport::close() {
  job_.drop();
  stop_drawing();
  view_.reset();
  scan_.reset();
  folder_.reset();
  choice_ = {};
}

bool CtImport::update() {
  const bool has_pictures = take_pictures();
  if (!job_.done()) return has_pictures;
  try {
    const auto done = job_.take();
    if (!done) return has_pictures;
    if (done->folder) {
      folder_ = done->folder;
      list_series(*folder_);
    }
    if (done->scan) show_scan(*done);
  } catch (...) {
    if (folder_)
      show([](CtView& view) { view.stage = CtStage::series; });
    else
      close();
    throw;
  }
  return true;
}

}  // namespace condyle
