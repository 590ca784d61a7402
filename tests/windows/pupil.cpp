// A Pupil Core whose observer looks at one point, until the program is killed.
//
//     foci_pupil PORT X Y
//
// Answers as Pupil Remote at PORT of the loopback device (0: a free port, printed). Sends gaze 100
// times a second at (X, Y), shares of the screen from its top left corner.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#define MSGPACK_NO_BOOST
#include <msgpack.hpp>
#include <zmq.hpp>

namespace foci {

static std::string portOf(const zmq::socket_t& socket) {
  const std::string address = socket.get(zmq::sockopt::last_endpoint);
  return address.substr(address.rfind(':') + 1);
}

static void serve(const std::string& port, double x, double y) {
  zmq::context_t context{1};
  zmq::socket_t remote(context, zmq::socket_type::rep), data(context, zmq::socket_type::pub);
  remote.bind("tcp://127.0.0.1:" + (port == "0" ? "*" : port));
  data.bind("tcp://127.0.0.1:*");
  std::printf("%s\n", portOf(remote).c_str());
  std::fflush(stdout);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    zmq::message_t request;
    if (remote.recv(request, zmq::recv_flags::dontwait)) {
      remote.send(zmq::buffer(portOf(data)), zmq::send_flags::none);
    }
    msgpack::sbuffer buffer;
    msgpack::packer packer(buffer);
    packer.pack_map(3);
    packer.pack("timestamp");
    packer.pack(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    packer.pack("confidence");
    packer.pack(1.0);
    packer.pack("norm_pos");  // from the bottom left
    packer.pack(std::vector<double>{x, 1.0 - y});
    data.send(zmq::str_buffer("gaze.2d.0."), zmq::send_flags::sndmore);
    data.send(zmq::buffer(buffer.data(), buffer.size()), zmq::send_flags::none);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace foci

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  foci::serve(argv[1], std::atof(argv[2]), std::atof(argv[3]));
}
