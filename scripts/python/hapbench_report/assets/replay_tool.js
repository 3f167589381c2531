// The tool: a solid of revolution about its axis, given by its profile, such as a cylinder with a flat or round tip.

const RING_POINTS = 40;

class Tool {
  /** `profile`: pairs [s, r] in metres from the far end to the tip: radius r at position s along the axis, where the
   *  tip centre has s = 0. */
  constructor(profile) {
    this.profile = profile;
    this.far = Math.min(...profile.map(([s]) => s));
    this.tip = Math.max(...profile.map(([s]) => s));
    this.radius = Math.max(...profile.map(([, r]) => r));
  }

  /** Returns the distance of a point inside the tool to its surface [m]. Outside, returns a negative number, whose
   *  magnitude is at most the distance. */
  depthOf(point, tip, axis) {
    const q = [point[0] - tip[0], point[1] - tip[1], point[2] - tip[2]];
    const s = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2];
    const r = Math.sqrt(Math.max(0, q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - s * s));
    // Return early for points outside the cylinder around the tool, as most points are.
    const outside = Math.max(r - this.radius, s - this.tip, this.far - s);
    if (outside > 0) return -outside;
    let nearest = Infinity, inside = false;
    for (let i = 1; i < this.profile.length; ++i) {
      const [a, b] = [this.profile[i - 1], this.profile[i]];
      // Skip segments on the axis, which are not part of the surface.
      if (a[1] > 0 || b[1] > 0) nearest = Math.min(nearest, distanceToSegment(s, r, a, b));
      // A point is inside if a ray outwards from the point crosses the profile an odd number of times.
      if ((a[0] > s) !== (b[0] > s) && r < a[1] + (b[1] - a[1]) * (s - a[0]) / (b[0] - a[0])) inside = !inside;
    }
    return inside ? nearest : -nearest;
  }
}

function distanceToSegment(x, y, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]], length2 = dx * dx + dy * dy;
  const t = length2 > 0 ? Math.min(1, Math.max(0, ((x - a[0]) * dx + (y - a[1]) * dy) / length2)) : 0;
  return Math.hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

/** Returns two unit vectors that span the plane perpendicular to the axis. */
function across(axis) {
  const e = Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const first = cross(axis, e), length = norm(first);
  const a = first.map((x) => x / length);
  return [a, cross(axis, a)];
}

/** Returns the projected tool as a path. It has one convex piece for each pair of neighbouring rings of the profile. */
function toolPath(tool, project, tip, axis) {
  const [a, b] = across(axis), path = new Path2D();
  const ring = ([s, r]) => {
    const centre = add(tip, axis, s);
    if (r === 0) return [project(centre)];
    return Array.from({length: RING_POINTS}, (_, i) => {
      const turn = (2 * Math.PI * i) / RING_POINTS;
      return project(add(add(centre, a, r * Math.cos(turn)), b, r * Math.sin(turn)));
    });
  };
  const rings = tool.profile.map(ring);
  for (let i = 1; i < rings.length; ++i) {
    hull([...rings[i - 1], ...rings[i]]).forEach((p, k) => (k ? path.lineTo(p[0], p[1]) : path.moveTo(p[0], p[1])));
    path.closePath();
  }
  return path;
}

const toolLayer = document.createElement("canvas");

/** Draws the tool on a separate layer. This hides the edges between the pieces, and a tool that extends beyond the
 *  picture fades out instead of being cut. */
function drawTool(context, scene, project, tip, axis, colours) {
  if (!scene.tool) return drawTip(context, project(tip), colours);
  const target = context.canvas, ratio = context.getTransform().a;
  toolLayer.width = target.width;
  toolLayer.height = target.height;
  const layer = toolLayer.getContext("2d"), path = toolPath(scene.tool, project, tip, axis);
  layer.setTransform(ratio, 0, 0, ratio, 0, 0);
  layer.fillStyle = layer.strokeStyle = colours.tool;
  layer.lineWidth = 3;
  layer.lineJoin = "round";
  layer.stroke(path);
  layer.globalCompositeOperation = "destination-out";
  layer.fill(path);
  layer.globalCompositeOperation = "source-over";
  layer.globalAlpha = 0.2;
  layer.fill(path);
  layer.globalAlpha = 0.45;
  layer.lineWidth = 1;
  layer.setLineDash([6, 4]);
  const from = project(tip), to = project(add(tip, axis, scene.tool.far));
  tracePath(layer, [from, to]);
  layer.stroke();
  layer.setLineDash([]);
  layer.globalAlpha = 1;
  fadeOut(layer, from, to, target.width / ratio, target.height / ratio);
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.drawImage(toolLayer, 0, 0);
  context.restore();
  drawTip(context, from, colours);
}

function drawTip(context, at, colours) {
  context.fillStyle = colours.tool;
  drawDot(context, at, 3);
}

/** Fades the layer out from the tip towards the border of the picture if the tool's far end lies beyond the border. */
function fadeOut(layer, from, to, width, height) {
  const inside = (p) => p[0] >= 0 && p[0] <= width && p[1] >= 0 && p[1] <= height;
  if (inside(to) || !inside(from)) return;
  const reach = Math.min(...[0, 1].map((i) => {
    const d = to[i] - from[i], side = i ? height : width;
    return d > 0 ? (side - from[i]) / d : d < 0 ? from[i] / -d : Infinity;
  }));
  const point = (t) => [from[0] + t * reach * (to[0] - from[0]), from[1] + t * reach * (to[1] - from[1])];
  const gradient = layer.createLinearGradient(...point(0.7), ...point(1));
  gradient.addColorStop(0, "#000f");
  gradient.addColorStop(1, "#0000");
  layer.globalCompositeOperation = "destination-in";
  layer.fillStyle = gradient;
  layer.fillRect(0, 0, width, height);
  layer.globalCompositeOperation = "source-over";
}
