// terminal.hpp - what the command says while it works: progress on a terminal, notes on standard error.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "facezip/progress.hpp"

namespace facezip::cli {

/// Writes to standard output, in place of a line of progress; names of strangers in it do nothing to a terminal. Throws
/// std::system_error where it cannot be written.
void printText(const std::string& text);
template <typename... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  printText(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Writes to standard error, likewise, and says nothing where that is closed: a job of hours must not end because
/// nobody can read a note.
void printError(const std::string& text);

/// Shows the stage and its share done on one line of standard error when that is a terminal; in a pipe only notes
/// appear. No note is printed twice. One at a time.
class TerminalProgress : public Progress {
 public:
  /// quiet  no progress and no notes
  explicit TerminalProgress(bool quiet);
  ~TerminalProgress() override;
  void stage(std::string_view name, std::size_t total) override;
  void advance(std::size_t done) override;
  void busy(std::string_view what) override;
  void note(std::string_view message) override;

 private:
  void showLine(const std::string& text);
  bool quiet_;
  bool terminal_;
  std::set<std::string> noted_;
  std::string stage_;
  std::size_t total_ = 0;
  std::chrono::steady_clock::time_point last_shown_;
};

}  // namespace facezip::cli
