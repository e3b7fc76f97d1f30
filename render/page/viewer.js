// Shows the GLB file of the page in WebGL 2, without any library and without a network.
// Only what Condyle writes is read: float positions, sparse targets, 16-bit colours, linear tracks.
(function () {
"use strict";
const $ = (id) => document.getElementById(id);
const words = JSON.parse($("words").textContent);

// ---- GLB ----------------------------------------------------------------------------------
function bytesOf(base64) {
  const text = atob(base64.trim()), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}
function readGlb(buffer) {
  const view = new DataView(buffer), length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, length)));
  const start = 20 + length + 8;
  const types = { 5126: Float32Array, 5125: Uint32Array, 5123: Uint16Array };
  const widths = { SCALAR: 1, VEC3: 3, VEC4: 4 };
  json.values = (index) => {
    const accessor = json.accessors[index], width = widths[accessor.type];
    const list = (view, type, count) =>
        new types[type](buffer, start + (json.bufferViews[view].byteOffset || 0), count);
    if (!accessor.sparse) return list(accessor.bufferView, accessor.componentType, accessor.count * width);
    const all = new types[accessor.componentType](accessor.count * width), some = accessor.sparse;
    const indices = list(some.indices.bufferView, some.indices.componentType, some.count);
    const values = list(some.values.bufferView, accessor.componentType, some.count * width);
    indices.forEach((each, i) => { for (let k = 0; k < width; ++k) all[width * each + k] = values[width * i + k]; });
    return all;
  };
  return json;
}

