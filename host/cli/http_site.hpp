// http_site.hpp - what a web server for this machine alone answers: which files it has, and who may have them.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "facezip/input_file.hpp"

namespace facezip::cli {

/// A request as it was parsed; nothing of it is trusted.
struct HttpRequest {
  std::string method;
  std::string target;
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in any case
};

/// A file: text that is in memory, or one that is open.
struct HttpFile {
  std::string_view type;
  std::string_view text;
  const InputFile* file = nullptr;
  std::shared_ptr<const std::string> held = {};  ///< that `text` is in, where nobody else keeps it
};

struct HttpAnswer {
  int status = 200;
  HttpFile body;  ///< of status 200 alone
};

/// The one thing that the pages may send: a PUT with a body to `path`.
struct HttpTaker {
  std::string path;
  std::size_t most_bytes = 0;
  std::function<std::string(const std::string& body)> take;  ///< answers with JSON; throws nothing
};

/// Some files, for pages of this server alone. Every web page that a browser has open can send requests to this
/// machine, and by a name of its own that leads here (DNS rebinding) it could read the answers: so requests must name
/// this server as their host, and where the browser says who asks, that must be this server, too.
class HttpSite {
 public:
  /// files  by path, "/" the page itself; what they refer to must outlive the site
  /// port   that the server is asked at
  /// taker  none: nothing is taken
  HttpSite(std::map<std::string, HttpFile> files, int port, std::optional<HttpTaker> taker = std::nullopt);

  HttpAnswer answer(const HttpRequest& request) const;

  /// Most bytes of a body that this request may have; 0 for any but the taker's. Browsers say who sends one (Origin).
  std::size_t bodyLimit(const HttpRequest& request) const;
  /// To a request with a body within that limit.
  HttpAnswer take(const std::string& body) const;

 private:
  bool isOurs(const HttpRequest& request, const std::string& path) const;

  std::map<std::string, HttpFile> files_;
  std::vector<std::string> hosts_;
  std::optional<HttpTaker> taker_;
};

/// The path of a target "/a%20b?c": "/a b". None where the target is no path, or its percents say nothing.
std::optional<std::string> pathOf(std::string_view target);

}  // namespace facezip::cli
