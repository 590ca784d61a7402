// The socket of remote control: a datagram (UDP) brings a command, another one takes the answer.
// docs/live.md lists the commands.
#pragma once

#include <functional>
#include <string>
#include <thread>

namespace foci {

class RemoteSocket {
 public:
  /// @param address  "PORT" on the loopback address, or "ADDRESS:PORT" (IPv4)
  /// @param answer   called with each command, on the thread of the socket; returns the answer
  /// @throws InputError if the address is wrong, std::runtime_error if it is taken
  RemoteSocket(const std::string& address, std::function<std::string(const std::string&)> answer);
  ~RemoteSocket();
  RemoteSocket(const RemoteSocket&) = delete;
  RemoteSocket& operator=(const RemoteSocket&) = delete;

  /// The port in use. If port 0 was asked for, the system has chosen a free one.
  int port() const { return port_; }

 private:
  void run(const std::stop_token& stop);

  int socket_ = -1, port_ = 0;
  std::function<std::string(const std::string&)> answer_;
  std::jthread thread_;
};

}  // namespace foci
