// The bytes of the model file become a part of the library, so that it opens no file.
#include "gaze/events/event_model.h"

extern "C" {
extern const char foci_event_model_begin[], foci_event_model_end[];
}

asm(R"(
.section .rodata
.balign 16
.globl foci_event_model_begin
foci_event_model_begin:
.incbin ")" FOCI_EVENT_MODEL R"("
.globl foci_event_model_end
foci_event_model_end:
.byte 0
.text
)");

namespace foci {

const EventModel& builtinEventModel() {
  static const EventModel kModel =
      unpackModel({foci_event_model_begin,
                   static_cast<std::size_t>(foci_event_model_end - foci_event_model_begin)},
                  "the built-in event model");
  return kModel;
}

}  // namespace foci
