#include "engine/core/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <mutex>

#include "engine/core/thread_order.h"

namespace condyle {
namespace {

/// Never destroyed: creating an arena costs more than most loops.
tbb::task_arena& arena_of(int threads) {
  static std::mutex mutex;
  static std::map<int, tbb::task_arena> arenas;
  const std::lock_guard lock(mutex);
  return arenas.try_emplace(threads, threads).first->second;
}

}  // namespace

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  assert(body);
  threads = std::min(threads, tbb::info::default_concurrency());
  if (threads <= 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  char started = 0, done = 0;  // the bodies run after the call begins and before it returns
  publish_to_sanitizer(&started);
  const auto ordered_body = [&](std::size_t i) {
    acquire_for_sanitizer(&started);
    body(i);
    publish_to_sanitizer(&done);
  };
  arena_of(threads).execute(
      [&] { tbb::parallel_for(std::size_t{0}, count, ordered_body, tbb::simple_partitioner()); });
  acquire_for_sanitizer(&done);
}

}  // namespace condyle
