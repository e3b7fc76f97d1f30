#include "engine/tissue/equilibrium.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

double largest(const VectorXd& force) {
  double most = 0;
  for (Index i = 0; i < force.size(); i += 3) most = std::max(most, force.segment<3>(i).norm());
  return most;
}

/// Adds a block of nodes a and b where it lies in the lower triangle.
void add_block(std::vector<Eigen::Triplet<double>>& entries, int a, int b, const Matrix3d& m) {
  if (a < b) return;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < (a == b ? i + 1 : 3); ++j)
      entries.emplace_back(3 * a + i, 3 * b + j, m(i, j));
}

/// An element with chosen tension: N of a spring, N/mm^2 of a prism. Its tension is proportional to
/// the stretch, with different stiffness in tension and compression, up to a bound.
struct Element {
  double pulls = 0, pushes = 0;  // stiffness when stretched and when shortened
  double low = 0, high = 0;      // bounds of the tension
  double stretch = 0;

  double tension(double at) const { return std::clamp((at < 0 ? pushes : pulls) * at, low, high); }
  double tension() const { return tension(stretch); }
  bool bound() const { return tension() == low || tension() == high; }
  double stiffness() const { return bound() ? 0 : stretch < 0 ? pushes : pulls; }
};

// The strains of least energy that balance given forces equal those of a mesh of such elements
// whose nodes these forces displace by y; elements at a bound transfer the remainder to the others.
// y is the minimum of a convex function, which Newton's method with a line search always finds.
// Weak springs at every node keep forces that cannot be balanced from diverging; their reaction is
// added to the forces again and so tends to zero where strains can balance it. Without prism
// pressures the weight of soft tissue would rest on buckling fibres.
class Balance {
 public:
  Balance(const SpringPrismMesh& mesh, const Nodes& x, const EquilibriumSettings& settings);
  /// Tensions that balance `outer` within bounds, or nearly; starts from the previous ones.
  void solve(const VectorXd& outer);
  /// Excludes the elements at these nodes from prestrain.
  void exclude(const std::vector<char>& node);
  /// Writes rest lengths, volumes and the result.
  void write(SpringPrismMesh& mesh, Equilibrium& result) const;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  void factorize();
  /// Stretch of each element due to displacements: springs, then prisms.
  std::vector<double> stretches(const VectorXd& y) const;
  VectorXd force(const VectorXd& outer, const VectorXd& y) const;
  void take_step(const VectorXd& outer, const VectorXd& held_at, const VectorXd& d);

  const SpringPrismMesh mesh_;
  const EquilibriumSettings settings_;
  std::vector<std::size_t> springs_;  // with chosen strain
  std::vector<double> length_;        // of those
  std::vector<Vector3d> along_;
  std::vector<double> volume_;
  std::vector<std::array<Vector3d, 6>> slope_;  // of the volumes
  std::vector<Element> elements_;               // springs_, then prisms
  VectorXd anchor_;                             // stiffness of each node's anchors
  VectorXd y_;
  double stiffest_ = 0, hold_ = 0;
  Eigen::SimplicialLDLT<Matrix> solver_;
  bool analyzed_ = false;
};

Balance::Balance(const SpringPrismMesh& mesh, const Nodes& x, const EquilibriumSettings& settings)
    : mesh_(mesh), settings_(settings) {
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    if (mesh.spring_sheet[s] == 0) continue;
    const Vector3d d = x[mesh.spring_b[s]] - x[mesh.spring_a[s]];
    springs_.push_back(s);
    length_.push_back(d.norm());
    along_.push_back(d / d.norm());
    const double k = 2 * mesh.stiffness[s], l = d.norm(), push = mesh.compression_ratio * k;
    elements_.push_back({k, push, -settings.max_push * l * push, settings.max_pull * l * k});
    stiffest_ = std::max(stiffest_, k);
  }
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p) {
    slope_.emplace_back();
    volume_.push_back(prism_volume_gradient(x, mesh.prisms[p], slope_.back()));
    const double k = 2 * (1 - mesh.lambda) / mesh.lambda * mesh.volume_weight[p];
    const double most = settings.max_volume * volume_.back() * k;
    elements_.push_back({k, k, -most, most});
  }
  y_ = anchor_ = VectorXd::Zero(3 * mesh.node_count);
  for (std::size_t i = 0; i < mesh.anchor_node.size(); ++i)
    anchor_.segment<3>(3 * mesh.anchor_node[i]).array() += 2 * mesh.anchor_stiffness[i];
}