// ---- small algebra: quaternions (x, y, z, w), matrices by columns ----------------------------
function turned(q, v) {
  const [x, y, z, w] = q, [a, b, c] = v;
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}
function poseMatrix(q, t) {
  const x = turned(q, [1, 0, 0]), y = turned(q, [0, 1, 0]), z = turned(q, [0, 0, 1]);
  return [...x, 0, ...y, 0, ...z, 0, ...t, 1];
}
function product(a, b) {
  const c = new Array(16).fill(0);
  for (let i = 0; i < 4; ++i)
    for (let j = 0; j < 4; ++j)
      for (let k = 0; k < 4; ++k) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
function unit(a) {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
}

// ---- WebGL --------------------------------------------------------------------------------
const canvas = $("view");
const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
if (!gl) {
  $("problem").hidden = false;
  $("problem").textContent =
      "This browser does not offer WebGL 2, which the picture needs. Switch hardware acceleration on, or " +
      "open the page in another browser.";
  return;
}
const vertexSource = `#version 300 es
in vec3 place, normal; in vec3 color;
uniform mat4 pose, eye, lens;
out vec3 n, p, c;
void main() {
  vec4 seen = eye * pose * vec4(place, 1.0);
  n = mat3(eye) * mat3(pose) * normal; p = seen.xyz; c = color;
  gl_Position = lens * seen;
}`;
const pixelSource = `#version 300 es
precision highp float;
in vec3 n, p, c;
uniform float opacity, roughness; uniform vec3 inside; uniform bool hollow;
out vec4 pixel;
vec3 display(vec3 v) {
  v = v * (1.0 + v * 0.06) / (1.0 + 0.28 * v);
  return mix(12.92 * v, 1.055 * pow(max(v, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, v));
}
void main() {
  vec3 N = normalize(n), V = normalize(-p), base = c;
  // At silhouettes simplified triangles may face backward while the surface does not.
  if (!gl_FrontFacing && dot(N, V) < 0.0) { N = -N; if (hollow) base = inside; }
  vec3 key = normalize(vec3(-0.45, 0.55, 0.75)), fill = normalize(vec3(0.8, 0.1, 0.45));
  float d = max(0.0, (dot(N, key) + 0.18) / 1.18), f = max(0.0, dot(N, fill));
  float sky = 0.5 + 0.5 * N.y;
  vec3 light = vec3(1.42, 1.38, 1.32) * d + vec3(0.24, 0.27, 0.32) * f +
      mix(vec3(0.20, 0.18, 0.17), vec3(0.40, 0.42, 0.46), sky);
  float shine = pow(max(0.0, dot(N, normalize(key + V))), mix(90.0, 8.0, roughness));
  float rim = pow(1.0 - max(0.0, dot(N, V)), 3.0);
  vec3 lit = base * light + shine * mix(0.30, 0.04, roughness) + rim * 0.05;
  float a = opacity < 1.0 ? clamp(opacity + 0.55 * opacity * rim + 0.12 * rim, 0.0, 1.0) : 1.0;
  pixel = vec4(display(lit) * a, a);
}`;
function shader(kind, source) {
  const made = gl.createShader(kind);
  gl.shaderSource(made, source);
  gl.compileShader(made);
  if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
  return made;
}
const program = gl.createProgram();
gl.attachShader(program, shader(gl.VERTEX_SHADER, vertexSource));
gl.attachShader(program, shader(gl.FRAGMENT_SHADER, pixelSource));
["place", "normal", "color"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
gl.linkProgram(program);
if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
const at = {};
for (const name of ["pose", "eye", "lens", "opacity", "roughness", "inside", "hollow"])
  at[name] = gl.getUniformLocation(program, name);

// ---- surfaces -------------------------------------------------------------------------------
function normalsOf(places, indices) {
  const sums = new Float32Array(places.length);
  for (let t = 0; t < indices.length; t += 3) {
    const a = 3 * indices[t], b = 3 * indices[t + 1], c = 3 * indices[t + 2];
    const ux = places[b] - places[a], uy = places[b + 1] - places[a + 1], uz = places[b + 2] - places[a + 2];
    const vx = places[c] - places[a], vy = places[c + 1] - places[a + 1], vz = places[c + 2] - places[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const v of [a, b, c]) { sums[v] += x; sums[v + 1] += y; sums[v + 2] += z; }
  }
  for (let v = 0; v < sums.length; v += 3) {
    const length = Math.hypot(sums[v], sums[v + 1], sums[v + 2]) || 1;
    sums[v] /= length; sums[v + 1] /= length; sums[v + 2] /= length;
  }
  return sums;
}
function buffer(kind, values, use) {
  const made = gl.createBuffer();
  gl.bindBuffer(kind, made);
  gl.bufferData(kind, values, use || gl.STATIC_DRAW);
  return made;
}
class Surface {
  constructor(glb, node, body) {
    const primitive = glb.meshes[node.mesh].primitives[0], material = glb.materials[primitive.material];
    this.name = node.name;
    this.kind = (node.extras || {}).kind || "bone";
    this.body = body;
    this.hollow = !!material.doubleSided;
    this.roughness = material.pbrMetallicRoughness.roughnessFactor ?? 1;
    this.places = glb.values(primitive.attributes.POSITION);
    this.indices = glb.values(primitive.indices);
    this.indexType = this.indices instanceof Uint16Array ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
    this.targets = (primitive.targets || []).map((target) => glb.values(target.POSITION));
    this.keyShapes = new Map();
    const count = this.places.length / 3, colors = new Float32Array(3 * count);
    const base = material.pbrMetallicRoughness.baseColorFactor || [1, 1, 1, 1];
    const own = "COLOR_0" in primitive.attributes ? glb.values(primitive.attributes.COLOR_0) : null;
    for (let v = 0; v < count; ++v)
      for (let k = 0; k < 3; ++k) colors[3 * v + k] = base[k] * (own ? own[4 * v + k] / 65535 : 1);
    const normals = "NORMAL" in primitive.attributes ? glb.values(primitive.attributes.NORMAL)
                                                     : normalsOf(this.places, this.indices);
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    const use = this.targets.length ? gl.DYNAMIC_DRAW : gl.STATIC_DRAW;
    [this.places, normals, colors].forEach((values, i) => {
      const made = buffer(gl.ARRAY_BUFFER, values, use);
      if (i === 0) this.placeBuffer = made;
      if (i === 1) this.normalBuffer = made;
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, 3, gl.FLOAT, false, 0, 0);
    });
    buffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    gl.bindVertexArray(null);
    this.shownPlaces = new Float32Array(this.places.length);
    this.shownNormals = new Float32Array(this.places.length);
  }
  /// Places and normals at a key.
  key(k) {
    if (!this.keyShapes.has(k)) {
      const places = Float32Array.from(this.places);
      if (k > 0) this.targets[k - 1].forEach((offset, i) => { places[i] += offset; });
      this.keyShapes.set(k, { places, normals: normalsOf(places, this.indices) });
    }
    return this.keyShapes.get(k);
  }
  shape(k, s) {
    if (!this.targets.length) return;
    const a = this.key(k), b = s > 0 ? this.key(k + 1) : a;
    for (let i = 0; i < this.shownPlaces.length; ++i) {
      this.shownPlaces[i] = a.places[i] + s * (b.places[i] - a.places[i]);
      this.shownNormals[i] = a.normals[i] + s * (b.normals[i] - a.normals[i]);
    }
    for (const [target, values] of
         [[this.placeBuffer, this.shownPlaces], [this.normalBuffer, this.shownNormals]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, target);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, values);
    }
  }
}

