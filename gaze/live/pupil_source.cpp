#include "gaze/live/pupil_source.h"

#include <algorithm>
#include <zmq.hpp>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kPatience_s = 2.0;
// Gaze of one eye comes ten samples late, that of both at once (RealtimeMatcher,
// gaze_mapping/matching.py).
constexpr double kLate_s = 0.25;    // longer than those ten samples at 60 Hz
constexpr double kAlone_s = 1.0;    // after gaze of one eye, that of both may come earlier
constexpr int kMaxMessages = 4096;  // in the queue

zmq::socket_t quietSocket(zmq::context_t& context, zmq::socket_type type) {
  zmq::socket_t socket(context, type);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::rcvhwm, kMaxMessages);
  socket.set(zmq::sockopt::maxmsgsize, std::int64_t{1} << 20);
  return socket;
}

}  // namespace

struct PupilSource::Sockets {
  zmq::context_t context{1};
  std::optional<zmq::socket_t> request{}, data{};
  bool heard = false;  // a message has arrived from `data`
};

PupilSource::PupilSource(const std::string& host, int port, const Screen& screen)
    : host_(host), port_(port), screen_(screen), sockets_(std::make_unique<Sockets>()) {
  const bool plain =
      !host.empty() && host.size() <= 253 && std::ranges::all_of(host, [](unsigned char c) {
        return std::isalnum(c) || c == '.' || c == '-' || c == '_';
      });
  if (!plain) throw InputError("pupil:" + shown(host), "expected a host's name or address");
  if (port < 1 || port > 65535) {
    throw InputError("pupil:" + host + ":" + std::to_string(port), "expected a port, 1 to 65535");
  }
}

PupilSource::~PupilSource() = default;

void PupilSource::poll(double now_s, std::vector<GazeSample>& samples) {
  try {
    if (!sockets_->request && !sockets_->data) {
      ask(now_s);
    } else if (sockets_->request) {
      subscribe(now_s);
    }
    if (sockets_->data) receive(now_s, samples);
  } catch (const zmq::error_t&) {
    sockets_->request.reset();
    sockets_->data.reset();
  }
  if (now_s - since_s_ > kPatience_s) {
    sockets_->request.reset();
    sockets_->data.reset();
    sockets_->heard = false;
  }
}

void PupilSource::ask(double now_s) {
  since_s_ = now_s;
  sockets_->request = quietSocket(sockets_->context, zmq::socket_type::req);
  sockets_->request->connect("tcp://" + host_ + ":" + std::to_string(port_));
  sockets_->request->send(zmq::str_buffer("SUB_PORT"), zmq::send_flags::dontwait);
}

void PupilSource::subscribe(double now_s) {
  zmq::message_t reply;
  if (!sockets_->request->recv(reply, zmq::recv_flags::dontwait)) return;
  const auto port = parseNumber(trimmed(reply.to_string_view()));
  sockets_->request.reset();
  since_s_ = now_s;
  if (!port || *port < 1 || *port > 65535 || *port != std::floor(*port)) return;
  sockets_->data = quietSocket(sockets_->context, zmq::socket_type::sub);
  sockets_->data->set(zmq::sockopt::subscribe, "gaze.");
  sockets_->data->connect("tcp://" + host_ + ":" + std::to_string(static_cast<int>(*port)));
}

void PupilSource::receive(double now_s, std::vector<GazeSample>& samples) {
  for (int i = 0; i < kMaxMessages; ++i) {
    zmq::message_t topic, payload, rest;
    if (!sockets_->data->recv(topic, zmq::recv_flags::dontwait)) return;
    bool more = topic.more();
    if (more) {
      (void)sockets_->data->recv(payload);
      more = payload.more();
    }
    while (more) {
      (void)sockets_->data->recv(rest);
      more = rest.more();
    }
    const auto sample =
        parsePupilMessage(topic.to_string_view(), payload.to_string_view(), screen_);
    if (!sample) {
      ++unread_;
      continue;
    }
    if (isLossOfOneEye(topic.to_string_view(), sample->point_px.has_value(), now_s)) continue;
    const std::size_t before = samples.size();
    clock_.take({*sample}, now_s, samples,
                now_s - alone_s_ > kAlone_s ? SenderClock::kStep_s : kLate_s);
    for (std::size_t k = before; k < samples.size(); ++k) note(samples[k], now_s);
  }
}

/// Whether only this eye is lost, and not the other. Pupil Capture sends such a loss at once, but
/// the other eye's gaze late, with earlier times.
bool PupilSource::isLossOfOneEye(std::string_view topic, bool has_point, double now_s) {
  if (!seen_s_) seen_s_ = {now_s, now_s};
  const std::string_view eyes = topic.substr(std::min(topic.size(), sizeof("gaze.3d.") - 1));
  const bool both = eyes.starts_with("01");
  if (!both) alone_s_ = now_s;
  for (const int eye : {0, 1}) {
    if (both || eyes.starts_with(std::to_string(eye))) {
      (*seen_s_)[eye] = has_point ? now_s : -INFINITY;
    }
  }
  return !both && !has_point && now_s - std::ranges::max(*seen_s_) <= kLate_s;
}

void PupilSource::note(const GazeSample& sample, double now_s) {
  since_s_ = now_s;
  sockets_->heard = true;
  if (last_s_) {
    constexpr double kMemory = 0.05;  // share of the newest interval, chosen by eye
    const double interval_s = sample.time_s - *last_s_;
    interval_s_ = interval_s_
                      ? std::lerp(*interval_s_, std::min(interval_s, 2.0 * *interval_s_), kMemory)
                      : interval_s;
  }
  last_s_ = sample.time_s;
}

double PupilSource::rate_Hz() const {
  constexpr double kUsual_Hz = 200.0;  // eye cameras of Pupil Core
  return interval_s_ ? std::clamp(1.0 / *interval_s_, 25.0, 2000.0) : kUsual_Hz;
}

SenderFacts PupilSource::sender() const {
  const std::size_t unfit = clock_.dropped();
  return {.dropped = unfit + unread_,
          .why = unfit >= unread_ ? kUnfitting : "their messages are no gaze that foci can read",
          .clock = clock_.facts()};
}

std::string PupilSource::status() const {
  return "Pupil at " + host_ + ":" + std::to_string(port_) +
         (sockets_->heard  ? ""
          : sockets_->data ? ", no gaze yet"
                           : ", no answer yet");
}

}  // namespace foci
