#include "app/record/run_events.h"

#include <algorithm>

#include "app/session/session.h"

namespace foci {

RunEvents eventsOfRun(const Study& study, const GazeTrace& trace, double from_s, double to_s) {
  const Screen screen = study.screenInForce();
  const auto on_screen = [&](std::optional<glm::dvec2>& point_px) {
    if (point_px) point_px = onOtherScreen_px(*trace.screen, screen, *point_px);
  };
  const EventSettings& settings = study.gaze.events;
  EventLabels labels = labelEvents(trace, *trace.screen, settings);
  RunEvents run{.events = eventsOf(labels, trace, *trace.screen, settings)};
  run.quality = qualityOf(trace, *trace.screen, labels.states, run.events);
  run.warnings = eventWarnings(trace, labels, run.quality, settings);
  run.states = std::move(labels.states);
  std::vector<GazeEvent>& events = run.events;
  std::erase_if(events, [&](const GazeEvent& event) {
    return event.onset_s >= to_s || event.onset_s + event.duration_s <= from_s;
  });
  for (GazeEvent& event : events) {
    on_screen(event.position_px);
    on_screen(event.start_px);
  }
  return run;
}

std::size_t countOf(const std::vector<GazeEvent>& events, GazeState kind) {
  return static_cast<std::size_t>(std::ranges::count(events, kind, &GazeEvent::kind));
}

}  // namespace foci
