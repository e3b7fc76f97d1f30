#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "sim/contact/distance_map.h"
#include "sim/frame/frame_state.h"

namespace condyle {

/// Computes the distances of the newest frame on a separate thread, so that neither the simulation
/// steps nor the pictures wait for them.
class LiveDistances {
 public:
  /// Builds the map on that thread, too. The patient must outlive this.
  explicit LiveDistances(const Case& patient, const DistanceMapSettings& settings = {});
  ~LiveDistances();
  LiveDistances(const LiveDistances&) = delete;
  LiveDistances& operator=(const LiveDistances&) = delete;

  void request(FrameState frame);

  struct Answer {
    FrameState frame;
    DistanceMap::Values values;
  };
  /// The newest result, if it was not taken yet. Rethrows the exception that stopped the thread.
  std::optional<Answer> take();

  /// Null until the first result is available.
  const DistanceMap* map() const;

 private:
  void work();

  const Case& patient_;
  DistanceMapSettings settings_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<DistanceMap> map_;
  std::optional<FrameState> requested_;
  std::optional<Answer> newest_;
  std::exception_ptr failure_;
  bool answered_ = false, stop_ = false;
  std::thread thread_;
};

}  // namespace condyle
