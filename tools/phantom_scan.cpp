#include "tools/phantom_scan.h"

#include <fmt/format.h>

#include <array>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/dicom/write_ct_series.h"
#include "engine/volume/volume_files.h"
#include "sim/case/case_io.h"
#include "sim/case/landmark_files.h"
#include "sim/face_scan/depth_map_files.h"
#include "sim/scanner/laser_scan.h"
#include "sim/scanner/scanner_noise.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Landmarks of the skin that a laser scan shows.
constexpr std::array skin_landmarks = {
    "soft_glabella",    "sellion",           "pronasale",         "subnasale",
    "left_cheilion",    "right_cheilion",    "soft_pogonion",     "labrale_superius",
    "left_exocanthion", "right_exocanthion", "left_endocanthion", "right_endocanthion",
    "left_alare",       "right_alare"};

/// As an observer places them, with a standard deviation of `error_mm` along each axis.
Landmarks observed(const Landmarks& true_ones, const Pose& X_SC, double error_mm,
                   std::uint64_t seed) {
  Landmarks found;
  std::uint64_t number = 0;
  for (const auto& [name, p] : true_ones.points) {
    Vector3d error;
    for (int a = 0; a < 3; ++a) error[a] = error_mm * normal_number(seed, number++);
    found.points[name] = X_SC * p + error;
  }
  return found;
}

void write_ct(const Case& patient, const HeadChoice& choice, const PhantomScanRequest& request,
              const CommonOptions& common, ProgressBar& bar, const fs::path& out) {
  CtSettings settings = request.ct_settings;
  settings.spacing_mm.setConstant(request.voxel_mm);
  settings.seed = request.seed;
  settings.threads = common.threads;
  const CtScan scan =
      scan_ct(ScannedHead(choice, request.tooth_growth_mm), settings, bar.callback());
  bar.show("writing", 0.5);
  write_nrrd(scan.volume, out / "ct.nrrd", NrrdEncoding::gzip);
  write_ct_series(scan.volume, out / "ct");
  constexpr double error_mm = 0.5;
  write_file(out / "ct-landmarks.csv",
             landmarks_csv(observed(patient.landmarks, Pose{}, error_mm, request.seed)));
}

void write_laser(const Case& patient, const PhantomScanRequest& request, int threads,
                 const fs::path& out) {
  const LaserScan scan = scan_laser(patient, {.seed = request.seed, .threads = threads});
  write_depth_map(scan.map, out / "laser.json");
  Landmarks skin;
  for (const char* name : skin_landmarks)
    if (const auto p = patient.landmarks.find(name)) skin.points[name] = *p;
  constexpr double error_mm = 0.7;
  write_file(out / "laser-landmarks.csv",
             landmarks_csv(observed(skin, scan.X_SC, error_mm, request.seed + 1)));
  const Pose X_CS = scan.X_SC.inverse();
  write_file(out / "truth-laser-pose.csv",
             fmt::format("qw,qx,qy,qz,x_mm,y_mm,z_mm\n{},{},{},{},{},{},{}\n", X_CS.R.w(),
                         X_CS.R.x(), X_CS.R.y(), X_CS.R.z(), X_CS.t.x(), X_CS.t.y(), X_CS.t.z()));
}

}  // namespace

void write_scans(const Case& patient, const HeadChoice& choice, const PhantomScanRequest& request,
                 const CommonOptions& common, ProgressBar& bar, const fs::path& out) {
  std::error_code problem;
  if (fs::exists(out, problem) && !(fs::is_directory(out, problem) && fs::is_empty(out, problem)))
    throw InputError(out, "--out", "must be a new or an empty folder");
  make_folder(out);
  if (request.ct) write_ct(patient, choice, request, common, bar, out);
  if (request.laser) write_laser(patient, request, common.threads, out);
  bar.show("writing", 0.9);
  save_case(patient, out / "truth");
}

}  // namespace condyle
