#include "sim/session/motion_preview.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>

#include "sim/frame/part_names.h"
#include "sim/report/motion_plots.h"

namespace condyle {
namespace {

std::string pair_name(const Case& patient, const PairContact& pair) {
  const auto name = [&](int part) {
    return readable_name(patient.parts[static_cast<std::size_t>(part)].name);
  };
  return name(pair.part_a) + " / " + name(pair.part_b);
}

/// Signed distance of the pairs that come nearest.
class ClearanceCurves {
 public:
  explicit ClearanceCurves(const Case& patient) : patient_(patient) {}

  void add(const FrameState& frame) {
    const auto& pairs = frame.contacts.pairs;
    if (distance_.empty()) {
      distance_.resize(pairs.size());
      for (const auto& pair : pairs) names_.push_back(pair_name(patient_, pair));
    }
    for (std::size_t i = 0; i < std::min(pairs.size(), distance_.size()); ++i)
      distance_[i].push_back(pairs[i].touching ? -pairs[i].depth_mm : pairs[i].distance_mm);
    time_s_.push_back(frame.time_s);
  }

  PlotSet plots() const {
    constexpr std::size_t max_curves = 6;
    constexpr double far_mm = 20;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < distance_.size(); ++i)
      order.emplace_back(*std::min_element(distance_[i].begin(), distance_[i].end()), i);
    std::sort(order.begin(), order.end());
    PlotPanel panel{
        {}, {.title = "Clearance (negative: overlap)", .x_label = "time, s", .y_label = "mm"}};
    panel.settings.levels = {{"contact", 0}};
    panel.settings.y_most = far_mm;
    for (std::size_t k = 0; k < std::min(order.size(), max_curves); ++k)
      if (order[k].first < far_mm)
        panel.curves.push_back({names_[order[k].second], time_s_, distance_[order[k].second]});
    return {"Clearance", {std::move(panel)}, time_s_};
  }

 private:
  const Case& patient_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> distance_;  // of each pair, over time
  std::vector<double> time_s_;
};

std::array<std::vector<Eigen::Vector3f>, 3> paths_of(const MotionSeries& series) {
  std::array<std::vector<Eigen::Vector3f>, 3> paths;
  for (const Measures& m : series.measures) {
    paths[0].push_back(m.incisor.cast<float>());
    paths[1].push_back(m.left_condyle.cast<float>());
    paths[2].push_back(m.right_condyle.cast<float>());
  }
  return paths;
}

MotionPreview preview_of(const MotionSeries& series, const ClearanceCurves& clearance) {
  std::vector<PlotSet> sets;
  for (auto& plot : motion_plots(series)) {
    std::string name = plot.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    sets.push_back({std::move(name), std::move(plot.panels), series.time_s});
  }
  sets.push_back(clearance.plots());
  return {std::move(sets), paths_of(series)};
}

}  // namespace

MotionPreview preview_motion(const SessionPatient& patient, const Motion& motion,
                             SimulatorSettings settings, bool obey_contact,
                             const std::function<void(MotionPreview)>& partly,
                             const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  constexpr double each_s = 1.0 / 30;
  constexpr long max_frames = 1800;
  constexpr std::chrono::milliseconds news_every(400);
  settings.tissue = settings.face = false;
  settings.threads = 1;  // it runs beside the live simulation
  Playback playback(patient.scene, motion, settings, obey_contact);
  MotionSeries series(patient.scene, motion);
  if (!series.known_landmarks) return {};
  ClearanceCurves clearance(patient.scene.patient);
  const long frames = std::clamp(std::lround(motion.duration_s / each_s), 1L, max_frames);
  auto reported = Clock::now();
  for (long i = 0; i <= frames; ++i) {
    report(progress, "walking through the motion",
           static_cast<double>(i) / static_cast<double>(frames));
    const FrameState frame =
        playback.at(motion.duration_s * static_cast<double>(i) / static_cast<double>(frames));
    series.add(frame);
    clearance.add(frame);
    if (Clock::now() - reported < news_every) continue;
    partly(preview_of(series, clearance));
    reported = Clock::now();
  }
  return preview_of(series, clearance);
}

}  // namespace condyle
