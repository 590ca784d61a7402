#include "gaze/live/live_source.h"

#include <cassert>
#include <utility>

namespace foci {

void MouseSource::poll(double now_s, std::vector<GazeSample>& samples) {
  if (last_s_ && now_s <= *last_s_) return;
  last_s_ = now_s;
  samples.push_back({.time_s = now_s, .point_px = point_px_});
}

TraceSource::TraceSource(GazeTrace trace) : trace_(std::move(trace)) {
  assert(!trace_.samples.empty() && trace_.rate_Hz > 0.0);
}

void TraceSource::poll(double now_s, std::vector<GazeSample>& samples) {
  if (!offset_s_) offset_s_ = now_s - trace_.samples.front().time_s;
  for (; !ended() && trace_.samples[next_].time_s + *offset_s_ <= now_s; ++next_) {
    samples.push_back(trace_.samples[next_]);
    samples.back().time_s += *offset_s_;
  }
}

std::string TraceSource::status() const { return trace_.format + (ended() ? ", ended" : ""); }

}  // namespace foci
