#include "sim/ct_case/ct_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <future>
#include <iterator>
#include <mutex>
#include <numeric>
#include <utility>

#include "engine/core/error.h"
#include "engine/segmentation/metal_artifacts.h"
#include "engine/segmentation/scan_surfaces.h"
#include "sim/case/import_checks.h"
#include "sim/case/soft_landmarks.h"
#include "sim/case/tooth_labels.h"
#include "sim/ct_case/crown_fit.h"
#include "sim/ct_case/fitted_seeds.h"
#include "sim/ct_case/open_joints.h"
#include "sim/ct_case/tooth_voxels.h"
#include "sim/motion/condylar_path_table.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int fitted_triangles = 120000;  // of the surfaces that the template is fitted to
constexpr double least_tooth_mm3 = 20;

/// A stage of the work as a part of the whole.
Progress part_of(const Progress& whole, double from, double to) {
  if (!whole) return {};
  return [&whole, from, to](std::string_view what, double fraction) {
    whole(what, from + (to - from) * std::clamp(fraction, 0.0, 1.0));
  };
}

const TriMesh& carried_mesh(const AnatomyFit& fit, Role role) {
  static const TriMesh none;
  const CarriedPart* found = fit.find(role);
  return found ? found->part.mesh : none;
}

/// From the axes of the scan to LPS.
Matrix3d to_lps(ScanFrame frame) {
  Vector3d signs(1, 1, 1);
  if (frame == ScanFrame::face_behind) signs = {-1, -1, 1};
  if (frame == ScanFrame::upside_down) signs = {1, -1, -1};
  if (frame == ScanFrame::turned_over) signs = {-1, 1, -1};
  return signs.asDiagonal();
}

/// The progress of several works that are done in parallel.
class JointProgress {
 public:
  JointProgress(const Progress& whole, std::size_t works) : whole_(whole), done_(works, 0) {}

  Progress of(std::size_t work) {
    if (!whole_) return {};
    return [this, work](std::string_view what, double fraction) {
      const std::lock_guard lock(mutex_);
      done_[work] = fraction;
      whole_(what,
             std::accumulate(done_.begin(), done_.end(), 0.0) / static_cast<double>(done_.size()));
    };
  }

 private:
  const Progress& whole_;
  std::mutex mutex_;
  std::vector<double> done_;
};

/// The segmentation of one scan, in steps.
class CtSegmentation {
 public:
  CtSegmentation(const Volume& volume, const Case& model, const CtCaseRequest& request)
      : volume_(volume), model_(model), request_(request) {}

  CtCase run(const Progress& progress) {
    reduce_artifacts(part_of(progress, 0, 0.05));
    find_tissue(part_of(progress, 0.05, 0.3));
    fit_template(part_of(progress, 0.3, 0.55));
    part_bones(part_of(progress, 0.55, 0.7));
    add_bones(part_of(progress, 0.7, 0.95));
    add_face();
    add_landmarks();
    made_.threshold_hu = bone_.threshold_hu;
    for (const std::string& note : made_.fit.notes) patient().notes.push_back(note);
    turn_to_lps();
    part_joints();
    add_disc();
    patient().name = request_.name;
    estimate_landmarks(patient());
    estimate_profile_landmarks(patient());
    return std::move(made_);
  }

 private:
  Case& patient() { return made_.patient; }
  SurfaceOptions surface_options(int triangles) const {
    return {.target_triangles = triangles, .threads = request_.threads};
  }

  /// Work beside that of this thread, as decimation is single-threaded.
  template <class Work>
  auto beside(Work&& work) const {
    return std::async(request_.threads > 1 ? std::launch::async : std::launch::deferred,
                      std::forward<Work>(work));
  }

  void reduce_artifacts(const Progress& progress) {
    if (request_.keep_metal_artifacts) return;
    auto corrected = reduce_metal_artifacts(volume_, request_.threads, progress);
    if (!corrected) return;
    corrected_ = std::move(corrected->volume);
    patient().notes.push_back(fmt::format("metal artifacts were reduced in {} slice{}",
                                          corrected->slices, corrected->slices == 1 ? "" : "s"));
  }

  const Volume& volume() const { return corrected_.values.empty() ? volume_ : corrected_; }

