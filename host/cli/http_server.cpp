#include "http_server.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <list>
#include <optional>

#include "facezip/error.hpp"

namespace facezip::cli {
namespace {
namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

/// The body of an answer: text, or an open file from its first byte to its last, a piece at a time. Reads by position:
/// several answers may be on their way from one file.
struct FileBody {
  using value_type = HttpFile;

  static std::uint64_t size(const HttpFile& file) {
    return file.file == nullptr ? file.text.size() : file.file->size();
  }

  class writer {
   public:
    using const_buffers_type = asio::const_buffer;

    template <bool isRequest, class Fields>
    writer(http::header<isRequest, Fields>&, HttpFile& file) : file_(file), left_(size(file)) {}

    void init(error_code& error) { error = {}; }

    boost::optional<std::pair<const_buffers_type, bool>> get(error_code& error) {
      error = {};
      if (left_ == 0) return boost::none;
      if (file_.file == nullptr) {
        left_ = 0;
        return {{asio::const_buffer(file_.text.data(), file_.text.size()), false}};
      }
      const ssize_t got =
          ::pread(file_.file->descriptor(), piece_.data(), std::min<std::uint64_t>(piece_.size(), left_),
                  static_cast<off_t>(size(file_) - left_));
      if (got <= 0) {  // the file was cut since
        error =
            got < 0 ? error_code(errno, boost::system::system_category()) : error_code(http::error::partial_message);
        return boost::none;
      }
      left_ -= static_cast<std::uint64_t>(got);
      return {{asio::const_buffer(piece_.data(), static_cast<std::size_t>(got)), left_ > 0}};
    }

   private:
    HttpFile& file_;
    std::uint64_t left_;
    std::array<char, 1 << 16> piece_;
  };
};

/// True for a fault of what was asked; else the client is gone, or its time is over.
bool isOfTheRequest(const error_code& error) {
  return error.category() == http::make_error_code(http::error::end_of_stream).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

HttpRequest plain(const http::request<http::empty_body>& parsed) {
  HttpRequest request{std::string(parsed.method_string()), std::string(parsed.target()), {}};
  for (const auto& field : parsed) request.fields.emplace_back(field.name_string(), field.value());
  return request;
}

http::response<FileBody> response(const HttpAnswer& answer) {
  http::response<FileBody> message;
  message.result(static_cast<unsigned>(answer.status));
  message.set(http::field::cache_control, "no-store");
  message.set("X-Content-Type-Options", "nosniff");
  message.set("Referrer-Policy", "no-referrer");
  message.set("Cross-Origin-Resource-Policy", "same-origin");
  message.set("Cross-Origin-Opener-Policy", "same-origin");
  message.set("Content-Security-Policy",
              "default-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
              "frame-ancestors 'none'");
  if (answer.status == 405) message.set(http::field::allow, "GET, HEAD");
  if (answer.status == 200) {
    message.set(http::field::content_type, std::string(answer.body.type));
    message.body() = answer.body;
  }
  message.prepare_payload();
  return message;
}

}  // namespace

struct HttpServer::State {
  explicit State(const HttpLimits& given) : limits(given) {}

  /// A connection, and whether it has something to answer.
  struct Connection {
    beast::tcp_stream stream;
    bool answering = false;
  };
  using Connections = std::list<Connection>;

  HttpLimits limits;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer watch{context};
  Connections connections;  ///< in the order of their last requests

  void listen(int port) {
    acceptor.open(tcp::v4());
    // No two servers on one port, but a port again whose last server has just ended.
    acceptor.set_option(tcp::acceptor::reuse_address(true));
    acceptor.bind({asio::ip::address_v4::loopback(), static_cast<unsigned short>(port)});
    acceptor.listen();
  }

  asio::awaitable<void> accept(const HttpSite& site) {
    while (true) {
      error_code error;
      tcp::socket socket = co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (error == asio::error::operation_aborted) co_return;
      if (error) {  // no descriptor is left, say: connections that end give some back
        asio::steady_timer pause(context, std::chrono::milliseconds(100));
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
        continue;
      }
      makeRoom();
      const auto connection = connections.emplace(connections.end(), Connection{beast::tcp_stream(std::move(socket))});
      asio::co_spawn(context, serve(connection, site), asio::detached);
    }
  }

  /// Closes the connection that has waited longest, with nothing to be answered if there is one such.
  void makeRoom() {
    if (connections.size() < limits.connections) return;
    auto idle = std::ranges::find(connections, false, &Connection::answering);
    if (idle == connections.end()) idle = connections.begin();
    idle->stream.close();
  }

  asio::awaitable<void> serve(Connections::iterator connection, const HttpSite& site) {
    try {
      beast::flat_buffer buffer(limits.header_bytes + 1);
      while (co_await answerOne(connection, buffer, site)) {
        connections.splice(connections.end(), connections, connection);
      }
    } catch (const std::exception&) {  // the client went away, or took too long
    }
    connections.erase(connection);
  }

