// http_server.hpp - a small web server for this machine alone, by Boost.Beast. Nobody can make it wait, or fill its
// memory: one thread serves every connection, requests have short headers and no bodies but the one that the site
// takes, and all takes its time at most.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>

#include "facezip/progress.hpp"
#include "http_site.hpp"

namespace facezip::cli {

/// What a client may ask of the server.
struct HttpLimits {
  std::size_t header_bytes = 16 << 10;
  std::size_t connections = 64;  ///< open at once; one more, and the one that has asked for nothing longest goes
  std::chrono::milliseconds request{10000};  ///< from its first byte to its last, and between requests
  std::chrono::milliseconds answer{60000};   ///< and a second for each MiB
};

class HttpServer {
 public:
  /// Listens on 127.0.0.1. port  0: any that is free. Throws InputError when it cannot be had.
  explicit HttpServer(int port, const HttpLimits& limits = {});
  ~HttpServer();

  int port() const;

  /// Serves `site` until `progress` is cancelled; then it returns.
  void run(const HttpSite& site, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace facezip::cli
