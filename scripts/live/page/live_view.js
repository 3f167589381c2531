// Draws a view of the live page: the parts of the replay, and the hand's target, the spring force and the proxy.

const KEPT_S = 4;            // duration of the plot [s]
const EVERY = 6;             // number of steps per point of the plot
const LAWS_COLOURS = [["#b04a00", "#ffb06b"], ["#0068a8", "#7cc0ee"]];
const NEAR = 9;              // half extent of the drawn shell around the tool's start, in half widths of the tool
const MAX_POINTS = 7000;     // largest number of drawn shell points, approximately
const DEEPEST_M = 2e-4;      // depth [m] of the last colour of the depth scale

TRACKS[2] = {title: "created", unit: "mJ", of: (r, k) => r.value(k, "created_J") * 1e3};

/** Last KEPT_S seconds of a run, with the methods of a recording that the drawing functions of the replay call. */
class Trail {
  constructor(label, index, step) {
    const [light, dark] = LAWS_COLOURS[index];
    Object.assign(this, {label, step, colours: {light, dark}, dash: index ? [5, 3] : [], points: [], firstTouch: -1});
    this.vibration = new Vibration(1 / step);
    this.heard = new Float32Array(0);
    this.last = null;
  }

  /** Appends new rows of numbers (ROW). `state`: the engine's state after the last row. */
  add(rows, state) {
    const rate = 1 / this.step, count = rows.length / ROW.size, heard = new Float32Array(count);
    const clicks = [];
    for (let k = 0; k < count; ++k) {
      const at = k * ROW.size, number = Math.round(rows[at] * rate);
      heard[k] = this.vibration.next(vectorAt(rows, at + ROW.vibration));
      const touches = rows[at + ROW.contacts] > 0;
      if (this.touches !== undefined && touches !== this.touches) clicks.push([k, touches]);
      this.touches = touches;
      if (number % EVERY === 0) this.points.push({time: rows[at], force: vectorAt(rows, at + ROW.force), tip: vectorAt(rows, at + ROW.position),
        depth: rows[at + ROW.depth], created: state.energy_created_J});
    }
    for (const [k, begins] of clicks) addClick(heard, k, rate, begins);
    this.heard = heard;
    if (count) this.last = rows.slice(-ROW.size);
    this.state = state;
    const oldest = this.points.length ? this.points[this.points.length - 1].time - KEPT_S : 0;
    const first = this.points.findIndex((p) => p.time >= oldest);
    if (first > 0) this.points.splice(0, first);
  }

  // Interface for drawScene, drawField and drawTracks. Index k is a point of the plot; k = length is the current step.
  // axis(), contactsAt() and tensor() always return values of the current step.
  get length() { return this.points.length; }
  get start() { return this.length ? Math.max(0, this.points[this.length - 1].time - KEPT_S) : 0; }
  time(k) { return this.points[k].time - this.start; }
  tip(k) { return k < this.length ? this.points[k].tip : vectorAt(this.last, ROW.position); }
  axis() { return vectorAt(this.last, ROW.axis); }
  force(k) { return k < this.length ? this.points[k].force : vectorAt(this.last, ROW.force); }
  value(k, name) { return name === "depth_max_m" ? this.points[k].depth : this.points[k].created; }
  contactsAt() {
    return this.state.contacts.map(([x, y, z, ux, uy, uz, depth, weight]) => ({point: [x, y, z], gradient: [ux, uy, uz], depth, weight}));
  }
  tensor() {
    const S = this.state.tensor;
    return [S[0][0], S[0][1], S[0][2], S[1][1], S[1][2], S[2][2]];
  }
}

const vectorAt = (numbers, at) => [numbers[at], numbers[at + 1], numbers[at + 2]];

