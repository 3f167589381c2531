// An orthographic view: which way one looks, how large, and where to.

class Camera {
  constructor(scene) {
    this.planar = scene.planar;
    this.home = {yaw: -1.25, pitch: 0.28, zoom: 1};
    const box = (i, bound) => bound(...scene.points.map((p) => p.at[i]));
    this.centre = [0, 1, 2].map((i) => (box(i, Math.min) + box(i, Math.max)) / 2);
    this.extent = Math.max(...[0, 1, 2].map((i) => box(i, Math.max) - box(i, Math.min)), 4 * scene.radius);
    this.reset();
  }

  reset() { Object.assign(this, this.home, {pan: [0, 0]}); }
  zoomBy(factor) { this.zoom = Math.min(12, Math.max(0.3, this.zoom * factor)); }

  /** A drag by so many pixels turns a 3-D view and shifts a planar one. */
  drag(dx, dy) {
    if (this.planar) {
      this.pan[0] += dx;
      this.pan[1] += dy;
    } else {
      this.yaw -= dx * 0.01;
      this.pitch = Math.min(1.55, Math.max(-1.55, this.pitch + dy * 0.01));
    }
  }

  /** Unit vectors to the right, up and towards the viewer, in the world. */
  basis() {
    if (this.planar) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]];
  }

  /** A function from world [m] to [x, y, nearness] in pixels and metres. */
  projection(width, height) {
    const [right, up, toward] = this.basis(), c = this.centre;
    const scale = this.scale(width, height);
    const x0 = width / 2 + this.pan[0], y0 = height / 2 + this.pan[1];
    const along = (p, e) => (p[0] - c[0]) * e[0] + (p[1] - c[1]) * e[1] + (p[2] - c[2]) * e[2];
    return (p) => [x0 + scale * along(p, right), y0 - scale * along(p, up), along(p, toward)];
  }

  /** Pixels per metre. */
  scale(width, height) { return 0.82 * this.zoom * Math.min(width, height) / this.extent; }
}
