// stage_clock.hpp - wall time by stage, for reports.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace facezip::io {

class StageClock {
 public:
  /// Books the time since construction or the last call under `stage`; times of the same stage add up.
  void book(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    for (auto& [name, sum] : seconds_) {
      if (name == stage) {
        sum += seconds;
        return;
      }
    }
    seconds_.emplace_back(stage, seconds);
  }
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace facezip::io
