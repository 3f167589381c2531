// The live page: starts runs in the worker, shows their values and handles the user's files.

const PACKED = JSON.parse(document.getElementById("packed").textContent);
/** Decodes base64 and decompresses gzip. Returns a promise of an ArrayBuffer. */
function unpressed(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}
/** Hand damping [N s/m] for a stiffness [N/m]: 3/4 of the critical damping of a mass of 0.1 kg. */
const dampingOf = (stiffness) => 1.5 * Math.sqrt(0.1 * stiffness);
/** Number of steps of a run that must not end before the user stops it. */
const ENDLESS = 1e9;

/** Sends orders to the worker (worker.js) and resolves a promise for each answer. */
class Worked {
  constructor(onFailure) {
    this.onFailure = onFailure;
    this.waiting = new Map();
    this.number = 0;
    const code = document.getElementById("worker-code").textContent;
    this.worker = new Worker(URL.createObjectURL(new Blob([code], {type: "text/javascript"})));
    this.worker.onmessage = ({data: {number, answer, failed}}) => {
      const settle = this.waiting.get(number);
      this.waiting.delete(number);
      if (failed === undefined) settle.resolve(answer);
      else if (settle) settle.reject(new Error(failed));
      else this.onFailure(failed);
    };
  }

  ask(order, given = {}) {
    return new Promise((resolve, reject) => {
      this.waiting.set(++this.number, {resolve, reject});
      this.worker.postMessage({order, number: this.number, ...given});
    });
  }
}

/** Replaces the value at a dotted path of a nested object. Creates missing objects on the path. */
function setPath(json, path, value) {
  const keys = path.split("."), last = keys.pop();
  let at = json;
  for (const key of keys) at = at[key] = typeof at[key] === "object" && at[key] !== null ? at[key] : {};
  at[last] = value;
}

const pathAndValue = (override) => {
  const at = override.indexOf("="), text = override.slice(at + 1);
  try {
    return [override.slice(0, at), JSON.parse(text)];
  } catch {
    return [override.slice(0, at), text];
  }
};

class Live {
  constructor() {
    this.find = (selector) => document.querySelector(selector);
    this.sides = [...document.querySelectorAll(".side")];
    this.files = new Map();
    this.sound = new LiveSound();
    this.worked = new Worked((message) => this.fail(message));
    this.scenes = PACKED.scenes.slice();
    this.fillMenus();
    listenToLive(this);
    this.ready = this.begin();
  }

  async begin() {
    // Compile asynchronously, because browsers refuse to compile a large module synchronously on the page's main
    // thread. The worker receives the compiled module.
    this.module = await WebAssembly.compile(await unpressed(PACKED.engine));
    const files = JSON.parse(new TextDecoder().decode(await unpressed(PACKED.files)));
    for (const [name, text] of Object.entries(files)) this.files.set(name, new TextEncoder().encode(text));
    await this.openAddress();
    requestAnimationFrame(() => this.frame());
  }

  fillMenus() {
    const fill = (selector, entries) => this.find(selector).replaceChildren(...entries.map((name, i) => new Option(name, i)));
    fill("#scene", this.scenes.map((scene) => scene.title));
    fill("#device", PACKED.devices.map((device) => device.title));
    fill("#stage", PACKED.stages.map((stage) => stage.title));
    this.sides.forEach((side) => side.querySelector("select").replaceChildren(
      ...PACKED.laws.map((law) => new Option(law.replaceAll("_", " "), law))));
  }

  get scene() { return this.scenes[this.find("#scene").selectedIndex]; }
  get shownSides() { return this.sides.slice(0, Number(this.find("#views").value)); }
  get handStiffness() { return Math.round(10 ** Number(this.find("#stiffness").value)); }

  /** Returns the overrides of a view's run. A later override takes precedence over an earlier override. */
  overrides(side) {
    const k = this.handStiffness, device = PACKED.devices[this.find("#device").selectedIndex];
    const hand = {type: "impedance", stiffness_N_per_m: k, damping_N_s_per_m: +dampingOf(k).toPrecision(4), target: {x_m: 0, y_m: 0, z_m: 0}};
    return [...this.scene.set, ...device.set, ...PACKED.stages[this.find("#stage").selectedIndex].set,
      `rendering.algorithm=${side.querySelector("select").value}`, `hand=${JSON.stringify(hand)}`, `time.steps=${ENDLESS}`, "time.stop_when=[]",
      "record={\"trajectory\":false,\"contacts\":false,\"stiffness_tensor\":false,\"energy\":false,\"ratio_iterations\":[],\"ideal_trajectory\":false}"];
  }

  /** Opens a scene and selects its force laws. */
  async openScene(index) {
    this.find("#scene").selectedIndex = index;
    const {laws, note} = this.scene;
    this.sides.forEach((side, i) => { side.querySelector("select").value = laws[i % laws.length]; });
    this.find("#note").textContent = note;
    await this.restart();
  }

