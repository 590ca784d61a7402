#include "app/headset/headset.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include "app/headset/openxr_api.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <thread>
#include <utility>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr double kStart_s = 10.0, kEnd_s = 2.0;  // that runtimes take at most, by hand
constexpr XrViewConfigurationType kBothEyes = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
constexpr auto kNotPermitted = static_cast<XrResult>(-1000710000);  // newer than 1.0.20
constexpr XrPosef kNoPose{{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};

HeadInWorld poseOf(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return {.position_m = {p.x, p.y, p.z},
          .world_from_head = glm::normalize(glm::dquat(q.w, q.x, q.y, q.z))};
}

XrPosef xrPoseOf(const glm::dvec3& position_m, const glm::dquat& rotation) {
  const glm::quat q(rotation);
  const glm::vec3 p(position_m);
  return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}

EyeField fieldOf(const XrFovf& fov) {
  return {.left_deg = -glm::degrees(static_cast<double>(fov.angleLeft)),
          .right_deg = glm::degrees(static_cast<double>(fov.angleRight)),
          .up_deg = glm::degrees(static_cast<double>(fov.angleUp)),
          .down_deg = -glm::degrees(static_cast<double>(fov.angleDown))};
}

XrFovf xrFieldOf(const EyeField& field) {
  const auto rad = [](double deg) { return static_cast<float>(glm::radians(deg)); };
  return {-rad(field.left_deg), rad(field.right_deg), rad(field.up_deg), -rad(field.down_deg)};
}

bool isLost(XrResult result) {
  return result == XR_SESSION_LOSS_PENDING || result == XR_ERROR_SESSION_LOST ||
         result == XR_ERROR_INSTANCE_LOST;
}

/// What keeps a headset from starting.
std::string whyNot(const OpenXrApi& xr, XrResult result) {
  if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE || result == XR_ERROR_FORM_FACTOR_UNSUPPORTED) {
    return "no headset at " + xr.name + ": expected one that is connected and switched on";
  }
  if (result == kNotPermitted) {
    return xr.name + " does not permit it: expected the permission in its settings";
  }
  return xr.name + " answers " + xr.textOf(result);
}

double steadyNow_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr const char* kLost = "the headset's session is lost, as if it was unplugged";

}  // namespace

struct Headset::Parts {
  OpenXrApi xr;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrSession session = XR_NULL_HANDLE;
  XrSpace local = XR_NULL_HANDLE, head = XR_NULL_HANDLE, gaze = XR_NULL_HANDLE;
  XrActionSet actions = XR_NULL_HANDLE;
  XrAction look = XR_NULL_HANDLE;
  XrSwapchain chain = XR_NULL_HANDLE;
  std::vector<XrSwapchainImageOpenGLKHR> images{};
  glm::ivec2 chain_px{0}, most_px{0};
  XrFrameState frame = xrOf<XrFrameState>(XR_TYPE_FRAME_STATE);
  std::atomic<XrTime> predicted = 0, period = 0;
  std::atomic<bool> running = false;
  bool lost = false;
  std::array<XrCompositionLayerProjectionView, 2> views{};
  bool has_picture = false;
  GLuint from = 0, to = 0, uploaded = 0;  // frame buffers, a texture

  Parts(const std::string& loader, bool egl) : xr(openOpenXr(loader, egl)) {}
  ~Parts() {
    if (session != XR_NULL_HANDLE) xr.DestroySession(session);
    xr.DestroyInstance(xr.instance);
  }
  Parts& operator=(Parts&&) = delete;  // nor copied

  /// For all calls once the session runs.
  void check(XrResult result) {
    if (isLost(result)) lost = true;
    if (lost) throw HeadsetLost(std::string(kLost) + " (" + xr.textOf(result) + ")");
    if (XR_FAILED(result)) throw HeadsetLost(xr.name + " answers " + xr.textOf(result));
  }
  /// For those that start it.
  void require(XrResult result) const {
    if (XR_FAILED(result)) throw InputError("--headset", whyNot(xr, result));
  }

