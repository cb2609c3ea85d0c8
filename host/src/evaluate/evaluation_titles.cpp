#include "blocks/block_format.hpp"
#include "evaluate/every_texture.hpp"
#include "facezip/evaluate.hpp"

namespace facezip {

template <>
const std::vector<NamedValue<Baseline>>& namesOf() {
  static const std::vector<NamedValue<Baseline>> names = {
      {Baseline::kWeightsPerMap, "weights-per-map", "own weights"},
      {Baseline::kPca4, "pca4", "PCA(4)"},
      {Baseline::kPca8, "pca8", "PCA(8)"},
      {Baseline::kLimit, "limit", "block limit"},
  };
  return names;
}

const std::vector<std::pair<std::string, std::string>>& evaluationTitles() {
  static const auto titles = [] {
    std::vector<std::pair<std::string, std::string>> all = {{"package", "package"}, {"rig", "rig's shapes"}};
    for (const auto& method : namesOf<Method>()) all.emplace_back(method.name, method.title);
    for (const auto& baseline : namesOf<Baseline>()) all.emplace_back(baseline.name, baseline.title);
    for (const blocks::BlockFormatInfo& format : blocks::blockFormats()) {
      all.emplace_back(evaluate::everyTextureKey(format.format), "all in " + std::string(format.name));
    }
    all.emplace_back("pca", "PCA(C)");  // of an ablation
    return all;
  }();
  return titles;
}

std::string evaluationTitle(const std::string& key) {
  for (const auto& [known, title] : evaluationTitles()) {
    if (known == key) return title;
  }
  return key;
}

}  // namespace facezip
