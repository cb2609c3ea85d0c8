#include "serve.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "facezip/check.hpp"
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

}  // namespace facezip::cli