const glb = readGlb(bytesOf($("glb").textContent));
const poses = glb.nodes.map((node) =>
    ({ q: node.rotation || [0, 0, 0, 1], t: node.translation || [0, 0, 0] }));
const surfaces = [];
for (const body of glb.nodes[0].children) {
  const node = glb.nodes[body];
  if ("mesh" in node) surfaces.push(new Surface(glb, node, body));
  for (const child of node.children || []) surfaces.push(new Surface(glb, glb.nodes[child], body));
}
const animation = (glb.animations || [])[0];
const tracks = [];
let keyTimes = null, duration = 0;
for (const channel of animation ? animation.channels : []) {
  const sampler = animation.samplers[channel.sampler], times = glb.values(sampler.input);
  duration = Math.max(duration, times[times.length - 1]);
  if (channel.target.path === "weights") keyTimes = times;
  else tracks.push({ node: channel.target.node, path: channel.target.path, times, values: glb.values(sampler.output) });
}
/// The interval of increasing times that holds t, and the fraction within it.
function interval(times, t) {
  let low = 0, high = times.length - 1;
  if (t <= times[0]) return [0, 0];
  if (t >= times[high]) return [high, 0];
  while (high - low > 1) {
    const middle = low + high >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return [low, (t - times[low]) / (times[high] - times[low])];
}
function poseAt(t) {
  for (const track of tracks) {
    const [i, s] = interval(track.times, t), width = track.path === "rotation" ? 4 : 3;
    const value = [];
    for (let k = 0; k < width; ++k) {
      const a = track.values[width * i + k], b = s > 0 ? track.values[width * (i + 1) + k] : a;
      value.push(a + s * (b - a));
    }
    if (width === 3) poses[track.node].t = value;
    else {
      const length = Math.hypot(...value);
      poses[track.node].q = value.map((x) => x / length);
    }
  }
  if (keyTimes) {
    const [k, s] = interval(keyTimes, t);
    for (const surface of surfaces) surface.shape(k, s);
  }
}

// ---- view -----------------------------------------------------------------------------------
const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
for (const surface of surfaces) {
  const p = poses[surface.body];
  for (let v = 0; v < surface.places.length; v += 30) {
    const point = turned(p.q, [surface.places[v], surface.places[v + 1], surface.places[v + 2]]);
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], point[k] + p.t[k]);
      high[k] = Math.max(high[k], point[k] + p.t[k]);
    }
  }
}
const middle = low.map((value, k) => (value + high[k]) / 2);
const radius = Math.hypot(...minus(high, low)) / 2;
const views = { "front": [0, 4], "left": [90, 2], "right": [-90, 2], "three-quarter": [38, 8], "below": [20, -38] };
const fov = 24 * Math.PI / 180;
const camera = { azimuth: 38, elevation: 8, zoom: 1, target: middle.slice() };
function eyeMatrix() {
  const a = camera.azimuth * Math.PI / 180, e = camera.elevation * Math.PI / 180;
  // x is left, y is back, z is up: from the front the eye lies at -y, from the left at +x.
  const back = [Math.sin(a) * Math.cos(e), -Math.cos(a) * Math.cos(e), Math.sin(e)];
  const right = unit(cross([0, 0, 1], back)), up = cross(back, right);
  const aspect = canvas.width / canvas.height;
  const distance = 0.83 * radius / Math.sin(fov / 2) / Math.min(1, aspect) / camera.zoom;
  const eye = camera.target.map((value, k) => value + distance * back[k]);
  return { matrix: [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
                    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1], distance, right, up };
}
function lensMatrix(distance) {
  const near = Math.max(distance - 2.2 * radius, distance / 50), far = distance + 2.2 * radius;
  const f = 1 / Math.tan(fov / 2), aspect = canvas.width / canvas.height;
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
}

