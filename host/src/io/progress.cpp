#include "facezip/progress.hpp"

namespace facezip {

void Progress::stage(std::string_view, std::size_t) {}
void Progress::advance(std::size_t) {}
void Progress::busy(std::string_view) {}
void Progress::note(std::string_view) {}

void Progress::checkCancelled() const {
  if (cancelled_.load()) throw Cancelled();
}

}  // namespace facezip
