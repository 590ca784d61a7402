#include "app/live/remote_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "base/input_error.h"

namespace foci {
namespace {

TEST(RemoteSocket, AnswersADatagramWithOne) {
  RemoteSocket socket_under_test("0",
                                 [](const std::string& command) { return "<" + command + ">"; });
  const int ours = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(socket_under_test.port()));
  const std::string sent = "mark a\tb\n";
  sendto(ours, sent.data(), sent.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  char bytes[64];
  const ssize_t count = recv(ours, bytes, sizeof bytes, 0);
  close(ours);
  ASSERT_GT(count, 0);
  EXPECT_EQ(std::string(bytes, static_cast<std::size_t>(count)), "<mark a b>\n");
}

TEST(RemoteSocket, RefusesWhatIsNoAddress) {
  for (const char* address : {"", "x", "70000", "1.2.3:5", "localhost:5", ":", "1.5"}) {
    EXPECT_THROW(RemoteSocket(address, [](const std::string& c) { return c; }), InputError)
        << address;
  }
}

}  // namespace
}  // namespace foci
