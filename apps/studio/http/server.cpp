#include "apps/studio/http/server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <list>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "apps/studio/http/connection.h"
#include "apps/studio/http/descriptor.h"
#include "apps/studio/http/message.h"

namespace scumble {
namespace {

constexpr std::size_t kMostConnections = 64;

Error CannotListen(int port, int failure) {
  const std::string where = "port " + std::to_string(port) + " of 127.0.0.1 ";
  if (failure == EADDRINUSE) {
    return UsageError(where + "is in use by another program: name another with --port, or leave it out for a free one");
  }
  return UsageError(where + "cannot be used (" + std::strerror(failure) +
                    "): name another with --port, 1024 or higher, or leave it out for a free one");
}

Expected<Descriptor> Listen(int port) {
  Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (listener.number() < 0) return CannotListen(port, errno);
  const int on = 1;
  ::setsockopt(listener.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));  // of a studio that has just ended
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::bind(listener.number(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      ::listen(listener.number(), 128) != 0) {
    return CannotListen(port, errno);
  }
  return listener;
}

int PortOf(const Descriptor& listener) {
  sockaddr_in address{};
  socklen_t length = sizeof(address);
  ::getsockname(listener.number(), reinterpret_cast<sockaddr*>(&address), &length);
  return ntohs(address.sin_port);
}

// Without a thread of its own: the answer must fit what the system buffers.
void TurnAway(int socket, int stop) {
  ClientSocket client(socket, stop);
  const HttpResponse answer =
      ErrorAnswer(503, "unavailable", "64 connections are open: close other tabs of the studio");
  if (client.Send({HeadText(answer, answer.body.size(), false), answer.body}, std::chrono::milliseconds(0))) {
    client.Drain(std::chrono::milliseconds(0));
  }
}

}  // namespace

struct HttpServer::State {
  struct Worker {
    std::thread thread;
    std::atomic<bool> is_done = false;
  };

  Site site;
  Descriptor listener, stop;
  std::list<Worker> workers;  // of the accepting thread, until that has ended
  std::thread accepting;

  void Accept();
  void Take(int socket);
  void Reap();
};

void HttpServer::State::Reap() {
  for (auto worker = workers.begin(); worker != workers.end();) {
    if (!worker->is_done) {
      ++worker;
      continue;
    }
    worker->thread.join();
    worker = workers.erase(worker);
  }
}

void HttpServer::State::Take(int socket) {
  Reap();
  if (workers.size() >= kMostConnections) return TurnAway(socket, stop.number());
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  Worker& worker = workers.emplace_back();
  try {
    worker.thread = std::thread([this, socket, &worker] {
      {
        ClientSocket client(socket, stop.number());
        ServeConnection(client, site);
      }
      worker.is_done = true;
    });
  } catch (const std::system_error&) {  // no more threads
    workers.pop_back();
    TurnAway(socket, stop.number());
  }
}

void HttpServer::State::Accept() {
  pollfd waits[] = {{listener.number(), POLLIN, 0}, {stop.number(), POLLIN, 0}};
  for (;;) {
    if (::poll(waits, 2, -1) < 0 && errno != EINTR) return;
    if (waits[1].revents != 0) return;
    const int socket = ::accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0) {
      Take(socket);
    } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      ::poll(&waits[1], 1, 100);  // until another connection ends
    }
  }
}

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

HttpServer::~HttpServer() { Stop(); }

Expected<std::unique_ptr<HttpServer>> HttpServer::Start(const ServerOptions& options, HttpHandler handler,
                                                        EventHub& events) {
  auto state = std::make_unique<State>();
  SCUMBLE_ASSIGN(state->site.files, WebFiles::Open(options.web));
  SCUMBLE_ASSIGN(state->listener, Listen(options.port));
  state->stop = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (state->stop.number() < 0) return MemoryError("the system gives no more descriptors: raise ulimit -n");
  state->site.rules = {PortOf(state->listener), options.token};
  state->site.handler = std::move(handler);
  state->site.events = &events;
  state->site.times = options.times;
  state->site.on_first_visit = options.on_first_visit;
  State* const running = state.get();
  state->accepting = std::thread([running] { running->Accept(); });
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(state)));
}

int HttpServer::port() const { return state_->site.rules.port; }

std::string HttpServer::address() const {
  return "http://127.0.0.1:" + std::to_string(port()) + "/?token=" + state_->site.rules.token;
}

void HttpServer::Stop() {
  if (!state_->accepting.joinable()) return;
  state_->site.events->Close();
  const std::uint64_t one = 1;
  static_cast<void>(!::write(state_->stop.number(), &one, sizeof(one)));
  state_->accepting.join();
  for (State::Worker& worker : state_->workers) worker.thread.join();
  state_->workers.clear();
  state_->listener = Descriptor();
}

}  // namespace scumble
