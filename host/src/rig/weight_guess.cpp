#include "rig/weight_guess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "blend/names.hpp"
#include "blend/number.hpp"
#include "blend/shape_names.hpp"
#include "facezip/error.hpp"
#include "facezip/nearest_names.hpp"
#include "io/json_field.hpp"
#include "io/quoted.hpp"
#include "io/read_file.hpp"

namespace facezip::rig {
namespace {

/// The guess while it is read.
class Guess {
 public:
  Guess(const std::filesystem::path& file, const std::vector<std::string>& expressions,
        const std::vector<std::string>& shapes)
      : file_(file.string()),
        expressions_(expressions),
        shapes_(shapes),
        weights_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(expressions.size()),
                                       static_cast<Eigen::Index>(shapes.size()))),
        seen_(expressions.size(), false) {}

  Eigen::Index shape(const std::string& name, const std::string& item) const {
    return indexIn(shapes_, name, item, "a shape of the template");
  }

  /// Row of an expression; each may be asked for once.
  Eigen::Index expression(const std::string& name, const std::string& item) {
    const Eigen::Index row = indexIn(expressions_, name, item, "an expression of the capture");
    if (seen_[static_cast<std::size_t>(row)]) {
      throw InputError({file_, item, "each expression once", io::quoted(name) + " twice", ""});
    }
    seen_[static_cast<std::size_t>(row)] = true;
    return row;
  }

  void set(Eigen::Index row, Eigen::Index shape, double weight, const std::string& item, const std::string& got) {
    // Rigs drive some shapes a little beyond 1; percents are a mistake.
    if (!(weight >= 0.0 && weight <= 2.0)) throw InputError({file_, item, "a weight from 0 to 1", got, ""});
    weights_(row, shape) = std::min(weight, 1.0);
  }

  Eigen::MatrixXd finish() const {
    for (std::size_t n = 0; n < seen_.size(); ++n) {
      if (seen_[n]) continue;
      throw InputError({file_, fmt::format("expression \"{}\"", expressions_[n]), "its weights", "none",
                        "add it, or give no guess at all"});
    }
    return weights_;
  }

  [[noreturn]] void fail(const std::string& item, const std::string& expected, const std::string& got) const {
    throw InputError({file_, item, expected, got, ""});
  }

 private:
  Eigen::Index indexIn(const std::vector<std::string>& names, const std::string& name, const std::string& item,
                       const std::string& expected) const {
    if (const auto found = blend::findName(name, names)) return static_cast<Eigen::Index>(*found);
    throw InputError({file_, item, expected, io::quoted(name),
                      fmt::format("the nearest is {}", nearestNames(name, names, 1).front())});
  }

  std::string file_;
  const std::vector<std::string>& expressions_;
  const std::vector<std::string>& shapes_;
  Eigen::MatrixXd weights_;
  std::vector<bool> seen_;
};

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.emplace_back(blend::trimmed(std::string_view(line).substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

void readCsv(const std::string& text, Guess& guess) {
  std::istringstream stream(text);
  std::vector<Eigen::Index> columns;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    if (blend::trimmed(line).empty()) continue;
    const std::vector<std::string> fields = fieldsOf(line);
    const std::string where = fmt::format("line {}", number);
    if (columns.empty()) {
      for (std::size_t i = 1; i < fields.size(); ++i) {
        const Eigen::Index shape = guess.shape(fields[i], where);
        if (std::find(columns.begin(), columns.end(), shape) != columns.end()) {
          guess.fail(where, "each shape once", io::quoted(fields[i]) + " twice");
        }
        columns.push_back(shape);
      }
      if (columns.empty()) guess.fail(where, "a header: expression, then names of shapes", io::quoted(line));
      continue;
    }
    if (fields.size() != columns.size() + 1) {
      guess.fail(where, fmt::format("{} columns", columns.size() + 1), fmt::format("{}", fields.size()));
    }
    const Eigen::Index row = guess.expression(fields[0], where);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string item = fmt::format("{}, column {}", where, i + 2);
      const std::optional<float> weight = blend::parseNumber(fields[i + 1]);
      if (!weight) guess.fail(item, "a weight from 0 to 1", io::quoted(fields[i + 1]));
      guess.set(row, columns[i], *weight, item, fields[i + 1]);
    }
  }
}

void readJson(const nlohmann::json& document, Guess& guess) {
  if (!document.is_object()) guess.fail("", "an object of expressions", document.dump().substr(0, 60));
  for (const auto& [expression, weights] : document.items()) {
    const Eigen::Index row = guess.expression(expression, expression);
    if (!weights.is_object()) guess.fail(expression, "an object of shapes and weights", weights.dump().substr(0, 60));
    std::set<Eigen::Index> seen;
    for (const auto& [shape, weight] : weights.items()) {
      const std::string item = expression + "." + shape;
      if (!seen.insert(guess.shape(shape, item)).second)
        guess.fail(item, "each shape once", "another name of one before");
      if (!weight.is_number()) guess.fail(item, "a weight from 0 to 1", weight.dump().substr(0, 60));
      guess.set(row, guess.shape(shape, item), weight.get<double>(), item, weight.dump());
    }
  }
}

}  // namespace

Eigen::MatrixXd readGuess(const std::filesystem::path& file, const std::vector<std::string>& expressions,
                          const std::vector<std::string>& shapes) {
  const std::string text = io::readFile(file, "weights of the expressions (.csv or .json)");
  Guess guess(file, expressions, shapes);
  if (file.extension() == ".json") {
    readJson(io::parseJson(text, file.string()), guess);
  } else if (file.extension() == ".csv") {
    readCsv(text, guess);
  } else {
    throw InputError({file.string(), "", "a name that ends in .csv or .json", file.extension().string(), ""});
  }
  return guess.finish();
}

}  // namespace facezip::rig