  void find_tissue(const Progress& progress) {
    levels_ = tissue_levels(volume(), request_.source);
    head_ =
        find_head(volume(), levels_, request_.source, request_.threads, part_of(progress, 0, 0.3));
    BoneOptions options{.threads = request_.threads};
    if (request_.threshold_hu) options.threshold_hu = *request_.threshold_hu;
    bone_ =
        find_bone(volume(), levels_, head_, request_.source, options, part_of(progress, 0.3, 0.6));
    const Progress of_surfaces = part_of(progress, 0.6, 1);
    JointProgress joint(of_surfaces, 2);
    auto skin = beside([&] {
      if (!head_.has_outside || !request_.face) return ScanSurface{};
      return skin_surface(volume(), levels_, head_, bone_.metal, request_.source,
                          surface_options(request_.face_triangles), joint.of(1));
    });
    whole_ =
        bone_surface(volume(), bone_, skull_label, surface_options(fitted_triangles), joint.of(0));
    skin_ = skin.get();
  }

  void fit_template(const Progress& progress) {
    AnatomyScan scan;
    scan.bone = whole_.mesh;
    scan.skin = skin_.mesh;
    scan.source = request_.source;
    made_.fit = fit_anatomy(scan, model_, {.threads = request_.threads}, progress);
  }

  bool has_mandible() const { return made_.fit.mandible.present; }
  bool has_skull() const { return made_.fit.skull.present; }

  void part_bones(const Progress& progress) {
    const AnatomyFit& fit = made_.fit;
    const bool by_hand = !request_.seeds.empty();
    if (!has_skull() && !by_hand) {
      std::replace(bone_.label.begin(), bone_.label.end(), skull_label, mandible_label);
    } else if (has_mandible() || by_hand) {
      const FittedSeeds fitted = fitted_seeds(fit);
      const auto seeds =
          seed_labels(volume(), bone_, fitted.surfaces, request_.seeds,
                      {.template_error_mm = fitted.error_mm, .threads = request_.threads},
                      part_of(progress, 0, 0.4));
      split_bones(volume(), seeds, bone_, request_.threads, part_of(progress, 0.4, 0.9));
    }
    if (has_skull()) find_crowns(Role::upper_teeth, Role::skull, skull_label, upper_teeth_label);
    if (has_mandible())
      find_crowns(Role::lower_teeth, Role::mandible, mandible_label, lower_teeth_label);
  }

  void find_crowns(Role teeth, Role bone, VoxelLabel bone_label, VoxelLabel teeth_label) {
    AnatomyFit& fit = made_.fit;
    if (const auto crowns = fit_crowns(volume(), bone_, bone_label, carried_mesh(fit, teeth),
                                       carried_mesh(fit, bone))) {
      move_crowns(teeth, crowns->X, fit);
      patient().notes.push_back(
          fmt::format("the {} crowns lie {:.1f} mm from where the fit of the bone put them",
                      teeth == Role::upper_teeth ? "upper" : "lower", crowns->moved_mm));
    }
    label_teeth(volume(), carried_mesh(fit, teeth), carried_mesh(fit, bone), bone_label,
                teeth_label, bone_, request_.threads);
  }

  void keep(ScanSurface surface, Part part) {
    made_.decimation.push_back({part.name, surface.decimation_median_mm, surface.decimation_p95_mm,
                                surface.decimation_max_mm});
    patient().parts.push_back(std::move(part));
  }

