#include "sim/motion/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "engine/core/error.h"
#include "sim/case/source_frame.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/recording_files.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double farthest_apart_mm = 2000;  // each is within a metre of its origin
constexpr double gap_of_steps = 2.5;        // a longer interval, in median steps, is a gap

struct Recording {
  std::vector<double> time_s;  // from 0, increasing
  std::vector<Pose> X_CM;      // consecutive quaternions with positive dot product
};

/// Poses of the mandible relative to the cranium, for rows that contain both.
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

/// Converts poses from the axes of the file to those of the case, relative to rest.
std::vector<Pose> in_case(const std::filesystem::path& file, const PoseSeries& series,
                          const RecordingMap& map) {
  const Eigen::Matrix3d& axes = map.source.axes_to_lps;
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
                       fmt::format("the mandible moves by {:.0f} mm; check length_unit and "
                                   "origin_mm in {}.json",
                                   X_CM.t.norm(), file.filename().string()));
    if (!out.empty() && out.back().R.dot(X_CM.R) < 0) X_CM.R.coeffs() = -X_CM.R.coeffs();
    out.push_back(X_CM);
  }
  return out;
}

/// Gaussian low-pass filter with half power at `cutoff_hz`.
std::vector<Pose> smoothed(const Recording& in, double cutoff_hz) {
  const double sigma = std::sqrt(std::log(2.0)) / (2 * std::numbers::pi * cutoff_hz);
  constexpr double reach = 4;
  std::vector<Pose> out;
  std::size_t first = 0;
  for (std::size_t r = 0; r < in.X_CM.size(); ++r) {
    while (in.time_s[first] < in.time_s[r] - reach * sigma) ++first;
    // The window is symmetric and shrinks at the ends, so that the ends are not displaced.
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
    facts.median_step_s = sorted[sorted.size() / 2];
    for (std::size_t k = 0; k < steps.size(); ++k)
      if (steps[k] > gap_of_steps * facts.median_step_s)
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
        "marker residuals from the fitted rigid pose: {:.3f} mm (root mean square), {:.3f} mm "
        "maximum",
        facts.residual_rms_mm, facts.residual_max_mm));
  if (facts.rows_without_pose > 0)
    notes.push_back(
        fmt::format("{} rows without enough markers were omitted", facts.rows_without_pose));
  if (!facts.gaps.empty()) {
    const auto longest =
        std::max_element(facts.gaps.begin(), facts.gaps.end(),
                         [](const auto& a, const auto& b) { return a.length_s < b.length_s; });
    notes.push_back(fmt::format(
        "{} in the recording, the longest of {:.3f} s after {:.3f} s; interpolated linearly",
        facts.gaps.size() == 1 ? "a gap" : fmt::format("{} gaps", facts.gaps.size()),
        longest->length_s, longest->after_s));
  }
  if (facts.smooth_hz > 0)
    notes.push_back(
        fmt::format("low-pass filtered at {} Hz, as the sidecar file requests", facts.smooth_hz));
  return notes;
}

}  // namespace

Motion read_recording(const std::filesystem::path& file) {
  const RecordingFile content = read_recording_file(file);
  const PoseSeries series =
      content.cranium ? against_cranium(content.mandible, *content.cranium) : content.mandible;
  if (series.X.empty()) throw InputError(file, "", "no row contains both mandible and cranium");
  auto recording = std::make_shared<Recording>();
  for (const double time : series.time_s) recording->time_s.push_back(time - series.time_s.front());
  recording->X_CM = in_case(file, series, content.map);
  if (content.map.smooth_hz > 0) recording->X_CM = smoothed(*recording, content.map.smooth_hz);
  Motion motion{.name = file.stem().string(),
                .duration_s = recording->time_s.back(),
                .recorded = true,
                .target = [recording](double time_s) { return sample(*recording, time_s); },
                .notes = {},
                .sample_times = recording->time_s};
  motion.recording = facts_of(content, series);
  motion.recording->file_name = file.filename().string();
  motion.notes = notes_of(*motion.recording);
  return motion;
}

