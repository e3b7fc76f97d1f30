#include "sim/motion/condylar_path_table.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/core/archive.h"
#include "engine/core/parallel.h"
#include "engine/core/user_cache.h"

namespace condyle {
namespace {

constexpr double step_mm = 1;
constexpr double close_mm = 0.01;
constexpr double steepest = 2.5;  // slope of the path; a steeper wall stops the condyle
constexpr int theta_rows = 4, shift_rows = 3;

/// Four-point interpolation through the inner two (Catmull-Rom), u from 0 to 1 between them.
double between(const std::array<double, 4>& y, double u) {
  const double m1 = 0.5 * (y[2] - y[0]), m2 = 0.5 * (y[3] - y[1]);
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * y[1] + (u3 - 2 * u2 + u) * m1 + (3 * u2 - 2 * u3) * y[2] +
         (u3 - u2) * m2;
}

/// Position of x among evenly spaced values: the four neighbours (clamped) and the fraction between
/// the inner two.
struct Cell {
  std::array<std::size_t, 4> index{};
  double u = 0;
};
Cell cell_of(const std::vector<double>& values, double x) {
  Cell cell;
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  if (last == 0) return cell;
  const double at =
      std::clamp((x - values.front()) / (values[1] - values[0]), 0.0, static_cast<double>(last));
  const auto base = std::min(static_cast<std::ptrdiff_t>(at), last - 1);
  cell.u = at - static_cast<double>(base);
  for (std::ptrdiff_t k = 0; k < 4; ++k)
    cell.index[static_cast<std::size_t>(k)] =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(base + k - 1, 0, last));
  return cell;
}

std::vector<double> even(double low, double high, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(low + (high - low) * i / (count - 1));
  return values;
}

/// Inferior translation that gives the required gap at one forward travel, by bounded secant steps
/// from a guess.
double find_translation(const JointSurfaces& joint, JawSide side,
                        const CondylarPathTable::Settings& settings, double forward, double theta,
                        double shift, double target, double guess, TrianglePair& start) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(theta, settings.axis));
  const Eigen::Vector3d& c = settings.center;
  const double deepest = steepest * forward;
  const auto excess = [&](double drop) {
    const Eigen::Vector3d moved(shift, -forward, -drop);
    return joint.gap_mm(side, {R, c - R * c + moved}, start) - target;
  };
  double low = 0, high = deepest, before = 0, excess_before = excess(0);
  if (excess_before >= 0) return 0;
  double drop = std::clamp(guess, 0.05 * deepest, deepest);
  for (int i = 0; i < 12; ++i) {
    const double now = excess(drop);
    if (std::abs(now) <= close_mm) break;
    (now > 0 ? high : low) = drop;
    const double slope = std::clamp((now - excess_before) / (drop - before), 0.2, 1.0);
    before = drop;
    excess_before = now;
    drop -= now / slope;
    if (drop <= low || drop >= high) drop = 0.5 * (low + high);
    if (high - low < close_mm) break;
  }
  return drop;
}