  void add_bones(const Progress& progress) {
    struct Wanted {
      VoxelLabel label;
      Role role;
      const char* name;
      int triangles;
    };
    constexpr int tooth_triangles = 60000;
    const Wanted all[] = {{skull_label, Role::skull, "skull", request_.skull_triangles},
                          {mandible_label, Role::mandible, "mandible", request_.mandible_triangles},
                          {upper_teeth_label, Role::upper_teeth, "upper-teeth", tooth_triangles},
                          {lower_teeth_label, Role::lower_teeth, "lower-teeth", tooth_triangles}};
    std::array<ScanSurface, std::size(all)> surfaces;
    JointProgress joint(progress, surfaces.size());
    const auto make = [&](std::size_t i) {
      SurfaceOptions options = surface_options(all[i].triangles);
      if (is_teeth(all[i].role)) options.least_piece_mm3 = least_tooth_mm3;
      surfaces[i] = bone_surface(volume(), bone_, all[i].label, options, joint.of(i));
    };
    auto skull = beside([&] { make(0); });
    for (std::size_t i = 1; i < surfaces.size(); ++i) make(i);
    skull.get();
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const Wanted& wanted = all[i];
      ScanSurface& surface = surfaces[i];
      if (surface.mesh.empty()) continue;
      TriMesh mesh = std::move(surface.mesh);
      const CarriedPart* carried = made_.fit.find(wanted.role);
      Part part =
          is_teeth(wanted.role) && carried
              ? with_tooth_labels(std::move(mesh), carried->part)
              : Part{wanted.name, wanted.role, std::move(mesh), {}, default_body(wanted.role)};
      part.name = wanted.name;
      keep(std::move(surface), std::move(part));
    }
    if (!patient().find(Role::mandible))
      patient().notes.push_back("the scan shows no lower jaw: nothing moves with it");
  }

  void add_face() {
    if (skin_.mesh.empty()) {
      patient().notes.push_back(request_.face
                                    ? "the scan shows no air around the head: there is no face"
                                    : "no face was requested");
      return;
    }
    TriMesh mesh = std::move(skin_.mesh);
    keep(std::move(skin_), {"face", Role::face, std::move(mesh), {}, default_body(Role::face)});
  }

  void add_landmarks() {
    std::string doubtful;
    int outside = 0, kept = 0;
    for (const auto& [name, mark] : made_.fit.landmarks) {
      if (mark.outside_scan) {
        ++outside;
        continue;
      }
      patient().landmarks.points[name] = mark.point;
      ++kept;
      if (mark.doubtful) doubtful += (doubtful.empty() ? "" : ", ") + name;
    }
    patient().notes.push_back(
        fmt::format("{} landmarks are proposed by fitting the built-in patient{}", kept,
                    outside > 0 ? fmt::format(", {} lie outside the scan", outside) : ""));
    if (!doubtful.empty())
      patient().notes.push_back("doubtful landmarks, to be checked: " + doubtful);
    patient().canals = made_.fit.canals;
  }

  void turn_to_lps() {
    const Matrix3d R = to_lps(made_.fit.frame);
    if (R.isIdentity()) return;
    for (Part& part : patient().parts)
      for (auto& v : part.mesh.vertices) v = R * v;
    for (auto& [name, point] : patient().landmarks.points) point = R * point;
    for (auto& [name, mark] : made_.fit.landmarks) mark.point = R * mark.point;
    for (Canal& canal : patient().canals)
      for (auto& p : canal.points) p = R * p;
    patient().notes.push_back(
        "the scan was turned to LPS: its face looked elsewhere than its axes say");
  }

  void part_joints() {
    const double moved_mm = open_joints(patient());
    if (moved_mm > 0)
      patient().notes.push_back(fmt::format(
          "condyle and skull touched in the surfaces: they were moved apart by up to {:.2f} mm",
          moved_mm));
  }

  /// Joints whose bones are nearer to each other than the voxels can show have a disc all the same.
  void add_disc() {
    constexpr double least_disc_mm = 1;
    const auto joints = JointSurfaces::find(patient());
    if (!joints) return;
    const double gap_mm = joints->rest_gap_mm();
    if (gap_mm >= std::min(least_disc_mm, volume().spacing_mm.maxCoeff())) return;
    // The wider joint shows more of its disc.
    const double wider_mm =
        std::max(joints->rest_gap_mm(JawSide::left), joints->rest_gap_mm(JawSide::right));
    const double disc_mm = std::clamp(wider_mm, least_disc_mm, usual_front_gap_mm);
    patient().motion.disc_gap_front_mm = disc_mm;
    patient().notes.push_back(
        fmt::format("the scan shows a gap of {:.1f} mm in a joint, less than a voxel: the discs "
                    "are assumed to be {:.1f} mm thick on the eminences",
                    gap_mm, disc_mm));
  }

  const Volume& volume_;
  Volume corrected_ = {};  // where there is metal
  const Case& model_;
  const CtCaseRequest& request_;
  TissueLevels levels_;
  HeadRegion head_;
  BoneVoxels bone_;
  ScanSurface whole_, skin_;
  CtCase made_;
};

}  // namespace

CtCase case_of_ct(const Volume& volume, const Case& model, const CtCaseRequest& request,
                  const Progress& progress) {
  return CtSegmentation(volume, model, request).run(progress);
}

}  // namespace condyle
