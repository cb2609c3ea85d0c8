#include "method_titles.hpp"

namespace facezip::cli {

const std::vector<std::pair<std::string, std::string>>& methodTitles() {
  static const std::vector<std::pair<std::string, std::string>> titles = {{"package", "package"},
                                                                          {"rig", "rig's shapes"},
                                                                          {"compress_stretch", "compress/stretch"},
                                                                          {"weights_per_map", "own weights"},
                                                                          {"refined", "refined"},
                                                                          {"closed_loop", "closed loop"},
                                                                          {"paper", "paper"},
                                                                          {"no_permutation", "not permuted"},
                                                                          {"pca4", "PCA(4)"},
                                                                          {"pca8", "PCA(8)"},
                                                                          {"pca", "PCA(C)"},
                                                                          {"limit", "block limit"}};
  return titles;
}

std::string methodTitle(const std::string& key) {
  for (const auto& [known, title] : methodTitles()) {
    if (known == key) return title;
  }
  return key;
}

}  // namespace facezip::cli
