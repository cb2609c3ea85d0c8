#include "terminal.hpp"

#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace facezip::cli {
namespace {

/// What asks a program to end: Ctrl-C, kill, a terminal that closes.
constexpr int kEndings[] = {SIGINT, SIGTERM, SIGHUP};
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
std::atomic<Progress*> g_cancelled_by_signal = nullptr;

/// Seconds of a clock that may be read in a signal handler.
double handlerClock() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

volatile double g_first_signal = 0.0;

void onSignal(int signal) {
  // One Ctrl-C may arrive twice, by the terminal and by a parent that passes it on: only a later one is a second wish.
  const double now = handlerClock();
  if (g_first_signal == 0.0) g_first_signal = now;
  if (now - g_first_signal > 1.0) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return;
  }
  if (Progress* progress = g_cancelled_by_signal.load()) progress->cancel();
}

}  // namespace

TerminalProgress::TerminalProgress(bool quiet) : quiet_(quiet), terminal_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() { clearLine(); }

void TerminalProgress::clearLine() {
  if (!line_shown_) return;
  std::fputs("\r\x1b[K", stderr);
  line_shown_ = false;
}

void TerminalProgress::stage(std::string_view name, std::size_t total) {
  stage_ = name;
  total_ = total;
  last_shown_ = {};
  advance(0);
}

void TerminalProgress::advance(std::size_t done) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now - last_shown_ < kRedrawInterval) return;
  last_shown_ = now;
  const std::string share =
      total_ > 0 ? fmt::format(" {:3.0f} %", 100.0 * static_cast<double>(done) / static_cast<double>(total_)) : "";
  showLine(stage_ + share);
}

void TerminalProgress::busy(std::string_view what) {
  if (!terminal_) return;
  showLine(std::string(what));
  last_shown_ = {};  // the stage may take the line back at once
}

void TerminalProgress::showLine(const std::string& text) {
  clearLine();
  std::fputs(fmt::format("{} ...", text).c_str(), stderr);
  std::fflush(stderr);
  line_shown_ = true;
}

void TerminalProgress::note(std::string_view message) {
  if (quiet_) return;
  clearLine();
  // Not fmt::print(), which throws: a job of hours must not end because nobody can read a note.
  std::fputs(fmt::format("facezip: {}\n", message).c_str(), stderr);
}

CancelOnSignal::CancelOnSignal(Progress& progress) {
  g_cancelled_by_signal.store(&progress);
  for (const int signal : kEndings) {
    const auto before = std::signal(signal, onSignal);
    if (signal == SIGHUP && before == SIG_IGN) std::signal(signal, SIG_IGN);  // nohup
  }
}

CancelOnSignal::~CancelOnSignal() {
  for (const int signal : kEndings) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  g_cancelled_by_signal.store(nullptr);
}

}  // namespace facezip::cli
