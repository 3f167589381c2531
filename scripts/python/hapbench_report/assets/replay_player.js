// Player of the replay: one clock, up to four views, and the controls.

class Player {
  constructor(root, packedScenes) {
    this.root = root;
    this.find = (selector) => root.querySelector(selector);
    this.packed = packedScenes;
    this.unpacked = new Map();
    this.sides = [...root.querySelectorAll(".side")];
    this.slider = this.find("#replay-time");
    this.tracks = this.find("#replay-chart");
    this.sound = new Sound();
    this.fillScenes();
    this.openScene(0);
    listenToPlayer(this);
    openMoment(this);
  }

  fillScenes() {
    const menu = this.find("#replay-scene");
    this.packed.forEach((scene, i) => menu.add(new Option(scene.title, i)));
    if (this.packed.length === 1) this.find("[data-single]").dataset.hidden = "";
  }

  openScene(index) {
    this.pause();
    if (!this.unpacked.has(index)) this.unpacked.set(index, new Scene(this.packed[index]));
    this.scene = this.unpacked.get(index);
    this.find("#replay-scene").selectedIndex = index;
    this.camera = new Camera(this.scene);
    this.find("#replay-frame").value = this.camera.frame;
    const recordings = this.scene.recordings, most = Math.min(this.sides.length, recordings.length);
    this.sides.forEach((side, i) => {
      const menu = side.querySelector("select");
      menu.replaceChildren(...recordings.map((r, k) => new Option(r.label, k)));
      menu.selectedIndex = Math.min(i, recordings.length - 1);
    });
    const views = this.find("#replay-views");
    views.replaceChildren(...Array.from({length: most}, (_, i) => new Option(i + 1, i + 1)));
    views.value = String(Math.min(2, most));
    this.find("#replay-note").textContent = this.scene.note;
    this.find("#replay-deepest").textContent = `${show(this.scene.deepest * 1e3, 2)} mm`;
    this.find("#replay-speed").value = String(this.scene.speed);
    this.time = 0;
    this.chooseViews();
  }

  get visibleSides() { return this.sides.slice(0, Number(this.find("#replay-views").value)); }

  /** Updates the player. Called after a change of the shown runs or of the number of views. */
  chooseViews() {
    const visible = this.visibleSides;
    this.sides.forEach((side) => { side.hidden = !visible.includes(side); });
    const sides = this.find(".sides");
    sides.dataset.views = visible.length;
    sides.style.setProperty("--views", visible.length);
    this.shown = visible.map((side) => this.scene.recordings[side.querySelector("select").selectedIndex]);
    this.duration = Math.max(...this.shown.map((r) => r.endTime), 1e-6);
    // The run with the largest number of rows determines the step of the slider.
    this.finest = this.shown.reduce((a, b) => (a.length >= b.length ? a : b));
    this.step = this.finest.length > 1 ? this.finest.endTime / (this.finest.length - 1) : this.duration;
    this.slider.max = String(Math.round(this.duration / this.step));
    this.find("#replay-log").checked = needsLogarithm(this.shown);
    this.hideWhatIsMissing();
    showWorstMoments(this);
    showSoundChoice(this);
    this.seek(Math.min(this.time, this.duration));
  }

  hideWhatIsMissing() {
    const has = {contacts: this.shown.some((r) => r.hasContacts), tensor: this.shown.some((r) => r.hasTensor)};
    for (const part of this.root.querySelectorAll("[data-needs]")) part.toggleAttribute("data-hidden", !has[part.dataset.needs]);
    this.sides.forEach((side, i) => {
      side.querySelector(".field").toggleAttribute("data-hidden", !(this.shown[i] && this.shown[i].hasTensor));
    });
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.slider.value = String(Math.round(this.time / this.step));
    this.slider.setAttribute("aria-valuetext", `${show(this.time, 4)} seconds of ${show(this.duration, 4)}`);
    this.find("#replay-clock").textContent = `${this.time.toFixed(4)} s`;
    this.draw();
  }

  /** Pauses and moves by `count` recorded rows of the run with the largest number of rows. */
  stepRows(count) {
    this.pause();
    const row = this.finest.rowAt(this.time) + count;
    this.seek(this.finest.time(Math.min(this.finest.length - 1, Math.max(0, row))));
  }

  draw() {
    this.shown.forEach((recording, i) => this.drawSide(this.sides[i], recording));
    drawTracks(this.tracks, this.shown, this.duration, this.time, this.find("#replay-log").checked);
    this.showKey();
    if (this.clip) this.clip.draw();
    // Publish the shown time and scene, for tests.
    this.root.dataset.time = String(this.time);
    this.root.dataset.scene = this.scene.id;
  }

  /** Shows the names of the runs in their colours, and the factor by which depths are drawn longer at this zoom. */
  showKey() {
    const key = `${this.shown.map((r) => r.label)} ${this.camera.zoom} ${this.camera.frame}`;
    if (this.keyShown === key) return;
    this.keyShown = key;
    const inColour = (part, recording) => {
      part.style.setProperty("--light", recording.colours.light);
      part.style.setProperty("--dark", recording.colours.dark);
      return part;
    };
    this.find("#replay-key").replaceChildren(...this.shown.map((r) =>
      inColour(Object.assign(document.createElement("b"), {textContent: r.label, className: "run-name"}), r)));
    this.shown.forEach((r, i) => inColour(this.sides[i].querySelector(".swatch"), r));
    const view = this.sides[0].querySelector(".view");
    const longer = depthScale(this.scene, this.camera.scale(view.clientWidth, view.clientHeight));
    this.find("#replay-longer").textContent = longer === 1 ? "true length" : `${longer} times as long`;
  }

  drawSide(side, recording) {
    const row = recording.rowAt(this.time);
    drawScene(side.querySelector(".view"), this.scene, this.camera, recording, row);
    if (recording.hasTensor) drawField(side.querySelector(".field"), this.scene, recording, row);
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
      // Limit the step to 0.1 s, so that the replay does not jump after the page was hidden.
      const passed = before === null ? 0 : Math.min(0.1, (now - before) / 1000), speed = Number(this.find("#replay-speed").value);
      before = now;
      this.seek(this.time + passed * speed);
      this.sound.follow(this.shown[this.heard], this.shown, this.time, speed);
      if (this.time >= this.duration) this.pause();
      else this.playing = requestAnimationFrame(frame);
    };
    this.playing = requestAnimationFrame(frame);
    this.showPlaying();
  }

  pause() {
    cancelAnimationFrame(this.playing);
    this.playing = null;
    if (this.clip) stopClip(this);
    this.showPlaying();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  showPlaying() {
    const button = this.find("#replay-play");
    button.textContent = this.playing ? "❚❚ Pause" : "▶ Play";
    button.setAttribute("aria-pressed", String(Boolean(this.playing)));
    this.root.dataset.playing = String(Boolean(this.playing));
  }
}
