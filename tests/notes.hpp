// notes.hpp - a progress that keeps what is noted.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "facezip/progress.hpp"

namespace facezip::test {

class Notes : public Progress {
 public:
  void note(std::string_view message) override { all.emplace_back(message); }
  std::vector<std::string> all;
};

}  // namespace facezip::test
