#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "facezip/printable.hpp"

namespace facezip::cli {
namespace {

constexpr auto kRedrawInterval = std::chrono::milliseconds(100);

/// Is there a line of progress on the terminal? Whatever else is printed clears it.
bool g_line_shown = false;

void clearLine() {
  if (!g_line_shown) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  g_line_shown = false;
}

}  // namespace

void printText(const std::string& text) {
  clearLine();
  if (std::fputs(printableLines(text).c_str(), stdout) == EOF) {
    throw std::system_error(errno, std::generic_category(), "standard output");
  }
}

void printError(const std::string& text) {
  clearLine();
  std::fputs(printableLines(text).c_str(), stderr);
}

TerminalProgress::TerminalProgress(bool quiet) : quiet_(quiet), terminal_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() { clearLine(); }

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
  std::fputs(fmt::format("{} ...", printable(text)).c_str(), stderr);
  std::fflush(stderr);
  g_line_shown = true;
}

void TerminalProgress::note(std::string_view message) {
  // Commands that do a step again (an ablation, a package that was replaced) would say again what it found.
  if (quiet_ || !noted_.insert(std::string(message)).second) return;
  printError(fmt::format("facezip: {}\n", printable(message)));
}

}  // namespace facezip::cli
