// Handles the events of the player's buttons, menus, keys and pointers.

function listenToPlayer(player) {
  const {find, slider, tracks} = player;
  const on = (selector, event, action) => find(selector).addEventListener(event, action);
  on("#replay-play", "click", () => player.toggle());
  on("#replay-back", "click", () => player.stepRows(-1));
  on("#replay-on", "click", () => player.stepRows(1));
  on("#replay-scene", "change", (e) => player.openScene(Number(e.target.value)));
  on("#replay-views", "change", () => player.chooseViews());
  on("#replay-frame", "change", (e) => { player.camera.show(e.target.value); player.draw(); });
  on("#replay-log", "change", () => player.draw());
  slider.addEventListener("input", () => { player.pause(); player.seek(Number(slider.value) * player.step); });
  for (const side of player.sides) {
    side.querySelector("select").addEventListener("change", () => player.chooseViews());
    listenToView(player, side.querySelector(".view"));
  }
  const goTo = (e) => { player.pause(); player.seek(trackTime(tracks, e, player.duration)); };
  tracks.addEventListener("pointerdown", (e) => { tracks.setPointerCapture(e.pointerId); goTo(e); });
  tracks.addEventListener("pointermove", (e) => { if (tracks.hasPointerCapture(e.pointerId)) goTo(e); });
  listenToSound(player);
  on("#replay-link", "click", () => linkMoment(player));
  on("#replay-picture", "click", () => { savePicture(player); say(player, "Picture saved."); });
  on("#replay-clip", "click", () => (player.clip ? player.pause() : startClip(player)));
  find("#replay-clip").disabled = !Clip.possible;
  player.root.addEventListener("keydown", (event) => onKey(player, event));
  document.addEventListener("keydown", (event) => onSpaceOutside(player, event));
  new ResizeObserver(() => player.draw()).observe(player.root);
  document.addEventListener("themechange", () => player.draw());
  addEventListener("hashchange", () => openMoment(player));
}

function listenToView(player, view) {
  view.addEventListener("pointerdown", (e) => view.setPointerCapture(e.pointerId));
  view.addEventListener("pointermove", (e) => {
    if (!view.hasPointerCapture(e.pointerId)) return;
    if (e.shiftKey) player.camera.shift(e.movementX, e.movementY);
    else player.camera.drag(e.movementX, e.movementY);
    player.draw();
  });
  view.addEventListener("wheel", (e) => {
    // Zoom only if the view has the focus; otherwise the wheel scrolls the page.
    if (document.activeElement !== view) return;
    e.preventDefault();
    player.camera.zoomBy(Math.exp(-0.0015 * e.deltaY));
    player.draw();
  }, {passive: false});
}

/** Handles keys. Space plays or pauses; left and right arrows step by one row, Page Up and Page Down by 50; Home and
 *  End seek; shift with an arrow turns the view; +, - and 0 zoom; a plays the sound of the next run. */
function onKey(player, event) {
  const {target, key} = event, tag = target.tagName;
  const range = target.type === "range" && target !== player.slider;
  if (tag === "SELECT" || range || (tag !== "CANVAS" && target !== player.slider && key === " ")) return;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const turn = {ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12]}[key];
  const jump = {ArrowLeft: -1, ArrowRight: 1, PageUp: -50, PageDown: 50}[key];
  const zoom = {"+": 1.2, "=": 1.2, "-": 1 / 1.2}[key];
  if (key === " ") player.toggle();
  else if (event.shiftKey && turn) player.camera.drag(...turn);
  else if (zoom) player.camera.zoomBy(zoom);
  else if (key === "0") player.camera.reset();
  else if (key === "a") hearNext(player);
  else if (key === "Home" || key === "End") player.seek(key === "Home" ? 0 : player.duration);
  else if (jump) player.stepRows(jump);
  else return;
  event.preventDefault();
  player.draw();
}

/** Handles space if no control has the focus: plays or pauses a replay in the middle of the window. */
function onSpaceOutside(player, event) {
  const idle = event.target === document.body || event.target.id === "main";
  if (!idle || event.key !== " " || event.shiftKey || event.ctrlKey || event.metaKey || event.altKey) return;
  const {top, bottom} = player.root.getBoundingClientRect();
  if (top > innerHeight / 2 || bottom < innerHeight / 2) return;
  event.preventDefault();
  player.toggle();
}

// Sound.

function showSoundChoice(player) {
  const menu = player.find("#replay-sound-of"), possible = player.shown.some((r) => r.sound);
  menu.replaceChildren(...player.shown.map((r, i) => {
    const option = new Option(r.sound ? `${String.fromCharCode(65 + i)}: ${r.label}` : `${r.label} (too few rows)`, i);
    option.disabled = !r.sound;
    return option;
  }));
  player.find("#replay-sound-bar").toggleAttribute("data-hidden", !possible);
  player.find("#replay-sound-next").toggleAttribute("data-hidden", player.shown.length === 1);
  hear(player, Math.max(0, player.shown.findIndex((r) => r.sound)));
}