namespace {

/// Whether the condyles stay in their joints when all translations are multiplied by `scale`.
bool joints_hold(const Vector3d& left, const Vector3d& right, const Motion& motion, double scale) {
  constexpr double longest_mm = 25, highest_mm = 4, hindmost_mm = 4;
  for (const double time : motion.sample_times) {
    Pose X = motion.target(time);
    X.t *= scale;
    for (const Vector3d& condyle : {left, right}) {
      const Vector3d displacement = X * condyle - condyle;
      if (displacement.norm() > longest_mm || displacement.z() > highest_mm ||
          displacement.y() > hindmost_mm)
        return false;
    }
  }
  return true;
}

/// The only unit of length in which the condyles would stay in their joints; none where they do as
/// read.
std::optional<std::string> unit_that_fits(const Case& patient, const Motion& motion) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (!left || !right || joints_hold(*left, *right, motion, 1)) return std::nullopt;
  std::optional<std::string> found;
  for (const auto& [unit, scale] : {std::pair("m", 1000.0), std::pair("cm", 10.0)}) {
    if (!joints_hold(*left, *right, motion, scale)) continue;
    if (found) return std::nullopt;
    found = unit;
  }
  return found;
}

}  // namespace

void note_implausible_values(const Case& patient, Motion& motion) {
  constexpr double hardly_mm = 1, far_mm = 90, rise_mm = 3, from_rest_mm = 5;
  constexpr double fastest_mm_s = 1000, widest_rad = 60 * degree;
  constexpr double tiny_mm = 0.2, written_mm = 1e-4, clear_turn_rad = 5 * degree;
  const auto incisor = patient.landmarks.find("lower_incisal_point");
  if (!incisor || !motion.recording || motion.sample_times.size() < 2) return;
  struct Most {
    double value = 0, time_s = 0;
    void see(double now, double at_s) {
      if (now > value) value = now, time_s = at_s;
    }
  } drop, rise, far, speed, turn;
  double before_s = 0;
  Vector3d before = motion.target(0) * *incisor;
  for (const double time : motion.sample_times) {
    const Pose X = motion.target(time);
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
  const double start = (motion.target(0) * *incisor - *incisor).norm();
  const double shift = motion.recording->largest_shift_mm;
  if (far.value < hardly_mm)
    suspect(
        fmt::format("the motion is tiny, {:.3g} mm at the incisal point; if the file is in metres, "
                    "add the sidecar file {}.json with {{\"length_unit\": \"m\"}}",
                    far.value, file));
  else if (turn.value > clear_turn_rad && shift > written_mm && shift < tiny_mm)
    suspect(fmt::format(
        "the jaw turns by {:.0f} degrees but its translations are tiny, at most {:.3g} mm; if they "
        "are in metres, add the sidecar file {}.json with {{\"length_unit\": \"m\"}}",
        turn.value / degree, shift, file));
  if (const auto unit = unit_that_fits(patient, motion))
    suspect(fmt::format(
        "the condyles leave their joints while the incisal point is displaced by {:.3g} mm and the "
        "jaw turns by {:.0f} degrees; they would not if the lengths were in {}; if they are, add "
        "the sidecar file {}.json with {{\"length_unit\": \"{}\"}}",
        far.value, turn.value / degree, *unit, file, *unit));
  if (far.value > far_mm)
    suspect(
        fmt::format("the incisal point is {:.0f} mm from rest at {:.2f} s, which no jaw reaches. "
                    "Check length_unit and origin_mm in {}.json",
                    far.value, far.time_s, file));
  if (rise.value > rise_mm && rise.value > drop.value)
    suspect(fmt::format(
        "the incisal point rises {:.1f} mm at {:.2f} s and descends only {:.1f} mm; give "
        "the directions of the file's axes, as in {{\"axes\": \"LPS\"}}, in {}.json",
        rise.value, rise.time_s, drop.value, file));
  if (start > from_rest_mm)
    suspect(
        fmt::format("the recording starts {:.1f} mm from rest; {{\"rest\": \"first\"}} in {}.json "
                    "makes its first row the rest pose",
                    start, file));
  if (speed.value > fastest_mm_s)
    suspect(
        fmt::format("the incisal point reaches {:.0f} mm/s at {:.2f} s; jaws reach about 460 mm/s. "
                    "Check time_unit and the rows at that time",
                    speed.value, speed.time_s));
  if (turn.value > widest_rad)
    suspect(fmt::format(
        "the mandible turns by {:.0f} degrees at {:.2f} s; check the order of the angles "
        "or of the quaternion columns",
        turn.value / degree, turn.time_s));
}

}  // namespace condyle
