// An OpenXR runtime without a headset, for tests. It scripts head and gaze, refuses whatever a
// client does wrong, and writes what a headset would show.
//
// FOCI_FAKE_OPENXR has words, between spaces, that change it:
//   no_gaze_extension, no_tracker, no_headset, no_srgb, denied   what it lacks
//   sample_time_0     it does not know when gaze was measured
//   blinks            0.2 s without gaze every 2 s
//   degraded          gaze is inferred
//   jumps             gaze jumps to the other side every 0.5 s
//   gaze=RIGHT,UP     degrees
//   eye=WIDTH,HEIGHT  px that it recommends
//   late=N            every N frames the display skips one
//   lost=N, exit=N    after N frames the session is lost, or ends
//   still             the head stays as it was at 0 s
//   real              time passes; else each frame takes its period
// FOCI_FAKE_OPENXR_OUT is the folder of log.txt and of the images that were shown.
#define GL_GLEXT_PROTOTYPES
#include "tests/fake_openxr/fake_openxr.h"

#include "app/headset/openxr_api.h"
//
#include <GL/gl.h>
#include <GL/glext.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace fake_openxr;
using namespace std::chrono;

std::recursive_mutex mutex;  // of all below
std::map<std::string, std::string> words;
std::ofstream log_file;
std::string folder;
std::int64_t virtual_ns = 0;
steady_clock::time_point begun;
std::deque<XrSessionState> events;
bool asked_requirements = false, running = false, focused = false, lost = false, exits = false;
bool waited = false, begun_frame = false;
std::int64_t predicted_ns = 0;
int frames = 0, images_written = 0;
void* context = nullptr;
bool egl = false;

struct Chain {
  std::int64_t format = 0;
  int width = 0, height = 0, next = 0, acquired = -1, shown = -1;
  bool waited = false, is_new = false;
  std::array<GLuint, 3> textures{};
} chain;

bool has(const char* word) { return words.contains(word); }
int number(const char* word) { return has(word) ? std::atoi(words[word].c_str()) : 0; }

void readWords() {
  words.clear();
  std::istringstream text(std::getenv("FOCI_FAKE_OPENXR") ? std::getenv("FOCI_FAKE_OPENXR") : "");
  for (std::string word; text >> word;) {
    const auto equals = word.find('=');
    words[word.substr(0, equals)] = equals == word.npos ? "" : word.substr(equals + 1);
  }
}

glm::dvec2 pairOf(const char* word, const glm::dvec2& otherwise) {
  if (!has(word)) return otherwise;
  glm::dvec2 pair;
  std::sscanf(words[word].c_str(), "%lf,%lf", &pair.x, &pair.y);
  return pair;
}

template <class... Parts>
void note(const Parts&... parts) {
  ((log_file << parts), ...) << std::endl;
}

template <class... Parts>
XrResult violated(const Parts&... parts) {
  note("VIOLATION: ", parts...);
  return XR_ERROR_VALIDATION_FAILURE;
}

std::int64_t nowSinceBegin_ns() {
  return has("real") ? duration_cast<nanoseconds>(steady_clock::now() - begun).count() : virtual_ns;
}
XrTime now() { return kEpoch_ns + nowSinceBegin_ns(); }
double scriptSeconds(XrTime time) { return 1e-9 * static_cast<double>(time - kEpoch_ns); }
Pose headNow(XrTime time) { return headAt(has("still") ? 0.0 : scriptSeconds(time)); }

bool isCurrent() {
  return context == (egl ? static_cast<void*>(eglGetCurrentContext())
                         : static_cast<void*>(glXGetCurrentContext()));
}

#define FAKE_REQUIRE(holds, ...) \
  if (!(holds)) return violated(__func__, ": ", __VA_ARGS__)
#define FAKE_LOCK const std::lock_guard lock(mutex)

XrPosef xrPose(const Pose& pose) {
  const glm::quat q(pose.rotation);
  const glm::vec3 p(pose.position_m);
  return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}
