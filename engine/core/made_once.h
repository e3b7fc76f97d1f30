#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace condyle {

/// A value that is made from its source when it is first needed; the source is then freed. Threads
/// may ask for it at once. What making throws reaches the caller, and the next one tries again.
template <class Made, class Source>
class MadeOnce {
 public:
  explicit MadeOnce(Source source) : state_(std::make_unique<State>(std::move(source))) {}

  const Made& get() const {
    // Not std::call_once: after a maker that throws it hangs under a thread sanitizer.
    State& state = *state_;
    if (!state.ready.load(std::memory_order_acquire)) {
      const std::scoped_lock lock(state.making);
      if (!state.made) {
        state.made.emplace(std::as_const(state.source));
        state.source = {};
        state.ready.store(true, std::memory_order_release);
      }
    }
    return *state.made;
  }

 private:
  struct State {
    explicit State(Source from) : source(std::move(from)) {}
    Source source;
    std::mutex making;
    std::atomic<bool> ready = false;
    std::optional<const Made> made;
  };
  std::unique_ptr<State> state_;
};

}  // namespace condyle
