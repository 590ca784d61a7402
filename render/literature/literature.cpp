#include "render/literature/literature.h"

#include "render/methods/method.h"

namespace foci {

// Each at the end of its file.
MethodEntry paperMethod();
MethodEntry paperLodMethod();
MethodEntry potmesilMethod();
MethodEntry rokitaMethod();
MethodEntry layeredMethod();
MethodEntry matthewsMethod();
MethodEntry shinyaMethod();
MethodEntry fearingMethod();
MethodEntry mulderMethod();
MethodEntry rasanenMethod();
MethodEntry inflateMethod();
MethodEntry raytraceMethod();

void registerLiterature() {
  [[maybe_unused]] static const bool done = [] {
    for (const auto entry :
         {paperMethod, paperLodMethod, potmesilMethod, rokitaMethod, layeredMethod, matthewsMethod,
          shinyaMethod, fearingMethod, mulderMethod, rasanenMethod, inflateMethod}) {
      registerMethod(entry());
    }
#ifdef FOCI_RAYTRACE
    registerMethod(raytraceMethod());
#endif
    return true;
  }();
}

}  // namespace foci