Pose poseOf(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return {{p.x, p.y, p.z}, glm::dquat(q.w, q.x, q.y, q.z)};
}
Pose operator*(const Pose& a, const Pose& b) {
  return {a.position_m + a.rotation * b.position_m, a.rotation * b.rotation};
}
Pose inverse(const Pose& a) {
  const glm::dquat q = glm::inverse(a.rotation);
  return {q * -a.position_m, q};
}
bool alike(const Pose& a, const Pose& b) {
  return glm::distance(a.position_m, b.position_m) < 1e-5 &&
         std::abs(glm::dot(a.rotation, b.rotation)) > 1.0 - 1e-7;
}

XrFovf fieldOf(int side) {
  const auto rad = [&](int i) { return static_cast<float>(glm::radians(kFields_deg[side][i])); };
  return {-rad(0), rad(1), rad(2), -rad(3)};
}

template <class T>
T handle(std::uintptr_t number) {
  return reinterpret_cast<T>(number);
}
constexpr std::uintptr_t kInstance = 1, kSession = 2, kLocal = 3, kView = 4, kGaze = 5, kChain = 6,
                         kActions = 7, kLook = 8;

/// Fills an array that the client asks for twice.
template <class From, class To, class Put>
XrResult enumerate(const std::vector<From>& all, std::uint32_t room, std::uint32_t* count, To* to,
                   const Put& put) {
  *count = static_cast<std::uint32_t>(all.size());
  if (room == 0) return XR_SUCCESS;
  if (room < all.size()) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < all.size(); ++i) put(all[i], to[i]);
  return XR_SUCCESS;
}

XrResult enumerateExtensions(const char*, std::uint32_t room, std::uint32_t* count,
                             XrExtensionProperties* to) {
  readWords();
  std::vector<const char*> names{"XR_KHR_convert_timespec_time", "XR_MNDX_egl_enable",
                                 "XR_KHR_opengl_enable"};
  if (!has("no_gaze_extension")) names.push_back("XR_EXT_eye_gaze_interaction");
  return enumerate(names, room, count, to, [](const char* name, XrExtensionProperties& property) {
    std::strcpy(property.extensionName, name);
    property.extensionVersion = 1;
  });
}

XrResult createInstance(const XrInstanceCreateInfo*, XrInstance* instance) {
  FAKE_LOCK;
  readWords();
  const char* const out = std::getenv("FOCI_FAKE_OPENXR_OUT");
  folder = out ? out : "";
  log_file = out ? std::ofstream(folder + "/log.txt") : std::ofstream();
  virtual_ns = 0;
  begun = steady_clock::now();
  events.clear();
  asked_requirements = running = focused = lost = exits = waited = begun_frame = false;
  frames = images_written = 0;
  chain = {};
  *instance = handle<XrInstance>(kInstance);
  return XR_SUCCESS;
}

XrResult destroyInstance(XrInstance) {
  note("end");
  return XR_SUCCESS;
}

XrResult getInstanceProperties(XrInstance, XrInstanceProperties* properties) {
  std::strcpy(properties->runtimeName, "Fake");
  properties->runtimeVersion = XR_MAKE_VERSION(1, 2, 3);
  return XR_SUCCESS;
}

XrResult pollEvent(XrInstance, XrEventDataBuffer* buffer) {
  FAKE_LOCK;
  if (events.empty()) return XR_EVENT_UNAVAILABLE;
  auto& changed = reinterpret_cast<XrEventDataSessionStateChanged&>(*buffer);
  changed.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
  changed.next = nullptr;
  changed.session = handle<XrSession>(kSession);
  changed.state = events.front();
  changed.time = now();
  note("state ", changed.state);
  events.pop_front();
  return XR_SUCCESS;
}

