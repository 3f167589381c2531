// Web worker: simulates one or two runs that follow the same pointer, at a pace relative to the wall clock.

/** Largest backlog of simulated time that the loop catches up [s]. It drops the rest and falls behind the clock. */
const MAX_BEHIND_S = 0.05;
/** Time constant [s] that smooths the pointer's motion: browsers report it only about 60 times per second. */
const SMOOTHING_S = 0.03;
/** Distance [steps] that the last waypoint must lie ahead: the engine needs two steps (live.cpp), rounding one more. */
const AHEAD = 3;
/** Largest number of steps between two waypoints of the pointer. */
const MAX_ROWS = 64;

class Loop {
  /** `asked`: {module, files, runs: [{name, overrides}]}, arguments of the engines (engine.js). */
  constructor(asked) {
    this.asked = asked;
    this.pace = 0;
    this.begin();
  }

  begin() {
    const {module, files, runs} = this.asked;
    this.engines = runs.map(({name, overrides}) => new Engine(module, files, name, overrides));
    const {scene} = this.engines[0];
    this.step = scene.step_s;
    this.rows = 0;
    this.waypoints = [];
    this.pointer = [...scene.initial_m, scene.tilt_rad, scene.azimuth_rad];
    this.led = [...this.pointer];
    this.fresh = this.engines.map(() => []);
    this.lead(0);
    this.due = 0;
    this.clock = this.watch = performance.now();
    this.watchedRows = 0;
    this.factor = 1;
  }

  lead(t) {
    const waypoint = [t, ...this.led];
    this.waypoints.push(waypoint);
    for (const engine of this.engines) engine.aim(t, this.led.slice(0, 3), this.led[3], this.led[4]);
  }

  get ended() { return this.engines.every((engine) => engine.ended); }

  /** Simulates `count` steps. The hand's target follows the pointer with smoothing. */
  run(count) {
    while (count > 0 && !this.ended) {
      const rows = Math.min(count, MAX_ROWS), share = 1 - Math.exp(-rows * this.step / SMOOTHING_S);
      this.led = this.led.map((value, i) => value + share * (this.pointer[i] - value));
      const until = (this.rows + rows + AHEAD) * this.step;
      if (until > this.waypoints[this.waypoints.length - 1][0]) this.lead(until);
      this.engines.forEach((engine, i) => {
        if (!engine.ended) this.fresh[i].push(engine.advance(rows));
      });
      this.rows += rows;
      count -= rows;
    }
  }

  tick() {
    const now = performance.now();
    this.due = Math.min(this.due + (now - this.clock) / 1000 * this.pace / this.step, MAX_BEHIND_S / this.step);
    this.clock = now;
    const rows = Math.floor(this.due);
    this.due -= rows;
    if (this.pace > 0) this.run(rows);
    if (now - this.watch < 500) return;
    const wanted = (now - this.watch) / 1000 * this.pace;
    this.factor = wanted > 0 ? (this.rows - this.watchedRows) * this.step / wanted : 1;
    this.watch = now;
    this.watchedRows = this.rows;
  }

  /** Goes back by `rows` steps: restarts the runs and repeats them with the same waypoints. */
  back(rows) {
    const target = Math.max(0, this.rows - rows), old = this.waypoints, {pointer} = this;
    this.begin();
    this.pointer = pointer;
    for (const waypoint of old.slice(1)) {
      if (this.rows >= target) break;
      this.led = waypoint.slice(1);
      this.lead(waypoint[0]);
      // Simulate as far as this waypoint allows.
      const reach = Math.min(target, Math.round(waypoint[0] / this.step) - AHEAD), count = reach - this.rows;
      if (count <= 0) continue;
      for (const engine of this.engines) if (!engine.ended) engine.advance(count);
      this.rows = reach;
    }
    this.watchedRows = this.rows;
  }

  /** Returns data to draw: the rows since the last call, the current state, and `factor`, the reached share of the
   *  pace. */
  show() {
    const runs = this.engines.map((engine, i) => ({rows: joined(this.fresh[i]), state: engine.state, ended: engine.ended}));
    this.fresh = this.engines.map(() => []);
    return {runs, rows: this.rows, time: this.rows * this.step, factor: this.factor, pointer: this.pointer, led: this.led};
  }
}

function joined(parts) {
  const all = new Float64Array(parts.reduce((n, part) => n + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

let loop = null;

const ORDERS = {
  start: (asked) => {
    loop = new Loop(asked);
    return {scenes: loop.engines.map((engine) => engine.scene), shell: loop.engines[0].shell()};
  },
  aim: ({pointer}) => { loop.pointer = pointer; },
  pace: ({pace}) => {
    loop.pace = pace;
    loop.clock = loop.watch = performance.now();
    loop.watchedRows = loop.rows;
    loop.due = 0;
  },
  run: ({rows}) => { loop.run(rows); },
  back: ({rows}) => { loop.back(rows); },
  show: () => loop.show(),
  keep: () => ({waypoints: loop.waypoints, runs: loop.engines.map((engine) => engine.state)}),
};

/** Answers each order with a message that has the order's number. `failed` is the message of an error. */
self.onmessage = ({data: {order, number, ...given}}) => {
  try {
    self.postMessage({number, answer: ORDERS[order](given)});
  } catch (error) {
    loop = null;
    self.postMessage({number, failed: error.message});
  }
};

setInterval(() => {
  if (!loop) return;
  try {
    loop.tick();
  } catch (error) {
    loop = null;
    self.postMessage({failed: error.message});
  }
}, 4);