  /** Starts new runs, for example after a change of the scene, a force law, the device or the hand. */
  async restart() {
    const shown = this.shownSides;
    this.sides.forEach((side) => { side.hidden = !shown.includes(side); });
    const sides = this.find(".sides");
    sides.dataset.views = shown.length;
    sides.style.setProperty("--views", shown.length);
    this.find("#stiffness-said").textContent = `${this.handStiffness} N/m`;
    this.runs = shown.map((side) => ({name: this.scene.scenario, overrides: this.overrides(side)}));
    this.begun = null;
    try {
      const {scenes, shell} = await this.worked.ask("start", {module: this.module, files: this.files, runs: this.runs});
      this.say("");
      this.begun = scenes;
      const [first] = scenes, springs = this.springsOf();
      this.viewed = viewedScene(first, shell, springs);
      const frame = this.find("#frame").value;
      this.camera = new Camera(this.viewed);
      this.camera.show(frame);
      this.pointer = [...first.initial_m, first.tilt_rad, first.azimuth_rad];
      this.trails = scenes.map((scene, i) => new Trail(scene.algorithm.replaceAll("_", " "), i, scene.step_s));
      this.showAngles();
      this.showKey();
      if (this.running) await this.setPace();
    } catch (error) {
      this.fail(error.message);
    }
  }

  springsOf() {
    const name = [...this.files.keys()].find((file) => file.endsWith(`/${this.scene.scenario}.json`) || file === this.scene.scenario);
    const groups = name ? (JSON.parse(new TextDecoder().decode(this.files.get(name))).environment || {}).groups || [] : [];
    return groups.map(({direction, count}) => [...direction, count]);
  }

  say(text) {
    const said = this.find("#said");
    said.textContent = text;
    said.classList.remove("failed");
  }
  fail(message) {
    this.begun = null;
    this.find("#said").textContent = `${message} – Restart begins anew.`;
    this.find("#said").classList.add("failed");
  }

  async toggle(running = !this.running) {
    this.running = running;
    const button = this.find("#run");
    button.textContent = running ? "❚❚ Stop" : "▶ Run";
    button.setAttribute("aria-pressed", String(running));
    await this.setPace();
  }
  async setPace() {
    if (this.begun) await this.worked.ask("pace", {pace: this.running && !document.hidden ? Number(this.find("#pace").value) : 0});
  }

  aim(pointer) {
    this.pointer = pointer;
    this.showAngles();
    if (this.begun) this.worked.ask("aim", {pointer}).catch(() => {});
  }
  moveBy(move) { this.aim(this.pointer.map((value, i) => value + (move[i] || 0))); }
  showAngles() {
    this.find("#tilt").value = String(this.pointer[3]);
    this.find("#azimuth").value = String(this.pointer[4]);
  }

  /** Stops continuous simulation, then simulates `rows` steps. */
  async stepRows(rows) {
    if (!this.begun) return;
    if (this.running) await this.toggle(false);
    await this.worked.ask("run", {rows});
  }
  async back(seconds) {
    if (!this.begun) return;
    const {step_s: step} = this.begun[0];
    await this.worked.ask("back", {rows: Math.round(seconds / step)});
    this.trails = this.begun.map((scene, i) => new Trail(scene.algorithm.replaceAll("_", " "), i, step));
    await this.worked.ask("run", {rows: 1});
    if (this.running) await this.setPace();
  }

  async frame() {
    try {
      if (this.begun) await this.update();
    } catch (error) {
      this.fail(error.message);
    }
    requestAnimationFrame(() => this.frame());
  }

  async update() {
    const shown = await this.worked.ask("show"), {trails} = this;
    if (!this.begun || shown.runs.length !== trails.length) return;
    shown.runs.forEach((run, i) => trails[i].add(run.rows, run.state));
    this.shown = shown;
    // Play sound in real time only: at a slower pace it would have gaps.
    if (this.find("#pace").value === "1") this.sound.play(trails.map((trail) => trail.heard));
    this.draw();
  }

  draw() {
    if (!this.shown || !this.begun) return;
    const {shown, trails} = this;
    this.shownSides.forEach((side, i) => {
      drawLive(side.querySelector(".view"), this.viewed, this.camera, trails[i], this.begun[i], shown.led);
      if (trails[i].last) drawField(side.querySelector(".field"), this.viewed, trails[i], 0);
      this.showReadings(side, shown.runs[i], trails[i]);
    });
    if (!(performance.now() - this.charted < 50)) {
      this.charted = performance.now();
      drawChart(this.find("#chart"), trails);
    }
    this.find("#clock").textContent = `${shown.time.toFixed(3)} s`;
    this.find("#factor").textContent = this.running ? `× ${shown.factor.toFixed(2)}` : "";
    this.find("#rows").textContent = String(shown.rows);
    this.find("#hash").textContent = shown.runs.map((run) => run.state.state_hash).join("  ");
  }

  showReadings(side, {state, ended}, trail) {
    if (!trail.last) return;
    const contacts = trail.last[ROW.contacts];
    const readings = {
      state: ended ? `ended: ${state.outcome.replaceAll("_", " ")}${state.fault ? ` (${state.fault})` : ""}` : contacts ? "in contact" : "free",
      contacts: String(contacts),
      depth: contacts ? `${show(trail.last[ROW.depth] * 1e3)} mm` : NOT_A_NUMBER,
      force: `${show(norm(vectorAt(trail.last, ROW.force)))} N`,
      vibration: `${show(trail.vibration.rms)} N`,
      created: `${show(state.energy_created_J * 1e3)} mJ`,
    };
    for (const [name, text] of Object.entries(readings)) side.querySelector(`[data-reading=${name}]`).textContent = text;
  }

