// The recorded runs, unpacked: typed arrays over the base64 of the page.

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;

/** One run: rows of numbers, and per row its contacts. Of a long run the rows that hold its peaks. */
class Recording {
  constructor(packed) {
    Object.assign(this, {algorithm: packed.algorithm, outcome: packed.outcome, worst: packed.worst, sound: packed.sound,
      colours: {light: packed.colour, dark: packed.dark}, dash: packed.dash, columns: packed.rowColumns});
    this.label = packed.label || packed.algorithm.replaceAll("_", " ");
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
  time(row) { return this.value(row, "time_s"); }
  tip(row) { return this.vector(row, ["px_m", "py_m", "pz_m"]); }
  axis(row) { return this.vector(row, ["axis_x", "axis_y", "axis_z"]); }
  force(row) { return this.vector(row, ["fx_N", "fy_N", "fz_N"]); }
  tensor(row) { return this.vector(row, ["sxx", "sxy", "sxz", "syy", "syz", "szz"]); }
  get hasTensor() { return "sxx" in this.column; }
  get hasContacts() { return this.contacts.length > 0; }
  get endTime() { return this.time(this.length - 1); }
  get deepest() { return Math.max(0, ...Array.from({length: this.length}, (_, k) => this.value(k, "depth_max_m") || 0)); }
  /** Row of the first contact; -1 without one. */
  get firstTouch() { return this.colliding.findIndex((n) => n > 0); }

  /** The last row that is not later than t; the first when all are. */
  rowAt(t) {
    let low = 0, high = this.length - 1;
    // Times are kept in single precision.
    const late = t * (1 + 1e-7) + 1e-9;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time(middle) <= late) low = middle; else high = middle - 1;
    }
    return low;
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
      scenario: packed.scenario, up: packed.up, lean: packed.lean, focus: packed.focus, springs: packed.springs,
      silhouette: packed.silhouette});
    this.tool = packed.tool ? new Tool(packed.tool) : null;
    const shell = new Int16Array(bytesOf(packed.shell)), normals = new Int8Array(bytesOf(packed.normals));
    this.points = [];
    for (let i = 0; i < shell.length; i += 3) {
      const triple = (from, scale) => [from[i] * scale, from[i + 1] * scale, from[i + 2] * scale];
      this.points.push({at: triple(shell, packed.shellScale), normal: triple(normals, 1 / 127)});
    }
    this.recordings = packed.recordings.map((recording) => new Recording(recording));
    // Colours span the depths of the gentlest recording: the deepest of one that was thrown about would flatten them.
    const depths = this.recordings.map((r) => r.deepest).filter((depth) => depth > 0);
    this.deepest = depths.length ? Math.min(...depths) : 1e-4;
  }

  /** Depth of a point in the tool, by the shortest distance to its surface [m]; negative outside, and wherever all that
   *  is known of the tool is its silhouette. */
  depthIn(point, tip, axis) { return this.tool && !this.silhouette ? this.tool.depthOf(point, tip, axis) : -1; }
}