function hear(player, index) {
  player.heard = index;
  player.find("#replay-sound-of").selectedIndex = index;
  player.root.dataset.heard = String(index);
}

function hearNext(player) {
  const n = player.shown.length;
  for (let i = 1; i <= n; ++i) {
    const next = (player.heard + i) % n;
    if (player.shown[next].sound) return hear(player, next);
  }
}

function listenToSound(player) {
  const button = player.find("#replay-sound");
  button.addEventListener("click", () => {
    if (player.sound.on) player.sound.stop();
    else player.sound.start();
    button.setAttribute("aria-pressed", String(player.sound.on));
    // Start the replay, because a paused replay has no sound.
    if (player.sound.on && !player.playing) player.play();
  });
  player.find("#replay-sound-of").addEventListener("change", (e) => hear(player, Number(e.target.value)));
  player.find("#replay-sound-next").addEventListener("click", () => hearNext(player));
  player.find("#replay-volume").addEventListener("input", (e) => player.sound.setVolume(Number(e.target.value)));
}

// Moments.

/** Shows one button per kind of worst moment. It seeks the moment of the shown run with the largest value. */
function showWorstMoments(player) {
  const kinds = new Map(), moments = player.shown.flatMap((recording) => recording.worst.map((moment) => ({...moment, recording})));
  const isSettled = (moment) => moment.title.startsWith("settled");
  for (const moment of moments) {
    // Prefer settled moments. A moment of a landing counts only if no shown run has a settled moment of this kind.
    const kind = moment.title.replace("settled ", ""), known = kinds.get(kind);
    const worse = !known || (isSettled(known) === isSettled(moment) ? moment.value > known.value : isSettled(moment));
    if (moment.value > 0 && worse) kinds.set(kind, moment);
  }
  player.find("#replay-worst").replaceChildren(...[...kinds.values()].map((moment) => {
    const whose = player.shown.length > 1 ? `, ${moment.recording.label}` : "";
    const among = player.shown.length < player.scene.recordings.length ? " in view" : "";
    const button = Object.assign(document.createElement("button"), {type: "button",
      textContent: `Largest ${moment.title}${among}: ${show(moment.value)} ${moment.unit} at ${+moment.time.toPrecision(4)} s${whose}`});
    button.addEventListener("click", () => { player.pause(); player.seek(moment.time); });
    return button;
  }));
}

const say = (player, text) => { player.find("#replay-said").textContent = text; };

/** Writes scene, time and shown runs into the page's address, #replay=SCENE,t=SECONDS,runs=0+2, and copies it. */
function linkMoment(player) {
  const runs = player.shown.map((r) => player.scene.recordings.indexOf(r)).join("+");
  const hash = `#replay=${encodeURIComponent(player.scene.id)},t=${+player.time.toFixed(6)},runs=${runs}`;
  history.replaceState(null, "", hash);
  const told = () => say(player, "The address now leads to this moment; it is in the clipboard.");
  const untold = () => say(player, "The address now leads to this moment: copy it from the address bar.");
  if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(told, untold);
  else untold();
}

function openMoment(player) {
  const parts = location.hash.slice(1).split(",").map((part) => part.split("="));
  const {replay, t, runs} = Object.fromEntries(parts.map(([key, value = ""]) => [key, decodeURIComponent(value)]));
  const scene = player.packed.findIndex((packed) => packed.id === replay);
  if (scene < 0) return;
  player.openScene(scene);
  const indices = (runs || "").split("+").map(Number).filter((i) => Number.isInteger(i) && i >= 0 && i < player.scene.recordings.length);
  if (runs && indices.length) {
    player.find("#replay-views").value = String(Math.min(indices.length, player.sides.length));
    indices.slice(0, player.sides.length).forEach((run, i) => { player.sides[i].querySelector("select").selectedIndex = run; });
    player.chooseViews();
  }
  player.seek(Number(t) || 0);
  player.root.scrollIntoView();
}

// Clips.

function startClip(player) {
  if (player.time >= player.duration) player.seek(0);
  player.clip = new Clip(player);
  showClip(player);
  say(player, "Recording until the end or the next click.");
  player.play();
}

function stopClip(player) {
  player.clip.stop();
  player.clip = null;
  showClip(player);
  say(player, "Clip saved.");
}

function showClip(player) {
  const button = player.find("#replay-clip");
  button.textContent = player.clip ? "Stop and save clip" : "Save clip";
  button.setAttribute("aria-pressed", String(Boolean(player.clip)));
}

const replayRoot = document.getElementById("replay-player");
if (replayRoot) window.player = new Player(replayRoot, JSON.parse(document.getElementById("replay-data").textContent));
