#pragma once

#include <string>

namespace condyle {

/// While it lives, Ctrl-C and a polite kill say a sentence on standard error before they end the
/// program as they always do. One at a time.
class Interruption {
 public:
  explicit Interruption(const std::string& sentence);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
};

}  // namespace condyle
