#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>

#include "engine/collide/distance_field.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/user_cache.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t format_version = 2;

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// Takes values from the front; false when too few remain.
template <class T>
bool take(std::string_view& bytes, T* values, std::size_t count) {
  if (bytes.size() / sizeof(T) < count) return false;
  std::memcpy(values, bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return true;
}

std::uint64_t name_of(const TriMesh& mesh, const FieldSettings& settings) {
  const Box box = settings.region.value_or(Box{});
  const double numbers[] = {settings.spacing_mm, settings.band_mm, box.low.x(),  box.low.y(),
                            box.low.z(),         box.high.x(),     box.high.y(), box.high.z()};
  const std::uint64_t start[] = {format_version, mesh_hash({mesh.vertices, mesh.triangles, {}})};
  return hash_values(std::span<const double>(numbers),
                     hash_values(std::span<const std::uint64_t>(start)));
}

/// The field stored under a name in the cache folder, else computed and stored there.
DistanceField stored_field(const fs::path& cache, std::uint64_t name, const FieldSettings& settings,
                           const std::function<DistanceField()>& compute) {
  char text[32];
  std::snprintf(text, sizeof text, "field-%016llx.bin", static_cast<unsigned long long>(name));
  const fs::path file = cache / text;
  if (!cache.empty()) try {
      std::error_code absent;
      if (fs::exists(file, absent))
        if (auto field = DistanceField::from_bytes(read_file(file), name, settings)) {
          note_use(file);
          return *std::move(field);
        }
    } catch (const std::exception&) {
      // Unreadable: treated as absent.
    }
  DistanceField field = compute();
  if (!cache.empty()) try {
      make_folder(cache);
      write_file(file, field.to_bytes(name));
      limit_cache(cache);
    } catch (const std::exception&) {
      // Failure to write the cache only costs time.
    }
  return field;
}

}  // namespace

std::string DistanceField::to_bytes(std::uint64_t name) const {
  std::string bytes;
  bytes.reserve(memory_bytes() + 128);
  const std::uint64_t head[] = {name, bricks_.size()};
  append(bytes, head, 2);
  append(bytes, origin_.data(), 3);
  append(bytes, size_.data(), 3);
  append(bytes, brick_.data(), brick_.size());
  append(bytes, bound_.data(), bound_.size());
  for (const Brick& brick : bricks_) append(bytes, brick.value.data(), brick.value.size());
  const std::uint64_t seal = word_hash(bytes.data(), bytes.size());
  append(bytes, &seal, 1);
  return bytes;
}

std::optional<DistanceField> DistanceField::from_bytes(std::string_view bytes, std::uint64_t name,
                                                       const FieldSettings& settings) {
  std::uint64_t seal = 0;
  if (bytes.size() < sizeof seal) return std::nullopt;
  std::memcpy(&seal, bytes.data() + bytes.size() - sizeof seal, sizeof seal);
  bytes.remove_suffix(sizeof seal);
  if (word_hash(bytes.data(), bytes.size()) != seal) return std::nullopt;

  DistanceField field;
  field.settings_ = settings;
  field.per_mm_ = 1 / settings.spacing_mm;
  std::uint64_t head[2];
  if (!take(bytes, head, 2) || head[0] != name) return std::nullopt;
  if (!take(bytes, field.origin_.data(), 3) || !take(bytes, field.size_.data(), 3))
    return std::nullopt;
  double places = 1;
  for (const int size : field.size_) places *= size;
  if (!(places >= 1 && places * 8 <= static_cast<double>(bytes.size()))) return std::nullopt;
  if (head[1] > bytes.size() / sizeof(Brick::value)) return std::nullopt;
  field.brick_.resize(static_cast<std::size_t>(places));
  field.bound_.resize(static_cast<std::size_t>(places));
  field.bricks_.resize(head[1]);
  if (!take(bytes, field.brick_.data(), field.brick_.size()) ||
      !take(bytes, field.bound_.data(), field.bound_.size()))
    return std::nullopt;
  for (Brick& brick : field.bricks_) {
    if (!take(bytes, brick.value.data(), brick.value.size())) return std::nullopt;
    mark_unknown(brick, settings.spacing_mm);
  }
  for (const std::int32_t index : field.brick_)
    if (index < -1 || index >= static_cast<std::int64_t>(head[1])) return std::nullopt;
  if (!bytes.empty()) return std::nullopt;
  field.find_whole();
  return field;
}

DistanceField cached_field(const fs::path& cache, const TriMesh& mesh,
                           const FieldSettings& settings, int threads, const Progress& progress) {
  return stored_field(cache, name_of(mesh, settings), settings,
                      [&] { return DistanceField(mesh, settings, threads, progress); });
}

DistanceField cached_piece_field(const fs::path& cache, const TriMesh& piece, const TriMesh& uncut,
                                 const DistanceField& uncut_field, int threads,
                                 const Progress& progress) {
  const FieldSettings& settings = uncut_field.settings();
  // Its samples follow from the piece and the grid.
  const std::uint64_t grid = uncut_field.grid_hash();
  const std::uint64_t name =
      hash_values(std::span<const std::uint64_t>(&grid, 1), name_of(piece, settings));
  return stored_field(cache, name, settings,
                      [&] { return DistanceField(piece, uncut, uncut_field, threads, progress); });
}

}  // namespace condyle
