// The server of `facezip view`, as clients of all kinds meet it.
#include "http_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "io/staged_directory.hpp"
#include "temporary_directory.hpp"

namespace facezip {
namespace {
using cli::HttpFile;
using cli::HttpLimits;
using cli::HttpRequest;
using cli::HttpSite;
using std::chrono::steady_clock;
using testing::HasSubstr;
using testing::StartsWith;

double secondsSince(steady_clock::time_point start) {
  return std::chrono::duration<double>(steady_clock::now() - start).count();
}

/// A connection to the server.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Client() { ::close(socket_); }
  Client(Client&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Client& operator=(Client&&) = delete;

  /// Bytes that the server took.
  std::size_t send(std::string_view bytes) const {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t got = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (got <= 0) break;
      sent += static_cast<std::size_t>(got);
    }
    return sent;
  }

  /// All that comes until the server closes.
  std::string receive() const {
    std::string all;
    char piece[4096];
    for (ssize_t got; (got = ::recv(socket_, piece, sizeof(piece), 0)) > 0;)
      all.append(piece, static_cast<std::size_t>(got));
    return all;
  }

 private:
  int socket_;
};

class HttpServer : public testing::Test {
 protected:
  /// Serves "/" and a large file on a free port while `use` runs.
  void serve(const HttpLimits& limits, const std::function<void(int port)>& use) {
    io::writeTextFile(folder_ / "large", large_);
    const InputFile file(folder_ / "large", "a file");
    cli::HttpServer server(0, limits);
    const HttpSite site({{"/", {"text/plain", "the page", nullptr}}, {"/large", {"image/png", "", &file}}},
                        server.port());
    Progress progress;
    std::thread thread([&] { server.run(site, progress); });
    use(server.port());
    progress.cancel();
    thread.join();
  }

  static std::string request(const std::string& line, int port, const std::string& fields = "") {
    return fmt::format("{} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n{}\r\n", line, port, fields);
  }

  static std::string ask(int port, const std::string& bytes) {
    const Client client(port);
    client.send(bytes);
    return client.receive();
  }

  /// The page comes, and soon: a server that waited for each of the forty half requests would take twenty seconds.
  static void expectPage(int port) {
    const auto start = steady_clock::now();
    EXPECT_THAT(ask(port, request("GET /", port)), testing::AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("the page")));
    EXPECT_LT(secondsSince(start), 12.0);
  }

  const test::TemporaryDirectory folder_;
  const std::string large_ = std::string(300000, 'x') + "end";
};

TEST_F(HttpServer, SendsFilesWhole) {
  serve({}, [&](int port) {
    expectPage(port);
    EXPECT_THAT(ask(port, request("GET /large", port)),
                testing::AllOf(HasSubstr("Content-Length: 300003\r\n"), testing::EndsWith("\r\n\r\n" + large_)));
    EXPECT_THAT(ask(port, request("HEAD /large", port)),
                testing::AllOf(HasSubstr("Content-Length: 300003\r\n"), testing::EndsWith("\r\n\r\n")));
    // What takes its place later is not followed; what is cut ends the connection.
    std::filesystem::remove(folder_ / "large");
    io::writeTextFile(folder_ / "secret", "secret");
    std::filesystem::create_symlink(folder_ / "secret", folder_ / "large");
    EXPECT_THAT(ask(port, request("GET /large", port)), testing::EndsWith(large_));
  });
}

TEST_F(HttpServer, KeepsAConnectionForAsManyRequestsAsItGets) {
  serve({}, [](int port) {
    const std::string kept = fmt::format("GET / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", port);
    const std::string answers = ask(port, kept + kept + request("GET /", port));
    std::size_t count = 0;
    for (std::size_t at = 0; (at = answers.find("the page", at)) != std::string::npos; ++at) ++count;
    EXPECT_EQ(count, 3u) << answers;
  });
}

TEST_F(HttpServer, IsForPagesOfItsOwnAlone) {
  serve({}, [](int port) {
    const auto status = [&](const std::string& path, const std::string& fields) {
      return ask(port, "GET " + path + " HTTP/1.1\r\nConnection: close\r\n" + fields + "\r\n").substr(9, 3);
    };
    const std::string host = fmt::format("Host: 127.0.0.1:{}\r\n", port);
    EXPECT_EQ(status("/large", host), "200");
    EXPECT_EQ(status("/large", fmt::format("Host: LocalHost:{}\r\n", port)), "200");
    for (const std::string& wrong :
         {std::string(), std::string("Host: attacker.example\r\n"), std::string("Host: 127.0.0.1\r\n"),
          fmt::format("Host: attacker.example:{}\r\n", port), host + "Host: attacker.example\r\n", host + host,
          fmt::format("Host: 127.0.0.1:{}.attacker.example\r\n", port)}) {
      EXPECT_EQ(status("/large", wrong), "403") << wrong;
      EXPECT_EQ(status("/", wrong), "403") << wrong;
    }
    EXPECT_EQ(status("/large", host + fmt::format("Origin: http://127.0.0.1:{}\r\n", port)), "200");
    for (const char* origin : {"null", "http://attacker.example", "https://127.0.0.1", "http://127.0.0.1:1"}) {
      EXPECT_EQ(status("/large", host + "Origin: " + origin + "\r\n"), "403") << origin;
    }
    EXPECT_EQ(status("/large", host + "Sec-Fetch-Site: same-origin\r\n"), "200");
    EXPECT_EQ(status("/large", host + "Sec-Fetch-Site: cross-site\r\n"), "403");
    EXPECT_EQ(status("/large", host + "sec-fetch-site: same-site\r\n"), "403");
    EXPECT_EQ(status("/", host + "Sec-Fetch-Site: cross-site\r\n"), "200") << "a link to the page";
    const std::string answer = ask(port, request("GET /", port));
    EXPECT_THAT(answer, HasSubstr("Cross-Origin-Resource-Policy: same-origin"));
    EXPECT_THAT(answer, HasSubstr("frame-ancestors 'none'"));
  });
}

