#pragma once

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Springs and prisms of a mesh as plain loops over arrays, which the compiler vectorises: the
/// reference for the element batches. Each block of elements is gathered, evaluated and added to
/// the nodes.
class PlainElements {
 public:
  /// Keeps the mesh by reference.
  explicit PlainElements(const SpringPrismMesh& mesh) : mesh_(mesh) {}

  /// sum k (l - l0)^2 + `scale` sum w v0^2 law(v / v0), as ElementKernels::springs and ::prisms;
  /// adds its gradient. Infinite where a prism has nearly no volume.
  double value_and_gradient(const AxisRows& x, double scale, const AxisRows& gradient) const;

 private:
  const SpringPrismMesh& mesh_;
};

}  // namespace condyle
