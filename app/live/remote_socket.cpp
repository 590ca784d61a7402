#include "app/live/remote_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "base/input_error.h"
#include "base/number.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::size_t kMaxBytes = 65536;  // the largest datagram
constexpr int kPatience_ms = 100;         // between two looks at the stop token

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
                           std::function<std::string(const std::string&)> answer)
    : answer_(std::move(answer)) {
  sockaddr_in wanted = addressOf(address);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  socklen_t size = sizeof wanted;
  if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&wanted), size) != 0 ||
      getsockname(socket_, reinterpret_cast<sockaddr*>(&wanted), &size) != 0) {
    if (socket_ >= 0) close(socket_);
    throw std::runtime_error("cannot listen at " + address + ": taken, or not an address of ours");
  }
  port_ = ntohs(wanted.sin_port);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

RemoteSocket::~RemoteSocket() {
  thread_.request_stop();
  thread_.join();
  close(socket_);
}

void RemoteSocket::run(const std::stop_token& stop) {
  std::array<char, kMaxBytes> bytes;
  while (!stop.stop_requested()) {
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, kPatience_ms) <= 0) continue;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t count =
        recvfrom(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) continue;
    const std::string answer =
        answer_(cleaned({bytes.data(), static_cast<std::size_t>(count)})) + "\n";
    sendto(socket_, answer.data(), answer.size(), MSG_DONTWAIT,
           reinterpret_cast<const sockaddr*>(&from), size);
  }
}

}  // namespace foci
