// The published methods, for comparison. They are a library of their own, foci::literature.
#pragma once

namespace foci {

/// Adds them to `methods()`; a second call does nothing. As `registerMethod`, before other threads
/// use methods.
void registerLiterature();

}  // namespace foci
