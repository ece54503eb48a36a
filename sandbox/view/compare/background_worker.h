// A thread that does one thing after the other for a window that must not wait: of what is still to be done only the
// newest matters.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace weir::view {

class BackgroundWorker {
 public:
  /// What it throws is lost: it reports its errors itself, and one that cannot has no memory left. The token says that
  /// the worker is to end: a long job looks at it now and then.
  using Job = std::function<void(const std::stop_token&)>;

  BackgroundWorker();
  /// A job that waits is dropped, one that runs is told and waited for.
  ~BackgroundWorker();
  BackgroundWorker(const BackgroundWorker&) = delete;
  BackgroundWorker& operator=(const BackgroundWorker&) = delete;

  /// Replaces the job that waits, if there is one. Returns at once.
  void post(Job job);
  /// Nothing waits and nothing runs.
  bool idle() const;

 private:
  void run(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any posted_;
  Job waiting_;
  bool running_ = false;
  std::jthread thread_;  ///< last: it ends before what it uses
};

}  // namespace weir::view
