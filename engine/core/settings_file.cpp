#include "engine/core/settings_file.h"

#include <cstdlib>

namespace condyle {

std::filesystem::path settings_file(const std::string& name) {
  namespace fs = std::filesystem;
  const char* config = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  // By the XDG specification a relative path is ignored.
  if (config && fs::path(config).is_absolute()) return fs::path(config) / "condyle" / name;
  if (home && *home) return fs::path(home) / ".config" / "condyle" / name;
  return {};
}

}  // namespace condyle