TEST_F(HttpServer, TakesNoBodiesAndNoLongHeaders) {
  serve({}, [](int port) {
    EXPECT_THAT(ask(port, request("POST /", port, "Content-Length: 600000000\r\n")), StartsWith("HTTP/1.1 405"));
    EXPECT_THAT(ask(port, request("GET /", port, "Content-Length: 5\r\n") + "hello"), StartsWith("HTTP/1.1 413"));
    EXPECT_THAT(ask(port, request("GET /", port, "Transfer-Encoding: chunked\r\n") + "5\r\nhello\r\n"),
                StartsWith("HTTP/1.1 413"));
    EXPECT_THAT(ask(port, request("GET /", port, "Content-Length: 18446744073709551616\r\n")),
                StartsWith("HTTP/1.1 400"));
    // As much as fits into the buffers of the system, no more, of what never ends.
    const std::string much(std::size_t{64} << 20, 'a');
    for (const std::string& start : {request("POST /", port, "Content-Length: 600000000\r\n"), std::string("GET /"),
                                     std::string("GET / HTTP/1.1\r\nX: ")}) {
      const Client client(port);
      EXPECT_LT(client.send(start + much), much.size()) << start;
    }
    EXPECT_THAT(ask(port, "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 431"));
    std::string many = "GET / HTTP/1.1\r\n";
    for (int i = 0; i < 5000; ++i) many += "A: b\r\n";
    EXPECT_THAT(ask(port, many), StartsWith("HTTP/1.1 431"));
    expectPage(port);
  });
}

TEST_F(HttpServer, RefusesWhatIsNoRequestForAFileOfIts) {
  serve({}, [](int port) {
    const auto status = [&](const std::string& line) { return ask(port, request(line, port)).substr(9, 3); };
    EXPECT_EQ(status("GET /?query=1"), "200");
    EXPECT_EQ(status("GET /l%61rge"), "200");
    for (const char* path :
         {"/none", "/../etc/passwd", "/..%2f..%2fetc/passwd", "//large", "/large/", "/%00", "/large%00"}) {
      EXPECT_EQ(status(std::string("GET ") + path), "404") << path;
    }
    for (const char* target : {"/%", "/%4", "/%zz", "/%-1", "*", "http://127.0.0.1/", "large"}) {
      EXPECT_EQ(status(std::string("GET ") + target), "400") << target;
    }
    for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "ODD"}) {
      EXPECT_EQ(status(std::string(method) + " /"), "405") << method;
    }
    for (const char* bytes :
         {"\r\n\r\n", "GET\r\n\r\n", "\x16\x03\x01\x02", "GET / HTTP/9.9\r\n\r\n", "\xff\xfe\xfd"}) {
      EXPECT_THAT(ask(port, bytes), testing::AnyOf(StartsWith("HTTP/1.1 4"), testing::IsEmpty()));
    }
  });
}

TEST_F(HttpServer, WaitsForNobody) {
  serve({.request = std::chrono::milliseconds(500)}, [](int port) {
    std::vector<Client> half;
    for (int i = 0; i < 40; ++i) {
      half.emplace_back(port);
      half.back().send("GET / HTTP/1.1\r\n");
    }
    expectPage(port);
    // A byte now and then gains nothing: the time is that of the whole request.
    const Client slow(port);
    int sent = 0;
    for (; sent < 100 && slow.send("a") == 1; ++sent) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_LT(sent, 30);
    for (const Client& client : half) EXPECT_EQ(client.receive(), "");
    expectPage(port);
  });
}

TEST_F(HttpServer, GivesUpOnClientsThatDoNotRead) {
  io::writeTextFile(folder_ / "huge", std::string(std::size_t{32} << 20, 'x'));
  const InputFile file(folder_ / "huge", "a file");
  cli::HttpServer server(0, {.connections = 4, .answer = std::chrono::milliseconds(100)});
  const int port = server.port();
  const HttpSite site({{"/", {"text/plain", "the page", nullptr}}, {"/huge", {"image/png", "", &file}}}, port);
  Progress progress;
  std::thread thread([&] { server.run(site, progress); });
  std::vector<Client> deaf;
  for (int i = 0; i < 20; ++i) {
    deaf.emplace_back(port);
    deaf.back().send(request("GET /huge", port));
    expectPage(port);
  }
  progress.cancel();
  thread.join();
}

TEST_F(HttpServer, ManyConnectionsLeaveRoomForTheNext) {
  serve({}, [](int port) {
    std::vector<Client> idle;
    for (int i = 0; i < 300; ++i) idle.emplace_back(port);
    expectPage(port);
    for (int i = 0; i < 2000; ++i) Client(port).send("GET");
    expectPage(port);
  });
}

TEST_F(HttpServer, TwoDoNotShareAPort) {
  const cli::HttpServer first(0);
  EXPECT_THROW(cli::HttpServer(first.port()), InputError);
}

}  // namespace
}  // namespace facezip
