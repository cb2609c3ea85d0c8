// cancel_on_signal.hpp - Ctrl-C, kill and a terminal that closes end the work at its next step.
#pragma once

#include <signal.h>

#include <atomic>
#include <thread>

#include "facezip/progress.hpp"

namespace facezip::cli {

/// Makes SIGINT, SIGTERM and SIGHUP (but under nohup) cancel `progress`, so that the work stops at its next step and
/// removes what is unfinished. Another one, a second or more later, ends the process at once.
/// The signals are blocked and waited for, not handled: drivers that compile kernels install handlers of their own.
/// Threads inherit that, so it must be made before any that does the work. One object at a time.
class CancelOnSignal {
 public:
  explicit CancelOnSignal(Progress& progress);
  ~CancelOnSignal();
  CancelOnSignal(const CancelOnSignal&) = delete;
  CancelOnSignal& operator=(const CancelOnSignal&) = delete;

 private:
  void watch();

  Progress& progress_;
  sigset_t endings_{};
  sigset_t blocked_before_{};
  std::atomic<bool> over_ = false;
  std::thread watcher_;
};

}  // namespace facezip::cli
