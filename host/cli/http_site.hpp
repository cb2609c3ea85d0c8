// http_site.hpp - what a web server for this machine alone answers: which files it has, and who may have them.
#pragma once

#include <map>
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
};

struct HttpAnswer {
  int status = 200;
  HttpFile body;  ///< of status 200 alone
};

/// Some files, for pages of this server alone. Every web page that a browser has open can send requests to this
/// machine, and by a name of its own that leads here (DNS rebinding) it could read the answers: so requests must name
/// this server as their host, and where the browser says who asks, that must be this server, too.
class HttpSite {
 public:
  /// files  by path, "/" the page itself; what they refer to must outlive the site
  /// port   that the server is asked at
  HttpSite(std::map<std::string, HttpFile> files, int port);

  HttpAnswer answer(const HttpRequest& request) const;

 private:
  bool isOurs(const HttpRequest& request, const std::string& path) const;

  std::map<std::string, HttpFile> files_;
  std::vector<std::string> hosts_;
};

/// The path of a target "/a%20b?c": "/a b". None where the target is no path, or its percents say nothing.
std::optional<std::string> pathOf(std::string_view target);

}  // namespace facezip::cli