const groups = { bone: "bones", teeth: "teeth", mouth: "mouth", face: "face", eyes: "face", lining: "lining" };
const groupOf = (surface) => groups[surface.kind] || "bones";
const shown = { bones: true, teeth: true, mouth: true };
let faceOpacity = words.face_opacity;

function drawSurface(surface, opacity) {
  const p = poses[surface.body];
  gl.uniformMatrix4fv(at.pose, false, poseMatrix(p.q, p.t));
  gl.uniform1f(at.opacity, opacity);
  gl.uniform1f(at.roughness, surface.roughness);
  gl.uniform1i(at.hollow, surface.hollow ? 1 : 0);
  gl.bindVertexArray(surface.array);
  gl.drawElements(gl.TRIANGLES, surface.indices.length, surface.indexType, 0);
}
function draw() {
  const scale = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * scale));
  const height = Math.max(1, Math.round(canvas.clientHeight * scale));
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.depthMask(true);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.disable(gl.BLEND);
  gl.useProgram(program);
  const eye = eyeMatrix();
  gl.uniformMatrix4fv(at.eye, false, eye.matrix);
  gl.uniformMatrix4fv(at.lens, false, lensMatrix(eye.distance));
  gl.uniform3f(at.inside, 0.22, 0.07, 0.06);
  const solid = [], glass = [];
  for (const surface of surfaces) {
    const group = groupOf(surface);
    if (group === "face") {
      if (faceOpacity <= 0) continue;
      (faceOpacity >= 1 || surface.kind === "eyes" ? solid : glass).push(surface);
    } else if (group === "lining") {
      if (faceOpacity >= 0.98) solid.push(surface);
    } else if (shown[group]) solid.push(surface);
  }
  for (const surface of solid) drawSurface(surface, 1);
  if (!glass.length) return;
  gl.colorMask(false, false, false, false);  // first the depth of the nearest layer
  for (const surface of glass) drawSurface(surface, 1);
  gl.colorMask(true, true, true, true);
  gl.depthMask(false);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  for (const surface of glass) drawSurface(surface, faceOpacity);
}

// ---- motion and captions --------------------------------------------------------------------
let time = 0, playing = false, last = 0, speed = 1, asked = false;
function openingAt(t) {
  const [i, s] = interval(words.times_s, t), a = words.opening_mm[i];
  return s > 0 ? a + s * (words.opening_mm[i + 1] - a) : a;
}
const moves = duration > 0;
const widest = moves ? Math.max(...words.opening_mm) : 0;
/// The time at which the mouth first opens by this much.
function timeOfOpening(mm) {
  for (let i = 1; i < words.times_s.length; ++i)
    if (words.opening_mm[i] >= mm) {
      const a = words.opening_mm[i - 1], b = words.opening_mm[i];
      const s = b > a ? Math.max(0, (mm - a) / (b - a)) : 1;
      return words.times_s[i - 1] + s * (words.times_s[i] - words.times_s[i - 1]);
    }
  return words.times_s[words.opening_mm.indexOf(widest)];
}
function caption() {
  if (!moves) return;
  const phase = words.phases.find((each) => time >= each.start_s && time <= each.end_s);
  const opening = openingAt(time);
  $("opening-now").textContent = opening.toFixed(1) + " mm";
  $("time-now").textContent = time.toFixed(2) + " s";
  $("phase").textContent = phase ? phase.name : "";
  $("time").value = String(time);
  if (document.activeElement !== $("opening")) $("opening").value = String(opening);
}
function request() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(frame);
}
function frame(now) {
  asked = false;
  if (playing) {
    time += Math.min(0.1, (now - last) / 1000) * speed;
    if (time > duration) time = 0;
    poseAt(time);
    request();
  }
  last = now;
  caption();
  draw();
}
function show(t) {
  time = Math.min(Math.max(t, 0), duration);
  poseAt(time);
  request();
}
function play(on) {
  playing = on && moves;
  last = performance.now();
  $("play").textContent = playing ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", String(playing));
  request();
}
function look(name) {
  [camera.azimuth, camera.elevation] = views[name];
  camera.zoom = 1;
  camera.target = middle.slice();
  request();
}

