// The script of page.html.
"use strict";
const $ = (id) => document.getElementById(id);
const canvas = $("picture"), divider = $("divider"), pen = canvas.getContext("2d");
const viewer = crypto.getRandomValues(new Uint32Array(2)).join("-");
const rest = {yaw: 0, pitch: 0, zoom: 1};
const settle_ms = 500;  // for so long after an input, the page knows better than an older state
let state = null, orbit = {...rest}, cut = 0.5, input_at = -Infinity;

// Settings are sent one request after the other; what is overtaken meanwhile is never sent.
let wanted = null, is_sending = false, problem = "";
function merged(before, change) {
  const both = {...before, ...change};
  if (before?.parameters && change.parameters)
    both.parameters = {...before.parameters, ...change.parameters};
  return both;
}
async function send(change) {
  input_at = performance.now();
  wanted = merged(wanted, change);
  if (is_sending) return;
  is_sending = true;
  while (wanted) {
    const body = JSON.stringify(wanted);
    wanted = null;
    try {
      const reply = await fetch("settings", {method: "POST", body});
      problem = reply.ok ? "" : await reply.text();
    } catch { /* the next state says so */ }
  }
  is_sending = false;
  if (state) show();
}

// Pictures, by mode: one request at a time for each, and another one if there is news by then.
const pictures = {};
async function load(view) {
  const picture = pictures[view.mode] ??= {key: "", is_loading: false, bitmap: null, range: null};
  const key = `${view.image} ${state.layer} ${state.exposure} ${state.curve}`;
  if (!view.image || picture.is_loading || picture.key === key) return;
  picture.is_loading = true;
  try {
    const reply = await fetch(`image?mode=${view.mode}&version=${view.image}`);
    if (reply.status !== 200) return;  // there is none yet
    picture.bitmap = await createImageBitmap(await reply.blob());
    picture.range = reply.headers.get("X-Range");
    picture.key = key;
    draw();
  } catch {
    return;  // the next state asks again
  } finally {
    picture.is_loading = false;
  }
  for (const one of state.views) load(one);
}

const units = {rays: "rays per sample", bounces: "bounces", samples: "samples",
               variance: "standard error", depth: "depth", collision: "distance"};
function show_legend(range) {
  $("legend").hidden = !range;
  if (!range) return;
  const [low, high] = range.split(" ").map((x) => Number(x).toPrecision(3));
  $("low").textContent = `${low} ${units[state.layer] ?? ""}`;
  $("high").textContent = high;
}

function draw() {
  const shown = state.views.map((view) => pictures[view.mode]).filter((one) => one?.bitmap);
  const is_split = shown.length > 1;
  for (const id of ["divider", "left", "right"]) $(id).hidden = !is_split;
  if (shown.length === 0) return;
  const {width, height} = shown[0].bitmap;
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  $("stage").style.maxWidth =
    `min(calc((100vh - 9rem) * ${width / height}), ${Math.max(4 * width / state.scale, 320)}px)`;
  pen.drawImage(shown[0].bitmap, 0, 0);
  show_legend(shown[0].range);
  if (!is_split) return;
  const at = Math.round(cut * width);
  if (at < width)
    pen.drawImage(shown[1].bitmap, at, 0, width - at, height, at, 0, width - at, height);
  divider.style.left = `${100 * cut}%`;
  divider.setAttribute("aria-valuenow", Math.round(100 * cut));
  $("left").textContent = state.views[0].mode;
  $("right").textContent = state.views[1].mode;
}

// Numbers.
const percent = (x) => x === null ? "–" : `${(100 * x).toPrecision(3)} %`;
function duration(ms) {
  const s = ms / 1000;
  if (s < 100) return `${s.toPrecision(2)} s`;
  if (s < 6000) return `${Math.round(s / 60)} min`;
  return s < 360000 ? `${(s / 3600).toPrecision(2)} h` : `${Math.round(s / 86400)} days`;
}
const milliseconds = (ms) => `${ms < 100 ? ms.toPrecision(3) : Math.round(ms)} ms`;
function element(name, text, kind) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function show_figures() {
  $("figures").replaceChildren(...state.views.map((view) => {
    const row = element("tr"), name = element("th", view.mode);
    name.scope = "row";
    row.append(name, element("td", view.samples), element("td", percent(view.error)),
               element("td", view.pass_samples, "wide"),
               element("td", view.pass_ms.toFixed(1), "wide"),
               element("td", view.msamples_per_s.toPrecision(3)));
    return row;
  }));
}

