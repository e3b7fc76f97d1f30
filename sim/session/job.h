#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/session/background_work.h"

namespace condyle {

/// Objects that are no longer needed, destroyed on separate threads; only the end of the session
/// waits for them.
class RetiredWork {
 public:
  /// Cancels the work.
  template <class Result>
  void add(std::unique_ptr<BackgroundWork<Result>> work) {
    work->cancel();
    keep(std::shared_ptr<BackgroundWork<Result>>(std::move(work)));
  }
  /// Destroys running or large work; `keeper`, on which it works, is released after it.
  template <class Thing>
  void add(std::shared_ptr<Thing> thing, std::shared_ptr<const void> keeper) {
    auto both = std::make_shared<std::pair<std::shared_ptr<const void>, std::shared_ptr<Thing>>>(
        std::move(keeper), std::move(thing));
    keep(std::make_shared<BackgroundWork<bool>>(
        [both](const Progress&) {
          both->second.reset();
          both->first.reset();
          return true;
        },
        [] {}));
  }
  /// Discards work that has ended.
  void sweep() {
    std::erase_if(ending_, [](const auto& has_ended) { return has_ended(); });
  }

 private:
  template <class Result>
  void keep(std::shared_ptr<BackgroundWork<Result>> work) {
    ending_.push_back([work = std::move(work)] { return work->done(); });
  }
  std::vector<std::function<bool()>> ending_;
};

/// Background work of one kind, at most one at a time.
template <class Result>
class Job {
 public:
  using Work = std::function<Result(const Progress&)>;

  /// `notify`: called when there is news, from the other thread. Both must outlive the job.
  Job(RetiredWork& retired, std::function<void()> notify)
      : retired_(retired), notify_(std::move(notify)) {}

  /// Starts work; running work is dropped.
  void start(Work work) {
    drop();
    work_ = std::make_unique<BackgroundWork<Result>>(std::move(work), notify_);
  }
  /// Ends it without a result and without waiting.
  void drop() {
    if (work_) retired_.add(std::move(work_));
    work_.reset();
  }
  /// Ends it when it next reports progress; its result, if any, can be taken.
  void cancel() {
    if (work_) work_->cancel();
  }
  /// Started, and its result not taken yet.
  bool active() const { return work_ != nullptr; }
  /// Its result can be taken.
  bool done() const { return work_ && work_->done(); }
  std::pair<std::string, double> progress() const {
    return work_ ? work_->progress() : std::pair<std::string, double>{};
  }
  /// The result of finished work, none if it was cancelled. The job is idle afterwards. Rethrows
  /// the exception that ended the work.
  std::optional<Result> take() { return std::exchange(work_, nullptr)->take(); }
  /// Waits for the end, then as `take`.
  std::optional<Result> finish() { return std::exchange(work_, nullptr)->finish(); }

 private:
  RetiredWork& retired_;
  std::function<void()> notify_;
  std::unique_ptr<BackgroundWork<Result>> work_;
};

}  // namespace condyle
