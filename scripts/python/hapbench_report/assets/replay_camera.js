// Orthographic camera with a viewing direction, a zoom and a centre.

class Camera {
  constructor(scene) {
    this.planar = scene.planar;
    this.home = {yaw: -1.25, pitch: 0.28, zoom: 1};
    this.frames = {contact: contactFrame(scene), whole: wholeFrame(scene)};
    this.show("contact");
  }

  /** Shows the region of contact (`frame` "contact") or the whole scene ("whole"). */
  show(frame) {
    this.frame = frame;
    Object.assign(this, this.frames[frame]);
    this.reset();
  }

  reset() { Object.assign(this, this.home, {pan: [0, 0]}); }
  zoomBy(factor) { this.zoom = Math.min(40, Math.max(0.2, this.zoom * factor)); }

  /** Turns a 3-D view or shifts a planar view after a drag by dx, dy [pixels]. */
  drag(dx, dy) {
    if (this.planar) this.shift(dx, dy);
    else {
      this.yaw -= dx * 0.01;
      this.pitch = Math.min(1.55, Math.max(-1.55, this.pitch + dy * 0.01));
    }
  }

  shift(dx, dy) {
    this.pan[0] += dx;
    this.pan[1] += dy;
  }

  /** Returns unit vectors to the right, up and towards the viewer, in world coordinates. */
  basis() {
    if (this.planar) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]];
  }

  /** Returns a function that projects a world point [m] to [x, y, nearness]: x, y [pixels], nearness to viewer [m]. */
  projection(width, height) {
    const [right, up, toward] = this.basis(), c = this.centre;
    const scale = this.scale(width, height);
    const x0 = width / 2 + this.pan[0], y0 = height / 2 + this.pan[1];
    const along = (p, e) => (p[0] - c[0]) * e[0] + (p[1] - c[1]) * e[1] + (p[2] - c[2]) * e[2];
    const project = (p) => [x0 + scale * along(p, right), y0 - scale * along(p, up), along(p, toward)];
    return Object.assign(project, {scale});
  }

  /** Returns the scale [pixels/m]. */
  scale(width, height) { return 0.82 * this.zoom * Math.min(width, height) / this.extent; }
}

/** Frame of the region of contact: 1.5 tool diameters larger than the region, and at least 3 tool diameters wide. */
function contactFrame(scene) {
  const [low, high] = scene.focus, wide = scene.tool ? 2 * scene.tool.radius : 0;
  const size = Math.max(...low.map((x, i) => high[i] - x));
  return {centre: low.map((x, i) => (x + high[i]) / 2), extent: Math.max(size + 1.5 * wide, 3 * wide, 1e-5)};
}

/** Frame of all shell points, the region of contact, and the tool at its first position. */
function wholeFrame(scene) {
  const places = [...scene.points.map((p) => p.at), ...scene.focus], first = scene.recordings[0];
  if (scene.tool) places.push(first.tip(0), add(first.tip(0), first.axis(0), scene.tool.far));
  const bound = (pick) => [0, 1, 2].map((i) => places.reduce((found, p) => pick(found, p[i]), places[0][i]));
  const low = bound(Math.min), high = bound(Math.max);
  return {centre: low.map((x, i) => (x + high[i]) / 2), extent: Math.max(1e-5, ...low.map((x, i) => high[i] - x))};
}
