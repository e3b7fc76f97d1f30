#include "sim/phantom/cache.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <optional>

#include "engine/core/files.h"
#include "engine/mesh/measure.h"
#include "sim/case/case_io.h"
#include "sim/phantom/mix_hash.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

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
  for (const auto& canal : patient.canals) {
    hash = hash_bytes(canal.name.data(), canal.name.size(), hash);
    mix(hash, canal.body);
    mix(hash, canal.diameter_mm);
    for (const auto& point : canal.points)
      hash = hash_values(std::span<const double>(point.data(), 3), hash);
  }
  if (patient.condylar_path) {
    hash = hash_values(std::span<const double>(patient.condylar_path->forward_mm), hash);
    hash = hash_values(std::span<const double>(patient.condylar_path->inferior_mm), hash);
  }
  return hash;
}

/// The stored case, if its content has the stored hash.
std::optional<Case> stored_case(const fs::path& folder, const fs::path& seal) {
  try {
    std::error_code absent;
    if (!fs::exists(seal, absent)) return std::nullopt;
    Case patient = load_case(folder);
    if (read_file(seal, 64) == fmt::format("{:016x}\n", content_hash(patient))) return patient;
  } catch (const std::exception&) {
    // A damaged case is ignored.
  }
  return std::nullopt;
}

/// The seal is removed first and written last, so that it never confirms an incomplete case.
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

Case cached_case(const fs::path& cache, const std::string& name,
                 const std::function<Case()>& make) {
  const fs::path folder = cache / name, seal = cache / (name + ".hash");
  if (auto patient = stored_case(folder, seal)) return *std::move(patient);
  Case patient = make();
  store(patient, folder, seal);
  return patient;
}

}  // namespace condyle
