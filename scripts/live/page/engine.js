// Runs the simulation engine in a page: a WebAssembly instance (scripts/live/live.cpp), and its input files in memory.

const SUCCESS = 0, BAD_DESCRIPTOR = 8, NO_ENTRY = 44, NOT_SUPPORTED = 58;
const ROOT = 3;  // descriptor of the folder /, the first after the standard streams
const DIRECTORY = 3, REGULAR_FILE = 4;

/** System calls (WASI preview 1) of a WebAssembly instance that only reads files. `files` maps absolute
 *  paths to bytes. */
class System {
  constructor(files) {
    this.files = files;
    this.open = new Map();
    this.said = "";
  }

  get view() { return new DataView(this.memory.buffer); }
  bytes(at, length) { return new Uint8Array(this.memory.buffer, at, length); }
  text(at) {
    const all = new Uint8Array(this.memory.buffer);
    return new TextDecoder().decode(all.subarray(at, all.indexOf(0, at)));
  }

  path(at, length) {
    const parts = [];
    for (const part of new TextDecoder().decode(this.bytes(at, length)).split("/")) {
      if (part === "..") parts.pop();
      else if (part && part !== ".") parts.push(part);
    }
    return `/${parts.join("/")}`;
  }
  kind(path) {
    if (this.files.has(path)) return REGULAR_FILE;
    const below = path === "/" ? "/" : `${path}/`;
    return [...this.files.keys()].some((name) => name.startsWith(below)) ? DIRECTORY : 0;
  }

  stat(path, at) {
    const kind = this.kind(path);
    if (!kind) return NO_ENTRY;
    this.bytes(at, 64).fill(0);
    this.view.setUint8(at + 16, kind);
    this.view.setBigUint64(at + 32, BigInt(kind === REGULAR_FILE ? this.files.get(path).length : 0), true);
    return SUCCESS;
  }

  imports() {
    const calls = {
      fd_prestat_get: (fd, at) => {
        if (fd !== ROOT) return BAD_DESCRIPTOR;
        this.view.setUint32(at, 0, true);
        this.view.setUint32(at + 4, 1, true);
        return SUCCESS;
      },
      fd_prestat_dir_name: (fd, at) => {
        this.bytes(at, 1)[0] = "/".charCodeAt(0);
        return SUCCESS;
      },
      fd_fdstat_get: (fd, at) => {
        this.bytes(at, 24).fill(0);
        this.view.setUint8(at, fd === ROOT ? DIRECTORY : REGULAR_FILE);
        this.view.setBigUint64(at + 8, ~0n, true);
        this.view.setBigUint64(at + 16, ~0n, true);
        return SUCCESS;
      },
      fd_fdstat_set_flags: () => SUCCESS,
      path_filestat_get: (fd, flags, name, length, at) => this.stat(this.path(name, length), at),
      fd_filestat_get: (fd, at) => (this.open.has(fd) ? this.stat(this.open.get(fd).path, at) : BAD_DESCRIPTOR),
      path_open: (fd, lookup, name, length, flags, rights, inheriting, fdFlags, at) => {
        const path = this.path(name, length);
        if (this.kind(path) !== REGULAR_FILE) return NO_ENTRY;
        let next = ROOT + 1;
        while (this.open.has(next)) ++next;
        this.open.set(next, {path, position: 0});
        this.view.setUint32(at, next, true);
        return SUCCESS;
      },
      fd_read: (fd, vectors, count, at) => {
        const file = this.open.get(fd);
        if (!file) return BAD_DESCRIPTOR;
        let read = 0;
        for (let i = 0; i < count; ++i) {
          const to = this.view.getUint32(vectors + 8 * i, true), room = this.view.getUint32(vectors + 8 * i + 4, true);
          const part = this.files.get(file.path).subarray(file.position, file.position + room);
          this.bytes(to, part.length).set(part);
          file.position += part.length;
          read += part.length;
        }
        this.view.setUint32(at, read, true);
        return SUCCESS;
      },
      fd_seek: (fd, offset, whence, at) => {
        const file = this.open.get(fd);
        if (!file) return BAD_DESCRIPTOR;
        const from = [0, file.position, this.files.get(file.path).length][whence];
        file.position = from + Number(offset);
        this.view.setBigUint64(at, BigInt(file.position), true);
        return SUCCESS;
      },
      fd_close: (fd) => (this.open.delete(fd) ? SUCCESS : BAD_DESCRIPTOR),
      clock_time_get: (id, precision, at) => {
        this.view.setBigUint64(at, BigInt(Math.round(1e6 * performance.now())), true);
        return SUCCESS;
      },
      environ_sizes_get: (count, size) => {
        this.view.setUint32(count, 0, true);
        this.view.setUint32(size, 0, true);
        return SUCCESS;
      },
      environ_get: () => SUCCESS,
      proc_exit: (status) => { throw new Error(`the engine ended with status ${status}`); },
    };
    const anything = new Proxy(calls, {get: (known, name) => known[name] || (() => NOT_SUPPORTED)});
    return {page: {fail: (at) => { throw new Error(this.text(at)); }}, wasi_snapshot_preview1: anything};
  }
}

/** One run of a scenario. Throws Error with the engine's message; the run cannot continue after an error. */
class Engine {
  /** Loads a scenario. `name`: a file or a bundled scenario; `overrides`: strings "path=value" like values of --set.
   *  `isLed`: the waypoints of aim() move the tool, and aim() must be called before advance(). Otherwise the scenario's
   *  hand and motion move the tool. */
  constructor(module, files, name, overrides, isLed = true) {
    this.system = new System(files);
    const {exports} = new WebAssembly.Instance(module, this.system.imports());
    this.calls = exports;
    this.system.memory = exports.memory;
    exports.__wasm_call_ctors();
    exports.load(this.text(name), this.text(overrides.join("\n")), isLed ? 1 : 0);
    this.scene = this.json(exports.scene());
    this.rows = 0;
    this.ended = false;
  }

  text(text) {
    const bytes = new TextEncoder().encode(text), at = this.calls.allocate(bytes.length + 1);
    this.system.bytes(at, bytes.length + 1).set([...bytes, 0]);
    return at;
  }
  json(at) { return JSON.parse(this.system.text(at)); }

  /** Adds a waypoint: the pointer's position `place` [m], tilt and azimuth [rad] at time t [s]. */
  aim(t, place, tilt, azimuth) { this.calls.aim(t, ...place, tilt, azimuth); }

  /** Simulates `count` steps, or fewer if the run ends. Returns their numbers, one row (ROW) per step. */
  advance(count) {
    const at = this.calls.advance(count), done = this.calls.advanced();
    this.rows += done;
    this.ended = done < count;
    return new Float64Array(this.system.memory.buffer, at, done * ROW.size).slice();
  }

  get state() { return this.json(this.calls.state()); }

  /** Returns the points and normals of the point shell: x, y, z, nx, ny, nz of each point. */
  shell() {
    const columns = [0, 1, 2, 3, 4, 5].map((k) =>
      this.scene.points ? new Float64Array(this.system.memory.buffer, this.calls.coordinates(k), this.scene.points) : []);
    return Float32Array.from({length: 6 * this.scene.points}, (_, i) => columns[i % 6][Math.floor(i / 6)]);
  }
}

/** Index of each quantity in a row, which live.cpp writes for each step. `vibration`: rendered force above 30 Hz. */
const ROW = {time: 0, position: 1, axis: 4, force: 7, spring: 10, vibration: 13, depth: 16, contacts: 17, size: 18};
