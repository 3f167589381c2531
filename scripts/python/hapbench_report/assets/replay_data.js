// The recorded runs, unpacked: typed arrays over the base64 of the page.

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;

/** One algorithm's run: rows of numbers, and per row its contacts. */
class Recording {
  constructor(packed, scene) {
    this.algorithm = packed.algorithm;
    this.outcome = packed.outcome;
    this.columns = scene.rowColumns;
    this.rows = new Float32Array(bytesOf(packed.rows));
    this.length = this.rows.length / this.columns.length;
    this.column = Object.fromEntries(this.columns.map((name, i) => [name, i]));
    const counts = new Uint16Array(bytesOf(packed.counts));
    this.contactStart = new Uint32Array(this.length + 1);
    this.colliding = new Uint16Array(this.length);
    for (let k = 0; k < this.length; ++k) {
      this.contactStart[k + 1] = this.contactStart[k] + counts[2 * k];
      this.colliding[k] = counts[2 * k + 1];
    }
    this.contactScales = packed.contactScales;
    this.contacts = new Int16Array(bytesOf(packed.contacts));
  }

  value(row, name) { return this.rows[row * this.columns.length + this.column[name]]; }
  vector(row, names) { return names.map((name) => this.value(row, name)); }
  tip(row) { return this.vector(row, ["px_m", "py_m", "pz_m"]); }
  axis(row) { return this.vector(row, ["axis_x", "axis_y", "axis_z"]); }
  force(row) { return this.vector(row, ["fx_N", "fy_N", "fz_N"]); }
  tensor(row) { return this.vector(row, ["sxx", "sxy", "sxz", "syy", "syz", "szz"]); }
  get endTime() { return this.value(this.length - 1, "time_s"); }

  /** The last row that is not later than t; the first when all are. */
  rowAt(t) {
    let low = 0, high = this.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.value(middle, "time_s") <= t + 1e-9) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** The largest force in each of so many equal spans of time [N]: no peak of a vibration falls between two samples. */
  peaks(duration, columns) {
    const key = `${duration} ${columns}`;
    if (this.peaksKey === key) return this.peaksFound;
    this.peaksKey = key;
    this.peaksFound = new Float32Array(columns);
    for (let k = 0; k < this.length; ++k) {
      const i = Math.min(columns - 1, Math.floor((this.value(k, "time_s") / duration) * columns));
      this.peaksFound[i] = Math.max(this.peaksFound[i], Math.hypot(...this.force(k)));
    }
    return this.peaksFound;
  }

  /** The rendered contacts of a row: point, depth [m], gradient, weight. */
  contactsAt(row) {
    const width = this.contactScales.length, found = [];
    for (let i = this.contactStart[row]; i < this.contactStart[row + 1]; ++i) {
      const c = this.contactScales.map((scale, j) => this.contacts[i * width + j] * scale);
      found.push({point: c.slice(0, 3), depth: c[3], gradient: c.slice(4, 7), weight: c[7]});
    }
    return found;
  }
}

/** A scene: shell, tool, and the recordings of several algorithms. */
class Scene {
  constructor(packed) {
    Object.assign(this, {id: packed.id, title: packed.title, note: packed.note, speed: packed.speed, planar: packed.planar,
      scenario: packed.scenario, up: packed.up, lean: packed.lean, stiffness: packed.stiffness});
    this.radius = packed.tool.diameter_m / 2;
    this.length = packed.tool.length_m;
    this.round = packed.tool.tip === "round";
    const shell = new Int16Array(bytesOf(packed.shell)), normals = new Int8Array(bytesOf(packed.normals));
    this.points = [];
    for (let i = 0; i < shell.length; i += 3) {
      const triple = (from, scale) => [from[i] * scale, from[i + 1] * scale, from[i + 2] * scale];
      this.points.push({at: triple(shell, packed.shellScale), normal: triple(normals, 1 / 127)});
    }
    this.recordings = packed.recordings.map((recording) => new Recording(recording, packed));
    // Colours span the depths of the gentlest recording: the deepest of one that was thrown about would flatten them.
    this.deepest = Math.min(...this.recordings.map((r) => r.contactScales[3] * 32767));
  }

  /** Depth of a point in the tool, by the shortest distance to its surface [m]; negative outside. */
  depthIn(point, tip, axis) {
    const q = [point[0] - tip[0], point[1] - tip[1], point[2] - tip[2]];
    const s = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2];
    const distance2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    if (this.round && s > 0) return this.radius - Math.sqrt(distance2);
    const wall = this.radius - Math.sqrt(Math.max(0, distance2 - s * s));
    return Math.min(wall, s + this.length, this.round ? Infinity : -s);
  }
}
