// The displayed face of coarse and fine tissues of one patient, in the same poses, compared.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "sim/contact/contact.h"
#include "sim/motion/measure_pose.h"
#include "sim/motion/motion.h"
#include "sim/prediction/predictor.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;
using Face = std::vector<Eigen::Vector3f>;

/// A pose of the jaw at which faces are compared, or one on the way to it.
struct StudyPose {
  Pose X_CM;
  std::string motion;  // empty: on the way
  double opening_mm = 0;
};

/// A displayed face in equilibrium.
struct StudyFace {
  std::string motion;
  double opening_mm = 0;
  Face face;
  bool converged = false;
  int inverted_prisms = 0;
};

struct StudyTissue {
  int nodes = 0;
  std::vector<StudyFace> faces;
  double build_s = 0, solve_s = 0;
  std::string refusal;  // why it could not be built
};

constexpr double way_mm = 1.5;  // of the incisal point, between the poses on the way

/// A motion up to the time of its largest opening or protrusion, and back to one of its openings.
class StudyMotion {
 public:
  StudyMotion(const Case& patient, const ContactModel& contacts) : patient_(patient) {
    opening_ = make_motion("opening", patient, contacts);
    widest_s_ = time_of_most(opening_);
    protrusion_ = make_motion("protrude 5", patient, contacts);
  }

  /// Opening with stops, the widest opening, and closing down to one of them.
  std::vector<StudyPose> opening() const {
    std::vector<StudyPose> poses;
    const double widest = at(opening_, widest_s_);
    for (const double mm : {5.0, 15.0, 25.0, 40.0})
      if (mm < widest - 1) go(0, widest_s_, mm, "opening", poses);
    go(0, widest_s_, widest, "full opening", poses);
    constexpr double closing_mm = 25;
    if (closing_mm < widest) go(opening_.duration_s, widest_s_, closing_mm, "closing", poses);
    return poses;
  }

  std::vector<StudyPose> protrusion() const {
    std::vector<StudyPose> poses;
    constexpr int steps = 6;
    for (int i = 1; i <= steps; ++i)
      poses.push_back({protrusion_.target(protrusion_.duration_s * i / steps), "", 0});
    poses.back().motion = "protrusion";
    poses.back().opening_mm = opening_mm(poses.back().X_CM);
    return poses;
  }

 private:
  double opening_mm(const Pose& X_CM) const {
    return measure(patient_, BodyPoses(X_CM)).opening_mm;
  }
  double at(const Motion& motion, double time_s) const { return opening_mm(motion.target(time_s)); }

  double time_of_most(const Motion& motion) const {
    constexpr int frames = 720;
    double best_s = 0;
    for (int i = 0; i <= frames; ++i)
      if (const double time_s = motion.duration_s * i / frames;
          at(motion, time_s) > at(motion, best_s))
        best_s = time_s;
    return best_s;
  }

  /// Appends steps from the last pose to an opening between two times, of which `wide_s` is wider.
  void go(double narrow_s, double wide_s, double mm, const char* name,
          std::vector<StudyPose>& poses) const {
    const auto pose_of = [&](double target_mm) {
      double low = narrow_s, high = wide_s;
      for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (at(opening_, middle) < target_mm ? low : high) = middle;
      }
      return opening_.target(0.5 * (low + high));
    };
    const double from = poses.empty() ? 0 : opening_mm(poses.back().X_CM);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(mm - from) / way_mm)));
    for (int i = 1; i <= steps; ++i)
      poses.push_back({pose_of(from + (mm - from) * i / steps), "", 0});
    poses.back().motion = name;
    poses.back().opening_mm = mm;
  }

  const Case& patient_;
  Motion opening_, protrusion_;
  double widest_s_ = 0;
};

/// The faces along a motion, each solved to equilibrium from the frame before.
void follow(const TissueModel& tissue, const JawBodies& jaw, const std::vector<StudyPose>& poses,
            int threads, std::vector<StudyFace>& faces) {
  TissueState state = rest_tissue(tissue);
  TissueWarmStart warm;
  for (const StudyPose& pose : poses) {
    BodyPoses at;
    at[jaw.lower_arch] = pose.X_CM;
    state = solve_tissue(tissue, state, at.X_CB, {.threads = threads}, warm);
    if (pose.motion.empty()) continue;
    const TissueState settled = solve_to_equilibrium(tissue, state, warm, {.threads = threads});
    StudyFace found{pose.motion, pose.opening_mm, {}, settled.converged, settled.inverted_prisms};
    deform_face(tissue, settled, found.face, threads);
    faces.push_back(std::move(found));
  }
}