// An error falls with the root of the samples.
let samples_needed = 0;
function show_forecast() {
  const [view] = state.views, target = Number($("target").value);
  $("forecast").hidden = !(view.error > 0 && view.samples >= 4);
  if ($("forecast").hidden) return;
  samples_needed = Math.ceil(view.samples * (view.error / target) ** 2);
  const ms = state.views.reduce((sum, one) => sum + one.wall_ms / Math.max(one.samples, 1), 0);
  const more = samples_needed - view.samples;
  $("needs").textContent = more <= 0 ? "is reached."
    : `needs about ${samples_needed} samples: ${duration(more * ms)} more.`;
  $("enough").hidden = samples_needed <= state.spp || samples_needed > 2147483647;
}

function show_ratio() {
  const ratio = state.ratio;
  $("ratio").hidden = state.views.length < 2;
  if (state.views.length < 2) return;
  const [a, b] = state.views.map((view) => view.mode);
  const verdict = !ratio ? "" : ratio.low > 1 ? `Faster: ${b}.` : ratio.high < 1
    ? `Faster: ${a}.` : "No difference is shown.";
  $("ratio").textContent = ratio
    ? `${a} takes ${ratio.value.toFixed(3)} times as long as ${b} (95 %: ${ratio.low.toFixed(3)} ` +
      `to ${ratio.high.toFixed(3)}, ${ratio.rounds} rounds). ${verdict}`
    : "The ratio of the two times needs five rounds of samples.";
}

const colors = ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#76b7b2", "#edc948", "#b07aa1",
                "#ff9da7", "#9c755f", "#d4a6c8", "#499894", "#d37295", "#bab0ac"];
const color_of = new Map([["between stages", "#8888"]]);
function stage_color(stage) {
  if (!color_of.has(stage)) color_of.set(stage, colors[color_of.size % colors.length]);
  return color_of.get(stage);
}

/** A bar for each mode, as long as its time per sample, and its stages. */
function show_stages() {
  const rows = state.views.filter((view) => view.samples > 0).map((view) => {
    const stages = Object.entries(view.stages).map(([name, ms]) => [name, ms / view.samples]);
    const sum = stages.reduce((all, [, ms]) => all + ms, 0);
    const ms = Math.max(view.kernel_ms / view.samples, sum);
    if (ms > 1.01 * sum) stages.push(["between stages", ms - sum]);
    return {mode: view.mode, stages, ms};
  });
  const longest = Math.max(...rows.map((row) => row.ms));
  $("stages").replaceChildren(...rows.flatMap(({mode, stages, ms}) => {
    const bar = element("div", undefined, "bar"), list = element("div", undefined, "stages");
    bar.style.width = `${100 * ms / longest}%`;
    list.append(element("b", `${mode}: ${milliseconds(ms)} per sample`));
    for (const [name, stage_ms] of stages.filter(([, one]) => one > 0)) {
      const part = element("i"), swatch = element("i"), item = element("span");
      part.style.flexGrow = stage_ms;
      part.style.background = swatch.style.background = stage_color(name);
      part.title = `${name}: ${milliseconds(stage_ms)}`;
      item.append(swatch, `${name} ${Math.round(100 * stage_ms / ms)} %`);
      bar.append(part);
      list.append(item);
    }
    return [bar, list];
  }));
}

function show_settings() {
  if (is_sending || performance.now() - input_at < settle_ms) return;
  orbit = {...state.orbit};
  const values = {mode: state.mode, width: state.size[0], height: state.size[1],
                  scale: state.scale, spp: state.spp, layer: state.layer,
                  exposure: state.exposure, curve: state.curve};
  for (const [id, value] of Object.entries(values))
    if (document.activeElement !== $(id) || $(id).type !== "number") $(id).value = value;
  $("stops").textContent = state.exposure.toFixed(1);
  $("exposure").disabled = $("curve").disabled = state.layer !== "color";
  $("pause").textContent = state.paused ? "go on" : "pause";
  $("pause").setAttribute("aria-pressed", state.paused);
  show_time(state.time);
  show_parameters();
}

function show_time(time) {
  $("motion").hidden = !state.shutter;
  if (!state.shutter) return;
  [$("time").min, $("time").max] = state.shutter;
  $("time").value = time ?? state.shutter[0];
  $("seconds").textContent = time === null ? "" : `${time.toPrecision(3)} s`;
  $("blur").setAttribute("aria-pressed", time === null);
}

function status_text() {
  if (state.status === "failed") return state.error;
  const samples = Math.min(...state.views.map((view) => view.samples));
  return `${state.status}: ${samples} of ${state.spp} samples per pixel`;
}

