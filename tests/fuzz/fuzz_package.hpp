// fuzz_package.hpp - a package for readers of what belongs to one: clips, gains.
#pragma once

#include "../host/sample_package.hpp"
#include "facezip/package.hpp"
#include "fuzz_file.hpp"

namespace facezip::fuzz {

/// Expressions expression_0, expression_1, ...
inline const Package& package() {
  static const Package opened = [] {
    test::SamplePackage sample = test::makeSample();
    test::writeSample(sample, folder() / "package");
    return Package::open(folder() / "package");
  }();
  return opened;
}

}  // namespace facezip::fuzz
