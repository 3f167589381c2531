// Handles the events of the page's menus, buttons, pointers and keys.

function listenToLive(live) {
  const {find} = live, on = (selector, event, action) => find(selector).addEventListener(event, action);
  on("#scene", "change", () => live.openScene(find("#scene").selectedIndex));
  for (const menu of ["#device", "#stage", "#views", "#stiffness"]) on(menu, "change", () => live.restart());
  for (const side of live.sides) {
    side.querySelector("select").addEventListener("change", () => live.restart());
    listenToHand(live, side.querySelector(".view"));
  }
  on("#frame", "change", () => { live.camera.show(find("#frame").value); live.draw(); });
  on("#run", "click", () => live.toggle());
  on("#step", "click", () => live.stepRows(1));
  on("#back", "click", () => live.back(1));
  on("#restart", "click", () => live.restart());
  on("#pace", "change", () => live.setPace());
  on("#tilt", "input", () => live.aim([...live.pointer.slice(0, 3), Number(find("#tilt").value), live.pointer[4]]));
  on("#azimuth", "input", () => live.aim([...live.pointer.slice(0, 4), Number(find("#azimuth").value)]));
  on("#keep", "click", () => live.begun && live.download().catch((error) => live.fail(error.message)));
  on("#sound", "click", () => switchSound(live));
  on("#gain", "input", () => showGain(live));
  on("#file", "change", () => { for (const file of find("#file").files) live.take(file); });
  showGain(live);
  const root = find("#live");
  root.addEventListener("dragover", (e) => { e.preventDefault(); root.classList.add("dropping"); });
  root.addEventListener("dragleave", () => root.classList.remove("dropping"));
  root.addEventListener("drop", (e) => {
    e.preventDefault();
    root.classList.remove("dropping");
    for (const file of e.dataTransfer.files) live.take(file);
  });
  document.addEventListener("visibilitychange", () => live.setPace());
  document.addEventListener("themechange", () => live.draw());
  addEventListener("hashchange", () => live.openAddress());
}

async function switchSound(live) {
  const {sound} = live, button = live.find("#sound");
  try {
    if (sound.on) sound.stop();
    else if (live.begun) await sound.start(1 / live.begun[0].step_s);
    if (sound.on && !live.running) await live.toggle(true);
  } catch (error) {
    live.say(`No sound here: ${error.message}`);
  }
  button.setAttribute("aria-pressed", String(sound.on));
}

function showGain(live) {
  const db = Number(live.find("#gain").value);
  live.sound.setGain(db);
  live.find("#gain-said").textContent = `1 N is ${NEWTON_DB + db} dB of full scale`.replaceAll("-", "−");
}

/** Handles pointers, wheel and keys in a view. */
function listenToHand(live, view) {
  const fingers = new Map();
  view.addEventListener("contextmenu", (e) => e.preventDefault());
  view.addEventListener("pointerdown", (e) => {
    if (!live.begun) return;
    view.setPointerCapture(e.pointerId);
    fingers.set(e.pointerId, e);
    if (isLeading(e, fingers)) {
      leadTo(live, view, e);
      if (!live.running) live.toggle(true);
    }
  });
  view.addEventListener("pointermove", (e) => {
    if (!live.begun || !fingers.has(e.pointerId)) return;
    const before = fingers.get(e.pointerId);
    fingers.set(e.pointerId, e);
    if (isLeading(e, fingers)) return leadTo(live, view, e);
    live.camera.drag((e.clientX - before.clientX) / fingers.size, (e.clientY - before.clientY) / fingers.size);
    live.draw();
  });
  for (const end of ["pointerup", "pointercancel"]) view.addEventListener(end, (e) => fingers.delete(e.pointerId));
  view.addEventListener("wheel", (e) => {
    if (!live.begun || (document.activeElement !== view && !fingers.size)) return;
    e.preventDefault();
    const turn = -0.001 * e.deltaY;
    if (e.ctrlKey) live.camera.zoomBy(Math.exp(2 * turn));
    else live.moveBy(e.altKey ? [0, 0, 0, 0, turn] : [0, 0, 0, turn, 0]);
    live.draw();
  }, {passive: false});
  view.addEventListener("keydown", (e) => onLiveKey(live, e));
}

const isLeading = (event, fingers) => fingers.size === 1 && !event.shiftKey && !(event.buttons & 2);

/** Moves the hand's target under the pointer, parallel to the picture: its distance to the viewer stays. */
function leadTo(live, view, event) {
  const {left, top} = view.getBoundingClientRect(), {clientWidth: width, clientHeight: height} = view;
  const project = live.camera.projection(width, height), at = project(live.pointer.slice(0, 3));
  const [right, up] = live.camera.basis();
  const dx = (event.clientX - left - at[0]) / project.scale, dy = (at[1] - (event.clientY - top)) / project.scale;
  live.moveBy([0, 1, 2].map((i) => dx * right[i] + dy * up[i]));
}

function onLiveKey(live, event) {
  if (!live.begun || event.ctrlKey || event.metaKey || event.altKey) return;
  const {key} = event, [right, up, toward] = live.camera.basis(), length = event.shiftKey ? 5e-4 : 5e-5;
  const along = {ArrowRight: right, ArrowLeft: right.map((x) => -x), ArrowUp: up, ArrowDown: up.map((x) => -x),
    PageUp: toward, PageDown: toward.map((x) => -x)}[key];
  const turn = {q: [-0.02, 0], e: [0.02, 0], a: [0, -0.05], d: [0, 0.05]}[key];
  const zoom = {"+": 1.2, "=": 1.2, "-": 1 / 1.2}[key];
  if (along) live.moveBy(along.map((x) => length * x));
  else if (turn) live.moveBy([0, 0, 0, ...turn]);
  else if (zoom) live.camera.zoomBy(zoom);
  else if (key === "0") live.camera.reset();
  else if (key === " ") live.toggle();
  else if (key === ".") live.stepRows(1);
  else if (key === ",") live.back(1);
  else if (key === "r") live.restart();
  else return;
  event.preventDefault();
  live.draw();
}
