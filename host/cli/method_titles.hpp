// method_titles.hpp - what tables and pictures call the methods of an evaluation.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace facezip::cli {

/// Keys of Evaluation and their titles, in the order that tables show them.
const std::vector<std::pair<std::string, std::string>>& methodTitles();

/// The title of one; the key itself where there is none.
std::string methodTitle(const std::string& key);

}  // namespace facezip::cli
