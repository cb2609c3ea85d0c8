// Signals that ask a command to end, as they come: to any thread, twice, past handlers that drivers installed.
#include "cancel_on_signal.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "exit_codes.hpp"

namespace facezip::cli {
namespace {

bool cancelledSoon(const Progress& progress) {
  for (int wait = 0; wait < 1000; ++wait) {
    try {
      progress.checkCancelled();
    } catch (const Cancelled&) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(CancelOnSignal, EverySignalThatEndsAProgramCancels) {
  const auto before = std::signal(SIGHUP, SIG_DFL);  // the tests may run under nohup
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Progress progress;
    const CancelOnSignal cancel(progress);
    progress.checkCancelled();
    ::kill(::getpid(), signal);
    EXPECT_TRUE(cancelledSoon(progress)) << signal;
  }
  std::signal(SIGHUP, before);
}

/// Compilers inside OpenCL drivers install handlers that end the process, while they work.
TEST(CancelOnSignal, HandlersOfDriversAreNotCalled) {
  Progress progress;
  const CancelOnSignal cancel(progress);
  const auto before = std::signal(SIGINT, [](int) { ::_exit(kExitInternal); });
  std::thread worker([] { ::kill(::getpid(), SIGINT); });
  ::kill(::getpid(), SIGINT);
  worker.join();
  EXPECT_TRUE(cancelledSoon(progress));
  std::signal(SIGINT, before);
}

TEST(CancelOnSignal, ASignalThatComesTwiceIsHeardOnce) {
  for (int round = 0; round < 200; ++round) {
    Progress progress;
    const CancelOnSignal cancel(progress);
    for (int i = 0; i < 3; ++i) ::kill(::getpid(), SIGINT);
  }
}

TEST(CancelOnSignal, ASecondWishEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        Progress progress;
        const CancelOnSignal cancel(progress);
        ::kill(::getpid(), SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(1200));
        ::kill(::getpid(), SIGTERM);
        std::this_thread::sleep_for(std::chrono::seconds(5));
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST(CancelOnSignal, NohupHolds) {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  Progress progress;
  const CancelOnSignal cancel(progress);
  ::kill(::getpid(), SIGHUP);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_NO_THROW(progress.checkCancelled());
  std::signal(SIGHUP, before);
}

TEST(CancelOnSignal, AfterwardsSignalsDoWhatTheyDidBefore) {
  sigset_t before;
  ::pthread_sigmask(SIG_SETMASK, nullptr, &before);
  {
    Progress progress;
    const CancelOnSignal cancel(progress);
  }
  sigset_t after;
  ::pthread_sigmask(SIG_SETMASK, nullptr, &after);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(::sigismember(&before, signal), ::sigismember(&after, signal));
  }
}

}  // namespace
}  // namespace facezip::cli
