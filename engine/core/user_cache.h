#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/hash.h"

namespace condyle {

/// $XDG_CACHE_HOME/condyle, else ~/.cache/condyle; empty when neither is set.
std::filesystem::path user_cache_folder();

/// A hash of eight bytes at a time: as fast as memory is read. Chain by passing the previous value.
std::uint64_t word_hash(const void* data, std::size_t size, std::uint64_t h = hash_start);

/// Identifies the machine code of the running program, by its linker's build ID; empty where it has
/// none.
std::string_view program_build();

/// Most bytes of the results in a cache folder, files *.bin of any kind: 4 GiB.
constexpr std::uintmax_t most_cache_bytes = std::uintmax_t{4} << 30;

/// Removes the results that were not used for longest until the others take at most `most_bytes`,
/// and what an interrupted program left half-written more than an hour ago.
void limit_cache(const std::filesystem::path& folder, std::uintmax_t most_bytes = most_cache_bytes);

/// Notes that a result was used.
void note_use(const std::filesystem::path& file);

/// Results of this build of the program, kept on disk where they take longer to compute than to
/// read: files KIND-KEY.bin of a folder.
class ResultCache {
 public:
  /// Nothing is kept in an empty folder, nor by a program without a build ID. `most_bytes`: see
  /// limit_cache().
  ResultCache(std::filesystem::path folder, std::string kind,
              std::uintmax_t most_bytes = most_cache_bytes);

  /// The result stored under a hash of everything that it depends on besides the program; none when
  /// it is absent or damaged.
  std::optional<std::string> read(std::uint64_t inputs) const;
  /// Failure to write only costs time.
  void write(std::uint64_t inputs, std::string result) const;

 private:
  std::filesystem::path file_of(std::uint64_t key) const;

  std::filesystem::path folder_;
  std::string kind_;
  std::uintmax_t most_bytes_;
};

}  // namespace condyle
