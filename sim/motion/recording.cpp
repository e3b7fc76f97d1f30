#include "sim/motion/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/core/error.h"
#include "sim/case/source_frame.h"
#include "sim/motion/condylar_path.h"
#include "sim/motion/recording_files.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double farthest_apart_mm = 2000;  // each is within a metre of its origin
constexpr double gap_of_steps = 2.5;        // longer than so many usual steps is a gap

struct Recording {
  std::vector<double> time_s;  // from 0, increasing
  std::vector<Pose> X_CM;      // neighbours on the same side of the double cover
};

/// The mandible's poses against the cranium, in rows where both have one.
PoseSeries against_cranium(const PoseSeries& mandible, const PoseSeries& cranium) {
  PoseSeries out;
  out.missing = mandible.missing;
  std::size_t c = 0;
  for (std::size_t r = 0; r < mandible.X.size(); ++r) {
    while (c < cranium.time_s.size() && cranium.time_s[c] < mandible.time_s[r]) ++c;
    if (c == cranium.time_s.size() || cranium.time_s[c] > mandible.time_s[r]) {
      ++out.missing;
      continue;
    }
    out.time_s.push_back(mandible.time_s[r]);
    out.X.push_back(cranium.X[c].inverse() * mandible.X[r]);
    if (!mandible.residual_mm.empty())
      out.residual_mm.push_back(std::max(
          mandible.residual_mm[r], cranium.residual_mm.empty() ? 0.0 : cranium.residual_mm[c]));
  }
  return out;
}

/// From the file's axes into the case's, counted from rest.
std::vector<Pose> in_case(const std::filesystem::path& file, const PoseSeries& series,
                          const RecordingMap& map) {
  const Eigen::Matrix3d axes = source_frame("mm", map.axes).to_lps_mm;
  std::vector<Pose> out;
  for (const Pose& pose : series.X) {
    const Pose X = map.first_is_rest ? pose * series.X.front().inverse() : pose;
    Pose X_CM = X;
    if (!axes.isIdentity(0) || !map.origin_mm.isZero(0)) {
      X_CM.R = Eigen::Quaterniond(Eigen::Matrix3d(axes * X.R.toRotationMatrix() * axes.transpose()))
                   .normalized();
      X_CM.t = axes * X.t + map.origin_mm - X_CM.R * map.origin_mm;
    }
    if (!(X_CM.t.norm() <= farthest_apart_mm))
      throw InputError(file, fmt::format("{:.6g} s", series.time_s[out.size()]),
                       fmt::format("the mandible is carried {:.0f} mm off; check length_unit and "
                                   "origin_mm in {}.json",
                                   X_CM.t.norm(), file.filename().string()));
    if (!out.empty() && out.back().R.dot(X_CM.R) < 0) X_CM.R.coeffs() = -X_CM.R.coeffs();
    out.push_back(X_CM);
  }
  return out;
}

/// Weighted with a bell over the neighbours in time that passes half the power at `cutoff_hz`.
std::vector<Pose> smoothed(const Recording& in, double cutoff_hz) {
  const double sigma = std::sqrt(std::log(2.0)) / (2 * 3.14159265358979323846 * cutoff_hz);
  constexpr double reach = 4;
  std::vector<Pose> out;
  std::size_t first = 0;
  for (std::size_t r = 0; r < in.X_CM.size(); ++r) {
    while (in.time_s[first] < in.time_s[r] - reach * sigma) ++first;
    // As many on both sides: at the ends less is taken out, and nothing is drawn inward.
    const double far = std::min(
        {reach * sigma, in.time_s[r] - in.time_s.front(), in.time_s.back() - in.time_s[r]});
    Vector3d t = Vector3d::Zero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    double sum = 0;
    for (std::size_t k = first; k < in.X_CM.size() && in.time_s[k] <= in.time_s[r] + far + 1e-12;
         ++k) {
      const double away = in.time_s[k] - in.time_s[r];
      if (away < -far - 1e-12) continue;
      const double weight = std::exp(-0.5 * away * away / (sigma * sigma));
      t += weight * in.X_CM[k].t;
      q += weight * in.X_CM[k].R.coeffs();
      sum += weight;
    }
    out.push_back({Eigen::Quaterniond(Eigen::Vector4d(q.normalized())), t / sum});
  }
  return out;
}

