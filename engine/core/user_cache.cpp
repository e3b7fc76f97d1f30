#include "engine/core/user_cache.h"

#include <link.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

#include "engine/core/files.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// The build ID among the notes of a segment; source: the ELF specification, note section.
std::string_view build_id_in(const char* at, std::size_t size) {
  const auto padded = [](std::size_t length) { return (length + 3) / 4 * 4; };
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) head;
    std::memcpy(&head, at, sizeof head);
    const std::size_t name = sizeof head, content = name + padded(head.n_namesz);
    const std::size_t whole = content + padded(head.n_descsz);
    if (whole > size) break;
    if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == 4 &&
        std::memcmp(at + name, "GNU", 4) == 0)
      return {at + content, head.n_descsz};
    at += whole;
    size -= whole;
  }
  return {};
}

/// Called for the program first, then for its libraries.
int take_build_id(dl_phdr_info* object, std::size_t, void* to) {
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const auto& segment = object->dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const auto* notes = reinterpret_cast<const char*>(object->dlpi_addr + segment.p_vaddr);
    const std::string_view id = build_id_in(notes, segment.p_memsz);
    if (!id.empty()) *static_cast<std::string_view*>(to) = id;
  }
  return 1;  // no library
}

std::uint64_t with_build(std::uint64_t inputs) {
  const std::string_view build = program_build();
  return word_hash(build.data(), build.size(), inputs);
}

/// At the end of a file: the key and the hash of all before.
struct Tail {
  std::uint64_t key = 0, hash = 0;
};

std::uint64_t hash_with_key(std::string_view result, std::uint64_t key) {
  return word_hash(result.data(), result.size(), word_hash(&key, sizeof key));
}

}  // namespace

fs::path user_cache_folder() {
  const auto absolute = [](const char* variable) {
    const char* value = std::getenv(variable);
    const fs::path path = value ? value : "";
    return path.is_absolute() ? path : fs::path();
  };
  if (const auto cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return cache / "condyle";
  if (const auto home = absolute("HOME"); !home.empty()) return home / ".cache" / "condyle";
  return {};
}

std::uint64_t word_hash(const void* data, std::size_t size, std::uint64_t h) {
  const auto* bytes = static_cast<const char*>(data);
  std::size_t i = 0;
  for (; i + 8 <= size; i += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes + i, 8);
    h = (h ^ word) * 1099511628211ull;
    h ^= h >> 29;
  }
  return hash_bytes(bytes + i, size - i, h);
}

std::string_view program_build() {
  static const std::string_view id = [] {
    std::string_view found;
    dl_iterate_phdr(take_build_id, &found);
    return found;
  }();
  return id;
}

void limit_cache(const fs::path& folder, std::uintmax_t most_bytes) {
  constexpr auto half_written_for = std::chrono::hours(1);
  struct Kept {
    fs::file_time_type used;
    fs::path file;
    std::uintmax_t bytes;
    bool operator<(const Kept& other) const {
      return used != other.used ? used < other.used : file < other.file;
    }
  };
  std::vector<Kept> kept;
  std::uintmax_t all = 0;
  const auto now = fs::file_time_type::clock::now();
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code gone;  // by another program
    if (!entry->is_regular_file(gone)) continue;
    const auto used = entry->last_write_time(gone);
    const auto bytes = gone ? 0 : entry->file_size(gone);
    if (gone) continue;
    if (name.starts_with(".") && name.ends_with(".part") && now - used > half_written_for) {
      fs::remove(entry->path(), gone);
    } else if (name.ends_with(".bin")) {
      kept.push_back({used, entry->path(), bytes});
      all += bytes;
    }
  }
  if (all <= most_bytes) return;
  std::sort(kept.begin(), kept.end());
  for (const Kept& oldest : kept) {
    if (all <= most_bytes) return;
    fs::remove(oldest.file, error);
    all -= oldest.bytes;
  }
}

void note_use(const fs::path& file) {
  std::error_code not_ours;
  fs::last_write_time(file, fs::file_time_type::clock::now(), not_ours);
}

ResultCache::ResultCache(fs::path folder, std::string kind, std::uintmax_t most_bytes)
    : folder_(program_build().empty() ? fs::path() : std::move(folder)),
      kind_(std::move(kind)),
      most_bytes_(most_bytes) {}

fs::path ResultCache::file_of(std::uint64_t key) const {
  char text[32];
  std::snprintf(text, sizeof text, "-%016llx.bin", static_cast<unsigned long long>(key));
  return folder_ / (kind_ + text);
}

std::optional<std::string> ResultCache::read(std::uint64_t inputs) const {
  if (folder_.empty()) return std::nullopt;
  const std::uint64_t key = with_build(inputs);
  const fs::path file = file_of(key);
  try {
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    std::string bytes = read_file(file);
    Tail tail;
    if (bytes.size() < sizeof tail) return std::nullopt;
    const std::size_t size = bytes.size() - sizeof tail;
    std::memcpy(&tail, bytes.data() + size, sizeof tail);
    bytes.resize(size);
    if (tail.key != key || tail.hash != hash_with_key(bytes, key)) return std::nullopt;
    note_use(file);
    return bytes;
  } catch (const std::exception&) {
    return std::nullopt;  // unreadable: as absent
  }
}

void ResultCache::write(std::uint64_t inputs, std::string result) const {
  if (folder_.empty()) return;
  const std::uint64_t key = with_build(inputs);
  const Tail tail{key, hash_with_key(result, key)};
  result.append(reinterpret_cast<const char*>(&tail), sizeof tail);
  try {
    make_folder(folder_);
    write_file(file_of(key), result);
    limit_cache(folder_, most_bytes_);
  } catch (const std::exception&) {
    // See the header.
  }
}

}  // namespace condyle