  XrTime now() const {
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                        std::chrono::steady_clock::now().time_since_epoch())
                        .count();
    const timespec time{ns / 1'000'000'000, ns % 1'000'000'000};
    XrTime converted = 0;
    xr.ConvertTimespecTimeToTimeKHR(xr.instance, &time, &converted);
    return converted;
  }
  double seconds(XrTime time) const {
    timespec converted{};
    xr.ConvertTimeToTimespecTimeKHR(xr.instance, time, &converted);
    return static_cast<double>(converted.tv_sec) + 1e-9 * static_cast<double>(converted.tv_nsec);
  }
  std::optional<HeadInWorld> headAt(XrTime time) const {
    auto location = xrOf<XrSpaceLocation>(XR_TYPE_SPACE_LOCATION);
    const bool valid = XR_SUCCEEDED(xr.LocateSpace(head, local, time, &location)) &&
                       (location.locationFlags & XR_SPACE_LOCATION_ORIENTATION_VALID_BIT) != 0;
    return valid ? std::optional(poseOf(location.pose)) : std::nullopt;
  }
  std::optional<HeadsetEyes> eyesAt(XrTime time) const;

  void openSystem(HeadsetFacts& facts);
  void openSession(const NativeGl& gl);
  XrSpace space(XrReferenceSpaceType type) const;
  std::string openGaze();
  void makeChain(const glm::ivec2& size_px);
  void draw(const HeadsetPicture& picture);
};

std::optional<HeadsetEyes> Headset::Parts::eyesAt(XrTime time) const {
  auto info = xrOf<XrViewLocateInfo>(XR_TYPE_VIEW_LOCATE_INFO);
  info.viewConfigurationType = kBothEyes;
  info.displayTime = time;
  info.space = head;
  auto state = xrOf<XrViewState>(XR_TYPE_VIEW_STATE);
  std::array<XrView, 2> located{xrOf<XrView>(XR_TYPE_VIEW), xrOf<XrView>(XR_TYPE_VIEW)};
  std::uint32_t count = 0;
  if (XR_FAILED(xr.LocateViews(session, &info, &state, 2, &count, located.data())) || count != 2 ||
      (state.viewStateFlags & XR_VIEW_STATE_ORIENTATION_VALID_BIT) == 0) {
    return std::nullopt;
  }
  HeadsetEyes eyes;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto [position_m, head_from_eye] = poseOf(located.at(side).pose);
    eyes.at(side) = {.position_m = position_m,
                     .head_from_eye = head_from_eye,
                     .field = fieldOf(located.at(side).fov)};
  }
  return eyes;
}

void Headset::Parts::openSystem(HeadsetFacts& facts) {
  facts.runtime = xr.name;
  auto wanted = xrOf<XrSystemGetInfo>(XR_TYPE_SYSTEM_GET_INFO);
  wanted.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  require(xr.GetSystem(xr.instance, &wanted, &system));
  auto properties = xrOf<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
  auto tracker = xrOf<XrSystemEyeGazeInteractionPropertiesEXT>(
      XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT);
  if (xr.has_gaze) properties.next = &tracker;
  require(xr.GetSystemProperties(xr.instance, system, &properties));
  facts.headset = properties.systemName;
  most_px = {properties.graphicsProperties.maxSwapchainImageWidth,
             properties.graphicsProperties.maxSwapchainImageHeight};
  if (!xr.has_gaze) {
    facts.no_gaze = xr.name + " has no XR_EXT_eye_gaze_interaction";
  } else if (!tracker.supportsEyeGazeInteraction) {
    facts.no_gaze = xr.name + " says that " + facts.headset + " has no eye tracker";
  }
  std::array<XrViewConfigurationView, 2> images_of{
      xrOf<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW),
      xrOf<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW)};
  std::uint32_t count = 0;
  require(xr.EnumerateViewConfigurationViews(xr.instance, system, kBothEyes, 2, &count,
                                             images_of.data()));
  const glm::uvec2 eye_px = glm::max(
      glm::uvec2(images_of[0].recommendedImageRectWidth, images_of[0].recommendedImageRectHeight),
      glm::uvec2(images_of[1].recommendedImageRectWidth, images_of[1].recommendedImageRectHeight));
  facts.eye_px = glm::ivec2(eye_px + eye_px % 2u);  // as H.264 wants
}

