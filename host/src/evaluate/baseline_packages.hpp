// baseline_packages.hpp - packages of a capture by other methods, made to be measured beside the one in question.
#pragma once

#include <memory>
#include <string>

#include "facezip/compress.hpp"
#include "facezip/package.hpp"
#include "io/scratch_directory.hpp"

namespace facezip::evaluate {

/// A package in the directory for temporary files, gone with the object.
class TemporaryPackage {
 public:
  /// Compresses `capture`. Stages are told to `progress` behind `label`; notes are not: they were said of the package
  /// that is evaluated. Throws what compressCapture() throws.
  TemporaryPackage(const Capture& capture, const CompressOptions& options, const std::string& label,
                   const Device& device, Progress& progress);
  const Package& package() const { return *package_; }
  const CompressReport& report() const { return report_; }

 private:
  io::ScratchDirectory scratch_;
  CompressReport report_;
  std::unique_ptr<Package> package_;
};

}  // namespace facezip::evaluate