/// The face with the chin 5 mm forward; none for a case in which it cannot be cut.
std::optional<StudyFace> advanced_chin(const Case& patient,
                                       const std::shared_ptr<const TissueModel>& tissue,
                                       const PredictionSettings& settings) {
  try {
    Plan plan{.name = "chin", .geometry = geometry_of(patient)};
    plan = with_step(
        plan, CutStep{.osteotomy = "genioplasty", .pieces = {"chin"}, .below_margins = true});
    plan = with_step(plan, MoveStep{"chin", ClinicalMove{.forward_mm = 5}});
    Predictor predictor(patient, settings, tissue);
    Prediction prediction = predictor.predict(plan);
    return StudyFace{"chin advance", 0, std::move(prediction.after), prediction.unsettled_mm < 0.1,
                     prediction.state.inverted_prisms};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// `parted`: the patient with its lips parted.
StudyTissue studied(const Case& patient, const Case& parted, const StudyMotion& motion, int nodes,
                    int threads) {
  StudyTissue study;
  PredictionSettings settings;
  settings.threads = threads;
  settings.tissue.threads = threads;
  // Sheets are divided with the skin: the nodes per column are known after building alone.
  settings.tissue.surface_nodes = std::max(100, nodes / 4);
  std::shared_ptr<const TissueModel> tissue;
  const Stopwatch build;
  try {
    tissue = build_tissue(parted, settings.tissue);
    if (const double over = static_cast<double>(summary(*tissue).nodes) / nodes; over > 1.15) {
      settings.tissue.surface_nodes =
          static_cast<int>(std::lround(settings.tissue.surface_nodes / over));
      tissue = build_tissue(parted, settings.tissue);
    }
  } catch (const InputError& error) {
    study.nodes = nodes;
    study.refusal = error.what();
    return study;
  }
  study.build_s = build.wall_ms() / 1000;
  study.nodes = summary(*tissue).nodes;
  const Stopwatch solve;
  follow(*tissue, patient.jaw, motion.opening(), threads, study.faces);
  follow(*tissue, patient.jaw, motion.protrusion(), threads, study.faces);
  if (auto chin = advanced_chin(patient, tissue, settings)) study.faces.push_back(std::move(*chin));
  study.solve_s = solve.wall_ms() / 1000;
  return study;
}

double study_quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The landmark of the face nearest to a point.
std::string nearest_landmark(const Case& patient, const Eigen::Vector3d& p) {
  std::string name;
  double least = 1e9;
  for (const auto& [landmark, point] : patient.landmarks.points)
    if ((point - p).norm() < least) {
      least = (point - p).norm();
      name = landmark;
    }
  return name.empty() ? "" : fmt::format("{:.0f} mm from {}", least, name);
}

/// A face beside the finest one. `rest`: vertices of both.
Json compared(const Case& patient, const Face& rest, const StudyTissue& tissue,
              const StudyFace& face, const StudyFace& finest) {
  constexpr double moving_mm = 1;
  std::vector<double> all, moving;
  double most = 0;
  std::size_t where = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double error = (face.face[i] - finest.face[i]).cast<double>().norm();
    all.push_back(error);
    if ((finest.face[i] - rest[i]).norm() > moving_mm) moving.push_back(error);
    if (error > most) {
      most = error;
      where = i;
    }
  }
  return {{"name", "convergence"},
          {"patient", patient.name},
          {"nodes", tissue.nodes},
          {"motion", face.motion},
          {"opening_mm", face.opening_mm},
          {"median_mm", study_quantile(all, 0.5)},
          {"p95_mm", study_quantile(all, 0.95)},
          {"p95_moving_mm", study_quantile(moving, 0.95)},
          {"max_mm", most},
          {"max_at", nearest_landmark(patient, rest[where].cast<double>())},
          {"converged", face.converged},
          {"inverted_prisms", face.inverted_prisms}};
}

void print_row(const Json& row) {
  fmt::print(stderr, "  {:>7}  {:<13}{:>6.1f}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.2f}  {}{}{}\n",
             row["nodes"].get<int>(), row["motion"].get<std::string>(),
             row["opening_mm"].get<double>(), row["median_mm"].get<double>(),
             row["p95_mm"].get<double>(), row["p95_moving_mm"].get<double>(),
             row["max_mm"].get<double>(), row["max_at"].get<std::string>(),
             row["converged"].get<bool>() ? "" : "; not converged",
             row["inverted_prisms"].get<int>() == 0
                 ? ""
                 : fmt::format("; {} inverted prisms", row["inverted_prisms"].get<int>()));
}

}  // namespace

int run_bench_convergence(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient(options.patient, common, bar);
  if (!patient.find(Role::face)) throw InputError(patient.name + " has no face");
  const ContactModel contacts(patient);
  const StudyMotion motion(patient, contacts);
  Case parted = patient;
  part_lips(parted);
  bar.clear();

  std::vector<int> sizes = options.study_sizes;
  std::sort(sizes.begin(), sizes.end());
  std::vector<StudyTissue> tissues;
  Json results = Json::array();
  for (const int nodes : sizes) {
    tissues.push_back(studied(patient, parted, motion, nodes, common.threads));
    const StudyTissue& last = tissues.back();
    if (!common.quiet)
      fmt::print(stderr, "{} nodes: {}\n", last.nodes,
                 last.refusal.empty() ? fmt::format("built in {:.1f} s, solved in {:.1f} s",
                                                    last.build_s, last.solve_s)
                                      : last.refusal);
    results.push_back({{"name", "convergence.tissue"},
                       {"patient", patient.name},
                       {"nodes", last.nodes},
                       {"build_s", last.build_s},
                       {"solve_s", last.solve_s},
                       {"refusal", last.refusal}});
  }
  std::erase_if(tissues, [](const StudyTissue& tissue) { return !tissue.refusal.empty(); });
  if (tissues.size() > 1) {
    const StudyTissue& finest = tissues.back();
    Face rest;
    for (const Eigen::Vector3d& vertex : parted.find(Role::face)->mesh.vertices)
      rest.push_back(vertex.cast<float>());
    if (!common.quiet)
      fmt::print(stderr, "beside {} nodes, mm\n  {:>7}  {:<13}{:>6}{:>9}{:>9}{:>9}{:>9}\n",
                 finest.nodes, "nodes", "motion", "open", "median", "p95", "moving", "max");
    for (std::size_t t = 0; t + 1 < tissues.size(); ++t)
      for (std::size_t i = 0; i < std::min(tissues[t].faces.size(), finest.faces.size()); ++i) {
        results.push_back(
            compared(patient, rest, tissues[t], tissues[t].faces[i], finest.faces[i]));
        if (!common.quiet) print_row(results.back());
      }
  }
  if (common.json)
    fmt::print("{}\n", Json{{"machine", machine_json()}, {"results", results}}.dump(
                           2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
