#include "view/compare/background_worker.h"

#include <sys/resource.h>
#include <unistd.h>

#include <exception>
#include <utility>

namespace weir::view {

BackgroundWorker::BackgroundWorker() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

BackgroundWorker::~BackgroundWorker() {
  Job dropped;
  {
    const std::lock_guard lock(mutex_);
    dropped = std::exchange(waiting_, {});
  }
  thread_.request_stop();
  thread_.join();
}

void BackgroundWorker::post(Job job) {
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting_, job);
  }
  posted_.notify_one();  // what was replaced goes now, outside of the lock
}

bool BackgroundWorker::idle() const {
  const std::lock_guard lock(mutex_);
  return !waiting_ && !running_;
}

void BackgroundWorker::run(const std::stop_token& stop) {
  // The window's thread comes first. Linux knows this of threads, and those that a job starts inherit it; where it is
  // refused, nothing but that is lost.
  constexpr int kNicer = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNicer);
  while (true) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      running_ = false;
      if (!posted_.wait(lock, stop, [this] { return static_cast<bool>(waiting_); })) return;
      if (stop.stop_requested()) return;
      job = std::exchange(waiting_, {});
      running_ = true;
    }
    try {
      job(stop);
    } catch (const std::exception&) {
      continue;  // as the header says; the window goes on
    }
  }
}

}  // namespace weir::view