  /// Reads a request and answers it. True where another may follow.
  asio::awaitable<bool> answerOne(Connections::iterator connection, beast::flat_buffer& buffer, const HttpSite& site) {
    beast::tcp_stream& stream = connection->stream;
    http::request_parser<http::empty_body> parser;
    parser.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // it is not read
    stream.expires_after(limits.request);
    error_code error;
    co_await http::async_read_header(stream, buffer, parser, asio::redirect_error(asio::use_awaitable, error));
    if (error && !isOfTheRequest(error)) co_return false;  // nobody is left to answer
    const bool too_long = error == http::error::header_limit || error == http::error::buffer_overflow;
    // There is no use for a body: it is not read, and the connection ends, since where it does is not known.
    const bool has_body = !error && (parser.chunked() || parser.content_length().value_or(0) > 0);
    const std::size_t most = has_body ? site.bodyLimit(plain(parser.get())) : 0;
    if (most > 0 && parser.content_length().value_or(most + 1) <= most) {
      co_return co_await takeOne(connection, buffer, std::move(parser), most, site);
    }
    HttpAnswer answer = error ? HttpAnswer{too_long ? 431 : 400, {}} : site.answer(plain(parser.get()));
    if (has_body && (answer.status == 200 || most > 0)) answer = {413, {}};
    http::response<FileBody> message = response(answer);
    message.version(parser.get().version() == 10 ? 10 : 11);
    message.keep_alive(!error && !has_body && parser.get().keep_alive());
    co_await send(connection, message, parser.get().method() == http::verb::head);
    if (message.keep_alive()) co_return true;
    stream.socket().shutdown(tcp::socket::shutdown_send, error);
    if (has_body || error) co_await drop(stream);
    co_return false;
  }

  /// Reads the body of a request that the site takes, of a length that was said, and answers it.
  asio::awaitable<bool> takeOne(Connections::iterator connection, beast::flat_buffer& buffer,
                                http::request_parser<http::empty_body>&& header, std::size_t most,
                                const HttpSite& site) {
    http::request_parser<http::string_body> parser(std::move(header));
    parser.body_limit(most);
    co_await http::async_read(connection->stream, buffer, parser, asio::use_awaitable);
    http::response<FileBody> message = response(site.take(parser.get().body()));
    message.version(parser.get().version() == 10 ? 10 : 11);
    message.keep_alive(parser.get().keep_alive());
    co_await send(connection, message, false);
    error_code ignored;
    if (!message.keep_alive()) connection->stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    co_return message.keep_alive();
  }

  /// Takes some of what the client still sends: closing at once would take the answer from under its eyes.
  asio::awaitable<void> drop(beast::tcp_stream& stream) {
    std::array<char, 1 << 14> unread;
    stream.expires_after(std::chrono::seconds(1));
    for (std::size_t dropped = 0; dropped < std::size_t{1} << 20;) {
      dropped += co_await stream.async_read_some(asio::buffer(unread), asio::use_awaitable);
    }
  }

  asio::awaitable<void> send(Connections::iterator connection, http::response<FileBody>& message, bool header_alone) {
    const std::chrono::seconds of_size(FileBody::size(message.body()) >> 20);
    connection->stream.expires_after(limits.answer + of_size);
    connection->answering = true;
    http::response_serializer<FileBody> serializer(message);
    if (header_alone) {
      co_await http::async_write_header(connection->stream, serializer, asio::use_awaitable);
    } else {
      co_await http::async_write(connection->stream, serializer, asio::use_awaitable);
    }
    connection->answering = false;
  }

  asio::awaitable<void> stopWhenCancelled(Progress& progress) {
    try {
      while (true) {
        progress.checkCancelled();
        watch.expires_after(std::chrono::milliseconds(100));
        co_await watch.async_wait(asio::use_awaitable);
      }
    } catch (const Cancelled&) {  // how a server ends
    }
    context.stop();
  }
};

HttpServer::HttpServer(int port, const HttpLimits& limits) : state_(std::make_unique<State>(limits)) {
  try {
    state_->listen(port);
  } catch (const boost::system::system_error&) {
    throw InputError({"--port", "", "a port that is free on 127.0.0.1, and for this user", fmt::format("{}", port),
                      "choose another, or 0 for any"});
  }
}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return state_->acceptor.local_endpoint().port(); }

void HttpServer::run(const HttpSite& site, Progress& progress) {
  asio::co_spawn(state_->context, state_->accept(site), asio::detached);
  asio::co_spawn(state_->context, state_->stopWhenCancelled(progress), asio::detached);
  state_->context.run();
}

}  // namespace facezip::cli