void Balance::exclude(const std::vector<char>& node) {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    bool meets = false;
    if (i < springs_.size())
      meets = node[mesh_.spring_a[springs_[i]]] || node[mesh_.spring_b[springs_[i]]];
    else
      for (int corner : mesh_.prisms[i - springs_.size()]) meets = meets || node[corner];
    if (meets) elements_[i].low = elements_[i].high = 0;
  }
}

void Balance::factorize() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(27 * springs_.size() + 189 * volume_.size() + 3 * mesh_.node_count);
  const auto add = [&](int a, int b, const Matrix3d& m) { add_block(entries, a, b, m); };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const int a = mesh_.spring_a[springs_[i]], b = mesh_.spring_b[springs_[i]];
    const Matrix3d m = elements_[i].stiffness() * along_[i] * along_[i].transpose();
    add(a, a, m);
    add(b, b, m);
    add(a, b, -m);
    add(b, a, -m);
  }
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    const double k = elements_[springs_.size() + p].stiffness();
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b)
        add(mesh_.prisms[p][a], mesh_.prisms[p][b], k * slope_[p][a] * slope_[p][b].transpose());
  }
  for (Index i = 0; i < anchor_.size(); ++i) {
    const int row = static_cast<int>(i);
    entries.emplace_back(row, row, anchor_[i] + hold_);
  }
  Matrix matrix(anchor_.size(), anchor_.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (!analyzed_) solver_.analyzePattern(matrix);
  analyzed_ = true;
  solver_.factorize(matrix);
}

std::vector<double> Balance::stretches(const VectorXd& y) const {
  std::vector<double> stretch;
  stretch.reserve(elements_.size());
  for (std::size_t i = 0; i < springs_.size(); ++i)
    stretch.push_back(along_[i].dot(y.segment<3>(3 * mesh_.spring_b[springs_[i]]) -
                                    y.segment<3>(3 * mesh_.spring_a[springs_[i]])));
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    double sum = 0;
    for (int k = 0; k < 6; ++k) sum += slope_[p][k].dot(y.segment<3>(3 * mesh_.prisms[p][k]));
    stretch.push_back(sum);
  }
  return stretch;
}

VectorXd Balance::force(const VectorXd& outer, const VectorXd& y) const {
  VectorXd sum = outer - anchor_.cwiseProduct(y);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Vector3d pull = elements_[i].tension() * along_[i];
    sum.segment<3>(3 * mesh_.spring_a[springs_[i]]) += pull;
    sum.segment<3>(3 * mesh_.spring_b[springs_[i]]) -= pull;
  }
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    const double tension = elements_[springs_.size() + p].tension();
    for (int k = 0; k < 6; ++k) sum.segment<3>(3 * mesh_.prisms[p][k]) -= tension * slope_[p][k];
  }
  return sum;
}

void Balance::solve(const VectorXd& outer) {
  VectorXd held_at = y_, left = force(outer, y_);
  const double goal = 1e-13 * largest(outer);
  std::vector<double> factored;  // stiffness of each element in the factor
  int round = 0;
  for (double fraction : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-7, 1e-7}) {
    const double before = largest(left);
    hold_ = fraction * stiffest_;
    factored.clear();
    for (; round < settings_.rounds; ++round) {
      const VectorXd down = left - hold_ * (y_ - held_at);
      if (largest(down) < std::max(goal, 1e-3 * std::min(before, largest(left)))) break;
      std::vector<double> now;
      for (const auto& e : elements_) now.push_back(e.stiffness());
      if (now != factored) factorize();
      factored = std::move(now);
      take_step(outer, held_at, solver_.solve(down));
      left = force(outer, y_);
    }
    held_at = y_;
    // Where repetition does not reduce the remainder, strains cannot balance it.
    const double now = largest(left);
    if (now < goal || now > 0.8 * before || round == settings_.rounds) return;
  }
}

