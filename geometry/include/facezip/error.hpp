// error.hpp - what facezip throws when it cannot do what was asked.
// Broken invariants of facezip's own code are asserts, not exceptions.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace facezip {

/// Base of every failure that facezip reports. what() is one line that a user can act on; what files and options bring
/// into those of InputError and OutputError is made printable.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input is not what it must be: a file, an option or a value.
/// what() reads "FILE: ITEM: expected E, got G; CURE"; empty parts are left out.
class InputError : public Error {
 public:
  struct Parts {
    std::string file;      ///< path or option at fault, "" when the input came from memory
    std::string item;      ///< what in it: an expression, a line, a field
    std::string expected;  ///< what would have been accepted
    std::string got;       ///< what was found
    std::string cure;      ///< what to do about it
  };
  explicit InputError(Parts parts);
  const Parts& parts() const noexcept { return parts_; }
  /// The same error, naming `file` if it named none: for errors about values whose origin only the caller knows.
  InputError in(const std::string& file) const;

 private:
  Parts parts_;
};

/// A file or directory could not be written: permissions, a full disk, a name in the way.
class OutputError : public Error {
 public:
  OutputError(const std::filesystem::path& file, const std::string& reason, const std::string& cure = "");
  const std::filesystem::path& file() const noexcept { return file_; }
  const std::string& reason() const noexcept { return reason_; }
  /// The same error of another file: for files that the user did not name.
  OutputError of(const std::filesystem::path& file) const { return {file, reason_, cure_}; }

 private:
  std::filesystem::path file_;
  std::string reason_;
  std::string cure_;
};

/// A linear system could not be solved to the promised residual.
class SolverError : public Error {
 public:
  /// step      which system, for example "mask weights"
  /// size      number of unknowns
  /// residual  relative residual that was reached; NaN if the factorisation itself failed
  SolverError(const std::string& step, long size, double residual);
  long size() const noexcept { return size_; }
  double residual() const noexcept { return residual_; }

 private:
  long size_;
  double residual_;
};

}  // namespace facezip
