// The replay: one clock, two sides, and the controls.

const NOT_A_NUMBER = "–";
const show = (value, digits = 3) => {
  if (!Number.isFinite(value)) return NOT_A_NUMBER;
  // No exponents: a reader compares lengths.
  return (Math.abs(value) < 10 ** digits ? value.toPrecision(digits) : value.toFixed(0)).replace("-", "−");
};

class Player {
  constructor(root, packedScenes) {
    this.root = root;
    this.find = (selector) => root.querySelector(selector);
    this.packed = packedScenes;
    this.unpacked = new Map();
    this.sides = [...root.querySelectorAll(".side")];
    this.slider = this.find("#replay-time");
    this.fillScenes();
    this.listen();
    this.openScene(0);
  }

  fillScenes() {
    const menu = this.find("#replay-scene");
    this.packed.forEach((scene, i) => menu.add(new Option(scene.title, i)));
  }

  openScene(index) {
    this.pause();
    if (!this.unpacked.has(index)) this.unpacked.set(index, new Scene(this.packed[index]));
    this.scene = this.unpacked.get(index);
    this.camera = new Camera(this.scene);
    this.sides.forEach((side, i) => {
      const menu = side.querySelector("select");
      menu.replaceChildren(...this.scene.recordings.map((r, k) => new Option(r.algorithm.replaceAll("_", " "), k)));
      menu.selectedIndex = Math.min(i, this.scene.recordings.length - 1);
    });
    this.find("#replay-note").textContent = this.scene.note;
    this.find("#replay-deepest").textContent = `${show(this.scene.deepest * 1e3, 2)} mm`;
    this.find("#replay-speed").value = String(this.scene.speed);
    this.time = 0;
    this.chooseSides();
  }

  chooseSides() {
    this.shown = this.sides.map((side) => this.scene.recordings[side.querySelector("select").selectedIndex]);
    this.duration = Math.max(...this.shown.map((r) => r.endTime), 1e-6);
    const longest = this.shown.reduce((a, b) => (a.length > b.length ? a : b));
    this.step = longest.length > 1 ? longest.endTime / (longest.length - 1) : this.duration;
    this.slider.max = String(Math.round(this.duration / this.step));
    this.seek(Math.min(this.time, this.duration));
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.slider.value = String(Math.round(this.time / this.step));
    this.slider.setAttribute("aria-valuetext", `${show(this.time, 4)} seconds of ${show(this.duration, 4)}`);
    this.find("#replay-clock").textContent = `${this.time.toFixed(4)} s`;
    this.draw();
  }

  draw() {
    this.shown.forEach((recording, i) => this.drawSide(this.sides[i], recording));
    drawChart(this.find("#replay-chart"), this.shown, this.duration, this.time);
    // What is shown, for programs.
    this.root.dataset.time = String(this.time);
    this.root.dataset.scene = this.scene.id;
  }

  drawSide(side, recording) {
    const row = recording.rowAt(this.time);
    drawScene(side.querySelector(".view"), this.scene, this.camera, recording, row);
    drawField(side.querySelector(".field"), this.scene, recording, row);
    const value = (name) => recording.value(row, name);
    const inContact = recording.colliding[row] > 0;
    const ended = this.time > recording.endTime + this.step;
    const readings = {
      state: ended ? `ended: ${recording.outcome.replaceAll("_", " ")}` : inContact ? "in contact" : "free",
      colliding: `${recording.colliding[row]}`,
      rendered: `${recording.contactStart[row + 1] - recording.contactStart[row]}`,
      depth: inContact ? `${show(value("depth_max_m") * 1e3)} mm` : NOT_A_NUMBER,
      force: `${show(norm(recording.force(row)))} N`,
      ratio: inContact ? `${show(value("ratio_min"))} … ${show(value("ratio_max"))}` : NOT_A_NUMBER,
    };
    for (const [name, text] of Object.entries(readings)) side.querySelector(`[data-reading=${name}]`).textContent = text;
    side.dataset.row = String(row);
    side.dataset.tip = recording.tip(row).join(",");
    side.dataset.algorithm = recording.algorithm;
  }

  play() {
    if (this.time >= this.duration) this.seek(0);
    let before = null;
    const frame = (now) => {
      // A page that was hidden must not jump.
      const passed = before === null ? 0 : Math.min(0.1, (now - before) / 1000);
      before = now;
      this.seek(this.time + passed * Number(this.find("#replay-speed").value));
      if (this.time >= this.duration) this.pause();
      else this.playing = requestAnimationFrame(frame);
    };
    this.playing = requestAnimationFrame(frame);
    this.showPlaying();
  }

  pause() {
    cancelAnimationFrame(this.playing);
    this.playing = null;
    this.showPlaying();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  showPlaying() {
    const button = this.find("#replay-play");
    button.textContent = this.playing ? "❚❚ Pause" : "▶ Play";
    button.setAttribute("aria-pressed", String(Boolean(this.playing)));
    this.root.dataset.playing = String(Boolean(this.playing));
  }

  listen() {
    this.find("#replay-play").addEventListener("click", () => this.toggle());
    this.find("#replay-scene").addEventListener("change", (e) => this.openScene(Number(e.target.value)));
    this.slider.addEventListener("input", () => { this.pause(); this.seek(Number(this.slider.value) * this.step); });
    for (const side of this.sides) {
      side.querySelector("select").addEventListener("change", () => this.chooseSides());
      this.listenToView(side.querySelector(".view"));
    }
    const chart = this.find("#replay-chart");
    chart.addEventListener("pointerdown", (e) => { this.pause(); this.seek(chartTime(chart, e, this.duration)); });
    this.root.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.draw()).observe(this.root);
    document.addEventListener("themechange", () => this.draw());
  }

  listenToView(view) {
    view.addEventListener("pointerdown", (e) => view.setPointerCapture(e.pointerId));
    view.addEventListener("pointermove", (e) => {
      if (!view.hasPointerCapture(e.pointerId)) return;
      this.camera.drag(e.movementX, e.movementY);
      this.draw();
    });
    view.addEventListener("wheel", (e) => {
      // Only a view that was chosen takes the wheel; otherwise the page scrolls on.
      if (document.activeElement !== view) return;
      e.preventDefault();
      this.camera.zoomBy(Math.exp(-0.0015 * e.deltaY));
      this.draw();
    }, {passive: false});
  }

  /** Space plays; arrows step, or turn a chosen view with shift; plus, minus and zero zoom. */
  onKey(event) {
    const tag = event.target.tagName;
    if (tag === "SELECT" || (tag === "BUTTON" && event.key === " ") || event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = {ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12]}[event.key];
    const jump = {ArrowLeft: -1, ArrowRight: 1, PageDown: -50, PageUp: 50}[event.key];
    const zoom = {"+": 1.2, "=": 1.2, "-": 1 / 1.2}[event.key];
    if (event.key === " ") this.toggle();
    else if (event.shiftKey && turn) this.camera.drag(...turn);
    else if (zoom) this.camera.zoomBy(zoom);
    else if (event.key === "0") this.camera.reset();
    else if (event.key === "Home" || event.key === "End") this.seek(event.key === "Home" ? 0 : this.duration);
    else if (jump) { this.pause(); this.seek(this.time + jump * this.step); }
    else return;
    event.preventDefault();
    this.draw();
  }
}

const replayRoot = document.getElementById("replay-player");
if (replayRoot) window.player = new Player(replayRoot, JSON.parse(document.getElementById("replay-data").textContent));
