#include <weir/core/parallel.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace weir {

void parallelFor(size_t count, const std::function<void(size_t)>& work) {
  // Asking how many cores there are takes longer than many a piece of work.
  if (count == 1) return work(0);
  static const size_t kCores = std::max(1u, std::thread::hardware_concurrency());
  std::atomic<size_t> next{0}, firstFailed{count};
  std::mutex mutex;
  std::exception_ptr error;
  const auto run = [&] {
    // Numbers are handed out in order, so every number below a failed one is done or being done.
    for (size_t i; (i = next++) < firstFailed.load();) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i >= firstFailed.load()) continue;
        firstFailed = i;
        error = std::current_exception();
      }
    }
  };
  const size_t threads = std::min(kCores, count);
  {
    std::vector<std::jthread> pool;
    for (size_t i = 1; i < threads; ++i) pool.emplace_back(run);
    run();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace weir
