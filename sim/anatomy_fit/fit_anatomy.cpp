#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "sim/anatomy_fit/anatomy_fit.h"
#include "sim/anatomy_fit/definitions.h"
#include "sim/anatomy_fit/fit_start.h"
#include "sim/anatomy_fit/head_template.h"
#include "sim/anatomy_fit/mouth_line.h"
#include "sim/anatomy_fit/part_landmarks.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double least_explained = 0.5, least_detail = 0.44;
constexpr double least_jaw = 0.45;  // share of the lower jaw that must be there

/// The surfaces of a scan, and how each bone of the template is fitted to them.
struct Targets {
  std::optional<FitSurface> bone, skull, mandible, skin;

  const FitSurface* for_skull() const { return skull ? &*skull : bone ? &*bone : nullptr; }
  const FitSurface* for_jaw() const { return mandible ? &*mandible : bone ? &*bone : nullptr; }
};

Targets prepared(const AnatomyScan& scan, int threads) {
  Targets targets;
  const auto take = [&](std::optional<FitSurface>& to, const TriMesh& mesh, int samples,
                        const char* what) {
    if (!mesh.empty())
      to.emplace(scanned_surface(mesh, samples, threads, scan.source + ": " + what));
  };
  take(targets.bone, scan.bone, 9000, "bone");
  take(targets.skull, scan.skull, 6000, "skull");
  take(targets.mandible, scan.mandible, 4000, "mandible");
  take(targets.skin, scan.skin, 5000, "skin");
  if (!targets.for_skull() && !targets.for_jaw())
    throw InputError(scan.source, "", "has no bone surface: landmarks are found from bone");
  return targets;
}

/// Share of a part's samples that have a partner in the target under a map.
double covered_share(const FitSurface& moving, const AffineMap& map, const FitSurface& target,
                     double near, int threads) {
  return explained_share(moving, map.inverse(), target, near, threads);
}

/// The lower jaw's rigid start: turned about the joints' axis from where the skull's map puts it,
/// for scans with the mouth more or less open.
AffineMap jaw_start(const FitSurface& moving, const FitSurface& target, const AffineMap& skull_map,
                    const Case& model, const ElasticFitSettings& settings,
                    const OtherDistances& other) {
  constexpr double forward_mm_per_deg = 0.25, near_mm = 3;
  const Vector3d left = model.landmarks.points.at("left_condyle"),
                 right = model.landmarks.points.at("right_condyle");
  const Vector3d center = 0.5 * (left + right), axis = (left - right).normalized();
  ElasticFitSettings quick = settings;
  quick.similarity_rounds = 12;
  AffineMap best = skull_map;
  double most = -1;
  for (const double opened_deg : {0.0, 8.0, 16.0, 26.0}) {
    AffineMap open;
    open.matrix = Eigen::AngleAxisd(opened_deg * degree, axis).toRotationMatrix();
    open.offset = center - open.matrix * center +
                  Vector3d(0, -forward_mm_per_deg * opened_deg, -0.1 * opened_deg);
    AffineMap start;
    start.matrix = skull_map.matrix * open.matrix;
    start.offset = skull_map * open.offset;
    start = fit_similarity(moving, target, start, quick, other);
    const double share = covered_share(moving, start, target, near_mm, settings.match.threads);
    if (share > most + 0.02) {
      most = share;
      best = start;
    }
  }
  return best;
}

/// Proportions and turns about the vertical axis with which the affine map starts.
std::vector<Eigen::Matrix3d> head_variations() {
  std::vector<Eigen::Matrix3d> all;
  for (const double deep : {1.0, 0.93, 1.07})
    for (const double high : {1.0, 0.93, 1.07}) all.push_back(Vector3d(1, deep, high).asDiagonal());
  for (const double deep : {1.0, 0.93})
    for (const double turn_deg : {-6.0, 6.0})
      all.push_back(Eigen::AngleAxisd(turn_deg * degree, Vector3d::UnitZ()) *
                    Eigen::Matrix3d(Vector3d(1, deep, 1).asDiagonal()));
  return all;
}

/// Share of the part's detailed surface, without brain case and crowns, within the scan's box that
/// has a partner before the fine deformation, which could imitate anything.
double detail_covered(const FittedPart& part, int threads) {
  constexpr double near_mm = 4, border_mm = 5;
  constexpr std::size_t fewest = 100;
  const FitSurface& moving = *part.moving;
  const AffineMap& map = part.fit.deformation.affine;
  const auto near = explained_samples(moving, map.inverse(), *part.target, near_mm, threads);
  const Box box = bounding_box(part.target->mesh);
  std::size_t inside = 0, covered = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto& sample = moving.samples[i];
    if (moving.weight_of(sample.triangle) < 1 || !box.contains(map * sample.point, -border_mm))
      continue;
    ++inside;
    covered += near[i] ? 1 : 0;
  }
  return inside < fewest ? 0 : static_cast<double>(covered) / static_cast<double>(inside);
}

