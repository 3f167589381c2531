// Recorded runs: decodes the base64 text of the page to typed arrays.

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;

/** One recorded run: a row of numbers per recorded step, and the contacts of each row. A long run is subsampled, and
 *  rows with peaks are kept. */
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
  /** Index of the first row in contact; -1 if the tool never touches. */
  get firstTouch() { return this.colliding.findIndex((n) => n > 0); }

  /** Returns the index of the last row at or before time t [s]; 0 if all rows are later. */
  rowAt(t) {
    let low = 0, high = this.length - 1;
    // Tolerance, because the times of the rows have single precision.
    const late = t * (1 + 1e-7) + 1e-9;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time(middle) <= late) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** Returns the rendered contacts of a row: point [m], depth [m], gradient and weight. */
  contactsAt(row) {
    const width = this.contactScales.length, found = [];
    for (let i = this.contactStart[row]; i < this.contactStart[row + 1]; ++i) {
      const c = this.contactScales.map((scale, j) => this.contacts[i * width + j] * scale);
      found.push({point: c.slice(0, 3), depth: c[3], gradient: c.slice(4, 7), weight: c[7]});
    }
    return found;
  }
}

/** One scene: point shell, tool, and the recorded runs of several algorithms. */
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
    // Colours span the depths of the run with the smallest peak depth. The peak depth of an unstable run would make the
    // depths of the other runs indistinguishable.
    const depths = this.recordings.map((r) => r.deepest).filter((depth) => depth > 0);
    this.deepest = depths.length ? Math.min(...depths) : 1e-4;
  }

  /** Returns the depth of a point inside the tool [m]: its distance to the tool's surface. Negative outside, and
   *  everywhere if only the tool's silhouette is known or the scene has no tool. */
  depthIn(point, tip, axis) { return this.tool && !this.silhouette ? this.tool.depthOf(point, tip, axis) : -1; }
}
