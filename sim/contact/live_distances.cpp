#include "sim/contact/live_distances.h"

#include <utility>

namespace condyle {

LiveDistances::LiveDistances(const Case& patient, const DistanceMapSettings& settings)
    : patient_(patient), settings_(settings), thread_([this] { work(); }) {}

LiveDistances::~LiveDistances() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveDistances::request(FrameState frame) {
  {
    const std::lock_guard lock(mutex_);
    requested_ = std::move(frame);
  }
  changed_.notify_all();
}

std::optional<LiveDistances::Answer> LiveDistances::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, std::nullopt);
}

const DistanceMap* LiveDistances::map() const {
  const std::lock_guard lock(mutex_);
  return answered_ ? &*map_ : nullptr;
}

void LiveDistances::work() {
  try {
    map_.emplace(patient_, settings_);
    while (true) {
      Answer answer;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return stop_ || requested_; });
        if (stop_) return;
        answer.frame = *std::exchange(requested_, std::nullopt);
      }
      answer.values = map_->at(answer.frame.poses);
      const std::lock_guard lock(mutex_);
      newest_ = std::move(answer);
      answered_ = true;
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

}  // namespace condyle
