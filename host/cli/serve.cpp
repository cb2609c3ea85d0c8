#include "serve.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <thread>

#include "facezip/view.hpp"

namespace facezip::cli {
namespace {

const char* contentType(const std::string& name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css";
  if (name.ends_with(".js")) return "text/javascript";
  if (name.ends_with(".json")) return "application/json";
  if (name.ends_with(".png")) return "image/png";
  return "application/octet-stream";
}

void sendPage(const std::string& name, httplib::Response& response) {
  const auto page = viewerPage().find(name);
  if (page == viewerPage().end()) {
    response.status = 404;
    return;
  }
  response.set_content(std::string(page->second), contentType(name));
}

void sendFile(const std::filesystem::path& file, httplib::Response& response) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) {
    response.status = 404;
    return;
  }
  response.set_content(std::move(bytes), contentType(file.string()));
}

int bindLoopback(httplib::Server& server, int port) {
  constexpr const char* kLoopback = "127.0.0.1";
  // Not httplib's own options: with SO_REUSEPORT two servers would share a port, and a page show either package.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  const bool any = port == 0;
  const int bound = any ? server.bind_to_any_port(kLoopback) : server.bind_to_port(kLoopback, port) ? port : -1;
  if (bound > 0) return bound;
  throw InputError({"--port", "", "a port that is free on 127.0.0.1, and for this user", fmt::format("{}", port),
                    "choose another, or 0 for any"});
}

/// A server at work on a thread of its own, from its start to this object's end.
class Listening {
 public:
  explicit Listening(httplib::Server& server) : server_(server), thread_([this] { run(); }) {
    // A server that is not running yet would not hear stop().
    while (!server_.is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ~Listening() {
    server_.stop();
    thread_.join();
  }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;

 private:
  void run() {
    server_.listen_after_bind();
    ended_ = true;
  }

  httplib::Server& server_;
  std::atomic<bool> ended_ = false;
  std::thread thread_;  // starts when all else is there
};

}  // namespace

void serveViewer(const Package& package, int port, const std::function<void(int port)>& started, Progress& progress) {
  httplib::Server server;
  const std::vector<std::string> names = packageFiles(package);
  const std::set<std::string> known(names.begin(), names.end());
  server.Get("/", [](const httplib::Request&, httplib::Response& response) { sendPage("index.html", response); });
  server.Get("/package/(.+)", [&](const httplib::Request& request, httplib::Response& response) {
    const std::string name = request.matches[1];
    if (known.contains(name)) {
      sendFile(package.directory() / name, response);
    } else {
      response.status = 404;
    }
  });
  server.Get("/([a-z.]+)", [](const httplib::Request& request, httplib::Response& response) {
    sendPage(request.matches[1], response);
  });
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Content-Security-Policy",
                               "default-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; base-uri 'none'"}});
  const int bound = bindLoopback(server, port);
  const Listening listening(server);
  started(bound);
  try {
    while (true) {
      progress.checkCancelled();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  } catch (const Cancelled&) {  // how a server ends
  }
}

}  // namespace facezip::cli
