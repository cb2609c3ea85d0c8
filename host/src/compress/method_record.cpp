#include "compress/method_record.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace facezip::compress {
namespace {
using nlohmann::json;

const char* methodName(CompressOptions::Method method) {
  return method == CompressOptions::Method::kPaper ? "paper" : "no-permutation";
}

std::string lengthText(const geometry::Length& length) {
  return fmt::format("{}{}", length.value, length.unit ? geometry::unitSymbol(*length.unit) : "");
}

}  // namespace

std::string methodJson(const CompressOptions& options, const CompressReport& report, const std::string& region) {
  json record = {{"name", methodName(options.method)},
                 {"weight_scale", options.weight_scale},
                 {"mask_radius", lengthText(options.mask_radius)},
                 {"mask_cutoff", options.mask_cutoff},
                 {"restarts", options.restarts},
                 {"cluster_restarts", options.cluster_restarts},
                 {"seed", options.seed},
                 {"region", options.region},
                 {"unit", options.unit.value_or("")}};
  if (options.masks) record["masks"] = *options.masks;
  if (options.gutter) record["gutter"] = *options.gutter;
  record["result"] = {{"masks", report.masks},
                      {"mask_radius", report.mask_radius},
                      {"unit", report.unit},
                      {"region", region},
                      {"covered_texels", report.covered_texels},
                      {"permutation_cost", report.permutation_cost}};
  return record.dump();
}

CompressOptions optionsFromMethodJson(const std::string& json_text, const std::string& file) {
  try {
    const json record = json::parse(json_text);
    CompressOptions options;
    options.method = record.at("name").get<std::string>() == methodName(CompressOptions::Method::kNoPermutation)
                         ? CompressOptions::Method::kNoPermutation
                         : CompressOptions::Method::kPaper;
    options.weight_scale = record.at("weight_scale").get<int>();
    options.mask_radius = geometry::parseLength(record.at("mask_radius").get<std::string>());
    options.mask_cutoff = record.at("mask_cutoff").get<double>();
    options.restarts = record.at("restarts").get<int>();
    options.cluster_restarts = record.at("cluster_restarts").get<int>();
    options.seed = record.at("seed").get<std::uint64_t>();
    options.region = record.at("region").get<std::string>();
    if (const std::string unit = record.at("unit").get<std::string>(); !unit.empty()) options.unit = unit;
    if (record.contains("masks")) options.masks = record["masks"].get<int>();
    if (record.contains("gutter")) options.gutter = record["gutter"].get<int>();
    return options;
  } catch (const json::exception& error) {
    throw InputError(
        {file, "method", "the options that `facezip compress` recorded", error.what(), "compress the capture again"});
  }
}

}  // namespace facezip::compress
