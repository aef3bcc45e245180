// The socket of one client. Every wait has an end: a time, the client's going, or the server's stop.
#pragma once

#include <chrono>
#include <initializer_list>
#include <string>
#include <string_view>

namespace scumble {

class ClientSocket {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Result { kOk, kTimedOut, kEnded };

  // Owns `socket`, which does not block; `stop` is readable once the server stops.
  ClientSocket(int socket, int stop) : socket_(socket), stop_(stop) {}
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  // Waits for bytes and puts them into `bytes`, in place of what is there.
  Result Read(std::string& bytes, Clock::time_point deadline);
  // Sends all parts; `stall` is how long the client may take nothing at all. False: it has gone, or stalled.
  bool Send(std::initializer_list<std::string_view> parts, std::chrono::milliseconds stall);
  // Whether the client has closed its end.
  bool HasGone() const;
  // Takes in what the client still sends, for so long at most: a socket that is closed with bytes unread would take the
  // answer away from it.
  void Drain(std::chrono::milliseconds most);

 private:
  Result Await(short events, Clock::time_point deadline) const;

  int socket_;
  int stop_;
};

}  // namespace scumble
