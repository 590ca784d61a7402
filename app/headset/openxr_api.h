// The functions of OpenXR 1.0 that foci calls. The loader is opened while the program runs, so
// that it starts without one.
#pragma once

#include <X11/Xlib.h>
//
#include <EGL/egl.h>
#include <GL/glx.h>

#include <ctime>
#include <string>

#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_XLIB
#define XR_USE_PLATFORM_EGL
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

// X11 gives these words away.
#undef None
#undef Bool
#undef Always
#undef Status
#undef Success

#define FOCI_XR_FUNCTIONS(X)           \
  X(DestroyInstance)                   \
  X(GetInstanceProperties)             \
  X(PollEvent)                         \
  X(ResultToString)                    \
  X(StringToPath)                      \
  X(GetSystem)                         \
  X(GetSystemProperties)               \
  X(EnumerateViewConfigurationViews)   \
  X(GetOpenGLGraphicsRequirementsKHR)  \
  X(ConvertTimespecTimeToTimeKHR)      \
  X(ConvertTimeToTimespecTimeKHR)      \
  X(CreateSession)                     \
  X(DestroySession)                    \
  X(BeginSession)                      \
  X(EndSession)                        \
  X(RequestExitSession)                \
  X(CreateReferenceSpace)              \
  X(CreateActionSpace)                 \
  X(LocateSpace)                       \
  X(LocateViews)                       \
  X(EnumerateSwapchainFormats)         \
  X(CreateSwapchain)                   \
  X(DestroySwapchain)                  \
  X(EnumerateSwapchainImages)          \
  X(AcquireSwapchainImage)             \
  X(WaitSwapchainImage)                \
  X(ReleaseSwapchainImage)             \
  X(WaitFrame)                         \
  X(BeginFrame)                        \
  X(EndFrame)                          \
  X(CreateActionSet)                   \
  X(CreateAction)                      \
  X(SuggestInteractionProfileBindings) \
  X(AttachSessionActionSets)           \
  X(SyncActions)                       \
  X(GetActionStatePose)

namespace foci {

inline constexpr const char* kOpenXrLoader = "libopenxr_loader.so.1";

struct OpenXrApi {
#define FOCI_XR_MEMBER(name) PFN_xr##name name = nullptr;
  FOCI_XR_FUNCTIONS(FOCI_XR_MEMBER)
#undef FOCI_XR_MEMBER
  XrInstance instance = XR_NULL_HANDLE;
  bool has_gaze = false;  ///< XR_EXT_eye_gaze_interaction
  std::string name{};     ///< of the runtime, with its version

  /// "XR_ERROR_..."
  std::string textOf(XrResult result) const;
};

/// An OpenXR structure of this type, all else 0.
template <class T>
T xrOf(XrStructureType type) {
  T structure{};
  structure.type = type;
  return structure;
}

/// Opens the loader and an instance of its runtime.
/// @param egl  the session's context is of EGL; else of GLX
/// @throws InputError which says what is missing, and what to do
OpenXrApi openOpenXr(const std::string& loader, bool egl);

}  // namespace foci
