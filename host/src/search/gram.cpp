#include "search/gram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "bands/difference.hpp"
#include "cl/layout.h"
#include "io/counts.hpp"

namespace facezip::compress {
namespace {

// A block is a square piece of the upper triangle of an N x N matrix; gram.cl numbers them J (J + 1) / 2 + I.
constexpr int kBlockSide = FACEZIP_GRAM_BLOCK;
constexpr std::size_t kBlockLanes = kBlockSide * kBlockSide;
constexpr std::size_t kBlockBytes = kBlockLanes * sizeof(float);
// A launch over fewer blocks than this would form the weights of its tiles again for too little work.
constexpr std::size_t kFewestBlocks = 16;

int blockCount(int expressions) {
  const int side = divideUp(expressions, kBlockSide);
  return side * (side + 1) / 2;
}

}  // namespace

GramAccumulator::GramAccumulator(device::DeviceContext& context, GramSlots slots, int expressions,
                                 device::KernelVariant variant, std::size_t largest_partial_bytes)
    : context_(context),
      variant_(context.resolve(variant)),
      largest_partial_bytes_(largest_partial_bytes),
      pair_slots_(slots),
      run_begin_(context, "runs of tiles", CL_MEM_READ_ONLY),
      run_rows_(context, "partial sums of the runs", CL_MEM_READ_ONLY),
      slot_begin_(context, "Gram matrices of the tiles", CL_MEM_READ_ONLY),
      entries_(context, "entries of the Gram matrices", CL_MEM_READ_ONLY),
      touched_begin_(context, "rows of the Gram matrices", CL_MEM_READ_ONLY),
      touched_rows_(context, "row lists of the Gram matrices", CL_MEM_READ_ONLY),
      partial_(context, "partial sums of the Gram matrices"),
      reduced_(context, "sums of the Gram matrices") {
  assert(expressions >= 1);
  sums_.expressions = expressions;
  sums_.slots = std::move(slots);
}

void GramAccumulator::holdSums() {
  if (sums_.values.empty()) sums_.values.resize(sums_.slots.bytes(sums_.expressions) / sizeof(double), 0.0);
}

void GramAccumulator::add(const DeviceTiles& tiles, const cl::Buffer& differences, const BandShape& shape,
                          double metric_weight) {
  assert(shape.expressions == sums_.expressions);
  if (tiles.tileCount() == 0) return;
  holdSums();
  device::requireBytes(context_, differences, differenceBufferBytes(shape, tiles.tileCount()), "differences of a band");
  const std::size_t blocks = toSize(blockCount(sums_.expressions));
  const std::size_t most_rows = largest_partial_bytes_ / (kBlockBytes * std::min(blocks, kFewestBlocks));
  for (std::size_t tile = 0; tile < tiles.tileCount();) {
    const GramPlan plan = planGram(tiles, sums_.slots, pair_slots_, tile, most_rows);
    uploadPlan(plan);
    const std::size_t most_blocks = std::max<std::size_t>(1, largest_partial_bytes_ / (kBlockBytes * plan.rows()));
    for (std::size_t block = 0; block < blocks; block += most_blocks) {
      const int count = static_cast<int>(std::min(most_blocks, blocks - block));
      runBlocks(tiles, differences, shape, plan, static_cast<int>(block), count);
      addSums(plan, static_cast<int>(block), count, metric_weight);
    }
    tile += plan.tile_count;
  }
}

void GramAccumulator::uploadPlan(const GramPlan& plan) {
  run_begin_.upload(plan.run_begin);
  run_rows_.upload(plan.run_rows);
  slot_begin_.upload(plan.slot_begin);
  entries_.upload(plan.entries);
  touched_begin_.upload(plan.touched_begin);
  touched_rows_.upload(plan.touched_rows);
}

cl::Event GramAccumulator::runBlocks(const DeviceTiles& tiles, const cl::Buffer& differences, const BandShape& shape,
                                     const GramPlan& plan, int first_block, int block_count) {
  partial_.reserve(toSize(plan.rows(), block_count) * kBlockBytes);
  const bool gpu = variant_ == device::KernelVariant::kGpu;
  // 64 is what gram_gpu.cl is laid out for; a device that allows less still runs it.
  const std::size_t group = gpu ? std::min<std::size_t>(64, context_.info().largest_work_group) : 1;
  const cl::Kernel kernel =
      gpu ? context_.kernel("gram_gpu.cl", "gram_gpu", fmt::format("{} -D WGS={}", differenceDefines(shape), group))
          : context_.kernel("gram.cl", "gram", differenceDefines(shape));
  const device::WorkItems items = gpu ? device::WorkItems(toSize(group, block_count), plan.runs()).inGroupsOf(group, 1)
                                      : device::WorkItems(plan.runs()).inGroupsOf(1);
  return context_.launch(kernel, items, tiles.maskBegin(), tiles.maskWeights(), tiles.texelWeights(), differences,
                         run_begin_, run_rows_, slot_begin_, entries_, partial_, sums_.expressions, first_block,
                         block_count);
}

void GramAccumulator::addSums(const GramPlan& plan, int first_block, int block_count, double metric_weight) {
  const std::size_t lanes = toSize(block_count) * kBlockLanes;
  const std::size_t bytes = plan.touched.size() * lanes * sizeof(cl_float2);
  reduced_.reserve(bytes);
  context_.launch(context_.kernel("gram_reduce.cl", "gram_reduce"),
                  device::WorkItems(lanes, plan.touched.size()).inGroupsOf(kBlockLanes, 1), partial_, touched_begin_,
                  touched_rows_, reduced_);

  const device::MappedBytes mapped = reduced_.mapForReading(bytes);
  const std::span<const cl_float2> sums = mapped.as<const cl_float2>();
  const auto n_count = toSize(sums_.expressions);
  for (std::size_t i = 0; i < plan.touched.size(); ++i) {
    double* matrix = sums_.values.data() + toSize(plan.touched[i]) * n_count * n_count;
    std::size_t row = 0;  // of blocks
    while ((row + 1) * (row + 2) / 2 <= toSize(first_block)) ++row;
    std::size_t column = toSize(first_block) - row * (row + 1) / 2;
    for (int b = 0; b < block_count; ++b) {
      for (std::size_t lane = 0; lane < kBlockLanes; ++lane) {
        const std::size_t n = column * kBlockSide + lane / kBlockSide;
        const std::size_t m = row * kBlockSide + lane % kBlockSide;
        // Blocks on the diagonal hold both halves, and the same bits in both.
        if (n > m || m >= n_count) continue;
        const cl_float2 sum = sums[i * lanes + toSize(b) * kBlockLanes + lane];
        const double value = metric_weight * (static_cast<double>(sum.s[0]) + static_cast<double>(sum.s[1]));
        matrix[n * n_count + m] += value;
        if (n != m) matrix[m * n_count + n] += value;
      }
      if (++column > row) {
        column = 0;
        ++row;
      }
    }
  }
}

GramMatrices GramAccumulator::finish() {
  holdSums();
  // Moved: the matrices of many masks and expressions are hundreds of MB.
  GramMatrices result{sums_.slots, sums_.expressions, std::move(sums_.values)};
  sums_.values.clear();
  return result;
}

}  // namespace facezip::compress