/** Converts the engine's scene to a scene object for the drawing functions of the replay. */
function viewedScene(engineScene, shell, springs) {
  const {initial_m: start, half_width_m: half, box_m: [low, high], up} = engineScene;
  const near = Math.max(NEAR * half, 1e-4), places = [];
  const planar = up[1] === 1 && low[2] === high[2];
  for (let i = 0; i < shell.length; i += 6) places.push(i);
  const isNear = (i) => [0, 1, 2].every((k) => Math.abs(shell[i + k] - start[k]) < near);
  const shown = planar ? places : places.filter(isNear);
  // Choose points pseudo-randomly, because every n-th point of a grid would form stripes.
  const share = MAX_POINTS / shown.length, lot = (n) => (Math.imul(n + 1, 2654435761) >>> 0) / 2 ** 32;
  const points = shown.filter((i) => lot(i / 6) < share).map((i) => ({at: vectorAt(shell, i), normal: vectorAt(shell, i + 3)}));
  const size = springs.length ? 1e-3 : 4 * half, whole = planar && shell.length > 0;
  return {planar: planar || springs.length > 0, points, springs, deepest: DEEPEST_M, up, lean: engineScene.lean,
    tool: engineScene.outline_m.length && !springs.length ? new Tool(engineScene.outline_m) : null,
    focus: whole ? [low, high] : [start.map((x) => x - size), start.map((x) => x + size)], depthIn: () => -1,
    recordings: [{tip: () => start, axis: () => up.map((x) => -x)}]};
}

function drawLive(canvas, scene, camera, trail, engineScene, led) {
  if (!trail.last) return;
  drawScene(canvas, scene, camera, trail, trail.length);
  const context = canvas.getContext("2d"), {clientWidth: width, clientHeight: height} = canvas, colours = palette();
  const project = camera.projection(width, height), tip = trail.tip(trail.length);
  drawSpringForce(context, project, tip, vectorAt(trail.last, ROW.spring), colours);
  if (engineScene.algorithm === "proxy" && scene.tool) {
    const proxy = add(tip, vectorAt(trail.last, ROW.spring), 1 / engineScene.stiffness_N_per_m);
    context.strokeStyle = colours.tool;
    context.lineWidth = 1;
    context.setLineDash([2, 3]);
    tracePath(context, outlineOf(scene.tool, project, proxy, trail.axis()));
    context.closePath();
    context.stroke();
    context.setLineDash([]);
  }
  drawTarget(context, project(led.slice(0, 3)), project(tip), colours);
}

/** Returns the convex hull of the projected tool. The proxy's guarantee holds for convex tools only. */
function outlineOf(tool, project, tip, axis) {
  const [a, b] = across(axis), ring = [...Array(16).keys()].map((i) => [Math.cos(Math.PI * i / 8), Math.sin(Math.PI * i / 8)]);
  return hull(tool.profile.flatMap(([s, r]) => ring.map(([c, d]) => project(add(add(add(tip, axis, s), a, r * c), b, r * d)))));
}

function drawSpringForce(context, project, tip, force, colours) {
  const size = norm(force);
  if (!(size > 0)) return;
  const from = project(tip), end = project(add(tip, force, 1 / size)), pixels = 26 * Math.log10(1 + size / 0.1);
  context.strokeStyle = context.fillStyle = colours.field;
  context.lineWidth = 1.5;
  drawArrow(context, from, [0, 1].map((i) => from[i] + (end[i] - from[i]) / project.scale * pixels), 7);
}

function drawTarget(context, at, tip, colours) {
  context.strokeStyle = colours.muted;
  context.lineWidth = 1;
  context.setLineDash([3, 3]);
  tracePath(context, [tip, at]);
  context.stroke();
  context.setLineDash([]);
  context.strokeStyle = colours.ink;
  context.lineWidth = 1.5;
  for (const [dx, dy] of [[7, 0], [0, 7]]) {
    tracePath(context, [[at[0] - dx, at[1] - dy], [at[0] + dx, at[1] + dy]]);
    context.stroke();
  }
}

/** Plots the last KEPT_S seconds of all trails. */
function drawChart(canvas, trails) {
  canvas.paintedKey = null;
  if (trails.every((trail) => trail.length > 1)) drawTracks(canvas, trails, KEPT_S, KEPT_S, false);
}
