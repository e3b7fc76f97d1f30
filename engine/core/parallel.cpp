#include "engine/core/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace condyle {

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  threads = std::min(threads, tbb::info::default_concurrency());
  if (threads <= 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, body, tbb::simple_partitioner()); });
}

}  // namespace condyle