function show() {
  document.title = `ptexp view: ${state.scene}`;
  $("scene").textContent = `${state.scene} on ${state.device}`;
  $("status").textContent = problem || status_text();
  $("status").classList.toggle("problem", problem !== "" || state.status === "failed");
  if ($("layer").options.length === 0)
    $("layer").append(...state.layers.map((name) => new Option(name)));
  $("why").textContent = state.views.filter((view) => view.mode === "auto" && view.used)
    .map((view) => `${view.used}: ${view.why}`).join();
  for (const form of ["png", "exr"]) $(form).href = `save?mode=${state.views[0].mode}&form=${form}`;
  if (pointers.size === 0) show_settings();
  show_figures();
  show_forecast();
  show_ratio();
  show_stages();
  draw();
  for (const view of state.views) load(view);
}

async function listen() {
  for (let after = 0; ;) {
    try {
      const reply = await fetch(`state?after=${after}&viewer=${viewer}`);
      if (!reply.ok) throw new Error(reply.status);
      state = await reply.json();
      after = state.version;
      show();
    } catch {
      $("status").textContent = "no connection: ptexp view has ended";
      $("status").classList.add("problem");
      after = 0;
      await new Promise((resume) => setTimeout(resume, 1000));
    }
  }
}

// The camera. Two pointers, as fingers are, change the distance.
function turn(yaw, pitch, zoom = 1) {
  if (!state) return;
  const bound = (x, [least, most]) => Math.min(Math.max(x, least), most);
  orbit = {yaw: (orbit.yaw + yaw) % 360, pitch: bound(orbit.pitch + pitch, state.pitch_range),
           zoom: bound(orbit.zoom * zoom, [0.001, 1000])};
  send({orbit});
}
function reset() {
  orbit = {...rest};
  send({orbit});
}
const pointers = new Map();
function spread() {
  const [a, b] = [...pointers.values()];
  return Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1);
}
canvas.addEventListener("pointerdown", (event) => {
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const last = pointers.get(event.pointerId), now = {x: event.clientX, y: event.clientY};
  if (!last) return;
  const before = pointers.size > 1 ? spread() : 0;
  pointers.set(event.pointerId, now);
  const degrees = 180 / Math.max(canvas.clientHeight, 100);
  if (before) turn(0, 0, before / spread());
  else turn((last.x - now.x) * degrees, (now.y - last.y) * degrees);
});
for (const name of ["pointerup", "pointercancel"])
  canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  turn(0, 0, Math.exp(event.deltaY * (event.deltaMode ? 0.03 : 0.001)));
}, {passive: false});
canvas.addEventListener("dblclick", reset);

async function copy(form) {
  const text = state.camera[form];
  $("copied").textContent = text;
  $("copied").hidden = false;
  try {
    await navigator.clipboard.writeText(text);
    $("copy_note").textContent = "copied:";
  } catch {
    $("copy_note").textContent = "The browser refuses the clipboard; copy it from here:";
  }
}

// The parameters of materials and lights: made when they are first looked at.
let parameters = null;
const short = (x) => Number(x.toPrecision(6));
/** A colour of the same hue, as bright as a display can show it. */
function hex_of(color) {
  const most = Math.max(...color, 1);
  const encode = (x) => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
  return "#" + color.map((x) => Math.round(255 * encode(Math.max(x, 0) / most)).toString(16)
    .padStart(2, "0")).join("");
}
function color_of_hex(hex, most) {
  const decode = (x) => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
  return [1, 3, 5].map((at) => short(most * decode(parseInt(hex.slice(at, at + 2), 16) / 255)));
}

function parameter_row(parameter) {
  const row = element("div", undefined, "row");
  const word = parameter.name.slice(parameter.name.lastIndexOf(".") + 1);
  const inputs = parameter.value.map((_, i) => {
    const input = element("input");
    Object.assign(input, {type: "number", step: "any", ariaLabel: `${parameter.name} ${i}`});
    return input;
  });
  const values = () => inputs.map((input) => Number(input.value));
  const set = (list) => send({parameters: {[parameter.name]: list}});
  for (const input of inputs)
    input.addEventListener("change", () => { if (input.value !== "") set(values()); });
  row.append(element("span", word));
  let swatch = null;
  if (inputs.length === 3 && word !== "eta" && word !== "k") {
    swatch = element("input");
    Object.assign(swatch, {type: "color", ariaLabel: parameter.name});
    swatch.addEventListener("input", () => {
      const color = color_of_hex(swatch.value, Math.max(...values(), 1));
      inputs.forEach((input, i) => { input.value = color[i]; });
      set(color);
    });
    row.append(swatch);
  }
  row.append(...inputs);
  parameter.show = () => {
    const now = state.parameters[parameter.name] ?? parameter.value;
    row.classList.toggle("edited", parameter.name in state.parameters);
    inputs.forEach((input, i) => {
      if (document.activeElement !== input) input.value = short(now[i]);
    });
    if (swatch) swatch.value = hex_of(now);
  };
  return row;
}

