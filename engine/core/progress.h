#pragma once

#include <functional>
#include <string_view>

namespace condyle {

/// Receives the current stage of the work and its progress, 0 to 1. May be empty. An exception
/// thrown from it cancels the work.
using Progress = std::function<void(std::string_view what, double fraction)>;

inline void report(const Progress& progress, std::string_view what, double fraction) {
  if (progress) progress(what, fraction);
}

}  // namespace condyle
