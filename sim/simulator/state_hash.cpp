#include "sim/simulator/state_hash.h"

#include <span>

#include "engine/core/hash.h"

namespace condyle {
namespace {

class Hasher {
 public:
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T value) { hash_ = hash_bytes(&value, sizeof value, hash_); }
  void add(const Eigen::Vector3d& p) { hash_ = hash_bytes(p.data(), 3 * sizeof(double), hash_); }
  void add(const Pose& pose) {
    hash_ = hash_bytes(pose.R.coeffs().data(), 4 * sizeof(double), hash_);
    add(pose.t);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = hash_start;
};

}  // namespace

std::uint64_t state_hash(const FrameState& frame) {
  Hasher h;
  h.add(frame.X_CM_wanted);
  h.add(frame.X_CM);
  for (const auto& X : frame.X_CF) h.add(X);
  h.add(frame.stopped ? 1 : 0);
  for (const auto& pair : frame.contacts.pairs) {
    h.add(pair.touching ? 1 : 0);
    h.add(pair.distance_mm);
    h.add(pair.witness_a);
    h.add(pair.witness_b);
    h.add(pair.depth_mm);
    for (const auto& contact : pair.contacts) {
      h.add(contact.point);
      h.add(contact.normal);
    }
  }
  for (const auto& node : frame.tissue.nodes) h.add(node);
  h.add(frame.tissue.iterations);
  h.add(frame.tissue.energy);
  h.add(frame.tissue.residual);
  h.add(frame.tissue.inverted_prisms);
  h.add(frame.measures.incisor);
  h.add(frame.measures.left_condyle);
  h.add(frame.measures.right_condyle);
  return h.value();
}

}  // namespace condyle
