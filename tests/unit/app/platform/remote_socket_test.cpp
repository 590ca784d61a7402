#include "app/platform/remote_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <optional>
#include <string>

#include "base/input_error.h"

namespace foci {
namespace FOCI_FILE {

/// A socket of an experiment that talks to the one under test.
class Experiment {
 public:
  explicit Experiment(int port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  ~Experiment() { close(socket_); }
  Experiment(const Experiment&) = delete;
  Experiment& operator=(const Experiment&) = delete;

  void send(const std::string& text) const { ::send(socket_, text.data(), text.size(), 0); }
  std::string answer() const {
    char bytes[64];
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    return count > 0 ? std::string(bytes, static_cast<std::size_t>(count)) : "";
  }

 private:
  int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
};

std::optional<std::string> never(const std::string&) { return std::nullopt; }

TEST(RemoteSocket, AnswersADatagramWithOne) {
  RemoteSocket remote("0", never, [](const std::string& command) { return "<" + command + ">"; });
  const Experiment experiment(remote.port());
  experiment.send("mark a\tb\n");
  EXPECT_EQ(experiment.answer(), "<mark a b>\n");
}

TEST(RemoteSocket, GazeDoesNotWaitForASlowCommand) {
  std::promise<void> pushed;
  constexpr int kSamples = 2000;  // more than the system's buffer holds
  const auto gaze = [&](const std::string& command) -> std::optional<std::string> {
    return command == "gaze" ? std::optional<std::string>("ok") : std::nullopt;
  };
  RemoteSocket remote("0", gaze, [&](const std::string&) {
    pushed.get_future().wait();
    return std::string("done");
  });
  const Experiment experiment(remote.port());
  experiment.send("slow");
  for (int i = 0; i < kSamples; ++i) {
    experiment.send("gaze");
    EXPECT_EQ(experiment.answer(), "ok\n");
  }
  pushed.set_value();
  EXPECT_EQ(experiment.answer(), "done\n");
}

TEST(RemoteSocket, RefusesWhatIsNoAddress) {
  for (const char* address : {"", "x", "70000", "1.2.3:5", "localhost:5", ":", "1.5"}) {
    EXPECT_THROW(RemoteSocket(address, never, [](const std::string& c) { return c; }), InputError)
        << address;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