class Fitter {
 public:
  Fitter(const AnatomyScan& scan, const Case& model, const AnatomyFitSettings& settings,
         const Progress& progress)
      : scan_(scan), model_(model), settings_(settings), progress_(progress) {
    elastic_.match.threads = settings.threads;
    elastic_.variations = head_variations();
  }

  AnatomyFit run() {
    report(progress_, "preparing the surfaces", 0);
    targets_ = prepared(scan_, settings_.threads);
    template_.emplace(model_, settings_.threads);
    report(progress_, "placing the head", 0.15);
    place();
    report(progress_, "fitting the skull", 0.3);
    fit_skull();
    report(progress_, "fitting the lower jaw", 0.55);
    fit_jaw();
    judge();
    report(progress_, "fitting the skin", 0.75);
    fit_skin();
    report(progress_, "finding the landmarks", 0.85);
    finish();
    report(progress_, "finding the landmarks", 1);
    return std::move(result_);
  }

 private:
  void place();
  void judge();
  void note();
  void refuse_unless(double explained, double least) const;
  void fit_skull();
  void fit_jaw();
  void fit_skin();
  void finish();
  void carry_part(const Part& part, const FittedPart& fitted);

  const AnatomyScan& scan_;
  const Case& model_;
  const AnatomyFitSettings& settings_;
  const Progress& progress_;
  ElasticFitSettings elastic_;
  Targets targets_;
  std::optional<HeadTemplate> template_;
  std::optional<FitSurface> skin_template_;
  FitStart start_;
  bool has_skull_ = true, has_jaw_ = true;
  std::optional<FittedPart> skull_, jaw_, skin_;
  AnatomyFit result_;
};

void Fitter::place() {
  const FitSurface* target = targets_.for_skull();
  const FitSurface* moving = &template_->skull;
  if (!target) {
    target = targets_.for_jaw();
    moving = &template_->mandible;
    has_skull_ = false;
  } else if (targets_.bone) {
    moving = &template_->whole;
  }
  start_ = find_start(*moving, *target, settings_.threads);
  if (moving == &template_->whole) {
    const double covered =
        covered_share(template_->skull, start_.map, *target, 6, settings_.threads);
    if (covered < 0.08) {  // a lower jaw by itself
      has_skull_ = false;
      start_ = find_start(template_->mandible, *target, settings_.threads);
    }
  }
  result_.frame = start_.frame;
  refuse_unless(start_.explained, 0.3);
}

/// throws: InputError when too little of the bone looks like the template.
void Fitter::refuse_unless(double explained, double least) const {
  if (explained >= least) return;
  throw InputError(
      scan_.source, "",
      fmt::format("the built-in head explains {:.0f} % of the bone's surface, too little: "
                  "this is no skull and no lower jaw",
                  100 * explained));
}

/// Whether the scan is what it is taken for. throws: InputError.
void Fitter::judge() {
  constexpr double near_mm = 4;
  std::size_t near_count = 0, all_count = 0;
  for (const FitSurface* target : {targets_.for_skull(), targets_.for_jaw()}) {
    if (!target) continue;
    std::vector<char> any(target->samples.size());
    for (const auto* part : {&skull_, &jaw_}) {
      if (!*part || (*part)->target != target) continue;
      const auto near = explained_samples(*target, (*part)->fit.deformation.affine,
                                          *(*part)->moving, near_mm, settings_.threads);
      for (std::size_t i = 0; i < any.size(); ++i) any[i] |= near[i];
    }
    near_count += static_cast<std::size_t>(std::count(any.begin(), any.end(), 1));
    all_count += any.size();
  }
  result_.explained =
      static_cast<double>(near_count) / static_cast<double>(std::max<std::size_t>(1, all_count));
  refuse_unless(result_.explained, least_explained);
}

void Fitter::fit_skull() {
  if (!has_skull_) return;
  FittedPart part;
  part.role = Role::skull;
  part.moving = &template_->skull;
  part.target = targets_.for_skull();
  OtherDistances other;
  AffineMap start = start_.map;
  TriMesh jaw = template_->mandible.mesh;
  if (!targets_.skull) {
    start = fit_similarity(template_->whole, *part.target, start, elastic_);
    for (auto& v : jaw.vertices) v = start * v;
    other = distances_to(TriangleTree(jaw), *part.target, settings_.threads);
  }
  part.fit = fit_stiffly(*part.moving, *part.target, start, elastic_, other);
  refuse_unless(detail_covered(part, settings_.threads), least_detail);
  add_displacements(part.fit, *part.moving, *part.target, elastic_, other);
  measure_errors(part, settings_.threads);
  skull_ = std::move(part);
}

