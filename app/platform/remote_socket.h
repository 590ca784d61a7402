// The socket of remote control: a datagram (UDP) brings a command, another one takes the answer.
// docs/live.md lists the commands.
#pragma once

#include <netinet/in.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace foci {

class RemoteSocket {
 public:
  /// @param address  "PORT" on the loopback address, or "ADDRESS:PORT" (IPv4)
  /// @param at_once  called with each command as it arrives; returns the answer, or nothing if
  ///   answering may take time. It must not wait: gaze arrives behind it.
  /// @param answer   called with the others, in their order, on a thread of its own
  /// @throws InputError if the address is wrong, std::runtime_error if it is taken
  RemoteSocket(const std::string& address,
               std::function<std::optional<std::string>(const std::string&)> at_once,
               std::function<std::string(const std::string&)> answer);
  ~RemoteSocket();
  RemoteSocket& operator=(RemoteSocket&&) = delete;  // nor copied

  /// The port in use. If port 0 was asked for, the system has chosen a free one.
  int port() const { return port_; }

 private:
  struct Command {
    std::string text;
    sockaddr_in from{};
  };

  void receive(const std::stop_token& stop);
  void answerLater(const std::stop_token& stop);
  void send(const std::string& answer, const sockaddr_in& to) const;

  int socket_ = -1, port_ = 0;
  std::function<std::optional<std::string>(const std::string&)> at_once_;
  std::function<std::string(const std::string&)> answer_;
  std::mutex mutex_;
  std::deque<Command> waiting_;
  std::condition_variable_any arrived_;
  std::jthread receiver_, answerer_;  // last: they use the others
};

}  // namespace foci
