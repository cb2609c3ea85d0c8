// progress.hpp - how long work tells where it is, and how it is asked to stop.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>

#include "facezip/error.hpp"

namespace facezip {

/// The work was asked to stop. Nothing half-written is left.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

/// Receives the progress of long work. The base class ignores it all; calls come from one thread at a time.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage begins that has `total` steps (0 when that is not known).
  virtual void stage(std::string_view name, std::size_t total);
  /// `done` of the current stage's steps are finished.
  virtual void advance(std::size_t done);
  /// Something outside the stage takes a while ("compiling kernels"); the stage goes on with the next advance().
  virtual void busy(std::string_view what);
  /// A fact the user should see: what was guessed, chosen or skipped.
  virtual void note(std::string_view message);

  /// Asks the work to stop at its next step; safe in a signal handler and from any thread.
  void cancel() noexcept { cancelled_.store(true); }
  /// Throws Cancelled once cancel() was called.
  void checkCancelled() const;

 private:
  std::atomic<bool> cancelled_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free, "cancel() is called in signal handlers");
};

}  // namespace facezip
