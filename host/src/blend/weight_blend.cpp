#include "blend/weight_blend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "facezip/blend.hpp"
#include "facezip/error.hpp"

namespace facezip::blend {

WeightMaps::WeightMaps(device::DeviceContext& context, WeightCodes grid, std::span<const std::byte> codes,
                       device::KernelVariant variant)
    : context_(context), grid_(std::move(grid)) {
  assert(codes.size() == grid_.codeBytes());
  const bool gpu = context.resolve(variant) == device::KernelVariant::kGpu;
  items_per_block_ = gpu ? WeightCodes::kBlockCells : 1;
  kernel_ = context.kernel("weight_blend.cl", "weight_blend",
                           fmt::format("-D LANES={} -D DIFFERENCES={} -D PREFETCH={}", gpu ? 1 : 16, grid_.channels(),
                                       context.clangBuiltins(variant) ? 1 : 0));
  local_size_ = context.workGroupSize(kernel_, gpu ? 64 : 16);
  const std::size_t expressions = toSize(grid_.expressions);
  const std::size_t channels = toSize(grid_.channels());
  const std::size_t padded_cells = grid_.blocks() * WeightCodes::kBlockCells;
  codes_ = context.upload(codes, "the weight maps");
  active_ = context.allocate(expressions * sizeof(cl_int), CL_MEM_READ_ONLY, "expressions in use");
  beta_ = context.allocate(expressions * sizeof(float), CL_MEM_READ_ONLY, "blendshape weights");
  encoding_ = context.allocate(2 * channels * sizeof(float), CL_MEM_READ_ONLY, "weight encoding");
  weights_ = context.allocate(padded_cells * channels * sizeof(float), CL_MEM_READ_WRITE, "blended weights");
  // Frames allocate nothing.
  active_expressions_.reserve(expressions);
  active_beta_.reserve(expressions);
  decoding_.resize(2 * channels);
  gain_ = context.allocate(padded_cells * sizeof(float), CL_MEM_READ_ONLY, "gains of cells");
  setGain({});
}

void WeightMaps::setGain(std::span<const float> gain) {
  assert(gain.empty() || gain.size() == grid_.cellCount());
  std::vector<float> padded(grid_.blocks() * WeightCodes::kBlockCells, 1.0f);
  std::ranges::copy(gain, padded.begin());
  context_.write(gain_, padded, "gains of cells");
}

cl::Event WeightMaps::blend(std::span<const float> beta, int begin_row, int end_row) {
  assert(beta.size() == toSize(grid_.expressions));
  assert(0 <= begin_row && begin_row < end_row && end_row <= grid_.rows);
  active_expressions_.clear();
  active_beta_.clear();
  double beta_sum = 0.0;
  for (std::size_t n = 0; n < beta.size(); ++n) {
    if (beta[n] == 0.0f) continue;
    active_expressions_.push_back(static_cast<cl_int>(n));
    active_beta_.push_back(beta[n]);
    beta_sum += static_cast<double>(beta[n]);
  }
  for (std::size_t i = 0; i < grid_.scale.size(); ++i) {
    decoding_[i] = static_cast<float>(grid_.scale[i]);
    decoding_[grid_.scale.size() + i] = static_cast<float>(grid_.offset[i] * beta_sum);
  }
  context_.write(active_, active_expressions_, "expressions in use");
  context_.write(beta_, active_beta_, "blendshape weights");
  context_.write(encoding_, decoding_, "weight encoding");

  const cl_ulong first_block = grid_.cell(begin_row, 0) / WeightCodes::kBlockCells;
  const cl_ulong block_count = divideUp(toSize(end_row, grid_.columns), WeightCodes::kBlockCells) - first_block;
  const std::size_t items = roundUp(block_count * items_per_block_, local_size_);
  return context_.launch(kernel_, device::WorkItems(items).inGroupsOf(local_size_), codes_, active_, beta_, encoding_,
                         weights_, static_cast<cl_int>(active_expressions_.size()), grid_.expressions, first_block,
                         block_count, gain_);
}

void requireWeights(std::span<const float> beta, std::span<const std::string> names) {
  if (beta.size() != names.size()) {
    throw InputError({"", "blendshape weights", fmt::format("{} values, one per expression", names.size()),
                      fmt::format("{}", beta.size()), ""});
  }
  for (std::size_t n = 0; n < beta.size(); ++n) {
    if (std::abs(beta[n]) <= kLargestWeight) continue;
    throw InputError({"", fmt::format("blendshape weight of {}", names[n]),
                      fmt::format("a number of at most {:g} either way", kLargestWeight),
                      std::isnan(beta[n]) ? "NaN" : fmt::format("{:g}", beta[n]), ""});
  }
}

}  // namespace facezip::blend
