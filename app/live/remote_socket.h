// A socket through which an experiment's script drives a live run: one datagram (UDP) a command,
// one datagram as the answer. docs/live.md has the commands.
#pragma once

#include <functional>
#include <string>
#include <thread>

namespace foci {

class RemoteSocket {
 public:
  /// @param address  "PORT" on the loopback address, or "ADDRESS:PORT" (IPv4)
  /// @param answer   called on the socket's thread with a command; what it returns is sent back
  /// @throws InputError where the address is none, std::runtime_error where it is taken
  RemoteSocket(const std::string& address, std::function<std::string(const std::string&)> answer);
  ~RemoteSocket();
  RemoteSocket(const RemoteSocket&) = delete;
  RemoteSocket& operator=(const RemoteSocket&) = delete;

  /// In use: the one asked for, or where that was 0 a free one.
  int port() const { return port_; }

 private:
  void run(const std::stop_token& stop);

  int socket_ = -1, port_ = 0;
  std::function<std::string(const std::string&)> answer_;
  std::jthread thread_;
};

}  // namespace foci