void Fitter::fit_jaw() {
  const FitSurface* target = targets_.for_jaw();
  if (!target) {
    has_jaw_ = false;
    return;
  }
  FittedPart part;
  part.role = Role::mandible;
  part.moving = &template_->mandible;
  part.target = target;
  OtherDistances other;
  AffineMap start = start_.map;
  ElasticFitSettings settings = elastic_;
  std::optional<TriangleTree> skull_tree;
  if (skull_) {
    const double scale = std::cbrt(skull_->fit.similarity.matrix.determinant());
    settings.scale = {0.85 * scale, 1.15 * scale};
    if (!targets_.mandible) {
      TriMesh skull = template_->skull.mesh;
      skull.vertices = skull_->fit.vertices;
      skull_tree.emplace(skull);
      other = distances_to(*skull_tree, *target, settings_.threads);
    }
    start = jaw_start(*part.moving, *target, skull_->fit.similarity, model_, settings, other);
  }
  part.fit = fit_stiffly(*part.moving, *target, start, settings, other);
  if (!skull_ || targets_.mandible)
    refuse_unless(detail_covered(part, settings_.threads), least_detail);
  add_displacements(part.fit, *part.moving, *target, settings, other);
  measure_errors(part, settings_.threads, skull_tree ? &*skull_tree : nullptr);
  has_jaw_ = part.covered >= least_jaw;
  if (has_jaw_) jaw_ = std::move(part);
}

void Fitter::fit_skin() {
  if (!targets_.skin) return;
  FittedPart part;
  part.role = Role::face;
  skin_template_.emplace(template_skin(model_, settings_.threads));
  part.moving = &*skin_template_;
  part.target = &*targets_.skin;
  const AffineMap start = skull_ ? skull_->fit.similarity : jaw_->fit.similarity;
  part.fit = fit_stiffly(*part.moving, *part.target, start, elastic_);
  add_displacements(part.fit, *part.moving, *part.target, elastic_);
  measure_errors(part, settings_.threads);
  skin_ = std::move(part);
}

void Fitter::carry_part(const Part& part, const FittedPart& fitted) {
  CarriedPart carried;
  carried.part = part;
  carried.part.mesh.vertices =
      fitted.fit.deformation.carried(part.mesh.vertices, settings_.threads);
  carried.error_mm = errors_of(carried.part.mesh, *fitted.target, settings_.threads);
  result_.parts.push_back(std::move(carried));
}

/// What a person should know about the scan.
void Fitter::note() {
  if (result_.frame == ScanFrame::face_behind)
    result_.notes.push_back(
        "the face looks towards +y: these are RAS coordinates taken for LPS (a turn), or the y "
        "axis is "
        "reversed, and then left and right are exchanged");
  if (result_.frame == ScanFrame::upside_down || result_.frame == ScanFrame::turned_over)
    result_.notes.push_back(
        "the head is upside down: the z axis is reversed; if only that axis is, left and right are "
        "exchanged");
  if (!skull_) result_.notes.push_back("no skull in the scan: the lower jaw alone was fitted");
  if (!jaw_ && targets_.for_jaw())
    result_.notes.push_back("no lower jaw in the scan, or too little of it");
  if (jaw_ && jaw_->covered < 0.6)
    result_.notes.push_back(
        fmt::format("the scan has {:.0f} % of the lower jaw", 100 * jaw_->covered));
}

void Fitter::finish() {
  note();
  const auto take = [&](const std::optional<FittedPart>& part, PartFit& fit) {
    if (!part) return;
    fit = {true, part->fit.rms_mm, part->covered};
    auto marks = carried_landmarks(*part, model_);
    if (settings_.definitions) apply_definitions(marks, *part, model_);
    result_.landmarks.merge(marks);
    for (const auto& model_part : model_.parts) {
      const bool lower = default_body(model_part.role) == mandible_body;
      const bool bone = model_part.role == Role::skull || model_part.role == Role::mandible ||
                        is_teeth(model_part.role);
      const bool mine = part->role == Role::face ? model_part.role == Role::face
                                                 : bone && lower == (part->role == Role::mandible);
      if (mine) carry_part(model_part, *part);
    }
  };
  take(skull_, result_.skull);
  take(jaw_, result_.mandible);
  take(skin_, result_.skin);
  if (skin_ && skull_ && settings_.definitions) {
    const Eigen::Matrix3d& turn = skull_->fit.similarity.matrix;
    find_mouth_line(result_.landmarks, scan_.skin, turn / std::cbrt(turn.determinant()));
  }
  if (jaw_)
    for (Canal canal : model_.canals) {
      canal.points = jaw_->fit.deformation.carried(canal.points, 1);
      result_.canals.push_back(std::move(canal));
    }
}

}  // namespace

AnatomyFit fit_anatomy(const AnatomyScan& scan, const Case& model,
                       const AnatomyFitSettings& settings, const Progress& progress) {
  return Fitter(scan, model, settings, progress).run();
}

}  // namespace condyle
