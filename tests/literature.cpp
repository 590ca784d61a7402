// Linked into programs of tests: their methods are those of `foci`.
#include "render/literature/literature.h"

namespace {
[[maybe_unused]] const bool kRegistered = (foci::registerLiterature(), true);
}
