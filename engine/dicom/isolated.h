#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace condyle {

/// What a function wrote in a process of its own.
struct IsolatedResult {
  std::string output;    // `size` bytes
  std::string messages;  // printed on standard output and error, at most 4 KiB
};

/// Runs `work` on a copy of this process, so that it may crash, exhaust memory or print without
/// harm: libraries do on damaged files. It gets a buffer of `size` zeros and returns whether it
/// succeeded; it must start no thread. Its memory is limited to that of this process, four times
/// `size` and 256 MiB, its time to 60 s of a processor. Empty where it failed in any of these.
/// throws: MachineError where no process can be started.
std::optional<IsolatedResult> run_isolated(std::size_t size,
                                           const std::function<bool(char* buffer)>& work);

}  // namespace condyle
