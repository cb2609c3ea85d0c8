#include "compress/method_record.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace facezip::compress {
namespace {
using nlohmann::json;

using Method = CompressOptions::Method;
constexpr std::pair<Method, const char*> kMethods[] = {{Method::kRefined, "refined"},
                                                       {Method::kClosedLoop, "closed-loop"},
                                                       {Method::kPaper, "paper"},
                                                       {Method::kNoPermutation, "no-permutation"},
                                                       {Method::kCompressStretch, "compress-stretch"}};

constexpr std::pair<PermutationSolver, const char*> kSolvers[] = {
    {PermutationSolver::kBest, "best"},
    {PermutationSolver::kDescent, "descent"},
    {PermutationSolver::kMessagePassing, "message-passing"}};

const char* solverName(PermutationSolver solver) {
  for (const auto& [value, name] : kSolvers) {
    if (value == solver) return name;
  }
  return "";
}

PermutationSolver solverOf(const std::string& name, const std::string& file) {
  for (const auto& [value, known] : kSolvers) {
    if (name == known) return value;
  }
  throw InputError({file, "method.permutation_solver", "a solver of this facezip", name, "compress the capture again"});
}

Method methodOf(const std::string& name, const std::string& file) {
  for (const auto& [value, known] : kMethods) {
    if (name == known) return value;
  }
  throw InputError({file, "method.name", "a method of this facezip", name, "compress the capture again"});
}

std::string lengthText(const geometry::Length& length) {
  return fmt::format("{}{}", length.value, length.unit ? geometry::unitSymbol(*length.unit) : "");
}

}  // namespace

const char* methodName(Method method) {
  for (const auto& [value, name] : kMethods) {
    if (value == method) return name;
  }
  return "";
}

std::string methodJson(const CompressOptions& options, const PackageForm& form, const MethodResult& result) {
  json record = {{"name", methodName(options.method)},
                 {"differences", form.differences},
                 {"weight_scale", form.weight_scale},
                 {"mask_radius", lengthText(options.mask_radius)},
                 {"mask_cutoff", options.mask_cutoff},
                 {"permutation_solver", solverName(options.permutation_solver)},
                 {"restarts", options.restarts},
                 {"cluster_restarts", options.cluster_restarts},
                 {"seed", options.seed},
                 {"region", options.region},
                 {"importance", options.importance},
                 {"weights_per_map", options.weights_per_map},
                 {"unit", options.unit.value_or("")}};
  if (options.masks) record["masks"] = *options.masks;
  if (options.gutter) record["gutter"] = *options.gutter;
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
    options.method = methodOf(record.at("name").get<std::string>(), file);
    options.differences = record.at("differences").get<int>();
    options.weight_scale = record.at("weight_scale").get<int>();
    options.mask_radius = geometry::parseLength(record.at("mask_radius").get<std::string>());
    options.mask_cutoff = record.at("mask_cutoff").get<double>();
    options.permutation_solver = solverOf(record.at("permutation_solver").get<std::string>(), file);
    options.restarts = record.at("restarts").get<int>();
    options.cluster_restarts = record.at("cluster_restarts").get<int>();
    options.seed = record.at("seed").get<std::uint64_t>();
    options.region = record.at("region").get<std::string>();
    options.importance = record.at("importance").get<std::string>();
    options.weights_per_map = record.at("weights_per_map").get<bool>();
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