// ---- hands ----------------------------------------------------------------------------------
if (moves) {
  $("time").max = String(duration);
  $("time").step = String(duration / 500);
  $("opening").max = String(widest);
  $("opening").step = String(widest / 200);
  $("time").addEventListener("input", () => { play(false); show(Number($("time").value)); });
  $("opening").addEventListener("input", () => { play(false); show(timeOfOpening(Number($("opening").value))); });
  $("play").addEventListener("click", () => play(!playing));
  $("speed").addEventListener("change", () => { speed = Number($("speed").value); });
} else for (const row of document.querySelectorAll(".motion")) row.hidden = true;
$("face").value = String(faceOpacity);
$("face").addEventListener("input", () => { faceOpacity = Number($("face").value); request(); });
for (const name of Object.keys(shown)) {
  $(name).addEventListener("change", () => { shown[name] = $(name).checked; request(); });
  if (!surfaces.some((surface) => groupOf(surface) === name))
    $(name).parentElement.hidden = true;
}
if (!surfaces.some((surface) => surface.kind === "face")) $("face").parentElement.hidden = true;
for (const button of document.querySelectorAll("[data-view]"))
  button.addEventListener("click", () => look(button.dataset.view));

const fingers = new Map();
function pan(dx, dy) {
  const eye = eyeMatrix(), mm = 2 * eye.distance * Math.tan(fov / 2) / canvas.clientHeight;
  for (let k = 0; k < 3; ++k) camera.target[k] -= mm * (dx * eye.right[k] - dy * eye.up[k]);
}
function zoom(factor) { camera.zoom = Math.min(Math.max(camera.zoom * factor, 0.3), 12); }
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
});
canvas.addEventListener("pointermove", (event) => {
  const was = fingers.get(event.pointerId);
  if (!was) return;
  const dx = event.clientX - was[0], dy = event.clientY - was[1];
  if (fingers.size === 2) {
    const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
    zoom(Math.hypot(event.clientX - other[0], event.clientY - other[1]) /
         Math.max(1, Math.hypot(was[0] - other[0], was[1] - other[1])));
    pan(dx / 2, dy / 2);
  } else if (event.buttons & 6 || event.shiftKey) pan(dx, dy);
  else {
    camera.azimuth -= 0.35 * dx;
    camera.elevation = Math.min(88, Math.max(-88, camera.elevation + 0.35 * dy));
  }
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  request();
});
for (const end of ["pointerup", "pointercancel"])
  canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(Math.exp(-0.0012 * event.deltaY));
  request();
}, { passive: false });
canvas.addEventListener("dblclick", () => look("three-quarter"));
window.addEventListener("keydown", (event) => {
  if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
  if (event.key === " ") { event.preventDefault(); play(!playing); }
  if (event.key === "ArrowRight") { play(false); show(time + duration / 60); }
  if (event.key === "ArrowLeft") { play(false); show(time - duration / 60); }
});
window.addEventListener("resize", request);

// A link may name a moment: page.html#time=1.2&view=left&face=0.3
const link = new URLSearchParams(location.hash.slice(1));
if (link.has("face")) { faceOpacity = Number(link.get("face")); $("face").value = String(faceOpacity); }
look(views[link.get("view")] ? link.get("view") : "three-quarter");
if (link.has("time")) show(Number(link.get("time")));
else if (link.has("opening")) show(timeOfOpening(Number(link.get("opening"))));
else { show(0); play(true); }
frame(performance.now());
document.body.dataset.ready = "yes";
})();
