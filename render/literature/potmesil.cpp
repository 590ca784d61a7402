// The first depth of field in computer graphics. A focus processor takes the finished pinhole image
// with depth and spreads each pixel over its circle of confusion. Source: Potmesil and Chakravarty,
// A Lens and Aperture Camera Model for Synthetic Image Generation, SIGGRAPH 1981; Synthetic Image
// Generation with a Lens and Aperture Camera Model, ACM Transactions on Graphics 1(2), 1982. The
// original weighs the light by Lommel's functions. Here it falls evenly on the circle, as Chen
// proposed (Lens Effect on Synthetic Image Generation Based on Light Particle Theory, 1987/88).
// Known failure: each pixel is spread without regard to the others. Blurred light leaks over sharp
// surfaces in front of it. Where surfaces of different blur meet, one side receives too little
// light.
#include "render/literature/filter_method.h"

namespace foci {
namespace {

class PotmesilMethod final : public FilterMethod {
  using FilterMethod::FilterMethod;

  void filter(const View&, const Defocus& defocus, Frame& frame) override {
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, defocus), defocus);
    forEachTile([&](int tile, auto&&...) { discs_.spreadOnto(tile, frame.rgba); });
  }
};

}  // namespace

MethodEntry potmesilMethod() {
  return filterEntry<PotmesilMethod>(
      {.name = "potmesil",
       .summary = "each pixel of the pinhole image spread evenly over its circle of confusion",
       .source = "Potmesil and Chakravarty 1981; Chen 1987",
       .family = MethodFamily::post_filter});
}

}  // namespace foci