XrResult resultToString(XrInstance, XrResult result, char* text) {
  std::snprintf(text, XR_MAX_RESULT_STRING_SIZE, "%s",
                result == XR_ERROR_SESSION_LOST         ? "XR_ERROR_SESSION_LOST"
                : result == XR_ERROR_VALIDATION_FAILURE ? "XR_ERROR_VALIDATION_FAILURE"
                                                        : "XR_OTHER");
  return XR_SUCCESS;
}

XrResult structureToString(XrInstance, XrStructureType, char* text) {
  std::strcpy(text, "a structure");
  return XR_SUCCESS;
}

XrResult stringToPath(XrInstance, const char* text, XrPath* path) {
  static const std::set<std::string> known{"/interaction_profiles/ext/eye_gaze_interaction",
                                           "/user/eyes_ext/input/gaze_ext/pose"};
  FAKE_REQUIRE(known.contains(text), text);
  *path = 1 + static_cast<XrPath>(std::distance(known.begin(), known.find(text)));
  return XR_SUCCESS;
}

XrResult getSystem(XrInstance, const XrSystemGetInfo* info, XrSystemId* system) {
  FAKE_REQUIRE(info->formFactor == XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY, "form factor");
  if (has("no_headset")) return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  *system = 1;
  return XR_SUCCESS;
}

XrResult getSystemProperties(XrInstance, XrSystemId, XrSystemProperties* properties) {
  std::strcpy(properties->systemName, "Fake headset");
  properties->graphicsProperties = {2000, 4000, 16};
  if (properties->next) {
    auto* const gaze = static_cast<XrSystemEyeGazeInteractionPropertiesEXT*>(properties->next);
    gaze->supportsEyeGazeInteraction = !has("no_tracker");
  }
  return XR_SUCCESS;
}

XrResult enumerateViews(XrInstance, XrSystemId, XrViewConfigurationType, std::uint32_t room,
                        std::uint32_t* count, XrViewConfigurationView* views) {
  const glm::dvec2 eye_px = pairOf("eye", {64.0, 60.0});
  return enumerate(std::vector<int>{0, 1}, room, count, views, [&](int, auto& view) {
    view.recommendedImageRectWidth = static_cast<std::uint32_t>(eye_px.x);
    view.recommendedImageRectHeight = static_cast<std::uint32_t>(eye_px.y);
    view.maxImageRectWidth = view.maxImageRectHeight = 2000;
    view.recommendedSwapchainSampleCount = view.maxSwapchainSampleCount = 1;
  });
}

XrResult getRequirements(XrInstance, XrSystemId, XrGraphicsRequirementsOpenGLKHR* needs) {
  needs->minApiVersionSupported = XR_MAKE_VERSION(3, 3, 0);
  needs->maxApiVersionSupported = XR_MAKE_VERSION(5, 0, 0);
  asked_requirements = true;
  return XR_SUCCESS;
}

XrResult timeOf(XrInstance, const timespec* from, XrTime* to) {
  FAKE_LOCK;
  const auto steady = seconds(from->tv_sec) + nanoseconds(from->tv_nsec);
  *to = has("real") ? kEpoch_ns + (steady - begun.time_since_epoch()).count() : now();
  return XR_SUCCESS;
}

XrResult timespecOf(XrInstance, XrTime from, timespec* to) {
  FAKE_LOCK;
  const std::int64_t base = has("real") ? begun.time_since_epoch().count() : 0;
  const std::int64_t ns = base + from - kEpoch_ns;
  *to = {ns / 1'000'000'000, ns % 1'000'000'000};
  return XR_SUCCESS;
}

