#pragma once

#include <functional>
#include <string_view>

namespace condyle {

/// Told what is being done and how far it is, 0 to 1. May be empty. Throwing from it cancels the
/// work.
using Progress = std::function<void(std::string_view what, double fraction)>;

inline void report(const Progress& progress, std::string_view what, double fraction) {
  if (progress) progress(what, fraction);
}

}  // namespace condyle
