#include "app/graphics/figure.h"
#include "app/replay/report_explorer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>

#include "app/replay/figures.h"
#include "base/base64.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr float kRadiiPerOctave = 16.0f;  // of a point's radius in 8 bits
constexpr std::size_t kHeatColors = 64;

/// `scene` holds the numbers; `run`, `video`, `seek`, `tip`, `spans` and `watchers` are the
/// explorer's. A row of `path` is time, eye, point; of `fixations` time, duration, number, eye,
/// point, normal. Times from the video's start.
constexpr const char* kSceneScript = R"(
const view = document.getElementById('view'), gl = view.getContext('webgl2', { alpha: false });
const byId = id => document.getElementById(id), clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const bytes = text => Uint8Array.from(atob(text), one => one.charCodeAt(0));
function rowsOf(text, width) {
  const all = new Float32Array(bytes(text).buffer);
  return Array.from({ length: all.length / width }, (_, i) => all.subarray(width * i, width * (i + 1)));
}
function startScene() {
  const sigma_rad = scene.sigma_deg * Math.PI / 180;
  const places = new Uint16Array(bytes(scene.places).buffer), looks = bytes(scene.looks);
  const path = rowsOf(scene.path, 7), fixations = rowsOf(scene.fixations, 12), home = [.5, .35, 1.7 * Math.hypot(...scene.half)];
  let shown = fixations, now = 0, queued = false, moved = 0, matrix, [yaw, pitch, away] = home, target = scene.middle;
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, `#version 300 es
    in vec3 place; in vec4 look; uniform mat4 matrix; uniform float low, size, lift, spot, zoom; uniform vec2 shift;
    uniform vec4 tint; out vec4 paint;
    void main() {
      gl_Position = matrix * vec4(low + size * place, 1.);
      gl_Position += vec4(shift * gl_Position.w, lift, 0.);
      float radius = ${scene.unit} * exp2(look.a * 255. / ${scene.octave}.);
      gl_PointSize = spot > 0. ? spot : clamp(2. * radius * zoom / gl_Position.w, 1.5, 40.);
      paint = tint.a > 0. ? tint : vec4(look.rgb, 1.);
    }`], [gl.FRAGMENT_SHADER, `#version 300 es
    precision mediump float; in vec4 paint; uniform bool dots; out vec4 color;
    void main() { if (dots && length(gl_PointCoord - .5) > .5) discard; color = paint; }`]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, 'place');
  gl.bindAttribLocation(program, 1, 'look');
  gl.linkProgram(program);
  gl.useProgram(program);
  const at = name => gl.getUniformLocation(program, name);
  const ground = gl.createBuffer(), coats = gl.createBuffer(), lines = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, ground);
  gl.bufferData(gl.ARRAY_BUFFER, places, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  function coat() {
    const colors = looks.slice(), heat = new Float32Array(looks.length / 4);
    const spots = byId('heat-on').checked ? shown.map(f => {
      const sigma = sigma_rad * Math.hypot(f[3] - f[6], f[4] - f[7], f[5] - f[8]);
      return [f[6], f[7], f[8], 2 * sigma * sigma, f[1] / (2 * Math.PI * scene.sigma_deg ** 2)];
    }) : [];
    let most = 0;
    if (spots.length) heat.forEach((_, i) => {
      const [x, y, z] = [0, 1, 2].map(k => scene.low + scene.size * places[3 * i + k] / 65535);
      let sum = 0;
      for (const s of spots) {
        const d = (x - s[0]) ** 2 + (y - s[1]) ** 2 + (z - s[2]) ** 2;
        if (d < 5 * s[3]) sum += s[4] * Math.exp(-d / s[3]);
      }
      most = Math.max(most, heat[i] = sum);
    });
    if (spots.length) for (let i = 0; i < heat.length; ++i) {
      const grey = .3 * looks[4 * i] + .59 * looks[4 * i + 1] + .11 * looks[4 * i + 2], share = heat[i] / (most || 1);
      const color = scene.heat[Math.round(share * (scene.heat.length - 1))], cover = Math.min(1, 8 * share);
      for (let k = 0; k < 3; ++k) colors[4 * i + k] = .6 * grey * (1 - cover) + color[k] * cover;
    }
    byId('heat-scale').hidden = !spots.length;
    byId('heat-most').textContent = most.toPrecision(3);
    gl.bindBuffer(gl.ARRAY_BUFFER, coats);
    gl.bufferData(gl.ARRAY_BUFFER, colors, gl.DYNAMIC_DRAW);
  }
  function paint(mode, points, tint, spot = 0) {
    gl.bindBuffer(gl.ARRAY_BUFFER, lines);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.DYNAMIC_DRAW);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.uniform4fv(at('tint'), tint);
    gl.uniform1f(at('spot'), spot * devicePixelRatio);
    gl.uniform1i(at('dots'), spot > 0);
    for (const [x, y] of mode === gl.LINES ? [[0, 0], [1, 0], [0, 1], [1, 1]] : [[0, 0]]) {
      gl.uniform2f(at('shift'), 2 * x / view.width, 2 * y / view.height);
      gl.drawArrays(mode, 0, points.length / 3);
    }
  }
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = a => a.map(x => x / Math.hypot(...a));
  function disc(f) {
    const normal = [...f.subarray(9)], u = unit(cross(Math.abs(normal[1]) < .9 ? [0, 1, 0] : [1, 0, 0], normal));
    const v = cross(normal, u), radius = sigma_rad * Math.hypot(f[3] - f[6], f[4] - f[7], f[5] - f[8]) * Math.sqrt(f[1]);
    const rim = i => [0, 1, 2].map(k => f[6 + k] + radius * (u[k] * Math.cos(i * Math.PI / 10) + v[k] * Math.sin(i * Math.PI / 10)));
    return Array.from({ length: 20 }, (_, i) => [...f.subarray(6, 9), ...rim(i), ...rim(i + 1)]).flat();
  }
  function axes() {
    const [c, s, C, S] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return [[c, 0, -s], [-s * S, C, -c * S], [s * C, S, c * C]];
  }
  function draw() {
    queued = false;
    const wide = Math.round(view.clientWidth * devicePixelRatio), high = Math.round(view.clientHeight * devicePixelRatio);
    if (view.width !== wide || view.height !== high) [view.width, view.height] = [wide, high];
    const [right, up, back] = axes(), eye = target.map((x, k) => x + away * back[k]), far = away + 2 * scene.size;
    // What lies between the viewer and the gaze is cut off.
    const depth = back.reduce((sum, b, k) => sum + b * (eye[k] - scene.middle[k]) - Math.abs(b) * scene.half[k], 0);
    const near = Math.max(away / 50, .95 * depth), zoom = 1.8, scale = [zoom * high / wide, zoom], a = (far + near) / (far - near), b = -2 * far * near / (far - near);
    const dot = v => v[0] * eye[0] + v[1] * eye[1] + v[2] * eye[2];
    matrix = [0, 1, 2].flatMap(k => [scale[0] * right[k], scale[1] * up[k], -a * back[k], -back[k]])
      .concat(-scale[0] * dot(right), -scale[1] * dot(up), a * dot(back) + b, dot(back));
    gl.viewport(0, 0, wide, high);
    gl.clearColor(...getComputedStyle(view).backgroundColor.match(/[\d.]+/g).slice(0, 3).map(x => x / 255), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(at('matrix'), false, matrix);
    gl.uniform1f(at('zoom'), zoom * high / 2);
    for (const [name, value] of [['low', scene.low], ['size', scene.size], ['lift', 0], ['spot', 0]]) gl.uniform1f(at(name), value);
    gl.uniform4f(at('tint'), 0, 0, 0, 0);
    gl.uniform2f(at('shift'), 0, 0);
    gl.uniform1i(at('dots'), 1);
    gl.enableVertexAttribArray(1);
    gl.bindBuffer(gl.ARRAY_BUFFER, coats);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, ground);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 0, 0);
    gl.drawArrays(gl.POINTS, 0, places.length / 3);
    gl.disableVertexAttribArray(1);
    gl.enable(gl.BLEND);
    for (const [name, value] of [['low', 0], ['size', 1], ['lift', -.04 * near]]) gl.uniform1f(at(name), value);
    const done = byId('until-now').checked ? shown.filter(f => f[0] <= now) : shown;
    const current = fixations.filter(f => f[0] <= now && now < f[0] + f[1]);
    paint(gl.LINES, path.slice(1).flatMap((row, i) => [...path[i].subarray(1, 4), ...row.subarray(1, 4)]), [.23, .51, .77, 1]);
    if (byId('sights-on').checked) paint(gl.LINES, done.flatMap(f => [...f.subarray(3, 9)]), [.95, .6, .15, .5]);
    if (!byId('heat-on').checked) paint(gl.TRIANGLES, done.flatMap(disc), [.95, .6, .15, .75]);
    paint(gl.TRIANGLES, current.flatMap(disc), [.85, .2, .2, .95]);
    const row = path.findLast(one => one[0] <= now) ?? path[0];
    if (row[4] === row[4]) paint(gl.LINES, [...row.subarray(1)], [.85, .2, .2, 1]);
    paint(gl.POINTS, [...row.subarray(1, 4)], [.23, .51, .77, 1], 11);
    gl.disable(gl.BLEND);
  }
  function redraw() { if (!queued) { queued = true; requestAnimationFrame(draw); } }
  function choose() {
    shown = fixations.filter(f => !spans.length || spans.some(([first, last]) => first <= run.first + f[0] && run.first + f[0] < last));
    coat();
    redraw();
  }
  watchers.push(time => {
    if (time === now) return;
    byId('clock').textContent = (run.first + time).toFixed(2) + ' s';
    byId('when').value = now = time;
    redraw();
  });
  byId('when').oninput = event => seek(run.first + +event.target.value, true);
  if (picked) picked.addEventListener('change', choose);
  for (const id of ['heat-on', 'sights-on', 'until-now']) byId(id).onchange = choose;
  for (const button of document.querySelectorAll('[data-turn]')) button.onclick = () => {
    [yaw, pitch] = button.dataset.turn.split(' ').map(Number);
    [away, target] = [home[2], scene.middle];
    redraw();
  };
  const fingers = new Map();
  view.onpointerdown = event => {
    fingers.set(event.pointerId, event);
    view.setPointerCapture(event.pointerId);
    moved = 0;
  };
  view.onpointerup = view.onpointercancel = event => fingers.delete(event.pointerId);
  view.onpointermove = event => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY, [right, up] = axes();
    const other = [...fingers.values()].find(one => one.pointerId !== event.pointerId);
    const gap = one => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) + 1;
    moved += Math.abs(dx) + Math.abs(dy);
    if (other) away *= gap(before) / gap(event);
    if (other || event.shiftKey || event.buttons & 6) {
      const step = 1.1 * away / view.clientHeight / (other ? 2 : 1);
      target = target.map((x, k) => x + step * (dy * up[k] - dx * right[k]));
    } else {
      yaw -= .008 * dx;
      pitch = clamp(pitch + .008 * dy, -1.57, 1.57);
    }
    fingers.set(event.pointerId, event);
    redraw();
  };
  view.oncontextmenu = event => event.preventDefault();
  view.addEventListener('wheel', event => {
    if (document.activeElement !== view && !event.ctrlKey) return;
    event.preventDefault();
    away *= Math.exp(.001 * event.deltaY);
    redraw();
  }, { passive: false });
  view.onkeydown = event => {
    const step = { ArrowLeft: [.1, 0, 1], ArrowRight: [-.1, 0, 1], ArrowUp: [0, .1, 1], ArrowDown: [0, -.1, 1], '+': [0, 0, .9], '-': [0, 0, 1.1] }[event.key];
    if (!step) return;
    event.preventDefault();
    [yaw, pitch, away] = [yaw + step[0], clamp(pitch + step[1], -1.57, 1.57), away * step[2]];
    redraw();
  };
  function under(event) {
    const box = view.getBoundingClientRect();
    const gap = f => {
      const [x, y, , w] = [0, 1, 2, 3].map(k => matrix[k] * f[6] + matrix[4 + k] * f[7] + matrix[8 + k] * f[8] + matrix[12 + k]);
      return w > 0 ? Math.hypot(box.width * (.5 + .5 * x / w) - event.clientX + box.left, box.height * (.5 - .5 * y / w) - event.clientY + box.top) : 1e9;
    };
    const nearest = shown.reduce((best, f) => best && gap(best) <= gap(f) ? best : f, null);
    return nearest && gap(nearest) < 12 ? nearest : null;
  }
  view.onclick = event => { const f = moved < 4 && under(event); if (f) seek(run.first + f[0], true); };
  view.onmouseleave = () => { tip.hidden = true; };
  view.onmousemove = event => {
    const f = under(event);
    if (f) tell(event, `fixation ${f[2]}, from ${(run.first + f[0]).toFixed(2)} s, ${f[1].toFixed(2)} s long, ${Math.hypot(f[3] - f[6], f[4] - f[7], f[5] - f[8]).toFixed(2)} m away`);
    else tip.hidden = true;
  };
  new ResizeObserver(redraw).observe(view);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  choose();
}
if (gl) startScene(); else byId('scene-live').hidden = !(byId('no-webgl').hidden = false);
)";

