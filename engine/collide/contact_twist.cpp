#include "engine/collide/contact_twist.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int max_rounds = 16;
constexpr int join_at_once = 12;
constexpr int max_sweeps = 400;

Twist row_of(const Vector3d& arm, const Vector3d& direction, double rotation_length_mm) {
  Twist row;
  row << direction, arm.cross(direction) / rotation_length_mm;
  return row;
}

/// An active contact.
struct Joined {
  int row = 0;
  double push = 0, inverse = 0;  // 1 / squared norm of the constraint
  bool rubs = false;
  Twist side[2];                  // motions of the point along two tangents
  double side_inverse = 0;        // 1 / the larger squared norm
  Eigen::Vector2d drag = {0, 0};  // friction along the tangents
};

Joined join(const ContactRow& contact, int row, const TwistSettings& settings) {
  Joined joined;
  joined.row = row;
  joined.inverse = 1 / contact.along.squaredNorm();
  joined.rubs = contact.rubs && settings.friction > 0;
  if (joined.rubs) {
    const Vector3d u = contact.normal.unitOrthogonal(), v = contact.normal.cross(u);
    joined.side[0] = row_of(contact.arm, u, settings.rotation_length_mm);
    joined.side[1] = row_of(contact.arm, v, settings.rotation_length_mm);
    // The trace bounds both tangents together, so that the steps cannot overshoot.
    joined.side_inverse = 1 / (joined.side[0].squaredNorm() + joined.side[1].squaredNorm());
  }
  return joined;
}

/// Gauss-Seidel sweeps over the active contacts until convergence.
void sweep(std::vector<Joined>& joined, const std::vector<ContactRow>& rows,
           const TwistSettings& settings, Twist& x) {
  const double still = 0.02 * settings.tolerance_mm;
  for (int k = 0; k < max_sweeps; ++k) {
    double change = 0;
    for (Joined& contact : joined) {
      const ContactRow& row = rows[contact.row];
      const double gap = row.gap_mm + row.along.dot(x);
      const double push = std::max(0.0, contact.push - gap * contact.inverse);
      if (push != contact.push) {
        x += (push - contact.push) * row.along;
        change = std::max(change, std::abs(push - contact.push));
        contact.push = push;
      }
      if (!contact.rubs) continue;
      const Eigen::Vector2d slip(contact.side[0].dot(x), contact.side[1].dot(x));
      Eigen::Vector2d drag = contact.drag - contact.side_inverse * slip;
      const double most = settings.friction * contact.push;
      if (drag.norm() > most) drag *= most / drag.norm();
      const Eigen::Vector2d more = drag - contact.drag;
      x += more[0] * contact.side[0] + more[1] * contact.side[1];
      change = std::max(change, more.norm());
      contact.drag = drag;
    }
    if (change < still) return;
  }
}

/// Iterates over the constraints that a motion violates, the worst first, while the motion is
/// unchanged.
class Violated {
 public:
  Violated(const std::vector<ContactRow>& rows, double tolerance_mm)
      : rows_(rows), tolerance_mm_(tolerance_mm), given_up_(rows.size(), false) {}

  /// -1: none left.
  int worst(const Twist& x) {
    if (!sorted_) return first(x);
    return next_ < order_.size() ? order_[next_].second : -1;
  }

  /// The worst one is skipped from now on. The others are sorted only at this point: in most cases
  /// none is skipped, but in deep overlap thousands are.
  void give_up_worst(int row, const Twist& x) {
    given_up_[static_cast<std::size_t>(row)] = true;
    if (sorted_) {
      ++next_;
      return;
    }
    order_.clear();
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (const double gap = gap_of(i, x); gap < -tolerance_mm_ && !given_up_[i])
        order_.emplace_back(gap, static_cast<int>(i));
    std::sort(order_.begin(), order_.end());
    sorted_ = true;
    next_ = 0;
  }

  void moved() { sorted_ = false; }

 private:
  double gap_of(std::size_t i, const Twist& x) const {
    return rows_[i].gap_mm + rows_[i].along.dot(x);
  }
  int first(const Twist& x) const {
    int found = -1;
    double least = -tolerance_mm_;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (const double gap = gap_of(i, x); gap < least && !given_up_[i]) {
        least = gap;
        found = static_cast<int>(i);
      }
    return found;
  }

  const std::vector<ContactRow>& rows_;
  double tolerance_mm_;
  std::vector<bool> given_up_;
  bool sorted_ = false;
  std::vector<std::pair<double, int>> order_;  // gap, row
  std::size_t next_ = 0;
};

