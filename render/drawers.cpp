#include "render/drawers.h"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "render/gl_context.h"

namespace condyle {

struct Drawers::State {
  std::span<const Part> parts;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<std::int64_t, Draw>> waiting;  // numbered as they came
  std::int64_t asked = 0, delivered = 0;
  int count = 0;  // known once the first is ready
  int ready = 0;
  bool ending = false;
  std::exception_ptr trouble;
  std::string driver;
  const SceneRenderer* first = nullptr;
  std::vector<std::thread> threads;

  explicit State(std::span<const Part> all) : parts(all) {}

  void keep_trouble() {
    const std::lock_guard lock(mutex);
    if (!trouble) trouble = std::current_exception();
    changed.notify_all();
  }

  void tell_ready(int wanted) {
    const std::lock_guard lock(mutex);
    count = wanted;
    ++ready;
    changed.notify_all();
  }

  void work(int drawer, int most) {
    try {
      const OffscreenContext context;
      std::optional<SceneRenderer> renderer;
      if (drawer == 0) {
        renderer.emplace(parts);
        first = &*renderer;
        driver = context.description();
        // A card draws one picture at a time.
        const bool card = driver.find("llvmpipe") == std::string::npos;
        tell_ready(card || std::thread::hardware_concurrency() < 2 ? 1 : std::max(1, most));
      } else {
        renderer.emplace(*first);
        tell_ready(count);
      }
      draw_all(*renderer, drawer);
    } catch (...) {
      keep_trouble();
    }
  }

  void draw_all(SceneRenderer& renderer, int drawer) {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [&] { return ending || trouble || (ready == count && !waiting.empty()); });
      if (ending || trouble) return;
      auto [number, draw] = std::move(waiting.front());
      waiting.pop_front();
      changed.notify_all();
      lock.unlock();
      const Deliver deliver = draw(renderer, drawer);
      lock.lock();
      changed.wait(lock, [&] { return trouble || delivered == number; });
      if (trouble) return;
      lock.unlock();
      deliver();
      lock.lock();
      ++delivered;
      changed.notify_all();
    }
  }

  void rethrow() const {
    if (trouble) std::rethrow_exception(trouble);
  }
};

Drawers::Drawers(std::span<const Part> parts, int most) : state_(std::make_unique<State>(parts)) {
  auto& s = *state_;
  const auto start = [&](int drawer) {
    s.threads.emplace_back([&s, drawer, most] { s.work(drawer, most); });
    std::unique_lock lock(s.mutex);
    s.changed.wait(lock, [&] { return s.trouble || s.ready == drawer + 1; });
    return !s.trouble;
  };
  for (int drawer = 0; start(drawer) && drawer + 1 < s.count; ++drawer) {
  }
  if (!s.trouble) return;
  for (auto& thread : s.threads) thread.join();
  s.rethrow();
}

Drawers::~Drawers() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->changed.notify_all();
  for (auto& thread : state_->threads)
    if (thread.joinable()) thread.join();
}

int Drawers::count() const { return state_->count; }
const std::string& Drawers::driver() const { return state_->driver; }

void Drawers::add(Draw draw) {
  auto& s = *state_;
  std::unique_lock lock(s.mutex);
  s.changed.wait(lock, [&] { return s.trouble || std::ssize(s.waiting) < s.count; });
  s.rethrow();
  s.waiting.emplace_back(s.asked++, std::move(draw));
  s.changed.notify_all();
}

void Drawers::finish() {
  auto& s = *state_;
  std::unique_lock lock(s.mutex);
  s.changed.wait(lock, [&] { return s.trouble || s.delivered == s.asked; });
  s.rethrow();
}

}  // namespace condyle