XrResult createSession(XrInstance, const XrSessionCreateInfo* info, XrSession* session) {
  FAKE_LOCK;
  FAKE_REQUIRE(asked_requirements, "before xrGetOpenGLGraphicsRequirementsKHR");
  FAKE_REQUIRE(info->next, "no binding");
  if (has("denied")) return static_cast<XrResult>(-1000710000);
  const auto* const base = static_cast<const XrBaseInStructure*>(info->next);
  egl = base->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX;
  context = egl ? static_cast<const XrGraphicsBindingEGLMNDX*>(info->next)->context
                : static_cast<void*>(
                      static_cast<const XrGraphicsBindingOpenGLXlibKHR*>(info->next)->glxContext);
  FAKE_REQUIRE(context && isCurrent(), "the context is not current in this thread");
  events = {XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY};
  *session = handle<XrSession>(kSession);
  return XR_SUCCESS;
}

XrResult destroySession(XrSession) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  note("session destroyed");
  return XR_SUCCESS;
}

XrResult beginSession(XrSession, const XrSessionBeginInfo* info) {
  FAKE_LOCK;
  FAKE_REQUIRE(!running, "twice");
  FAKE_REQUIRE(info->primaryViewConfigurationType == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
               "views");
  running = true;
  events.push_back(XR_SESSION_STATE_SYNCHRONIZED);
  return XR_SUCCESS;
}

XrResult endSession(XrSession) {
  FAKE_LOCK;
  FAKE_REQUIRE(running && exits, "not stopping");
  running = focused = false;
  events.push_back(XR_SESSION_STATE_IDLE);
  events.push_back(XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

XrResult requestExit(XrSession) {
  FAKE_LOCK;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(running, "does not run");
  exits = true;
  events.push_back(XR_SESSION_STATE_STOPPING);
  return XR_SUCCESS;
}

XrResult enumerateSpaces(XrSession, std::uint32_t room, std::uint32_t* count,
                         XrReferenceSpaceType* types) {
  return enumerate(std::vector{XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL}, room,
                   count, types, [](auto from, auto& to) { to = from; });
}

XrResult createSpace(XrSession, const XrReferenceSpaceCreateInfo* info, XrSpace* space) {
  const bool local = info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_LOCAL;
  FAKE_REQUIRE(local || info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_VIEW, "space");
  FAKE_REQUIRE(info->poseInReferenceSpace.orientation.w == 1.0f, "pose");
  *space = handle<XrSpace>(local ? kLocal : kView);
  return XR_SUCCESS;
}

XrResult createActionSpace(XrSession, const XrActionSpaceCreateInfo* info, XrSpace* space) {
  FAKE_REQUIRE(info->action == handle<XrAction>(kLook), "action");
  *space = handle<XrSpace>(kGaze);
  return XR_SUCCESS;
}

XrResult locateSpace(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* location) {
  FAKE_LOCK;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(std::abs(time - now()) < 1'000'000'000, "the time ", time, " is not near ", now());
  if (space == handle<XrSpace>(kView)) {
    FAKE_REQUIRE(base == handle<XrSpace>(kLocal), "base of the head");
    location->pose = xrPose(headNow(time));
    // The position is inferred, as that of a headset without position tracking.
    location->locationFlags = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                              XR_SPACE_LOCATION_POSITION_VALID_BIT |
                              XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
    return XR_SUCCESS;
  }
  FAKE_REQUIRE(space == handle<XrSpace>(kGaze) && base == handle<XrSpace>(kView), "space of gaze");
  const double sample = std::floor(scriptSeconds(time) * kGaze_Hz), time_s = sample / kGaze_Hz;
  const glm::dvec2 gaze_deg = pairOf("gaze", {10.0, 5.0});
  const double side = has("jumps") && std::fmod(time_s, 1.0) >= 0.5 ? -1.0 : 1.0;
  location->pose = xrPose({glm::dvec3(0.0), turned(side * gaze_deg.x, gaze_deg.y)});
  location->locationFlags =
      XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
  if (!has("degraded")) {
    location->locationFlags |=
        XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
  }
  if (has("blinks") && std::fmod(time_s, 2.0) < 0.2) location->locationFlags = 0;
  if (auto* const measured = static_cast<XrEyeGazeSampleTimeEXT*>(location->next)) {
    measured->time = has("sample_time_0") ? 0 : kEpoch_ns + std::llround(1e9 * time_s);
  }
  return XR_SUCCESS;
}

XrResult locateViews(XrSession, const XrViewLocateInfo* info, XrViewState* state,
                     std::uint32_t room, std::uint32_t* count, XrView* views) {
  FAKE_LOCK;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(info->displayTime > 0 && std::abs(info->displayTime - now()) < 1'000'000'000,
               "time");
  const bool in_head = info->space == handle<XrSpace>(kView);
  const Pose head = in_head ? Pose{} : headNow(info->displayTime);
  state->viewStateFlags = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT |
                          XR_VIEW_STATE_ORIENTATION_TRACKED_BIT;
  return enumerate(std::vector<int>{0, 1}, room, count, views, [&](int side, XrView& view) {
    view.pose = xrPose(head * kEyes.at(static_cast<std::size_t>(side)));
    view.fov = fieldOf(side);
  });
}

XrResult enumerateFormats(XrSession, std::uint32_t room, std::uint32_t* count, std::int64_t* to) {
  std::vector<std::int64_t> formats{GL_RGBA16, GL_RGBA8, GL_SRGB8_ALPHA8};  // the worst first
  if (has("no_srgb")) formats.pop_back();
  return enumerate(formats, room, count, to, [](auto from, auto& into) { into = from; });
}

XrResult createSwapchain(XrSession, const XrSwapchainCreateInfo* info, XrSwapchain* swapchain) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  FAKE_REQUIRE(
      info->sampleCount == 1 && info->faceCount == 1 && info->arraySize == 1 && info->mipCount == 1,
      "counts");
  FAKE_REQUIRE((info->usageFlags & XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT) != 0, "usage");
  chain = {.format = info->format,
           .width = static_cast<int>(info->width),
           .height = static_cast<int>(info->height)};
  glGenTextures(3, chain.textures.data());
  for (const GLuint texture : chain.textures) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexStorage2D(GL_TEXTURE_2D, 1, static_cast<GLenum>(info->format), chain.width, chain.height);
  }
  glBindTexture(GL_TEXTURE_2D, 0);
  note("swapchain ", chain.format, ' ', chain.width, 'x', chain.height);
  *swapchain = handle<XrSwapchain>(kChain);
  return XR_SUCCESS;
}

XrResult destroySwapchain(XrSwapchain) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  glDeleteTextures(3, chain.textures.data());
  chain = {};
  return XR_SUCCESS;
}