void Headset::Parts::openSession(const NativeGl& gl) {
  if (!gl.context) throw InputError("--headset", "expected a window of X11, which has GLX");
  auto needs = xrOf<XrGraphicsRequirementsOpenGLKHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
  require(xr.GetOpenGLGraphicsRequirementsKHR(xr.instance, system, &needs));
  auto info = xrOf<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
  info.systemId = system;
  auto egl = xrOf<XrGraphicsBindingEGLMNDX>(XR_TYPE_GRAPHICS_BINDING_EGL_MNDX);
  auto glx = xrOf<XrGraphicsBindingOpenGLXlibKHR>(XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR);
  if (gl.egl) {
    egl.getProcAddress = eglGetProcAddress;
    egl.display = gl.display;
    egl.config = gl.config;
    egl.context = gl.context;
    info.next = &egl;
  } else {
    glx.xDisplay = static_cast<Display*>(gl.display);
    glx.visualid = gl.visual;
    glx.glxFBConfig = static_cast<GLXFBConfig>(gl.config);
    glx.glxDrawable = gl.drawable;
    glx.glxContext = static_cast<GLXContext>(gl.context);
    info.next = &glx;
  }
  require(xr.CreateSession(xr.instance, &info, &session));
  local = space(XR_REFERENCE_SPACE_TYPE_LOCAL);
  head = space(XR_REFERENCE_SPACE_TYPE_VIEW);
}

