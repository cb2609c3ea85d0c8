// compress.hpp - a capture in, a package out: the FaceZip method from textures on disk to a package on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "facezip/block_format.hpp"
#include "facezip/capture.hpp"
#include "facezip/device.hpp"
#include "facezip/geometry/length.hpp"
#include "facezip/method.hpp"
#include "facezip/progress.hpp"

namespace facezip {

struct CompressOptions {
  Method method = Method::kRefined;
  int differences = 4;  ///< C, difference textures of every map and weight channels of every expression; 1 to 8
  /// Instead of `differences` and `weight_scale`, with kRefined: the smallest package of at most this RMSE (pooled over
  /// maps by their metric weights, in 1/255), and no larger than this in run-time memory; with a budget alone the best
  /// package within it. What they cost is estimated while the textures are read the first time.
  std::optional<double> target_rmse;
  std::optional<std::uint64_t> budget_bytes;
  /// Block format of the textures of maps of 8 bits, which are fitted to what their blocks decode to; none: images. BC1
  /// and BC7 become BC4 and BC5 in maps of one and two channels.
  std::optional<BlockFormat> texture_format;
  /// Of the difference textures, where it is to be another.
  std::optional<BlockFormat> difference_format;
  /// With a target or budget, instead of the two above: block formats to choose from, for all textures of 8 bits.
  std::vector<BlockFormat> format_choice;
  /// Weight maps that each set will have beside those of the expressions: a budget counts them too.
  int further_weight_maps = 0;
  /// Which maps share weights. What kAuto chooses by is estimated while the textures are read the first time; methods
  /// that fit no weights to texels (all but kRefined and kClosedLoop) share them.
  WeightSets weight_sets = WeightSets::kAuto;
  int weight_scale = 8;  ///< texels of the largest map per weight cell, per axis; 1 to 64
  /// Poisson-disk radius of the mask samples; bare numbers are in the mesh's unit. The paper's 3 cm.
  geometry::Length mask_radius{3.0, geometry::LengthUnit::kCentimetre};
  std::optional<int> masks;   ///< instead of the radius: exactly this many masks
  double mask_cutoff = 0.01;  ///< mask weights below this are cut, so that a fragment has compact support
  PermutationSolver permutation_solver = PermutationSolver::kBest;
  int restarts = 100;                       ///< of coordinate descent in the permutation search, >= 1
  int cluster_restarts = 64;                ///< of k-means, >= 1
  std::uint64_t seed = 1;                   ///< of every random choice
  std::uint64_t memory_bytes = 2ull << 30;  ///< bound on what the process keeps resident, host and device together
  std::optional<std::string> unit;          ///< of the mesh, over what the capture states; "cm"
  /// Which part of the face: "" the capture's own (face_region.txt, else coverage.png, else the whole mesh), "whole",
  /// or a file of triangle indices (.txt) or a painted image.
  std::string region;
  /// Painted image of where errors matter more: "" the capture's own if it has one, "none", or an image. White counts
  /// fully, black a hundredth.
  std::string importance;
  std::optional<int> gutter;  ///< texels; default max(16, side / 64)
  /// Texels beyond the region's border, where the mesh goes on, over which differences fade out; 0: they stop at the
  /// border. None: side / 32 where an expression changes tone or light there, else 0.
  std::optional<int> feather;
  /// Also put the neutral's mesh and the expressions', where the capture has them, into the package: viewers and
  /// exports need them, frames do not. Takes 36 bytes a vertex and expression of memory while it is written.
  bool mesh = true;
};

/// A number of difference textures and a weight scale, with what they cost.
struct RatePoint {
  int differences = 0;   ///< C
  int weight_scale = 0;  ///< texels of the largest map per weight cell, per axis
  int code_bits = 8;     ///< of the difference textures of maps of 16 bits or floats, 8 or 16; others have 8
  std::optional<BlockFormat> texture_format;     ///< of neutrals of maps of 8 bits; none: images
  std::optional<BlockFormat> difference_format;  ///< of their difference textures
  std::uint64_t bytes = 0;                       ///< run-time memory, as Package::bytesInMemory() counts it
  double rmse = 0.0;                             ///< estimate, in 1/255, pooled over the maps by their metric weights
  bool weights_per_map = false;                  ///< a set of weights for every map; else one for all