XrResult enumerateImages(XrSwapchain, std::uint32_t room, std::uint32_t* count,
                         XrSwapchainImageBaseHeader* images) {
  return enumerate(std::vector<GLuint>(chain.textures.begin(), chain.textures.end()), room, count,
                   reinterpret_cast<XrSwapchainImageOpenGLKHR*>(images),
                   [](GLuint texture, auto& image) { image.image = texture; });
}

XrResult acquireImage(XrSwapchain, const XrSwapchainImageAcquireInfo*, std::uint32_t* index) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  FAKE_REQUIRE(chain.acquired < 0, "twice");
  chain.acquired = chain.next;
  chain.next = (chain.next + 1) % 3;
  chain.waited = false;
  *index = static_cast<std::uint32_t>(chain.acquired);
  return XR_SUCCESS;
}

XrResult waitImage(XrSwapchain, const XrSwapchainImageWaitInfo*) {
  FAKE_LOCK;
  FAKE_REQUIRE(chain.acquired >= 0 && !chain.waited, "nothing acquired");
  chain.waited = true;
  return XR_SUCCESS;
}

XrResult releaseImage(XrSwapchain, const XrSwapchainImageReleaseInfo*) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  FAKE_REQUIRE(chain.acquired >= 0 && chain.waited, "not waited for");
  FAKE_REQUIRE(begun_frame, "outside a frame");
  chain.shown = std::exchange(chain.acquired, -1);
  chain.is_new = true;
  return XR_SUCCESS;
}

