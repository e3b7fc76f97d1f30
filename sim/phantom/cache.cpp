#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>

#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/mesh/measure.h"
#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"
#include "sim/phantom/solid.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr int surface_version = 1;  // raise when surfaces or landmarks change but no solid does

template <class T>
void mix(std::uint64_t& hash, const T& value) {
  hash = hash_values(std::span<const T>(&value, 1), hash);
}

/// What the recipes say at scattered points: another recipe, another key.
std::uint64_t recipe_key() {
  const PhantomSolid solid = make_phantom_solid();
  std::uint64_t hash = hash_start, seed = 1;
  mix(hash, surface_version);
  const auto next = [&] {  // a plain linear congruence; any fixed scatter would do
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

std::uint64_t content_hash(const Case& patient) {
  std::uint64_t hash = hash_start;
  for (const auto& part : patient.parts) {
    hash = hash_bytes(part.name.data(), part.name.size(), hash);
    mix(hash, part.role);
    mix(hash, mesh_hash(part.mesh));
    for (const auto& tooth : part.teeth) mix(hash, tooth);
  }
  for (const auto& [name, point] : patient.landmarks.points) {
    hash = hash_bytes(name.data(), name.size(), hash);
    hash = hash_values(std::span<const double>(point.data(), 3), hash);
  }
  if (patient.condylar_path) {
    hash = hash_values(std::span<const double>(patient.condylar_path->forward_mm), hash);
    hash = hash_values(std::span<const double>(patient.condylar_path->drop_mm), hash);
  }
  return hash;
}

/// The user's cache folder of this program, when the environment names one.
std::optional<fs::path> cache_folder() {
  const auto absolute = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
    return fs::path(value);
  };
  if (const auto cache = absolute("XDG_CACHE_HOME")) return *cache / "condyle";
  if (const auto home = absolute("HOME")) return *home / ".cache" / "condyle";
  return std::nullopt;
}

/// The stored patient when it is whole: its content must have the hash written beside it.
std::optional<Case> stored_patient(const fs::path& folder, const fs::path& seal) {
  try {
    std::error_code absent;
    if (!fs::exists(seal, absent)) return std::nullopt;
    Case patient = load_case(folder);
    if (read_file(seal, 64) == fmt::format("{:016x}\n", content_hash(patient))) return patient;
  } catch (const std::exception&) {
    // Damaged: as good as none.
  }
  return std::nullopt;
}

/// The seal goes first and comes last, so that it never vouches for half a patient.
void store(const Case& patient, const fs::path& folder, const fs::path& seal) {
  try {
    fs::remove(seal);
    fs::remove_all(folder);
    save_case(patient, folder);
    write_file(seal, fmt::format("{:016x}\n", content_hash(patient)));
  } catch (const std::exception&) {
    // A cache that cannot be written only costs time.
  }
}

}  // namespace

Case builtin_patient(const Progress& progress) {
  const auto cache = cache_folder();
  if (!cache) return build_phantom(progress);
  const std::string name = fmt::format("built-in-patient-{:016x}", recipe_key());
  const fs::path folder = *cache / name, seal = *cache / (name + ".hash");
  if (auto patient = stored_patient(folder, seal)) return *std::move(patient);
  Case patient = build_phantom(progress);
  store(patient, folder, seal);
  return patient;
}

}  // namespace condyle
