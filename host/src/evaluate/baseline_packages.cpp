#include "evaluate/baseline_packages.hpp"

namespace facezip::evaluate {
namespace {

/// Puts a label before every stage.
class LabelledProgress : public Progress {
 public:
  LabelledProgress(std::string label, Progress& outer) : label_(std::move(label)), outer_(outer) {}
  void stage(std::string_view name, std::size_t total) override {
    outer_.checkCancelled();  // cancel() reaches the outer one alone
    outer_.stage(label_ + ": " + std::string(name), total);
  }
  void advance(std::size_t done) override {
    outer_.checkCancelled();
    outer_.advance(done);
  }

 private:
  std::string label_;
  Progress& outer_;
};

}  // namespace

TemporaryPackage::TemporaryPackage(const Capture& capture, const CompressOptions& options, const std::string& label,
                                   const Device& device, Progress& progress) {
  LabelledProgress labelled(label, progress);
  report_ = compressCapture(capture, scratch_.path() / "package", options, device, labelled);
  package_ = std::make_unique<Package>(Package::open(scratch_.path() / "package"));
}

}  // namespace facezip::evaluate