void Balance::take_step(const VectorXd& outer, const VectorXd& held_at, const VectorXd& d) {
  const std::vector<double> by_d = stretches(d);
  // The derivative along d increases; a step that is too long is shortened to where it is nearly
  // zero.
  const double constant = (anchor_.cwiseProduct(y_) + hold_ * (y_ - held_at) - outer).dot(d);
  const double linear = (anchor_.array() + hold_).matrix().cwiseProduct(d).dot(d);
  const auto slope = [&](double step) {
    double sum = constant + step * linear;
    for (std::size_t i = 0; i < elements_.size(); ++i)
      sum += elements_[i].tension(elements_[i].stretch + step * by_d[i]) * by_d[i];
    return sum;
  };
  constexpr double flat = 0.1;
  const double steep = -slope(0);
  double step = 1, low = 0, high = 1;
  for (int cut = 0; cut < 30; ++cut) {
    const double at = slope(step);
    if (at <= flat * steep && (cut == 0 || at >= -flat * steep)) break;
    (at > 0 ? high : low) = step;
    step = 0.5 * (low + high);
  }
  y_ += step * d;
  for (std::size_t i = 0; i < elements_.size(); ++i) elements_[i].stretch += step * by_d[i];
}

void Balance::write(SpringPrismMesh& mesh, Equilibrium& result) const {
  result.at_bound = 0;
  result.max_strain = result.max_volume_strain = 0;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const double t = e.tension(), change = t / (t < 0 ? e.pushes : e.pulls);
    result.at_bound += e.bound();
    if (i < springs_.size()) {
      mesh.rest_length[springs_[i]] = length_[i] - change;
      result.max_strain = std::max(result.max_strain, std::abs(change) / length_[i]);
    } else {
      const std::size_t p = i - springs_.size();
      mesh.rest_volume[p] = volume_[p] - change;
      result.max_volume_strain = std::max(result.max_volume_strain, std::abs(change) / volume_[p]);
    }
  }
  // Common force of the anchors of a node, as a shift of their targets.
  result.anchor_offset.clear();
  for (int node : mesh.anchor_node) result.anchor_offset.emplace_back(-y_.segment<3>(3 * node));
}

/// Nodes at which the state is unstable: where a pivot of the exact Hessian is not positive. In
/// double precision, because sliver prisms are far stiffer than their springs. Empty when the state
/// is stable.
std::vector<char> unstable_nodes(const SpringPrismMesh& mesh, const Nodes& x) {
  const Index n = 3 * static_cast<Index>(mesh.node_count);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(27 * mesh.spring_a.size() + 189 * mesh.prisms.size());
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    const int a = mesh.spring_a[s], b = mesh.spring_b[s];
    const Vector3d d = x[b] - x[a];
    const double strain = 1 - mesh.rest_length[s] / d.norm();
    const double k = 2 * mesh.stiffness[s] * (strain < 0 ? mesh.compression_ratio : 1.0);
    Matrix3d m = k * (1 - strain) / d.squaredNorm() * d * d.transpose();
    m.diagonal().array() += k * strain;
    add_block(entries, a, a, m);
    add_block(entries, b, b, m);
    add_block(entries, a, b, -m);
    add_block(entries, b, a, -m);
  }
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p) {
    const auto& prism = mesh.prisms[p];
    std::array<Vector3d, 6> slope;
    const double j = prism_volume_gradient(x, prism, slope) / mesh.rest_volume[p];
    const double weight = (1 - mesh.lambda) / mesh.lambda * mesh.volume_weight[p];
    const double stiff = weight * volume_stiffness(j, mesh.barrier_fraction, mesh.barrier_weight);
    const double pressure = weight * mesh.rest_volume[p] *
                            volume_pressure(j, mesh.barrier_fraction, mesh.barrier_weight);
    const auto bend = prism_volume_bend(x, prism);
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b <= a; ++b) {
        Matrix3d m = stiff * slope[a] * slope[b].transpose();
        if (a != b) {
          const Vector3d u = pressure * bend[a * (a - 1) / 2 + b];
          m += (Matrix3d() << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0).finished();
          add_block(entries, prism[b], prism[a], m.transpose());
        }
        add_block(entries, prism[a], prism[b], m);
      }
  }
  for (std::size_t i = 0; i < mesh.anchor_node.size(); ++i)
    add_block(entries, mesh.anchor_node[i], mesh.anchor_node[i],
              2 * mesh.anchor_stiffness[i] * Matrix3d::Identity());
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  std::vector<char> unstable;
  for (Index i = 0; i < n; ++i) {
    if (factor.vectorD()[i] > 0) continue;
    unstable.resize(x.size(), 0);
    unstable[static_cast<std::size_t>(factor.permutationPinv().indices()[i] / 3)] = 1;
  }
  return unstable;
}

