#include "http_site.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace facezip::cli {
namespace {

bool sameName(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::vector<std::string_view> valuesOf(const HttpRequest& request, std::string_view name) {
  std::vector<std::string_view> values;
  for (const auto& [field, value] : request.fields) {
    if (sameName(field, name)) values.push_back(value);
  }
  return values;
}

}  // namespace

std::optional<std::string> pathOf(std::string_view target) {
  if (!target.starts_with('/')) return std::nullopt;
  target = target.substr(0, target.find_first_of("?#"));
  std::string path;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] != '%') {
      path += target[i];
      continue;
    }
    const std::string_view digits = target.substr(i + 1, 2);
    unsigned code = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (digits.size() < 2 || error != std::errc() || end != digits.data() + 2) return std::nullopt;
    path += static_cast<char>(code);
    i += 2;
  }
  return path;
}

HttpSite::HttpSite(std::map<std::string, HttpFile> files, int port, std::optional<HttpTaker> taker)
    : files_(std::move(files)), taker_(std::move(taker)) {
  for (const std::string host : {"127.0.0.1", "localhost"}) {
    hosts_.push_back(host + ":" + std::to_string(port));
    if (port == 80) hosts_.push_back(host);  // browsers leave that out
  }
}

bool HttpSite::isOurs(const HttpRequest& request, const std::string& path) const {
  const auto isHost = [&](std::string_view name) {
    return std::ranges::any_of(hosts_, [name](const std::string& host) { return sameName(host, name); });
  };
  const std::vector<std::string_view> hosts = valuesOf(request, "Host");
  if (hosts.size() != 1 || !isHost(hosts[0])) return false;
  for (const std::string_view origin : valuesOf(request, "Origin")) {
    constexpr std::string_view kScheme = "http://";
    if (!origin.starts_with(kScheme) || !isHost(origin.substr(kScheme.size()))) return false;
  }
  // Anyone may link to the page: it is all that they see of it.
  if (path == "/") return true;
  const auto isOwn = [](std::string_view site) { return site == "same-origin" || site == "none"; };
  return std::ranges::all_of(valuesOf(request, "Sec-Fetch-Site"), isOwn);
}

HttpAnswer HttpSite::answer(const HttpRequest& request) const {
  const std::optional<std::string> path = pathOf(request.target);
  if (!path) return {400, {}};
  if (!isOurs(request, *path)) return {403, {}};
  if (request.method != "GET" && request.method != "HEAD") return {405, {}};
  const auto file = files_.find(*path);
  if (file == files_.end()) return {404, {}};
  return {200, file->second};
}

std::size_t HttpSite::bodyLimit(const HttpRequest& request) const {
  const std::optional<std::string> path = pathOf(request.target);
  const bool taken = taker_ && path == taker_->path && request.method == "PUT" && isOurs(request, *path) &&
                     !valuesOf(request, "Origin").empty();
  return taken ? taker_->most_bytes : 0;
}

HttpAnswer HttpSite::take(const std::string& body) const {
  const auto said = std::make_shared<const std::string>(taker_->take(body));
  return {200, {"application/json", *said, nullptr, said}};
}

}  // namespace facezip::cli