Pose sample(const Recording& recording, double time_s) {
  const auto& times = recording.time_s;
  if (!(time_s > 0)) return recording.X_CM.front();
  if (time_s >= times.back()) return recording.X_CM.back();
  const std::size_t next = static_cast<std::size_t>(
      std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
  const double s = (time_s - times[next - 1]) / (times[next] - times[next - 1]);
  return interpolate(recording.X_CM[next - 1], recording.X_CM[next], s);
}

RecordingFacts facts_of(const RecordingFile& file, const PoseSeries& series) {
  RecordingFacts facts;
  facts.format = file.format;
  facts.rows = static_cast<int>(series.X.size());
  facts.rows_without_pose = series.missing;
  std::vector<double> steps;
  for (std::size_t r = 1; r < series.time_s.size(); ++r)
    steps.push_back(series.time_s[r] - series.time_s[r - 1]);
  if (!steps.empty()) {
    auto sorted = steps;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    facts.usual_step_s = sorted[sorted.size() / 2];
    for (std::size_t k = 0; k < steps.size(); ++k)
      if (steps[k] > gap_of_steps * facts.usual_step_s)
        facts.gaps.push_back({series.time_s[k] - series.time_s[0], steps[k]});
  }
  double squares = 0;
  for (const double residual : series.residual_mm) {
    squares += residual * residual;
    facts.residual_max_mm = std::max(facts.residual_max_mm, residual);
  }
  if (!series.residual_mm.empty())
    facts.residual_rms_mm = std::sqrt(squares / static_cast<double>(series.residual_mm.size()));
  facts.has_markers = !series.residual_mm.empty();
  facts.smooth_hz = file.map.smooth_hz;
  for (const Pose& pose : series.X)
    facts.largest_shift_mm = std::max(facts.largest_shift_mm, pose.t.norm());
  return facts;
}

std::vector<std::string> notes_of(const RecordingFacts& facts) {
  std::vector<std::string> notes;
  if (facts.format != "table of poses" || facts.has_markers)
    notes.push_back(fmt::format("recording: {}, {} rows", facts.format, facts.rows));
  if (facts.has_markers)
    notes.push_back(fmt::format(
        "markers leave the fitted rigid pose by {:.3f} mm (root mean square), {:.3f} at "
        "most",
        facts.residual_rms_mm, facts.residual_max_mm));
  if (facts.rows_without_pose > 0)
    notes.push_back(
        fmt::format("{} rows without enough markers were left out", facts.rows_without_pose));
  if (!facts.gaps.empty()) {
    const auto longest =
        std::max_element(facts.gaps.begin(), facts.gaps.end(),
                         [](const auto& a, const auto& b) { return a.length_s < b.length_s; });
    notes.push_back(fmt::format(
        "{} in the recording, the longest of {:.3f} s after {:.3f} s; bridged in a straight way",
        facts.gaps.size() == 1 ? "a gap" : fmt::format("{} gaps", facts.gaps.size()),
        longest->length_s, longest->after_s));
  }
  if (facts.smooth_hz > 0)
    notes.push_back(
        fmt::format("jitter above {} Hz was taken out, as its sidecar asks", facts.smooth_hz));
  return notes;
}

}  // namespace

Motion read_recording(const std::filesystem::path& file) {
  const RecordingFile content = read_recording_file(file);
  const PoseSeries series =
      content.cranium ? against_cranium(content.mandible, *content.cranium) : content.mandible;
  if (series.X.empty()) throw InputError(file, "", "in no row are both mandible and cranium seen");
  auto recording = std::make_shared<Recording>();
  for (const double time : series.time_s) recording->time_s.push_back(time - series.time_s.front());
  recording->X_CM = in_case(file, series, content.map);
  if (content.map.smooth_hz > 0) recording->X_CM = smoothed(*recording, content.map.smooth_hz);
  Motion motion{.name = file.stem().string(),
                .duration_s = recording->time_s.back(),
                .recorded = true,
                .wanted = [recording](double time_s) { return sample(*recording, time_s); },
                .notes = {},
                .sample_times = recording->time_s};
  motion.recording = facts_of(content, series);
  motion.recording->file_name = file.filename().string();
  motion.notes = notes_of(*motion.recording);
  return motion;
}