template <typename Number>
void base64(std::ostream& out, const std::vector<Number>& numbers) {
  Base64 text(out);
  text.add(reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size() * sizeof(Number));
  text.finish();
}

std::string triple(const glm::vec3& v) {
  return concat("[", exactText(v.x), ",", exactText(v.y), ",", exactText(v.z), "]");
}

void add(std::vector<float>& row, const glm::vec3& v) { row.insert(row.end(), {v.x, v.y, v.z}); }

}  // namespace

const char* const kSceneStyle = R"(
#view { width: 100%; height: min(36rem, 70vh); display: block; background: var(--card); border-radius: 6px; touch-action: none; cursor: grab; }
#scene-live label { margin-right: 1rem; } #when { width: min(28rem, 50%); vertical-align: middle; }
svg.plan { max-width: 100%; background: #fff; border-radius: 6px; margin: .3rem 0; }
@media print { #scene-live { display: none; } }
)";

void writeSceneSection(std::ostream& out, const SceneView& view, double first_s, double last_s) {
  const double duration_s = std::max(last_s - first_s, 1e-3);
  out << "<h2 id=\"scene\">The scene in three dimensions</h2>\n"
         "<p class=\"notice\" id=\"no-webgl\" hidden>This browser offers no WebGL 2: plan and side "
         "view are below.</p>\n<div id=\"scene-live\"><canvas id=\"view\" tabindex=\"0\" "
         "aria-label=\"the scene with fixations and lines of sight; arrow keys turn it, + and - "
         "zoom\"></canvas>\n<p><label>Time <input type=\"range\" id=\"when\" min=\"0\" "
         "step=\"any\" value=\"0\" max=\""
      << decimal(duration_s, 6) << "\"> <span id=\"clock\">" << decimal(first_s, 2)
      << " s</span></label></p>\n<p>"
         "<label><input type=\"checkbox\" id=\"heat-on\"> heat</label>"
         "<label><input type=\"checkbox\" id=\"sights-on\" checked> lines of sight</label>"
         "<label><input type=\"checkbox\" id=\"until-now\"> only up to this time</label>"
         "<button data-turn=\"0.5 0.35\">from behind</button> "
         "<button data-turn=\"0 1.57\">plan</button> <button data-turn=\"1.5708 "
         "0\">side</button></p>\n"
         "<p class=\"quiet\" id=\"heat-scale\" hidden>0 <span style=\"display:inline-block;width:"
         "12rem;height:.8rem;background:linear-gradient(to right";
  for (int i = 1; i <= 12; ++i)
    out << ", " << hexOf(heatAt(ColorMap::inferno, float(i) / 12.0f, 0.0f));
  out << ")\"></span> <span id=\"heat-most\"></span> s/m&sup2; of fixation on the surface, "
         "smoothed by a Gaussian of "
      << significant(kGazeMapSigma_deg, 2)
      << " deg</p>\n<p class=\"quiet\">Drag to turn, with Shift to move; after a click the wheel "
         "zooms. Discs are fixations, with a radius of 1 deg for 1 s and an area that grows with "
         "the duration; a click on one moves the video there. Blue: the path of the eye. Red: "
         "now. ";
  if (view.points.size() < view.points_near) {
    out << "The scene is thinned for this page: it shows " << thousands(double(view.points.size()))
        << " of " << thousands(double(view.points_near))
        << " points, and rather those that are opaque. ";
  }
  if (view.points_near < view.points_all) {
    out << thousands(double(view.points_all - view.points_near))
        << " points are left out, which are more than " << significant(double{view.reach_m}, 2)
        << " m away. ";
  }
  out << "</p></div>\n<figure>" << scenePlanSvg(view, SceneSide::above)
      << scenePlanSvg(view, SceneSide::right)
      << "<figcaption>Plan (above) and side view, in which the observer looks to the right. "
         "Surfaces between the viewer and the gaze are left out.</figcaption></figure>\n";
}

void writeSceneScript(std::ostream& out, const SceneView& view, double first_s) {
  std::vector<std::uint16_t> places;
  std::vector<std::uint8_t> looks;
  const float size_m = 2.0f * view.reach_m, unit_m = size_m / 65535.0f;
  for (const SceneView::Point& point : view.points) {
    const glm::vec3 steps = glm::round((point.at_m + view.reach_m) / unit_m);
    for (int k = 0; k < 3; ++k) places.push_back(static_cast<std::uint16_t>(steps[k]));
    for (int k = 0; k < 3; ++k) looks.push_back(point.color[k]);
    const float octaves = std::log2(std::max(point.radius_m / unit_m, 1.0f));
    looks.push_back(static_cast<std::uint8_t>(std::min(kRadiiPerOctave * octaves, 255.0f)));
  }
  std::vector<float> path, fixations;
  for (const SceneView::Sight& sight : view.path) {
    path.push_back(static_cast<float>(sight.time_s - first_s));
    add(path, sight.eye_m);
    add(path, sight.point_m);
  }
  for (const SceneView::Fixation& fixation : view.fixations) {
    fixations.insert(fixations.end(), {static_cast<float>(fixation.time_s - first_s),
                                       static_cast<float>(fixation.duration_s),
                                       static_cast<float>(fixation.number)});
    for (const glm::vec3& v : {fixation.eye_m, fixation.point_m, fixation.normal})
      add(fixations, v);
  }
  out << "<script>\nconst scene = {low: " << exactText(double{-view.reach_m})
      << ", size: " << exactText(double{size_m}) << ", unit: '" << decimal(double{unit_m}, 9)
      << "', octave: " << kRadiiPerOctave
      << ", middle: " << triple(0.5f * (view.low_m + view.high_m))
      << ", half: " << triple(0.5f * (view.high_m - view.low_m))
      << ", sigma_deg: " << significant(kGazeMapSigma_deg, 2) << ",\nheat: [";
  for (std::size_t i = 0; i < kHeatColors; ++i) {
    const glm::ivec3 code(255.0f * heatAt(ColorMap::inferno, float(i + 1) / kHeatColors, 0.0f));
    out << "[" << code.r << "," << code.g << "," << code.b << "],";
  }
  out << "],\nplaces: '";
  base64(out, places);
  out << "',\nlooks: '";
  base64(out, looks);
  out << "',\npath: '";
  base64(out, path);
  out << "',\nfixations: '";
  base64(out, fixations);
  out << "'};\n" << kSceneScript << "</script>\n";
}

}  // namespace foci
