#include "apps/studio/http/client_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>

namespace scumble {
namespace {

constexpr std::size_t kPiece = 64 << 10;

bool MustWait(ssize_t result) { return result < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR); }

}  // namespace

ClientSocket::~ClientSocket() { ::close(socket_); }

ClientSocket::Result ClientSocket::Await(short events, Clock::time_point deadline) const {
  pollfd waits[] = {{socket_, events, 0}, {stop_, POLLIN, 0}};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    const int ready = ::poll(waits, 2, static_cast<int>(std::max<decltype(left)>(left, 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0 || waits[1].revents != 0) return Result::kEnded;
    return ready == 0 ? Result::kTimedOut : Result::kOk;
  }
}

ClientSocket::Result ClientSocket::Read(std::string& bytes, Clock::time_point deadline) {
  for (;;) {
    if (const Result waited = Await(POLLIN, deadline); waited != Result::kOk) return waited;
    bytes.resize(kPiece);
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (MustWait(count)) continue;
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return count > 0 ? Result::kOk : Result::kEnded;
  }
}

bool ClientSocket::Send(std::initializer_list<std::string_view> parts, std::chrono::milliseconds stall) {
  for (const std::string_view part : parts) {
    for (std::string_view rest = part; !rest.empty();) {
      const ssize_t count = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
      if (count >= 0) {
        rest.remove_prefix(static_cast<std::size_t>(count));
      } else if (!MustWait(count) || Await(POLLOUT, Clock::now() + stall) != Result::kOk) {
        return false;
      }
    }
  }
  return true;
}

bool ClientSocket::HasGone() const {
  char byte = 0;
  const ssize_t count = ::recv(socket_, &byte, 1, MSG_PEEK);
  return count == 0 || (count < 0 && !MustWait(count));
}

void ClientSocket::Drain(std::chrono::milliseconds most) {
  ::shutdown(socket_, SHUT_WR);
  std::string ignored;
  const Clock::time_point deadline = Clock::now() + most;
  while (Read(ignored, deadline) == Result::kOk && Clock::now() < deadline) {
  }
}

}  // namespace scumble
