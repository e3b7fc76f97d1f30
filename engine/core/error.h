#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace condyle {

/// The user's file, plan or command line is wrong. The program ends with exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
  /// Message "FILE: ITEM: problem and remedy"; `item` may be empty.
  InputError(const std::filesystem::path& file, const std::string& item, const std::string& problem)
      : std::runtime_error(file.string() + ": " + (item.empty() ? "" : item + ": ") + problem) {}
};

/// The machine or the program failed (disk full, no EGL, no convergence). Exit code 1.
struct MachineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace condyle