/// The motion nearest to `requested` that keeps every gap non-negative, exactly: constraints are
/// added and dropped one at a time and at most six are active. source: Goldfarb and Idnani 1983,
/// with the unit matrix.
TwistSolution nearest_without_friction(const Twist& requested, const std::vector<ContactRow>& rows,
                                       const TwistSettings& settings) {
  constexpr int max_changes = 200;
  // After this many infeasible constraints in sequence, the worst first, the overlap is so deep
  // that the remaining ones are infeasible as well.
  constexpr int max_unresolved = 256;
  constexpr double dependent =
      1e-9;  // fraction of a constraint's squared norm that is independent of the others
  TwistSolution solution;
  Twist& x = solution.x;
  x = requested;
  std::vector<Push>& active = solution.pushes;
  Violated violated(rows, settings.tolerance_mm);
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
  Columns N;
  std::optional<Eigen::HouseholderQR<Columns>>
      factored;  // of N, valid while the active set is unchanged
  for (int changes = 0, given_up = 0; changes < max_changes && given_up < max_unresolved;) {
    const int joining = violated.worst(x);
    if (joining < 0) break;
    const Twist& n = rows[joining].along;
    double push = 0;
    for (;; ++changes) {
      const auto count = static_cast<Eigen::Index>(active.size());
      if (count > 0 && !factored) {
        N.resize(6, count);
        for (Eigen::Index k = 0; k < count; ++k) N.col(k) = rows[active[k].row].along;
        factored.emplace(N);
      }
      Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> r(count);
      Twist z = n;
      if (count > 0) {
        r = factored->solve(n);
        z -= N * r;
      }
      double drop_at = std::numeric_limits<double>::infinity();
      Eigen::Index dropped = -1;
      for (Eigen::Index k = 0; k < count; ++k)
        if (r[k] > 1e-12 && active[k].length_mm / r[k] < drop_at) {
          drop_at = active[k].length_mm / r[k];
          dropped = k;
        }
      const bool free = count < 6 && z.squaredNorm() > dependent * n.squaredNorm();
      const double full = -(rows[joining].gap_mm + n.dot(x)) / z.squaredNorm();
      if (!free && dropped < 0) {  // infeasible: no motion satisfies all constraints
        violated.give_up_worst(joining, x);
        ++given_up;
        break;
      }
      const bool joins = free && full <= drop_at;
      const double step = joins ? full : drop_at;
      if (free) {
        x += step * z;
        violated.moved();
      }
      for (Eigen::Index k = 0; k < count; ++k)
        active[k].length_mm = std::max(0.0, active[k].length_mm - step * r[k]);
      push += step;
      if (joins) {
        active.push_back({joining, push});
        given_up = 0;
        factored.reset();
        ++changes;
        break;
      }
      active.erase(active.begin() + dropped);
      factored.reset();
    }
  }
  for (const ContactRow& row : rows)
    solution.violation_mm = std::max(solution.violation_mm, -(row.gap_mm + row.along.dot(x)));
  return solution;
}

}  // namespace

ContactRow contact_row(const Vector3d& arm, const Vector3d& gradient, double gap_mm,
                       double rotation_length_mm) {
  assert(rotation_length_mm > 0);
  ContactRow row;
  row.along = row_of(arm, gradient, rotation_length_mm);
  row.gap_mm = gap_mm;
  row.arm = arm;
  row.normal = gradient.normalized();
  return row;
}

TwistSolution nearest_allowed(const Twist& requested, const std::vector<ContactRow>& rows,
                              const TwistSettings& settings) {
  assert(settings.friction >= 0 && settings.rotation_length_mm > 0);
  if (!(settings.friction > 0)) return nearest_without_friction(requested, rows, settings);
  TwistSolution solution;
  solution.x = requested;
  std::vector<Joined> joined;
  std::vector<bool> has_joined(rows.size(), false);
  std::vector<std::pair<double, int>> worst;  // gap, row
  for (int round = 0; round < max_rounds; ++round) {
    worst.clear();
    solution.violation_mm = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double gap = rows[i].gap_mm + rows[i].along.dot(solution.x);
      solution.violation_mm = std::max(solution.violation_mm, -gap);
      if (gap < -settings.tolerance_mm && !has_joined[i])
        worst.emplace_back(gap, static_cast<int>(i));
    }
    if (worst.empty()) break;
    std::sort(worst.begin(), worst.end());
    if (joined.size() + join_at_once > static_cast<std::size_t>(settings.max_contacts))
      std::erase_if(joined, [&](const Joined& contact) {
        if (contact.push == 0) has_joined[contact.row] = false;
        return contact.push == 0;
      });
    const std::size_t before = joined.size();
    for (const auto& [gap, row] : worst) {
      if (joined.size() >= before + join_at_once ||
          joined.size() >= static_cast<std::size_t>(settings.max_contacts))
        break;
      const bool crowded =
          std::any_of(joined.begin() + static_cast<std::ptrdiff_t>(before), joined.end(),
                      [&, row = row](const Joined& other) {
                        return (rows[other.row].arm - rows[row].arm).squaredNorm() <
                               settings.thinning_mm * settings.thinning_mm;
                      });
      if (crowded) continue;
      joined.push_back(join(rows[row], row, settings));
      has_joined[row] = true;
    }
    if (joined.size() == before) break;
    sweep(joined, rows, settings, solution.x);
  }
  for (const Joined& contact : joined)
    if (contact.push > 0) solution.pushes.push_back({contact.row, contact.push});
  return solution;
}

}  // namespace condyle