void note_what_looks_wrong(const Case& patient, Motion& motion) {
  constexpr double hardly_mm = 1, far_mm = 90, rise_mm = 3, from_rest_mm = 5;
  constexpr double fastest_mm_s = 1000, widest_rad = 60 * radian_per_degree;
  constexpr double tiny_mm = 0.2, written_mm = 1e-4, clear_turn_rad = 5 * radian_per_degree;
  const auto incisor = patient.landmarks.find("lower_incisal_point");
  if (!incisor || !motion.recording || motion.sample_times.size() < 2) return;
  struct Most {
    double value = 0, time_s = 0;
    void see(double now, double at_s) {
      if (now > value) value = now, time_s = at_s;
    }
  } drop, rise, far, speed, turn;
  double before_s = 0;
  Vector3d before = motion.wanted(0) * *incisor;
  for (const double time : motion.sample_times) {
    const Pose X = motion.wanted(time);
    const Vector3d now = X * *incisor;
    drop.see(incisor->z() - now.z(), time);
    rise.see(now.z() - incisor->z(), time);
    far.see((now - *incisor).norm(), time);
    turn.see(rotation_angle(X), time);
    if (time > before_s) speed.see((now - before).norm() / (time - before_s), time);
    before = now;
    before_s = time;
  }
  const std::string& file = motion.recording->file_name;
  const auto suspect = [&](const std::string& what) {
    motion.notes.push_back(fmt::format("suspicious: {}: {}", file, what));
  };
  const double start = (motion.wanted(0) * *incisor - *incisor).norm();
  const double shift = motion.recording->largest_shift_mm;
  if (far.value < hardly_mm)
    suspect(
        fmt::format("the motion is tiny, {:.3g} mm at the incisal point; if the file's lengths are "
                    "metres, write {{\"length_unit\": \"m\"}} into {}.json beside it",
                    far.value, file));
  else if (turn.value > clear_turn_rad && shift > written_mm && shift < tiny_mm)
    suspect(fmt::format(
        "the jaw turns by {:.0f} degrees but its translations are tiny, {:.3g} mm at most; if they "
        "are metres, write {{\"length_unit\": \"m\"}} into {}.json beside it",
        turn.value / radian_per_degree, shift, file));
  if (far.value > far_mm)
    suspect(
        fmt::format("the incisal point goes {:.0f} mm away at {:.2f} s; no jaw does. Check "
                    "length_unit and origin_mm in {}.json",
                    far.value, far.time_s, file));
  if (rise.value > rise_mm && rise.value > drop.value)
    suspect(
        fmt::format("the incisal point goes up {:.1f} mm at {:.2f} s and down only {:.1f} mm; tell "
                    "where the file's x, y and z point, as in {{\"axes\": \"LPS\"}}, in {}.json",
                    rise.value, rise.time_s, drop.value, file));
  if (start > from_rest_mm)
    suspect(
        fmt::format("the recording starts {:.1f} mm from rest; {{\"rest\": \"first\"}} in {}.json "
                    "counts from its first row",
                    start, file));
  if (speed.value > fastest_mm_s)
    suspect(fmt::format(
        "the incisal point is as fast as {:.0f} mm/s at {:.2f} s; jaws reach about 460. "
        "Check time_unit and single rows there",
        speed.value, speed.time_s));
  if (turn.value > widest_rad)
    suspect(
        fmt::format("the mandible turns by {:.0f} degrees at {:.2f} s; check the order of the "
                    "angles or of the quaternion's columns",
                    turn.value / radian_per_degree, turn.time_s));
}

}  // namespace condyle