  showKey() {
    const inColour = (part, trail) => {
      part.style.setProperty("--light", trail.colours.light);
      part.style.setProperty("--dark", trail.colours.dark);
      return part;
    };
    this.find("#key").replaceChildren(...this.trails.map((trail) =>
      inColour(Object.assign(document.createElement("b"), {textContent: trail.label, className: "run-name"}), trail)));
    this.trails.forEach((trail, i) => inColour(this.sides[i].querySelector(".swatch"), trail));
  }

  /** Returns the motion so far as a scenario with one view's force law, and the state hash of that view's run. */
  async kept(view = 0) {
    const {waypoints, runs} = await this.worked.ask("keep"), {rows, state_hash} = runs[view];
    const own = this.scene.own, base = own ? JSON.parse(own) : {extends: this.scene.scenario};
    for (const override of this.runs[view].overrides) setPath(base, ...pathAndValue(override));
    const profile = (i) => ({type: "waypoints", points: waypoints.map((w) => [w[0], w[i + 1]]), interpolation: "linear"});
    for (const [i, axis] of ["x_m", "y_m", "z_m"].entries()) setPath(base, `hand.target.${axis}`, profile(i));
    setPath(base, "motion.orientation.tilt_rad", profile(3));
    setPath(base, "motion.orientation.azimuth_rad", profile(4));
    delete base.record;
    delete base.time.duration_s;
    base.time.steps = rows;
    return {scenario: base, state_hash, name: `live_${this.scene.id}_${this.begun[view].algorithm}`};
  }

  async download() {
    const {scenario, state_hash, name} = await this.kept();
    const blob = new Blob([`${JSON.stringify(scenario, null, 1)}\n`], {type: "application/json"});
    const link = Object.assign(document.createElement("a"), {href: URL.createObjectURL(blob), download: `${name}.json`});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    this.say(`Kept as ${name}.json: "hapbench run ${name}.json" has the state ${state_hash}.`);
  }

  // Files of the user.

  async take(file) {
    const bytes = new Uint8Array(await file.arrayBuffer()), name = file.name;
    if (/\.json$/i.test(name)) return this.takeScenario(name, new TextDecoder().decode(bytes));
    this.files.set(`/own/${name}`, bytes);
    const scale = Number(this.find("#scale").value);
    const ask = (environment, tool, start) => JSON.stringify({
      time: {step_s: 0.0005, steps: 1}, environment: {type: "mesh", file: name, scale, ...environment}, tool, initial: {position_m: start},
      hand: {type: "impedance", target: {x_m: 0, y_m: 0, z_m: 0}}, rendering: {algorithm: "shaped_stiffness", stiffness_N_per_m: 20000}});
    try {
      // Load the mesh once to find its size, from which the tool's size and start follow.
      this.files.set("/own/size.json", new TextEncoder().encode(ask({}, {type: "bur", family: "ball", diameter_m: 0.001}, [0, 0, 900])));
      const {scenes: [{box_m: [low, high]}]} = await this.worked.ask("start", {module: this.module, files: this.files, runs: [{name: "/own/size.json", overrides: []}]});
      const size = Math.max(...low.map((x, i) => high[i] - x)), diameter = +(size / 8).toPrecision(2);
      const start = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + diameter].map((x) => +x.toPrecision(6));
      await this.takeScenario(name, ask({spacing_m: +(diameter / 8).toPrecision(2)}, {type: "bur", family: "ball", diameter_m: diameter}, start));
    } catch (error) {
      this.fail(error.message);
    }
  }

  async takeScenario(name, text) {
    try {
      JSON.parse(text);
    } catch (error) {
      return this.fail(`${name}: ${error.message}`);
    }
    const file = `/own/${name.replace(/\.[^.]*$/, "")}.json`, id = name.replace(/[^A-Za-z0-9_]+/g, "_");
    this.files.set(file, new TextEncoder().encode(text));
    const law = (JSON.parse(text).rendering || {}).algorithm || "shaped_stiffness";
    this.scenes.push({id, title: name, scenario: file, note: `Your own: ${name}.`, laws: [law, "mean"], set: [], own: text});
    const menu = this.find("#scene");
    menu.add(new Option(name, this.scenes.length - 1));
    await this.openScene(this.scenes.length - 1);
  }

  /** Opens the scene that the page's address names: #scene=ID, or #scenario=JSON in links of the report. Otherwise
   *  opens the first scene. */
  async openAddress() {
    const [key, value] = location.hash.slice(1).split(/=(.*)/s);
    if (key === "scenario") return this.takeScenario("linked.json", decodeURIComponent(value));
    await this.openScene(Math.max(0, this.scenes.findIndex((scene) => key === "scene" && scene.id === value)));
  }
}

window.live = new Live();
