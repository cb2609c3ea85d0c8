#include "serve.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "facezip/check.hpp"
#include "facezip/error.hpp"
#include "facezip/view.hpp"
#include "http_server.hpp"

namespace facezip::cli {
namespace {

std::string_view typeOf(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css";
  if (name.ends_with(".js")) return "text/javascript";
  if (name.ends_with(".json")) return "application/json";
  if (name.ends_with(".png")) return "image/png";
  return "application/octet-stream";
}

}  // namespace

void serveViewer(const Package& package, int port, const std::function<void(int port)>& started, Progress& progress) {
  checkMesh(package);
  // Open for as long as they are served: what takes their place in the folder is another package, or a stranger's file.
  const std::vector<OpenPackageFile> opened = openPackageFiles(package);
  std::map<std::string, HttpFile> files;
  for (const auto& [name, text] : viewerPage()) files["/" + std::string(name)] = {typeOf(name), text, nullptr};
  files["/"] = files.at("/index.html");
  for (const OpenPackageFile& file : opened) files["/package/" + file.name] = {typeOf(file.name), "", &file.file};
  HttpServer server(port);
  const HttpSite site(std::move(files), server.port());
  started(server.port());
  server.run(site, progress);
}

void serveLandmarks(const LandmarkSession& session, int port, const std::function<void(int port)>& started,
                    Progress& progress) {
  std::map<std::string, HttpFile> files;
  for (const auto& [name, text] : landmarksPage()) files["/" + std::string(name)] = {typeOf(name), text, nullptr};
  files["/"] = files.at("/landmarks.html");
  for (const LandmarkSession::File& file : session.files()) {
    files["/scene/" + file.name] = {typeOf(file.name), "", &file.file};
  }
  const auto take = [&session](const std::string& body) -> std::string {
    try {
      session.save(body);
      return R"({"saved": true})";
    } catch (const Error& error) {
      return nlohmann::json{{"error", error.what()}}.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    }
  };
  HttpServer server(port);
  const HttpSite site(std::move(files), server.port(), HttpTaker{"/landmarks", LandmarkSession::kMostBytes, take});
  started(server.port());
  server.run(site, progress);
}

}  // namespace facezip::cli