  bool operator==(const RatePoint&) const = default;
};

/// What a compression did, for --report and for tests.
struct CompressReport {
  int differences = 0;       ///< C
  int weight_scale = 0;      ///< texels of the largest map per weight cell, per axis
  int weight_sets = 1;       ///< of weights: one, or one for every map
  int feather = 0;           ///< texels of the largest map over which differences fade out beyond the region
  double border_step = 0.0;  ///< the largest step at the region's border without it, in 1/255; 0 where it was not asked
  /// What a target or budget was chosen from: rising bytes, falling RMSE. Empty where neither was asked for.
  std::vector<RatePoint> rate_curve;
  std::optional<RatePoint> rate;  ///< that of them which was taken
  int masks = 0;                  ///< K
  double mask_radius = 0.0;       ///< in the mesh's unit
  std::string unit;               ///< of the mesh
  bool unit_guessed = false;
  std::uint64_t covered_texels = 0;  ///< of the first map
  double cut_mass_mean = 0.0;        ///< share of a vertex's mask weight that the cutoff moved, mean
  double cut_mass_max = 0.0;         ///< and largest
  double active_masks_mean = 0.0;    ///< masks above zero at a vertex, after the cut
  int overlapping_pairs = 0;
  double permutation_cost = 0.0;   ///< Eq. 3, each unordered pair once, in (1/255)^2
  std::string permutation_solver;  ///< which found it: "descent" or "message-passing"; "" if not permuted
  /// Lower bound of the cost of every permutation, at most permutation_cost; none where clusters were not permuted.
  std::optional<double> permutation_bound;
  std::vector<double> permutation_bounds;        ///< pairs of masks alone, then after each iteration of message passing
  double permutation_cost_median = 0.0;          ///< median of the restarts' final costs; 0 without restarts
  std::vector<double> restart_costs;             ///< final cost of every restart
  std::vector<std::vector<double>> convergence;  ///< cost after each sweep, per restart
  /// Of every map whose difference textures were fitted (not with the paper's method): RMSE over the covered texels,
  /// expressions and channels, in 1/255 of full scale, of what is written, before frames are rounded.
  std::vector<std::pair<std::string, double>> rmse;
  /// The same, pooled over the maps by their metric weights: what a target speaks of.
  std::optional<double> pooled_rmse;
  /// Squared error after each sweep of the refinement, from the start on, texel and metric weights in it; of the last
  /// set of weights. Empty where nothing was refined.
  std::vector<double> refinement_errors;
  int band_rows = 0;
  std::string decoded;  ///< how later passes read the textures: "scratch file" or "decoded again"
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage, in order
  double decode_seconds = 0.0;                          ///< wall time of decoding images, most of it beside other work
  double wait_seconds = 0.0;                            ///< of it: waiting for images to be decoded
  std::uint64_t package_disk_bytes = 0;
  std::uint64_t peak_memory_bytes = 0;  ///< largest resident size of the process so far
  std::string device;

  /// How far the cost may lie above the lowest: (cost - bound) / cost, 0 to 1; 0 where the cost is 0 or has no bound.
  double permutationGap() const;
};

/// Compresses `capture` into the directory `package`, which appears whole or not at all; an earlier package there is
/// replaced. The same capture, options and device give the same bytes.
/// Throws InputError (the capture, an option), DeviceError, OutputError (also where `package` is an input, lies in one
/// or holds one), SolverError, Cancelled.
CompressReport compressCapture(const Capture& capture, const std::filesystem::path& package,
                               const CompressOptions& options, const Device& device, Progress& progress);

/// What compressCapture() reads.
ProtectedPaths inputsOf(const Capture& capture, const CompressOptions& options);

}  // namespace facezip
