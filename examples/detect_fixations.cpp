// Prints onset, duration and place of each fixation of a recording, seen on a 24-inch screen at 0.6
// m unless the file says otherwise:
//   detect_fixations RECORDING
#include <exception>
#include <iostream>

#include <foci/gaze/events/gaze_events.h>
#include <foci/gaze/sources/trace_reader.h>

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: detect_fixations RECORDING\n";
    return 2;
  }
  const foci::Screen fallback{{1920, 1080}, {0.531, 0.299}, 0.6};
  const foci::GazeTrace trace = foci::readTrace(argv[1], {}, fallback);

  std::cout << "onset_s\tduration_s\tx_px\ty_px\n";
  for (const foci::GazeEvent& event : foci::detectEvents(trace, *trace.screen)) {
    if (event.kind != foci::GazeState::fixation) continue;
    std::cout << event.onset_s << '\t' << event.duration_s << '\t' << event.position_px->x << '\t'
              << event.position_px->y << '\n';
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
