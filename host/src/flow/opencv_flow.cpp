// opencv_flow.cpp - dense inverse search (Kroeger et al. 2016) with variational refinement, as OpenCV has it.
#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cassert>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "facezip/error.hpp"
#include "flow/texture_flow.hpp"

namespace facezip::flow {
namespace {

// Detail is what is smaller than this, in texels; its strength is judged over twice as much.
constexpr double kDetail = 3.0;
constexpr double kAround = 4.0;         // texels, that agreement is judged over
constexpr double kNoise = 1.5 / 255.0;  // deviation at which a scan's noise is as strong as its detail
constexpr double kCodes = 40.0;         // of 8 bits for a standard deviation: three of them fit

/// OpenCV cuts its work into as many pieces as it has threads, and flow spreads within a piece: one thread alone gives
/// the same flow on every machine.
class OneThread {
 public:
  OneThread() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

/// Mean around every texel of those that are known.
cv::Mat meanOfKnown(const cv::Mat& values, const cv::Mat& known, double deviation) {
  cv::Mat sum, weight;
  cv::GaussianBlur(values.mul(known), sum, {0, 0}, deviation);
  cv::GaussianBlur(known, weight, {0, 0}, deviation);
  cv::max(weight, 1e-3, weight);
  return sum / weight;
}

/// What is smaller than kDetail, less its mean and over its deviation; 0 where nothing is known.
struct Detail {
  cv::Mat known;   ///< 0 or 1, float
  cv::Mat values;  ///< float
  cv::Mat codes() const {
    cv::Mat coded;
    values.convertTo(coded, CV_8U, kCodes, 128.0);
    return coded;
  }
};

Detail detailOf(const GreyPicture& picture) {
  // cv::Mat has no view of constant samples; neither is written to.
  const cv::Mat grey(picture.height, picture.width, CV_32F, const_cast<float*>(picture.grey.data()));
  const cv::Mat mask(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.known.data()));
  Detail detail;
  cv::Mat(mask > 0).convertTo(detail.known, CV_32F, 1.0 / 255.0);
  const cv::Mat high = (grey - meanOfKnown(grey, detail.known, kDetail)).mul(detail.known);
  cv::Mat strength;
  cv::sqrt(meanOfKnown(high.mul(high), detail.known, 2.0 * kDetail), strength);
  detail.values = high / (strength + kNoise);
  return detail;
}

/// Correlation around every texel, of what both know, of `from` with what its flow leads to.
std::vector<float> agreementOf(const Detail& from, const Detail& to, const std::vector<float>& flow) {
  cv::Mat places(from.values.rows, from.values.cols, CV_32FC2);
  for (int y = 0; y < places.rows; ++y) {
    for (int x = 0; x < places.cols; ++x) {
      const float* vector = &flow[2 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(places.cols) +
                                       static_cast<std::size_t>(x))];
      places.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + vector[0], static_cast<float>(y) + vector[1]};
    }
  }
  cv::Mat led, known;
  cv::remap(to.values, led, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::remap(to.known, known, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  const cv::Mat both = known.mul(from.known);
  const auto mean = [&](const cv::Mat& a, const cv::Mat& b) { return meanOfKnown(a.mul(b), both, kAround); };
  cv::Mat strength;
  cv::sqrt(mean(from.values, from.values).mul(mean(led, led)), strength);
  std::vector<float> agreement(from.values.total());
  cv::Mat out(from.values.rows, from.values.cols, CV_32F, agreement.data());
  const cv::Mat correlation = mean(from.values, led) / (strength + 1e-3);
  cv::multiply(correlation, from.known, out);
  return agreement;
}

std::vector<float> flowOf(const cv::Mat& from, const cv::Mat& to) {
  const cv::Ptr<cv::DISOpticalFlow> search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  search->setFinestScale(1);  // half the size: the refinement's smoothness reaches over the noise of a texel
  search->setPatchSize(12);
  search->setPatchStride(4);
  search->setGradientDescentIterations(25);
  search->setVariationalRefinementIterations(20);
  search->setVariationalRefinementAlpha(20.0f);
  search->setUseSpatialPropagation(true);
  std::vector<float> vectors(2 * from.total());
  cv::Mat flow(from.rows, from.cols, CV_32FC2, vectors.data());
  search->calc(from, to, flow);
  if (flow.ptr() != reinterpret_cast<const uchar*>(vectors.data())) flow.reshape(1, 1).copyTo(vectors);
  return vectors;
}

TextureFlow find(const GreyPicture& from, const GreyPicture& to) {
  assert(from.width == to.width && from.height == to.height && std::min(from.width, from.height) >= 32);
  try {
    const OneThread one;
    const Detail a = detailOf(from), b = detailOf(to);
    TextureFlow flow{from.width, from.height, {}, {}, {}};
    tbb::parallel_invoke([&] { flow.forward = flowOf(a.codes(), b.codes()); },
                         [&] { flow.backward = flowOf(b.codes(), a.codes()); });
    flow.agreement = agreementOf(a, b, flow.forward);
    return flow;
  } catch (const cv::Exception& error) {
    throw Error(fmt::format("optical flow of {} x {} texels: {}", from.width, from.height, error.what()));
  }
}

}  // namespace

FlowFunction facezipOpenCvFlow() { return &find; }

}  // namespace facezip::flow
