#pragma once

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
    std::call_once(state_->once, [state = state_.get()] {
      state->made.emplace(std::as_const(state->source));
      state->source = {};
    });
    return *state_->made;
  }

 private:
  struct State {
    explicit State(Source from) : source(std::move(from)) {}
    Source source;
    std::once_flag once;
    std::optional<const Made> made;
  };
  std::unique_ptr<State> state_;
};

}  // namespace condyle