XrResult waitFrame(XrSession, const XrFrameWaitInfo*, XrFrameState* state) {
  std::unique_lock lock(mutex);
  if (has("lost") && frames >= number("lost")) lost = true;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(running, "before xrBeginSession");
  FAKE_REQUIRE(!waited, "without xrBeginFrame before");
  constexpr auto kPeriod_ns = static_cast<std::int64_t>(1e9 * kPeriod_s);
  const int skips = has("late") && frames % number("late") == number("late") - 1 ? 2 : 1;
  if (has("real")) {
    lock.unlock();
    std::this_thread::sleep_until(
        begun + nanoseconds((nowSinceBegin_ns() / kPeriod_ns + skips) * kPeriod_ns));
    lock.lock();
  } else {
    virtual_ns += skips * kPeriod_ns;
  }
  waited = true;
  state->predictedDisplayTime = predicted_ns = (now() / kPeriod_ns + 2) * kPeriod_ns;
  state->predictedDisplayPeriod = kPeriod_ns;
  state->shouldRender = frames > 0;
  return XR_SUCCESS;
}

XrResult beginFrame(XrSession, const XrFrameBeginInfo*) {
  FAKE_LOCK;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  FAKE_REQUIRE(waited && !begun_frame, "without xrWaitFrame");
  waited = false;
  begun_frame = true;
  return XR_SUCCESS;
}

/// What a display shows of the image that was released last: the code that it is sent.
void writeImage() {
  constexpr int kImages = 400;
  if (folder.empty() || images_written >= kImages) return;
  std::vector<unsigned char> rgba(4 * static_cast<std::size_t>(chain.width) * chain.height);
  GLuint buffer = 0;
  glGenFramebuffers(1, &buffer);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, buffer);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                         chain.textures.at(static_cast<std::size_t>(chain.shown)), 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, chain.width, chain.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &buffer);
  const auto shown = [](unsigned char value) {
    if (chain.format == GL_SRGB8_ALPHA8) return static_cast<char>(value);  // it holds codes
    const double light = value / 255.0;                                    // it holds light
    const double code =
        light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    return static_cast<char>(std::lround(255.0 * code));
  };
  std::ofstream file(folder + "/shown-" + std::to_string(frames) + ".ppm", std::ios::binary);
  file << "P6\n" << chain.width << ' ' << chain.height << "\n255\n";
  for (int y = chain.height - 1; y >= 0; --y) {  // its origin is at the bottom
    for (int x = 0; x < chain.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        file.put(shown(rgba.at(4 * static_cast<std::size_t>(y * chain.width + x) + c)));
      }
    }
  }
  ++images_written;
}