XrSpace Headset::Parts::space(XrReferenceSpaceType type) const {
  auto info = xrOf<XrReferenceSpaceCreateInfo>(XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  info.referenceSpaceType = type;
  info.poseInReferenceSpace = kNoPose;
  XrSpace made = XR_NULL_HANDLE;
  require(xr.CreateReferenceSpace(session, &info, &made));
  return made;
}

/// @return why there is no gaze
std::string Headset::Parts::openGaze() {
  if (!xr.has_gaze) return {};  // said
  XrResult result = XR_SUCCESS;
  const auto ok = [&](XrResult answer) { return XR_SUCCEEDED(result = answer); };
  auto set = xrOf<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
  std::string("eyes").copy(set.actionSetName, XR_MAX_ACTION_SET_NAME_SIZE - 1);
  std::string("Eyes").copy(set.localizedActionSetName, XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
  auto pose = xrOf<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
  pose.actionType = XR_ACTION_TYPE_POSE_INPUT;
  std::string("gaze").copy(pose.actionName, XR_MAX_ACTION_NAME_SIZE - 1);
  std::string("Gaze").copy(pose.localizedActionName, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
  XrActionSuggestedBinding binding{};
  auto profile =
      xrOf<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
  profile.countSuggestedBindings = 1;
  profile.suggestedBindings = &binding;
  auto in_space = xrOf<XrActionSpaceCreateInfo>(XR_TYPE_ACTION_SPACE_CREATE_INFO);
  in_space.poseInActionSpace = kNoPose;
  auto attach = xrOf<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
  attach.countActionSets = 1;
  attach.actionSets = &actions;
  const bool done =
      ok(xr.CreateActionSet(xr.instance, &set, &actions)) &&
      ok(xr.CreateAction(actions, &pose, &look)) &&
      ok(xr.StringToPath(xr.instance, "/interaction_profiles/ext/eye_gaze_interaction",
                         &profile.interactionProfile)) &&
      ok(xr.StringToPath(xr.instance, "/user/eyes_ext/input/gaze_ext/pose", &binding.binding)) &&
      (binding.action = look, true) &&
      ok(xr.SuggestInteractionProfileBindings(xr.instance, &profile)) &&
      (in_space.action = look, true) && ok(xr.CreateActionSpace(session, &in_space, &gaze)) &&
      ok(xr.AttachSessionActionSets(session, &attach));
  if (done) return {};
  gaze = XR_NULL_HANDLE;
  return "no gaze: " + whyNot(xr, result);
}

/// The picture's codes are those of the display: the format is sRGB, and nothing encodes them.
void Headset::Parts::makeChain(const glm::ivec2& size_px) {
  if (chain != XR_NULL_HANDLE) xr.DestroySwapchain(chain);
  chain = XR_NULL_HANDLE;
  if (size_px.x > most_px.x || size_px.y > most_px.y) {
    throw InputError("--headset", "an image of both eyes has " + std::to_string(size_px.x) + "x" +
                                      std::to_string(size_px.y) + " px: expected at most " +
                                      std::to_string(most_px.x) + "x" + std::to_string(most_px.y) +
                                      "; choose output.size_px (--size)");
  }
  std::uint32_t count = 0;
  check(xr.EnumerateSwapchainFormats(session, 0, &count, nullptr));
  std::vector<std::int64_t> formats(count);
  check(xr.EnumerateSwapchainFormats(session, count, &count, formats.data()));
  if (std::ranges::find(formats, GL_SRGB8_ALPHA8) == formats.end()) {
    throw InputError("--headset", xr.name + " has no images of GL_SRGB8_ALPHA8, which foci needs");
  }
  auto info = xrOf<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT;
  info.format = GL_SRGB8_ALPHA8;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(size_px.x);
  info.height = static_cast<std::uint32_t>(size_px.y);
  check(xr.CreateSwapchain(session, &info, &chain));
  check(xr.EnumerateSwapchainImages(chain, 0, &count, nullptr));
  images.assign(count, xrOf<XrSwapchainImageOpenGLKHR>(XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR));
  check(xr.EnumerateSwapchainImages(chain, count, &count,
                                    reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data())));
  chain_px = size_px;
}

namespace {

/// A ring of small squares, which need no shader.
void drawGazeRing(const glm::dvec2& at_px, int height_px, bool broken) {
  constexpr int kSquares = 64, kArc = 4;
  const double radius_px = std::max(10.0, height_px / 36.0);
  const int half_px = std::max(1, height_px / 720);
  glEnable(GL_SCISSOR_TEST);
  for (const bool under : {true, false}) {
    under ? glClearColor(0.0f, 0.0f, 0.0f, 1.0f) : glClearColor(1.0f, 0.84f, 0.04f, 1.0f);
    const int reach_px = half_px + (under ? 1 : 0);
    for (int i = 0; i < kSquares; ++i) {
      if (broken && i / kArc % 2 == 1) continue;
      const double angle_rad = glm::two_pi<double>() * i / kSquares;
      const glm::ivec2 px(at_px + radius_px * glm::dvec2(std::cos(angle_rad), std::sin(angle_rad)));
      glScissor(px.x - reach_px, height_px - px.y - reach_px, 2 * reach_px, 2 * reach_px);
      glClear(GL_COLOR_BUFFER_BIT);
    }
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace

/// Rows of the picture start at the top, rows of a swapchain's image at the bottom.
void Headset::Parts::draw(const HeadsetPicture& picture) {
  const auto& [width, height] = std::pair(picture.size_px.x, picture.size_px.y);
  if (chain == XR_NULL_HANDLE || chain_px != picture.size_px) makeChain(picture.size_px);
  std::uint32_t index = 0;
  const auto acquire = xrOf<XrSwapchainImageAcquireInfo>(XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO);
  check(xr.AcquireSwapchainImage(chain, &acquire, &index));
  auto wait = xrOf<XrSwapchainImageWaitInfo>(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
  wait.timeout = XR_INFINITE_DURATION;
  check(xr.WaitSwapchainImage(chain, &wait));
  if (from == 0) {
    glGenFramebuffers(1, &from);
    glGenFramebuffers(1, &to);
  }
  GLuint texture = picture.texture;
  if (texture == 0) {
    if (uploaded == 0) glGenTextures(1, &uploaded);
    texture = uploaded;
    glBindTexture(GL_TEXTURE_2D, texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 picture.rgb);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                         images.at(index).image, 0);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(0, 0, width, height, 0, height, width, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  for (const glm::dvec2& at_px : picture.markers_px) drawGazeRing(at_px, height, !picture.fixates);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glFlush();
  const auto release = xrOf<XrSwapchainImageReleaseInfo>(XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO);
  check(xr.ReleaseSwapchainImage(chain, &release));

  const int eye_width = width / 2;
  for (std::size_t side = 0; side < 2; ++side) {
    const HeadsetEye& eye = picture.eyes.at(side);
    const HeadInWorld& head_now = picture.head;
    XrCompositionLayerProjectionView& view = views.at(side);
    view = xrOf<XrCompositionLayerProjectionView>(XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
    view.pose = xrPoseOf(head_now.position_m + head_now.world_from_head * eye.position_m,
                         head_now.world_from_head * eye.head_from_eye);
    view.fov = xrFieldOf(eye.field);
    view.subImage.swapchain = chain;
    view.subImage.imageRect = {{static_cast<int>(side) * eye_width, 0}, {eye_width, height}};
  }
  has_picture = true;
}

Headset::Headset(std::unique_ptr<GpuContext> context, const std::string& loader)
    : context_(std::move(context)),
      parts_(std::make_unique<Parts>(loader.empty() ? kOpenXrLoader : loader,
                                     context_->native().egl)) {
  Parts& parts = *parts_;
  parts.openSystem(facts_);
  parts.openSession(context_->native());
  if (const std::string problem = parts.openGaze(); !problem.empty()) facts_.no_gaze = problem;
  facts_.asks_gaze = parts.gaze != XR_NULL_HANDLE;
  std::optional<HeadsetEyes> eyes;
  for (const double begin_s = steadyNow_s(); !eyes;) {
    if (ended_ || steadyNow_s() > begin_s + kStart_s) {
      throw InputError("--headset", facts_.headset +
                                        " does not start within 10 s: put it on, and "
                                        "look at what its runtime says");
    }
    if (!waitFrame()) continue;
    eyes = parts.eyesAt(parts.frame.predictedDisplayTime);
    facts_.period_s = 1e-9 * static_cast<double>(parts.frame.predictedDisplayPeriod);
    submit(nullptr);
  }
  facts_.eyes = *eyes;
}

Headset::~Headset() {
  try {
    const double begin_s = steadyNow_s();
    if (parts_->running) parts_->xr.RequestExitSession(parts_->session);
    while (!ended_ && parts_->running && !parts_->lost && steadyNow_s() < begin_s + kEnd_s) {
      if (waitFrame()) submit(nullptr);
    }
  } catch (const HeadsetLost&) {
  }
  parts_.reset();
  context_->release();
}

void Headset::poll() {
  Parts& parts = *parts_;
  auto event = xrOf<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
  while (parts.xr.PollEvent(parts.xr.instance, &event) == XR_SUCCESS) {
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) {
      parts.check(XR_ERROR_INSTANCE_LOST);
    } else if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
      const auto& changed = reinterpret_cast<const XrEventDataSessionStateChanged&>(event);
      if (changed.state == XR_SESSION_STATE_READY) {
        auto info = xrOf<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
        info.primaryViewConfigurationType = kBothEyes;
        parts.check(parts.xr.BeginSession(parts.session, &info));
        parts.running = true;
      } else if (changed.state == XR_SESSION_STATE_STOPPING) {
        parts.running = false;
        parts.check(parts.xr.EndSession(parts.session));
      } else if (changed.state == XR_SESSION_STATE_EXITING) {
        ended_ = true;
      } else if (changed.state == XR_SESSION_STATE_LOSS_PENDING) {
        parts.check(XR_ERROR_SESSION_LOST);
      }
    }
    event = xrOf<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
  }
}

std::optional<HeadsetTick> Headset::waitFrame() {
  Parts& parts = *parts_;
  poll();
  if (!parts.running) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::nullopt;
  }
  const auto wait = xrOf<XrFrameWaitInfo>(XR_TYPE_FRAME_WAIT_INFO);
  parts.frame = xrOf<XrFrameState>(XR_TYPE_FRAME_STATE);
  parts.check(parts.xr.WaitFrame(parts.session, &wait, &parts.frame));
  const auto begin = xrOf<XrFrameBeginInfo>(XR_TYPE_FRAME_BEGIN_INFO);
  parts.check(parts.xr.BeginFrame(parts.session, &begin));
  parts.period = parts.frame.predictedDisplayPeriod;
  parts.predicted = parts.frame.predictedDisplayTime;
  return HeadsetTick{.display_s = parts.seconds(parts.frame.predictedDisplayTime),
                     .period_s = 1e-9 * static_cast<double>(parts.frame.predictedDisplayPeriod),
                     .shows = parts.frame.shouldRender == XR_TRUE};
}

void Headset::submit(const HeadsetPicture* picture) {
  Parts& parts = *parts_;
  const bool shows = parts.frame.shouldRender == XR_TRUE;
  if (picture && shows) parts.draw(*picture);
  auto layer = xrOf<XrCompositionLayerProjection>(XR_TYPE_COMPOSITION_LAYER_PROJECTION);
  layer.space = parts.local;
  layer.viewCount = 2;
  layer.views = parts.views.data();
  const auto* const base = reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
  auto end = xrOf<XrFrameEndInfo>(XR_TYPE_FRAME_END_INFO);
  end.displayTime = parts.frame.predictedDisplayTime;
  end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  end.layerCount = shows && parts.has_picture ? 1 : 0;
  end.layers = &base;
  parts.check(parts.xr.EndFrame(parts.session, &end));
}

HeadsetEyes Headset::eyesNow() {
  return parts_->eyesAt(parts_->frame.predictedDisplayTime).value_or(facts_.eyes);
}

std::optional<HeadNow> Headset::headNext() const {
  const XrTime predicted = parts_->predicted;
  const XrTime next = predicted == 0 ? parts_->now() : predicted + parts_->period;
  const auto head = parts_->headAt(next);
  if (!head) return std::nullopt;
  return HeadNow{.head = *head, .display_s = parts_->seconds(next)};
}

std::optional<HeadsetGaze> Headset::gaze() const {
  const Parts& parts = *parts_;
  const OpenXrApi& xr = parts.xr;
  if (!parts.running || parts.gaze == XR_NULL_HANDLE) return std::nullopt;
  const XrActiveActionSet active{parts.actions, XR_NULL_PATH};
  auto sync = xrOf<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
  sync.countActiveActionSets = 1;
  sync.activeActionSets = &active;
  auto which = xrOf<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
  which.action = parts.look;
  auto state = xrOf<XrActionStatePose>(XR_TYPE_ACTION_STATE_POSE);
  // A session without focus answers XR_SESSION_NOT_FOCUSED, a success.
  if (xr.SyncActions(parts.session, &sync) != XR_SUCCESS ||
      XR_FAILED(xr.GetActionStatePose(parts.session, &which, &state)) || !state.isActive) {
    return std::nullopt;
  }
  auto measured = xrOf<XrEyeGazeSampleTimeEXT>(XR_TYPE_EYE_GAZE_SAMPLE_TIME_EXT);
  auto location = xrOf<XrSpaceLocation>(XR_TYPE_SPACE_LOCATION);
  location.next = &measured;
  const XrTime now = parts.now();
  if (XR_FAILED(xr.LocateSpace(parts.gaze, parts.head, now, &location))) return std::nullopt;
  const XrTime time = measured.time != 0 ? measured.time : now;
  HeadsetGaze gaze{.time_s = parts.seconds(time), .own_time = measured.time != 0};
  const XrSpaceLocationFlags flags = location.locationFlags;
  if ((flags & XR_SPACE_LOCATION_ORIENTATION_VALID_BIT) != 0) {
    gaze.direction = poseOf(location.pose).world_from_head * glm::dvec3(0.0, 0.0, -1.0);
    gaze.degraded = (flags & XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT) == 0 ||
                    (flags & XR_SPACE_LOCATION_POSITION_TRACKED_BIT) == 0;
  }
  const auto head = parts.headAt(time);
  if (!head) return std::nullopt;
  gaze.head = *head;
  return gaze;
}

}  // namespace foci