/// The inferior translations by forward travel in steps of `step_mm`, for each theta and shift.
std::vector<std::vector<double>> find_rows(const JointSurfaces& joint, JawSide side,
                                           const CondylarPathTable::Settings& settings,
                                           const std::vector<double>& thetas,
                                           const std::vector<double>& shifts, int workers) {
  std::vector<std::vector<double>> rows(thetas.size() * shifts.size());
  parallel_for(rows.size(), workers, [&](std::size_t row) {
    const double theta = thetas[row / shifts.size()], shift = shifts[row % shifts.size()];
    std::vector<double> needed{0};
    TrianglePair start;
    const auto seated_gap = [&](double aside) {
      const Eigen::Quaterniond R(Eigen::AngleAxisd(theta, settings.axis));
      const Eigen::Vector3d& c = settings.center;
      return joint.gap_mm(side, {R, c - R * c + Eigen::Vector3d(aside, 0, 0)}, start);
    };
    // The gap lost by lateral shift of a seated condyle is regained during forward travel.
    constexpr double regained_mm = 6;
    const double lost = shift != 0 ? std::max(0.0, seated_gap(0) - seated_gap(shift)) : 0;
    for (double s = step_mm; s <= settings.longest_mm + 1e-9; s += step_mm) {
      const std::size_t n = needed.size();
      const double trend = n > 1 ? needed[n - 1] - needed[n - 2] : 0.5 * step_mm;
      const double u = std::min(s / regained_mm, 1.0);
      const double target = settings.gap.at(s) - lost * (1 - u * u * (3 - 2 * u));
      needed.push_back(find_translation(joint, side, settings, s, theta, shift, target,
                                        needed.back() + trend, start));
    }
    // The path does not rise again, and the facets of the surface are smoothed.
    for (std::size_t i = 1; i < needed.size(); ++i) needed[i] = std::max(needed[i], needed[i - 1]);
    std::vector<double>& smooth = rows[row] = needed;
    for (std::size_t i = 1; i + 1 < needed.size(); ++i)
      smooth[i] = std::max(needed[i], (needed[i - 1] + 2 * needed[i] + needed[i + 1]) / 4);
  });
  return rows;
}

/// A hash of everything that the rows depend on.
std::uint64_t inputs_of(const JointSurfaces& joint, JawSide side,
                        const CondylarPathTable::Settings& settings) {
  const auto& [center, axis, gap, longest_mm, widest_shift_mm, largest_theta] = settings;
  const double numbers[] = {center.x(), center.y(),      center.z(),    axis.x(),
                            axis.y(),   axis.z(),        gap.seated_mm, gap.front_mm,
                            longest_mm, widest_shift_mm, largest_theta};
  return word_hash(numbers, sizeof numbers, joint.hash(side));
}

}  // namespace

double DiscGap::at(double forward_mm) const {
  constexpr double thinned_by_mm = 7;  // on the slope of the eminence
  const double u = std::clamp(forward_mm / thinned_by_mm, 0.0, 1.0);
  return seated_mm + (front_mm - seated_mm) * u * u * (3 - 2 * u);
}

CondylarPathTable::CondylarPathTable(const JointSurfaces& joint, JawSide side,
                                     const Settings& settings, int threads)
    : theta_(even(0, settings.largest_theta, theta_rows)), shift_{0.0} {
  const double widest = settings.widest_shift_mm;
  if (widest > 0) shift_ = even(-widest, widest, shift_rows);
  const ResultCache results(user_cache_folder(), "condylar-path");
  const std::uint64_t inputs = inputs_of(joint, side, settings);
  std::vector<std::vector<double>> rows;
  bool stored = false;
  if (const auto bytes = results.read(inputs)) {
    ArchiveReader reader(*bytes);
    reader(rows);
    stored = reader.complete() && rows.size() == theta_.size() * shift_.size();
  }
  if (!stored) {
    rows = find_rows(joint, side, settings, theta_, shift_, threads);
    ArchiveWriter writer;
    writer(rows);
    results.write(inputs, writer.take());
  }
  for (const auto& row : rows) {
    std::vector<double> forward;
    for (std::size_t i = 0; i < row.size(); ++i)
      forward.push_back(static_cast<double>(i) * step_mm);
    inferior_.emplace_back(forward, row);
  }
}

double CondylarPathTable::inferior_translation_mm(double forward_mm, double theta,
                                                  double shift_mm) const {
  if (forward_mm <= 0) return 0;
  const Cell t = cell_of(theta_, theta), x = cell_of(shift_, shift_mm);
  std::array<double, 4> rows{};
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> row{};
    for (std::size_t k = 0; k < 4; ++k)
      row[k] = inferior_[t.index[i] * shift_.size() + x.index[k]](forward_mm);
    rows[i] = between(row, x.u);
  }
  return std::max(0.0, between(rows, t.u));
}

}  // namespace condyle