/// Force on each node at x, N without the factor lambda.
Nodes forces(const SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x, double& energy) {
  Nodes force;
  energy = SpringPrismEnergy(mesh, loads, 1).value_and_gradient(x, force);
  for (auto& f : force) f /= -mesh.lambda;
  return force;
}

}  // namespace

Equilibrium balance_strains(SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x,
                            const EquilibriumSettings& settings) {
  assert(x.size() == static_cast<std::size_t>(mesh.node_count));
  assert(mesh.spring_sheet.size() == mesh.spring_a.size());
  assert(settings.max_pull < 1 && settings.max_volume < 1);
  Equilibrium result;
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s)
    if (mesh.spring_sheet[s] != 0)
      mesh.rest_length[s] = (x[mesh.spring_b[s]] - x[mesh.spring_a[s]]).norm();
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p)
    mesh.rest_volume[p] = prism_volume(x, mesh.prisms[p]);
  VectorXd outer(
      3 * static_cast<Index>(mesh.node_count));  // force of all elements without chosen strain
  const Nodes before = forces(mesh, loads, x, result.rest_energy);
  for (int i = 0; i < mesh.node_count; ++i) outer.segment<3>(3 * i) = before[i];
  result.force_before = largest(outer);

  Balance balance(mesh, x, settings);
  MeshLoads balanced;
  for (int attempt = 0; attempt < settings.attempts; ++attempt) {
    balance.solve(outer);
    balance.write(mesh, result);
    balanced = loads;
    for (std::size_t i = 0; i < mesh.anchor_node.size(); ++i)
      balanced.anchor_target[i] += result.anchor_offset[i];
    const std::vector<char> unstable = unstable_nodes(mesh, x);
    result.stable = unstable.empty();
    if (result.stable) break;
    balance.exclude(unstable);
  }

  // Constant forces hold the remainder.
  const double small = 1e-9 * result.force_before;
  const Nodes left = forces(mesh, balanced, x, result.rest_energy);
  for (const auto& f : left) {
    result.force_held = std::max(result.force_held, f.norm());
  }
  for (const auto& f : left)
    result.nodes_held += f.norm() > std::max(small, 0.01 * result.force_held);
  if (result.nodes_held > 0) {
    for (const auto& f : left)
      result.held.push_back(f.norm() > small ? Vector3d(-f) : Vector3d::Zero());
    balanced.node_force.resize(x.size(), Vector3d::Zero());
    for (std::size_t i = 0; i < x.size(); ++i) balanced.node_force[i] += result.held[i];
  } else {
    result.force_held = 0;
  }
  for (const auto& f : forces(mesh, balanced, x, result.rest_energy))
    result.force_after = std::max(result.force_after, f.norm());
  return result;
}

}  // namespace condyle
