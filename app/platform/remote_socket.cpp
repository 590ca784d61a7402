#include "app/platform/remote_socket.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMaxBytes = 65536;  // the largest datagram
constexpr int kPatience_ms = 100;         // between two looks at the stop token
constexpr int kBuffer_B = 1 << 22;        // of datagrams on arrival, where the system allows it
constexpr std::size_t kMaxCommands = 1024;

sockaddr_in addressOf(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string host = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const auto port = parseNumber(colon == std::string::npos ? text : text.substr(colon + 1));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const bool right = port && *port >= 0.0 && *port <= 65535.0 && *port == std::floor(*port) &&
                     inet_pton(AF_INET, host.c_str(), &address.sin_addr) == 1;
  if (!right) throw InputError("--socket " + shown(text), "expected PORT or ADDRESS:PORT");
  address.sin_port = htons(static_cast<std::uint16_t>(*port));
  return address;
}

/// Replaces control characters: they would break the table of event markers.
std::string cleaned(std::string_view bytes) {
  std::string text(bytes);
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return std::string(trimmed(text));
}

}  // namespace

RemoteSocket::RemoteSocket(const std::string& address,
                           std::function<std::optional<std::string>(const std::string&)> at_once,
                           std::function<std::string(const std::string&)> answer)
    : at_once_(std::move(at_once)), answer_(std::move(answer)) {
  sockaddr_in wanted = addressOf(address);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  socklen_t size = sizeof wanted;
  if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&wanted), size) != 0 ||
      getsockname(socket_, reinterpret_cast<sockaddr*>(&wanted), &size) != 0) {
    if (socket_ >= 0) close(socket_);
    throw std::runtime_error("cannot listen at " + address + ": taken, or not an address of ours");
  }
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kBuffer_B, sizeof kBuffer_B);
  port_ = ntohs(wanted.sin_port);
  receiver_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
  answerer_ = std::jthread([this](const std::stop_token& stop) { answerLater(stop); });
}

RemoteSocket::~RemoteSocket() {
  receiver_.request_stop();
  answerer_.request_stop();
  receiver_.join();
  answerer_.join();
  close(socket_);
}

void RemoteSocket::receive(const std::stop_token& stop) {
  std::array<char, kMaxBytes> bytes;
  while (!stop.stop_requested()) {
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, kPatience_ms) <= 0) continue;
    Command command;
    socklen_t size = sizeof command.from;
    const ssize_t count = recvfrom(socket_, bytes.data(), bytes.size(), 0,
                                   reinterpret_cast<sockaddr*>(&command.from), &size);
    if (count < 0) continue;
    command.text = cleaned({bytes.data(), static_cast<std::size_t>(count)});
    if (const auto answer = at_once_(command.text)) {
      send(*answer, command.from);
      continue;
    }
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMaxCommands) {
      waiting_.push_back(std::move(command));
      arrived_.notify_one();
    } else {
      send("error too many commands wait", command.from);
    }
  }
}

void RemoteSocket::answerLater(const std::stop_token& stop) {
  while (true) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, stop, [this] { return !waiting_.empty(); });
    if (stop.stop_requested()) return;  // as with commands that have not arrived yet
    const Command command = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    send(answer_(command.text), command.from);
  }
}

void RemoteSocket::send(const std::string& answer, const sockaddr_in& to) const {
  const std::string line = answer + "\n";
  sendto(socket_, line.data(), line.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&to),
         sizeof to);
}

}  // namespace foci
