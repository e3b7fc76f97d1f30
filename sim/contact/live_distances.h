#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "sim/contact/distance_map.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// Takes the distances of the newest frame on a thread of its own, so that neither the steps of the
/// simulation nor the pictures wait for them.
class LiveDistances {
 public:
  /// Makes the map on that thread, too. The patient must outlive this.
  explicit LiveDistances(const Case& patient, const DistanceMapSettings& settings = {});
  ~LiveDistances();
  LiveDistances(const LiveDistances&) = delete;
  LiveDistances& operator=(const LiveDistances&) = delete;

  void request(FrameState frame);

  struct Answer {
    FrameState frame;
    DistanceMap::Values values;
  };
  /// The newest answer when there is one that was not taken yet. Rethrows what stopped the thread.
  std::optional<Answer> take();

  /// Null until the first answer is there.
  const DistanceMap* map() const;

 private:
  void work();

  const Case& patient_;
  DistanceMapSettings settings_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<DistanceMap> map_;
  std::optional<FrameState> wanted_;
  std::optional<Answer> newest_;
  std::exception_ptr failure_;
  bool answered_ = false, stop_ = false;
  std::thread thread_;
};

}  // namespace condyle
