#include "render/output/parallel_renderers.h"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "render/gl/framebuffer.h"
#include "render/gl/gl_context.h"

namespace condyle {

struct ParallelRenderers::State {
  std::span<const Part> parts;
  std::shared_ptr<const BeforeOperation> operation;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<std::int64_t, Draw>> waiting;  // numbered in order of submission
  std::int64_t submitted = 0, delivered = 0;
  int count = -1;  // known once the first is ready
  int ready = 0;
  bool ending = false;
  int busy = 0;  // threads that are drawing
  std::exception_ptr trouble;
  std::int64_t trouble_at = std::numeric_limits<std::int64_t>::max();  // the picture's number
  std::string driver;
  int max_samples = 1, max_side = 1;
  const SceneRenderer* first = nullptr;
  std::vector<std::thread> threads;

  State(std::span<const Part> all, std::shared_ptr<const BeforeOperation> before)
      : parts(all), operation(std::move(before)) {}

  /// The error of the earliest failed picture.
  void keep_trouble(std::int64_t number) {
    if (!trouble || number < trouble_at) trouble = std::current_exception();
    trouble_at = std::min(trouble_at, number);
  }

  void signal_ready(int expected) {
    const std::lock_guard lock(mutex);
    count = expected;
    ++ready;
    changed.notify_all();
  }

  void work(int drawer, int most) {
    std::optional<OffscreenContext> context;
    std::optional<SceneRenderer> renderer;
    try {
      context.emplace();
      if (drawer > 0 && context->shares_display())
        throw MachineError("no display is free for another context");
      if (drawer == 0)
        renderer.emplace(parts, operation);
      else
        renderer.emplace(*first);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (drawer == 0) keep_trouble(-1);
      count = drawer;  // the others continue without it
      changed.notify_all();
      return;
    }
    if (drawer == 0) {
      first = &*renderer;
      driver = context->description();
      max_samples = condyle::max_samples();
      max_side = condyle::max_side();
      // A graphics card draws one picture at a time.
      const bool card = driver.find("llvmpipe") == std::string::npos;
      signal_ready(card || std::thread::hardware_concurrency() < 2 ? 1 : std::max(1, most));
    } else {
      signal_ready(count);
    }
    draw_all(*renderer, drawer);
  }

  void draw_all(SceneRenderer& renderer, int drawer) {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [&] { return ending || trouble || (ready == count && !waiting.empty()); });
      if (trouble || (ending && waiting.empty())) return;
      auto [number, draw] = std::move(waiting.front());
      waiting.pop_front();
      ++busy;
      changed.notify_all();
      lock.unlock();
      try {
        const Deliver deliver = draw(renderer, drawer);
        lock.lock();
        changed.wait(lock, [&] { return delivered == number || trouble_at < number; });
        if (delivered == number) {
          lock.unlock();
          deliver();
          lock.lock();
          ++delivered;
        }
      } catch (...) {
        if (!lock.owns_lock()) lock.lock();
        keep_trouble(number);
      }
      --busy;
      changed.notify_all();
    }
  }

  /// Throws the error of an earlier picture, once no thread is drawing.
  void rethrow(std::unique_lock<std::mutex>& lock) {
    if (!trouble) return;
    changed.wait(lock, [&] { return busy == 0; });
    std::rethrow_exception(trouble);
  }
};

ParallelRenderers::ParallelRenderers(std::span<const Part> parts, int most,
                                     std::shared_ptr<const BeforeOperation> operation)
    : state_(std::make_unique<State>(parts, std::move(operation))) {
  auto& s = *state_;
  const auto start = [&](int drawer) {
    try {
      s.threads.emplace_back([&s, drawer, most] { s.work(drawer, most); });
    } catch (const std::system_error&) {
      if (drawer == 0) throw MachineError("pictures cannot be drawn: no thread can be started");
      const std::lock_guard lock(s.mutex);
      s.count = drawer;
    }
    std::unique_lock lock(s.mutex);
    s.changed.wait(lock, [&] { return s.trouble || s.ready == drawer + 1 || s.count == drawer; });
    return !s.trouble;
  };
  for (int drawer = 0; start(drawer) && drawer + 1 < s.count; ++drawer) {
  }
  if (!s.trouble) return;
  for (auto& thread : s.threads) thread.join();
  std::rethrow_exception(s.trouble);
}

ParallelRenderers::~ParallelRenderers() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->changed.notify_all();
  for (auto& thread : state_->threads)
    if (thread.joinable()) thread.join();
}

int ParallelRenderers::count() const { return state_->count; }
const std::string& ParallelRenderers::driver() const { return state_->driver; }
int ParallelRenderers::max_samples() const { return state_->max_samples; }
int ParallelRenderers::max_side() const { return state_->max_side; }

void ParallelRenderers::add(Draw draw) {
  auto& s = *state_;
  std::unique_lock lock(s.mutex);
  s.changed.wait(lock, [&] { return s.trouble || std::ssize(s.waiting) < s.count; });
  s.rethrow(lock);
  s.waiting.emplace_back(s.submitted++, std::move(draw));
  s.changed.notify_all();
}

void ParallelRenderers::finish() {
  auto& s = *state_;
  std::unique_lock lock(s.mutex);
  s.changed.wait(lock, [&] { return s.trouble || s.delivered == s.submitted; });
  s.rethrow(lock);
}

}  // namespace condyle