XrResult checkLayer(const XrFrameEndInfo& info) {
  const auto& layer = *reinterpret_cast<const XrCompositionLayerProjection*>(info.layers[0]);
  FAKE_REQUIRE(layer.type == XR_TYPE_COMPOSITION_LAYER_PROJECTION, "kind of layer");
  FAKE_REQUIRE(layer.space == handle<XrSpace>(kLocal) && layer.viewCount == 2, "views");
  std::array<Pose, 2> poses;
  for (int side = 0; side < 2; ++side) {
    const XrCompositionLayerProjectionView& view = layer.views[side];
    FAKE_REQUIRE(view.subImage.swapchain == handle<XrSwapchain>(kChain), "swapchain");
    const auto& [offset, extent] = view.subImage.imageRect;
    FAKE_REQUIRE(offset.x >= 0 && offset.y >= 0 && extent.width > 0 && extent.height > 0 &&
                     offset.x + extent.width <= chain.width &&
                     offset.y + extent.height <= chain.height,
                 "rectangle");
    const XrFovf is = view.fov, should = fieldOf(side);
    FAKE_REQUIRE(std::abs(is.angleLeft - should.angleLeft) < 1e-6 &&
                     std::abs(is.angleRight - should.angleRight) < 1e-6 &&
                     std::abs(is.angleUp - should.angleUp) < 1e-6 &&
                     std::abs(is.angleDown - should.angleDown) < 1e-6,
                 "field of view");
    poses.at(static_cast<std::size_t>(side)) = poseOf(view.pose);
    FAKE_REQUIRE(
        std::abs(glm::length(poses.at(static_cast<std::size_t>(side)).rotation) - 1.0) < 1e-5,
        "length of a quaternion");
  }
  FAKE_REQUIRE(
      layer.views[0].subImage.imageRect.offset.x < layer.views[1].subImage.imageRect.offset.x,
      "the left eye is not at the left");
  const Pose head = poses[0] * inverse(kEyes[0]);
  FAKE_REQUIRE(alike(head, poses[1] * inverse(kEyes[1])), "the eyes are not on one head");
  const glm::dvec3 at = head.position_m, sight = head.rotation * glm::dvec3(0.0, 0.0, -1.0);
  log_file.precision(9);
  note("frame ", frames, " at ", scriptSeconds(info.displayTime), " head ", at.x, ' ', at.y, ' ',
       at.z, " sight ", sight.x, ' ', sight.y, ' ', sight.z, chain.is_new ? " new" : " again");
  return XR_SUCCESS;
}

XrResult endFrame(XrSession, const XrFrameEndInfo* info) {
  FAKE_LOCK;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(isCurrent(), "the context is not current in this thread");
  FAKE_REQUIRE(begun_frame, "without xrBeginFrame");
  FAKE_REQUIRE(info->displayTime == predicted_ns, "display time");
  FAKE_REQUIRE(info->environmentBlendMode == XR_ENVIRONMENT_BLEND_MODE_OPAQUE, "blend mode");
  FAKE_REQUIRE(info->layerCount <= 1, "layers");
  begun_frame = false;
  if (info->layerCount == 1) {
    FAKE_REQUIRE(frames > 0, "a layer though nothing is shown");
    FAKE_REQUIRE(chain.shown >= 0 && chain.acquired < 0, "no image was released");
    if (const XrResult result = checkLayer(*info); result != XR_SUCCESS) return result;
    if (std::exchange(chain.is_new, false)) writeImage();
  }
  if (++frames == 1) {
    events.push_back(XR_SESSION_STATE_VISIBLE);
    events.push_back(XR_SESSION_STATE_FOCUSED);
    focused = true;
  }
  if (has("exit") && frames == number("exit")) {
    exits = true;
    events.push_back(XR_SESSION_STATE_STOPPING);
  }
  return XR_SUCCESS;
}

XrResult createActionSet(XrInstance, const XrActionSetCreateInfo* info, XrActionSet* set) {
  FAKE_REQUIRE(info->actionSetName[0] && info->localizedActionSetName[0], "names");
  *set = handle<XrActionSet>(kActions);
  return XR_SUCCESS;
}

XrResult createAction(XrActionSet, const XrActionCreateInfo* info, XrAction* action) {
  FAKE_REQUIRE(info->actionType == XR_ACTION_TYPE_POSE_INPUT, "type");
  *action = handle<XrAction>(kLook);
  return XR_SUCCESS;
}

XrResult suggest(XrInstance, const XrInteractionProfileSuggestedBinding* binding) {
  FAKE_REQUIRE(binding->countSuggestedBindings == 1 && binding->interactionProfile == 1 &&
                   binding->suggestedBindings[0].binding == 2 &&
                   binding->suggestedBindings[0].action == handle<XrAction>(kLook),
               "binding");
  return XR_SUCCESS;
}

XrResult attach(XrSession, const XrSessionActionSetsAttachInfo* info) {
  FAKE_REQUIRE(info->countActionSets == 1 && info->actionSets[0] == handle<XrActionSet>(kActions),
               "sets");
  return XR_SUCCESS;
}

