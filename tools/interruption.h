#pragma once

#include <string>

namespace condyle {

/// During its lifetime SIGINT and SIGTERM print a sentence on standard error before they end the
/// program as by default. One instance at a time.
class Interruption {
 public:
  explicit Interruption(const std::string& sentence);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
};

}  // namespace condyle
