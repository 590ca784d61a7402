#include "app/live/words.h"

#include <algorithm>

#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

constexpr double kSkip_s = 5.0, kFrame_s = 1.0 / 30.0;

std::string stepToFixation(int by, TracePlayer& player, const std::vector<GazeEvent>& events) {
  std::vector<const GazeEvent*> fixations;
  for (const GazeEvent& event : events) {
    if (event.kind == GazeState::fixation) fixations.push_back(&event);
  }
  const TracePlayer::State now = player.state();
  const auto onset = [](const GazeEvent* each) { return each->onset_s; };
  const auto offset = [](const GazeEvent* each) { return each->onset_s + each->duration_s; };
  const auto next = by > 0 ? std::ranges::upper_bound(fixations, now.recording_s, {}, onset)
                           : std::ranges::lower_bound(fixations, now.recording_s, {}, offset);
  if (next == (by > 0 ? fixations.end() : fixations.begin())) {
    return by > 0 ? "no later fixation" : "no earlier fixation";
  }
  const auto to = by > 0 ? next : next - 1;
  player.seek(0.5 * (onset(*to) + offset(*to)));
  return "fixation " + std::to_string(to - fixations.begin() + 1) + " of " +
         std::to_string(fixations.size());
}

std::string speedInWords(double speed) {
  return "speed " + (speed < 1.0 ? "1/" + significant(1.0 / speed) : significant(speed));
}

}  // namespace

std::string metresText(double focus_D) {
  if (focus_D < -0.005) return "behind the eye";
  return focus_D < 0.005 ? "infinity" : decimal(1.0 / focus_D, 2) + " m";
}

std::string changeInWords(std::string_view key, const std::string& toml) {
  const bool on = toml == "true";
  const std::string word(toml.size() > 1 && toml.front() == '"' ? toml.substr(1, toml.size() - 2)
                                                                : toml);
  if (key == "observer.pupil_mm") return "pupil " + word + " mm";
  if (key == "output.marker") return on ? "the gaze is shown" : "the gaze is hidden";
  if (key == "output.split") return on ? "left half sharp" : "no half sharp";
  if (key == "output.view") return "view: " + word;
  if (key == "quality.foveated") {
    return on ? "foveated: coarser away from the gaze" : "not foveated: equally fine everywhere";
  }
  if (key == "render.method") {
    return "method " + word + ": " + std::string(methodInfo(word).summary);
  }
  if (key == "focus.fixed_D") {
    const auto focus_D = parseNumber(toml);
    if (!focus_D) return "focus follows the gaze";
    return "focus fixed at " + decimal(*focus_D, 2) + " D, " + metresText(*focus_D);
  }
  return std::string(key) + " = " + toml;
}

std::string carryOut(PlayerStep step, TracePlayer& player, const std::vector<GazeEvent>& events) {
  const TracePlayer::State now = player.state();
  const auto seek = [&](double to_s) {
    player.seek(to_s);
    return "at " + decimal(player.state().recording_s - now.first_s, 2) + " s";
  };
  using Step = PlayerStep;
  if (step == Step::frame_forward && now.recording_s >= now.last_s) return "at the end";
  if (step == Step::frame_back || step == Step::frame_forward) player.play(false);
  if (step == Step::frame_back) return seek(now.recording_s - kFrame_s);
  if (step == Step::frame_forward) return seek(now.recording_s + kFrame_s);
  if (step == Step::back) return seek(now.recording_s - kSkip_s);
  if (step == Step::forward) return seek(now.recording_s + kSkip_s);
  if (step == Step::fixation_before) return stepToFixation(-1, player, events);
  if (step == Step::fixation_after) return stepToFixation(1, player, events);
  if (step == Step::begin) return seek(now.first_s);
  if (step == Step::end) return seek(now.last_s);
  if (step == Step::slower || step == Step::faster) {
    player.setSpeed((step == Step::slower ? 0.5 : 2.0) * now.speed);
    return speedInWords(player.state().speed);
  }
  if (step == Step::loop) {
    player.setLoops(!now.loops);
    return now.loops ? "plays once" : "plays in a loop";
  }
  player.play(!now.plays);
  return now.plays ? "paused" : "plays";
}

}  // namespace foci
