#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/progress.h"

namespace condyle {

/// Thrown inside cancelled work.
struct Cancelled {};

/// Long work on its own thread, with progress. Cancelled work ends when it next reports progress.
template <class Result>
class BackgroundWork {
 public:
  /// `notify`: called when there is news, from the other thread.
  BackgroundWork(std::function<Result(const Progress&)> work, std::function<void()> notify)
      : notify_(std::move(notify)), thread_([this, work = std::move(work)] { run(work); }) {}
  ~BackgroundWork() {
    cancel();
    thread_.join();
  }
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_; }
  bool done() const { return done_; }
  std::pair<std::string, double> progress() const {
    const std::lock_guard lock(mutex_);
    return {what_, fraction_};
  }
  /// Waits for the end, then as `take`.
  std::optional<Result> finish() {
    done_.wait(false);
    return take();
  }
  /// The result of finished work, none if it was cancelled. Rethrows the exception that ended it.
  std::optional<Result> take() {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::exchange(result_, std::nullopt);
  }

 private:
  void run(const std::function<Result(const Progress&)>& work) {
    try {
      result_.emplace(work([this](std::string_view what, double fraction) {
        if (cancelled_) throw Cancelled{};
        {
          const std::lock_guard lock(mutex_);
          what_ = what;
          fraction_ = fraction;
        }
        if (notify_) notify_();
      }));
    } catch (const Cancelled&) {
    } catch (...) {
      failure_ = std::current_exception();
    }
    done_ = true;
    done_.notify_all();
    if (notify_) notify_();
  }

  std::function<void()> notify_;
  mutable std::mutex mutex_;
  std::string what_;
  double fraction_ = 0;
  std::optional<Result> result_;
  std::exception_ptr failure_;
  std::atomic<bool> cancelled_ = false, done_ = false;
  std::thread thread_;
};

}  // namespace condyle
