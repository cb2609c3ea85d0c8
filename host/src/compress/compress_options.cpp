#include "compress/compress_options.hpp"

#include <fmt/format.h>

#include <cmath>

#include "facezip/error.hpp"
#include "io/quoted.hpp"
#include "io/safe_names.hpp"

namespace facezip::compress {

void requireSaneOptions(const CompressOptions& options) {
  const auto require = [](bool holds, const char* option, const char* expected, const std::string& got) {
    if (!holds) throw InputError({option, "", expected, got, ""});
  };
  require(options.weight_scale >= 1 && options.weight_scale <= 64, "--weight-scale", "1 to 64",
          fmt::format("{}", options.weight_scale));
  require(options.differences >= 1 && options.differences <= 8, "--differences", "1 to 8",
          fmt::format("{}", options.differences));
  const bool chooses = options.target_rmse || options.budget_bytes;
  require(!options.target_rmse || (*options.target_rmse > 0.0 && std::isfinite(*options.target_rmse)), "--target-rmse",
          "above 0 and finite", fmt::format("{}", options.target_rmse.value_or(0.0)));
  require(!chooses || options.method == Method::kRefined, "--method", "refined, with a target or budget",
          nameOf(options.method));
  require(options.restarts >= 1, "--restarts", "at least 1", fmt::format("{}", options.restarts));
  require(options.cluster_restarts >= 1, "--cluster-restarts", "at least 1",
          fmt::format("{}", options.cluster_restarts));
  require(options.mask_cutoff >= 0.0 && options.mask_cutoff < 1.0, "--mask-cutoff", "0 or more and below 1",
          fmt::format("{}", options.mask_cutoff));
  require(!options.masks || *options.masks >= 1, "--masks", "at least 1", fmt::format("{}", options.masks.value_or(0)));
  const std::string several = fmt::format("{} formats to choose from", options.format_choice.size());
  require(options.format_choice.empty() || chooses, "--texture-format",
          "one format, or --budget or --target-rmse beside it to choose one by", several);
  require(options.format_choice.empty() || !(options.texture_format || options.difference_format), "--texture-format",
          "one format where there is one for differences, too", several);
  require(!options.difference_format || options.texture_format, "--difference-format",
          "a block --texture-format beside it", "png");
  // They are recorded as JSON.
  require(io::isUtf8(options.region), "--region", "a name in UTF-8", io::quoted(options.region));
  require(io::isUtf8(options.importance), "--importance", "a name in UTF-8", io::quoted(options.importance));
  constexpr int kWidestGutter = 1024;  // the default of the largest textures
  require(!options.feather || (*options.feather >= 0 && *options.feather <= kWidestGutter), "--feather", "0 to 1024",
          fmt::format("{}", options.feather.value_or(0)));
  require(!options.gutter || (*options.gutter >= 0 && *options.gutter <= kWidestGutter), "--gutter", "0 to 1024",
          fmt::format("{}", options.gutter.value_or(0)));
}

}  // namespace facezip::compress
