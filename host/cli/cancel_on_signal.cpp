#include "cancel_on_signal.hpp"

#include <pthread.h>
#include <time.h>

#include <chrono>
#include <optional>

namespace facezip::cli {
namespace {

bool isIgnored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Lets `signal` do what it does to programs that know nothing of it.
void endBy(int signal) {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, signal);
  ::signal(signal, SIG_DFL);
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  ::raise(signal);
}

}  // namespace

CancelOnSignal::CancelOnSignal(Progress& progress) : progress_(progress) {
  ::sigemptyset(&endings_);
  ::sigaddset(&endings_, SIGINT);
  ::sigaddset(&endings_, SIGTERM);
  if (!isIgnored(SIGHUP)) ::sigaddset(&endings_, SIGHUP);
  ::pthread_sigmask(SIG_BLOCK, &endings_, &blocked_before_);
  watcher_ = std::thread([this] { watch(); });
}

CancelOnSignal::~CancelOnSignal() {
  over_ = true;
  ::pthread_kill(watcher_.native_handle(), SIGTERM);
  watcher_.join();
  // What came twice has been heard: nothing is left to end.
  const timespec now{};
  while (::sigtimedwait(&endings_, nullptr, &now) > 0) {
  }
  ::pthread_sigmask(SIG_SETMASK, &blocked_before_, nullptr);
}

void CancelOnSignal::watch() {
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> first;
  while (true) {
    int signal = 0;
    ::sigwait(&endings_, &signal);
    if (over_) return;
    // One Ctrl-C may arrive twice, by the terminal and by a parent that passes it on: only a later one is a second
    // wish.
    const Clock::time_point now = Clock::now();
    if (first && now - *first > std::chrono::seconds(1)) endBy(signal);
    if (!first) first = now;
    progress_.cancel();
  }
}

}  // namespace facezip::cli
