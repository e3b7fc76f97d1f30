#include <fmt/format.h>

#include <cstdlib>
#include <optional>

#include "engine/core/user_cache.h"
#include "sim/phantom/cache.h"
#include "sim/phantom/mix_hash.h"
#include "sim/phantom/phantom.h"
#include "sim/phantom/phantom_solid.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr int surface_version = 16;  // increment when surfaces, their colours or landmarks change
                                     // without a change of the solids

/// Hash of the recipes' values at scattered points, so that a changed recipe changes the key.
std::uint64_t recipe_key() {
  const PhantomSolid solid = make_phantom_solid();
  std::uint64_t hash = hash_start, seed = 1;
  mix(hash, surface_version);
  const auto next = [&] {  // linear congruential generator; any fixed scatter will do
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(seed >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d p(90 * next(), -125 + 230 * next(), -190 + 315 * next());
    for (const auto* field : {&solid.skull, &solid.skin}) mix(hash, (*field)(p));
    const Eigen::Vector3d q(40 * next(), -100 + 70 * next(), -90 + 70 * next());
    for (const auto* field : {&solid.mandible, &solid.upper_gums, &solid.lower_gums, &solid.tongue})
      mix(hash, (*field)(q));
    const auto& tooth = solid.teeth[static_cast<std::size_t>(i) % solid.teeth.size()];
    const Eigen::Vector3d size = tooth.box.sizes();
    mix(hash, tooth.solid(tooth.box.min() + Eigen::Vector3d(next() * size.x(), next() * size.y(),
                                                            next() * size.z())));
  }
  return hash;
}

}  // namespace

Case builtin_patient(const Progress& progress) {
  const fs::path cache = user_cache_folder();
  if (cache.empty()) return build_phantom(progress);
  return cached_case(cache, fmt::format("built-in-patient-{:016x}", recipe_key()),
                     [&] { return build_phantom(progress); });
}

Case builtin_patient(const HeadChoice& choice, const Progress& progress) {
  return reshaped_head(builtin_patient(progress), choice);
}

}  // namespace condyle
