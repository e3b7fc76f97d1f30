#include "engine/tissue/shear_springs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Of the stiffness of isotropic tissue along the sheets, how much may be added to it.
constexpr double most_added = 0.3;

/// Square of the cosine between a spring and the direction across the layer.
double across(const Vector3d& from, const Vector3d& to, const Vector3d& up) {
  const double cosine = (to - from).normalized().dot(up);
  return cosine * cosine;
}

/// Share of a spring in the shear stiffness across the layer, the mean over directions along it.
double in_shear(double across) { return 0.5 * across * (1 - across); }
/// The same in the stiffness along its own direction in the layer.
double in_plane(double across) { return (1 - across) * (1 - across); }

/// Shear stiffness across a prism over that of isotropic tissue.
double held_share(const StackedPrism& prism) {
  const auto& c = prism.corners;
  const Vector3d up = across_prism(c);
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const auto share = [&](int a, int b) { return in_shear(across(c[a], c[b], up)); };
    sum += prism.weights.along[k] * (share(k, next) + share(k + 3, next + 3)) +
           prism.weights.diagonal[k] * (share(k, next + 3) + share(next, k + 3)) +
           prism.weights.across * share(k, k + 3);
  }
  return sum / prism.volume;
}

/// One window of a stack.
class Window {
 public:
  explicit Window(std::span<StackedPrism> prisms)
      : prisms_(prisms), given_(prisms.begin(), prisms.end()) {
    std::array<Vector3d, 6> c = prisms.front().corners;
    std::copy(prisms.back().corners.begin() + 3, prisms.back().corners.end(), c.begin() + 3);
    const Vector3d up = across_prism(c);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      for (const double cc : {across(c[k], c[next + 3], up), across(c[next], c[k + 3], up)}) {
        shear_ += in_shear(cc);
        plane_[k] += in_plane(cc);
      }
    }
    for (const StackedPrism& prism : given_) {
      volume_ += prism.volume;
      isotropic_ += prism.volume * prism.shear;
      yield_ += prism.volume / prism.shear;
      for (int k = 0; k < 3; ++k) spare_[k] += spare(prism, k);
    }
  }

  /// Takes what the prisms can spare, and returns the weight of the springs over them.
  double take() {
    if (shear_ <= 0) return 0;
    double weight = 0;
    constexpr int rounds = 5;  // what is taken from diagonals is missing in shear
    for (int round = 0; round < rounds; ++round) {
      weight = missing() / shear_;
      for (int k = 0; k < 3; ++k)
        if (plane_[k] > 0)  // isotropic tissue has 3 along the sheets, springs 3/8 of their weight
          weight = std::min(weight, (spare_[k] + most_added * 8.0 / 3 * isotropic_) / plane_[k]);
      for (int k = 0; k < 3; ++k) take_along(k, weight * plane_[k]);
    }
    return weight;
  }

 private:
  /// Of the edge's springs along the sheets, as far as they are above the least weights.
  static double spare(const StackedPrism& prism, int k) {
    const double least = least_spring_weight * prism.volume;
    return 2 * prism.shear *
           (std::max(0.0, prism.weights.along[k] - least) +
            std::max(0.0, prism.weights.diagonal[k] - least) * plane_of_diagonals(prism, k));
  }

  static double plane_of_diagonals(const StackedPrism& prism, int k) {
    const auto& c = prism.corners;
    const int next = (k + 1) % 3;
    const Vector3d up = across_prism(c);
    return 0.5 *
           (in_plane(across(c[k], c[next + 3], up)) + in_plane(across(c[next], c[k + 3], up)));
  }

  double missing() const {
    constexpr double least_held = 0.02;
    double held = 0;
    for (const StackedPrism& prism : prisms_)
      held += prism.volume / (prism.shear * std::max(least_held, held_share(prism)));
    return std::max(0.0, volume_ * (volume_ / yield_ - volume_ / held));
  }

  void take_along(int k, double plane) {
    const double taken = spare_[k] > 0 ? std::min(1.0, plane / spare_[k]) : 0;
    for (std::size_t i = 0; i < prisms_.size(); ++i) {
      const double least = least_spring_weight * given_[i].volume;
      const auto reduced = [&](double weight) {
        return weight - taken * std::max(0.0, weight - least);
      };
      prisms_[i].weights.along[k] = reduced(given_[i].weights.along[k]);
      prisms_[i].weights.diagonal[k] = reduced(given_[i].weights.diagonal[k]);
    }
  }

  std::span<StackedPrism> prisms_;
  std::vector<StackedPrism> given_;
  std::array<double, 3> plane_{}, spare_{};  // of each edge along the sheets: per weight, available
  double shear_ = 0;                         // stiffness per weight
  double volume_ = 0, isotropic_ = 0, yield_ = 0;
};

}  // namespace

std::vector<LayerWindow> layer_windows(int layers, double flatness) {
  constexpr int in_a_batch = 3;      // see element_batches.h
  constexpr double steep = 0.9;      // height of a window, edges
  constexpr double flattest = 0.01;  // limits the number of layers in a window
  if (layers < 2) return {};
  const int most = std::max(in_a_batch, static_cast<int>(steep / std::max(flatness, flattest)));
  const int count = (layers + most - 1) / most;
  std::vector<LayerWindow> windows;
  for (int w = 0, first = 0; w < count; ++w) {
    windows.push_back({first, layers / count + (w < layers % count ? 1 : 0)});
    first += windows.back().count;
  }
  return windows;
}

std::vector<double> take_shear_weights(std::vector<StackedPrism>& stack,
                                       const std::vector<LayerWindow>& windows) {
  std::vector<double> weights;
  weights.reserve(windows.size());
  for (const auto& [first, count] : windows)
    weights.push_back(Window(std::span(stack).subspan(first, count)).take());
  return weights;
}

}  // namespace condyle
