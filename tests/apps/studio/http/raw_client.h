// A client that sends any bytes, and a server to send them to.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "apps/studio/http/event_hub.h"
#include "apps/studio/http/server.h"
#include "core/image/check.h"

namespace scumble {

constexpr const char* kTestToken = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

// A socket connected to 127.0.0.1:PORT. Waits are ended after 10 s.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    SCUMBLE_CHECK_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~RawClient() { Close(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void Close() {
    if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  }

  // False: the server has closed the connection.
  bool Send(const std::string& bytes) {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }

  // Everything up to `end`, or to the connection's end where that is empty or does not come.
  std::string ReadTo(const std::string& end) {
    while (end.empty() || buffer_.find(end) == buffer_.npos) {
      char bytes[4096];
      pollfd wait{socket_, POLLIN, 0};
      const ssize_t count = ::poll(&wait, 1, 10000) > 0 ? ::recv(socket_, bytes, sizeof(bytes), 0) : 0;
      if (count <= 0) {
        ended_ = true;
        return std::exchange(buffer_, "");
      }
      buffer_.append(bytes, static_cast<std::size_t>(count));
    }
    const std::size_t length = buffer_.find(end) + end.size();
    std::string read = buffer_.substr(0, length);
    buffer_.erase(0, length);
    return read;
  }

  // One answer that has a Content-Length, or none and no body.
  std::string Answer() {
    std::string answer = ReadTo("\r\n\r\n");
    const std::size_t field = answer.find("Content-Length: ");
    if (field == answer.npos) return answer;
    const auto length = static_cast<std::size_t>(std::stoul(answer.substr(field + 16)));
    while (buffer_.size() < length && !ended_) {
      const std::string rest = std::exchange(buffer_, "");
      buffer_ = rest + ReadSome();
    }
    answer += buffer_.substr(0, length);
    buffer_.erase(0, length);
    return answer;
  }

  bool ended() const { return ended_; }

 private:
  std::string ReadSome() {
    char bytes[65536];
    const ssize_t count = ::recv(socket_, bytes, sizeof(bytes), 0);
    ended_ = count <= 0;
    return std::string(bytes, static_cast<std::size_t>(ended_ ? 0 : count));
  }

  int socket_;
  std::string buffer_;
  bool ended_ = false;
};

// A server with a handler that echoes, and short times.
struct TestServer {
  explicit TestServer(HttpHandler handler = Echo, ServerOptions options = Options()) {
    auto started = HttpServer::Start(options, std::move(handler), hub);
    SCUMBLE_CHECK(started.ok());
    server = *std::move(started);
  }

  static ServerOptions Options() {
    ServerOptions options;
    options.token = kTestToken;
    return options;
  }
  static HttpResponse Echo(const HttpRequest& request) {
    return {200, "text/plain", request.method + " " + request.path + " " + request.body, {}};
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(server->port()); }
  std::string cookie() const { return "Cookie: scumble_" + std::to_string(server->port()) + "=" + kTestToken + "\r\n"; }
  // A request of the page: `line` is "GET /api/state".
  std::string Request(const std::string& line, const std::string& fields = "") const {
    return line + " HTTP/1.1\r\nHost: " + host() + "\r\n" + cookie() + fields + "\r\n";
  }
  std::string Change(const std::string& line, const std::string& body) const {
    return Request(line, "X-Scumble: 1\r\nContent-Type: application/json\r\nContent-Length: " +
                             std::to_string(body.size()) + "\r\n") +
           body;
  }
  // The answer to these bytes.
  std::string Ask(const std::string& request) const {
    RawClient client(server->port());
    client.Send(request);
    return client.Answer();
  }

  EventHub hub;
  std::unique_ptr<HttpServer> server;
};

// "200" of an answer.
inline std::string StatusOf(const std::string& answer) { return answer.size() > 12 ? answer.substr(9, 3) : "none"; }

}  // namespace scumble
