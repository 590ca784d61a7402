#include "app/headset/openxr_api.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/shared_library.h"
#include "base/text.h"
#include "base/transformed.h"

namespace foci {
namespace {

constexpr const char* kEglBinding = "XR_MNDX_egl_enable";

[[noreturn]] void refuse(const std::string& what) { throw InputError("--headset", what); }

std::vector<std::string> extensionsOf(PFN_xrEnumerateInstanceExtensionProperties enumerate) {
  std::uint32_t count = 0;
  if (XR_FAILED(enumerate(nullptr, 0, &count, nullptr))) {
    refuse(
        "no OpenXR runtime: expected one that is installed and active (SteamVR, Monado, the "
        "headset's own), or its JSON file in XR_RUNTIME_JSON");
  }
  std::vector<XrExtensionProperties> all(count,
                                         xrOf<XrExtensionProperties>(XR_TYPE_EXTENSION_PROPERTIES));
  enumerate(nullptr, count, &count, all.data());
  return transformed(all, [](const auto& each) { return std::string(each.extensionName); });
}

template <class Function>
void find(PFN_xrGetInstanceProcAddr address_of, XrInstance instance, const std::string& name,
          Function& function) {
  PFN_xrVoidFunction found = nullptr;
  if (XR_FAILED(address_of(instance, name.c_str(), &found)) || !found) {
    refuse("the OpenXR runtime has no " + name + ": expected OpenXR 1.0");
  }
  function = reinterpret_cast<Function>(found);
}

}  // namespace

std::string OpenXrApi::textOf(XrResult result) const {
  std::array<char, XR_MAX_RESULT_STRING_SIZE> text{};
  if (ResultToString && XR_SUCCEEDED(ResultToString(instance, result, text.data()))) {
    return text.data();
  }
  return "OpenXR error " + std::to_string(result);
}

OpenXrApi openOpenXr(const std::string& loader, bool egl) {
  void* const library = openLibrary(loader);
  void* const entry = library ? symbolIn(library, "xrGetInstanceProcAddr") : nullptr;
  if (!entry) {
    refuse("no OpenXR loader: expected " + loader + " (the package libopenxr-loader1)");
  }
  const auto address_of = reinterpret_cast<PFN_xrGetInstanceProcAddr>(entry);
  const QuietStderr quiet;  // without a runtime the loader prints five lines
  PFN_xrEnumerateInstanceExtensionProperties enumerate = nullptr;
  PFN_xrCreateInstance create = nullptr;
  find(address_of, XR_NULL_HANDLE, "xrEnumerateInstanceExtensionProperties", enumerate);
  find(address_of, XR_NULL_HANDLE, "xrCreateInstance", create);

  const std::vector<std::string> offered = extensionsOf(enumerate);
  const auto has = [&](std::string_view name) {
    return std::ranges::find(offered, name) != offered.end();
  };
  std::vector<const char*> wanted{XR_KHR_OPENGL_ENABLE_EXTENSION_NAME,
                                  XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME};
  if (egl) wanted.push_back(kEglBinding);
  for (const char* const name : wanted) {
    if (!has(name)) refuse(std::string("the OpenXR runtime has no ") + name + ", which foci needs");
  }
  OpenXrApi xr;
  xr.has_gaze = has(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);
  if (xr.has_gaze) wanted.push_back(XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME);

  auto info = xrOf<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  std::string("foci").copy(info.applicationInfo.applicationName, XR_MAX_APPLICATION_NAME_SIZE - 1);
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 20);
  info.enabledExtensionCount = static_cast<std::uint32_t>(wanted.size());
  info.enabledExtensionNames = wanted.data();
  if (const XrResult result = create(&info, &xr.instance); XR_FAILED(result)) {
    refuse("the OpenXR runtime does not start (error " + std::to_string(result) +
           "): expected one that runs");
  }
#define FOCI_XR_FIND(name) find(address_of, xr.instance, "xr" #name, xr.name);
  FOCI_XR_FUNCTIONS(FOCI_XR_FIND)
#undef FOCI_XR_FIND
  auto properties = xrOf<XrInstanceProperties>(XR_TYPE_INSTANCE_PROPERTIES);
  xr.GetInstanceProperties(xr.instance, &properties);
  const XrVersion version = properties.runtimeVersion;
  xr.name = std::string(properties.runtimeName) + ' ' + std::to_string(XR_VERSION_MAJOR(version)) +
            '.' + std::to_string(XR_VERSION_MINOR(version)) + '.' +
            std::to_string(XR_VERSION_PATCH(version));
  return xr;
}

}  // namespace foci
