#include "compress/method_record.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace facezip::compress {
namespace {
using nlohmann::json;

template <typename Value>
Value named(const json& record, const char* field, const std::string& what, const std::string& file) {
  const auto name = record.at(field).get<std::string>();
  if (const std::optional<Value> value = findNamed<Value>(name)) return *value;
  throw InputError(
      {file, std::string("method.") + field, what + " of this facezip", name, "compress the capture again"});
}

std::string lengthText(const geometry::Length& length) {
  return fmt::format("{}{}", length.value, length.unit ? geometry::unitSymbol(*length.unit) : "");
}

}  // namespace

std::string methodJson(const CompressOptions& options, const PackageForm& form, const MethodResult& result) {
  json record = {{"name", nameOf(options.method)},
                 {"differences", form.differences},
                 {"weight_scale", form.weight_scale},
                 {"mask_radius", lengthText(options.mask_radius)},
                 {"mask_cutoff", options.mask_cutoff},
                 {"permutation_solver", nameOf(options.permutation_solver)},
                 {"restarts", options.restarts},
                 {"cluster_restarts", options.cluster_restarts},
                 {"seed", options.seed},
                 {"region", options.region},
                 {"importance", options.importance},
                 {"weights_per_map", form.weights_per_map},
                 {"unit", options.unit.value_or("")}};
  if (options.masks) record["masks"] = *options.masks;
  if (options.gutter) record["gutter"] = *options.gutter;
  if (options.feather) record["feather"] = *options.feather;
  if (form.blocks) {
    record["texture_format"] = blockFormatName(form.blocks->neutral);
    record["difference_format"] = blockFormatName(form.blocks->differences);
  }
  record["result"] = {{"masks", result.masks},
                      {"mask_radius", result.mask_radius},
                      {"unit", result.unit},
                      {"region", result.region},
                      {"covered_texels", result.covered_texels},
                      {"permutation_cost", result.permutation_cost}};
  return record.dump();
}

CompressOptions optionsFromMethodJson(const std::string& json_text, const std::string& file) {
  try {
    const json record = json::parse(json_text);
    CompressOptions options;
    options.method = named<Method>(record, "name", "a method", file);
    options.differences = record.at("differences").get<int>();
    options.weight_scale = record.at("weight_scale").get<int>();
    options.mask_radius = geometry::parseLength(record.at("mask_radius").get<std::string>());
    options.mask_cutoff = record.at("mask_cutoff").get<double>();
    options.permutation_solver = named<PermutationSolver>(record, "permutation_solver", "a solver", file);
    options.restarts = record.at("restarts").get<int>();
    options.cluster_restarts = record.at("cluster_restarts").get<int>();
    options.seed = record.at("seed").get<std::uint64_t>();
    options.region = record.at("region").get<std::string>();
    options.importance = record.at("importance").get<std::string>();
    options.weight_sets = record.at("weights_per_map").get<bool>() ? WeightSets::kPerMap : WeightSets::kShared;
    if (const std::string unit = record.at("unit").get<std::string>(); !unit.empty()) options.unit = unit;
    if (record.contains("masks")) options.masks = record["masks"].get<int>();
    if (record.contains("gutter")) options.gutter = record["gutter"].get<int>();
    if (record.contains("feather")) options.feather = record["feather"].get<int>();
    if (record.contains("texture_format")) {
      options.texture_format = blockFormatOf(record["texture_format"].get<std::string>(), file);
      options.difference_format = blockFormatOf(record.at("difference_format").get<std::string>(), file);
    }
    return options;
  } catch (const json::exception& error) {
    throw InputError(
        {file, "method", "the options that `facezip compress` recorded", error.what(), "compress the capture again"});
  }
}

}  // namespace facezip::compress