XrResult syncActions(XrSession, const XrActionsSyncInfo* info) {
  FAKE_LOCK;
  if (lost) return XR_ERROR_SESSION_LOST;
  FAKE_REQUIRE(info->countActiveActionSets == 1, "sets");
  return focused ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

XrResult getPose(XrSession, const XrActionStateGetInfo* info, XrActionStatePose* state) {
  FAKE_REQUIRE(info->action == handle<XrAction>(kLook), "action");
  state->isActive = has("no_tracker") ? XR_FALSE : XR_TRUE;
  return XR_SUCCESS;
}

XrResult addressOf(XrInstance, const char* name, PFN_xrVoidFunction* function) {
#define FAKE(name, function) \
  { "xr" #name, reinterpret_cast<PFN_xrVoidFunction>(function) }
  static const std::map<std::string, PFN_xrVoidFunction> all{
      FAKE(GetInstanceProcAddr, addressOf),
      FAKE(EnumerateInstanceExtensionProperties, enumerateExtensions),
      FAKE(CreateInstance, createInstance),
      FAKE(DestroyInstance, destroyInstance),
      FAKE(GetInstanceProperties, getInstanceProperties),
      FAKE(PollEvent, pollEvent),
      FAKE(ResultToString, resultToString),
      FAKE(StructureTypeToString, structureToString),
      FAKE(StringToPath, stringToPath),
      FAKE(GetSystem, getSystem),
      FAKE(GetSystemProperties, getSystemProperties),
      FAKE(EnumerateViewConfigurationViews, enumerateViews),
      FAKE(GetOpenGLGraphicsRequirementsKHR, getRequirements),
      FAKE(ConvertTimespecTimeToTimeKHR, timeOf),
      FAKE(ConvertTimeToTimespecTimeKHR, timespecOf),
      FAKE(CreateSession, createSession),
      FAKE(DestroySession, destroySession),
      FAKE(BeginSession, beginSession),
      FAKE(EndSession, endSession),
      FAKE(RequestExitSession, requestExit),
      FAKE(EnumerateReferenceSpaces, enumerateSpaces),
      FAKE(CreateReferenceSpace, createSpace),
      FAKE(CreateActionSpace, createActionSpace),
      FAKE(LocateSpace, locateSpace),
      FAKE(LocateViews, locateViews),
      FAKE(EnumerateSwapchainFormats, enumerateFormats),
      FAKE(CreateSwapchain, createSwapchain),
      FAKE(DestroySwapchain, destroySwapchain),
      FAKE(EnumerateSwapchainImages, enumerateImages),
      FAKE(AcquireSwapchainImage, acquireImage),
      FAKE(WaitSwapchainImage, waitImage),
      FAKE(ReleaseSwapchainImage, releaseImage),
      FAKE(WaitFrame, waitFrame),
      FAKE(BeginFrame, beginFrame),
      FAKE(EndFrame, endFrame),
      FAKE(CreateActionSet, createActionSet),
      FAKE(CreateAction, createAction),
      FAKE(SuggestInteractionProfileBindings, suggest),
      FAKE(AttachSessionActionSets, attach),
      FAKE(SyncActions, syncActions),
      FAKE(GetActionStatePose, getPose)};
  const auto found = all.find(name);
  *function = found == all.end() ? nullptr : found->second;
  return *function ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

/// From the loader's specification; Debian 12 has no header for it.
struct LoaderInfo {
  int type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t least_interface, most_interface;
  XrVersion least_api, most_api;
};
struct RuntimeRequest {
  int type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface;
  XrVersion api;
  PFN_xrGetInstanceProcAddr address_of;
};

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(
    const LoaderInfo*, RuntimeRequest* request) {
  request->interface = 1;
  request->api = XR_MAKE_VERSION(1, 0, 20);
  request->address_of = addressOf;
  return XR_SUCCESS;
}