async function list_parameters() {
  const list = await (await fetch("parameters")).json();
  parameters = [...grouped(list)].map(([name, members]) => {
    const group = element("section");
    group.append(element("h3", name), ...members.map(parameter_row));
    return {name, members, group};
  });
  $("list").replaceChildren(...parameters.map(({group}) => group));
  show_parameters();
}
/** By their names without the last word. */
function grouped(list) {
  const groups = new Map();
  for (const one of list) {
    const group = one.name.slice(0, one.name.lastIndexOf("."));
    groups.set(group, [...groups.get(group) ?? [], one]);
  }
  return groups;
}
function show_parameters() {
  if (!$("parameters").open) return;
  for (const {members} of parameters ?? []) for (const one of members) one.show();
}
$("parameters").addEventListener("toggle", () => {
  if ($("parameters").open) parameters ? show_parameters() : list_parameters();
});
$("filter").addEventListener("input", () => {
  const words = $("filter").value.toLowerCase();
  for (const {name, group} of parameters ?? []) group.hidden = !name.toLowerCase().includes(words);
});
$("as_loaded").addEventListener("click", () => send({parameters: null}));

// Controls.
const pause = () => send({paused: !state.paused});
$("pause").addEventListener("click", pause);
$("reset").addEventListener("click", reset);
$("keys").addEventListener("click", () => $("help").showModal());
$("copy_options").addEventListener("click", () => copy("options"));
$("copy_xml").addEventListener("click", () => copy("xml"));
$("target").addEventListener("change", show_forecast);
$("enough").addEventListener("click", () => send({spp: samples_needed}));
for (const id of ["mode", "layer", "curve"])
  $(id).addEventListener("change", () => send({[id]: $(id).value}));
$("scale").addEventListener("change", () => send({scale: Number($("scale").value)}));
$("spp").addEventListener("change", () => send({spp: Number($("spp").value)}));
function set_time(time) {
  show_time(time);
  send({time});
}
$("time").addEventListener("input", () => set_time(Number($("time").value)));
$("blur").addEventListener("click", () => set_time(null));
for (const id of ["width", "height"])
  $(id).addEventListener("change",
                         () => send({size: [Number($("width").value), Number($("height").value)]}));
function expose(exposure) {
  $("exposure").value = exposure;
  $("stops").textContent = exposure.toFixed(1);
  send({exposure});
}
$("exposure").addEventListener("input", () => expose(Number($("exposure").value)));
function choose_next(id) {
  const select = $(id);
  select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
  select.dispatchEvent(new Event("change"));
}

const keys = {
  ArrowLeft: () => turn(-5, 0), ArrowRight: () => turn(5, 0), ArrowUp: () => turn(0, 5),
  ArrowDown: () => turn(0, -5), "+": () => turn(0, 0, 0.9), "-": () => turn(0, 0, 1 / 0.9),
  " ": pause, r: reset, m: () => choose_next("mode"), l: () => choose_next("layer"),
  t: () => choose_next("curve"), "[": () => expose(Number($("exposure").value) - 0.5),
  "]": () => expose(Number($("exposure").value) + 0.5),
  s: () => $("png").click(), e: () => $("exr").click(),
  c: () => copy("options"), x: () => copy("xml"), "?": () => $("help").showModal(),
};
addEventListener("keydown", (event) => {
  const presses = event.key === " " && event.target.closest("button, a, summary");
  if (presses || event.target.closest("input, select, dialog, #divider") || event.ctrlKey ||
      event.metaKey || event.altKey || !state) return;
  const action = keys[event.key];
  if (!action) return;
  event.preventDefault();
  action();
});

// The border between two modes.
function move_cut(to) {
  cut = Math.min(Math.max(to, 0), 1);
  draw();
}
divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
divider.addEventListener("pointermove", (event) => {
  if (!divider.hasPointerCapture(event.pointerId)) return;
  const box = canvas.getBoundingClientRect();
  move_cut((event.clientX - box.left) / box.width);
});
divider.addEventListener("keydown", (event) => {
  if (event.key === "ArrowLeft") move_cut(cut - 0.02);
  if (event.key === "ArrowRight") move_cut(cut + 0.02);
});

addEventListener("pagehide",
                 () => fetch(`leave?viewer=${viewer}`, {method: "POST", keepalive: true}));
listen();
