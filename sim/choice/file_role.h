#pragma once

#include <filesystem>
#include <string>

namespace condyle {

/// A surface, a list of landmarks or a table of muscles to import into a patient.
struct FileRole {
  std::filesystem::path file;
  // "mandible", "upper-teeth", ..., "landmarks", "muscles", or empty: leave it out
  std::string role;
  // The role that its name suggests, where another file of the same object has it.
  std::string taken = {};
};

}  // namespace condyle
