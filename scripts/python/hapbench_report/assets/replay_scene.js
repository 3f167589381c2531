// Draws one moment of a recording: shell, tool, colliding points, depths, force.

const DEPTH_STOPS = [[253, 231, 117], [247, 160, 72], [222, 84, 92], [150, 40, 120]];
const depthColour = (fraction) => {
  const at = Math.min(0.9999, Math.max(0, fraction)) * (DEPTH_STOPS.length - 1), i = Math.floor(at);
  const mix = DEPTH_STOPS[i].map((c, k) => Math.round(c + (at - i) * (DEPTH_STOPS[i + 1][k] - c)));
  return `rgb(${mix})`;
};

const add = (p, v, length = 1) => p.map((x, i) => x + length * v[i]);
const norm = (v) => Math.hypot(...v);

/** Colours of the page, which change with the theme. */
function palette() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ink", "muted", "panel", "line", "shell", "tool", "force", "field"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** The canvas's context in CSS pixels, cleared; its own pixels follow the screen's. */
function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1, {clientWidth: width, clientHeight: height} = canvas;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return {context, width, height};
}

/** Corners of the convex hull, counter-clockwise (Andrew's monotone chain). */
function hull(points) {
  const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const chain = (ordered) => {
    const kept = [];
    for (const p of ordered) {
      const turns = (a, b) => (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
      while (kept.length > 1 && turns(kept[kept.length - 2], kept[kept.length - 1]) <= 0) kept.pop();
      kept.push(p);
    }
    return kept.slice(0, -1);
  };
  return chain(sorted).concat(chain(sorted.reverse()));
}

function tracePath(context, points) {
  context.beginPath();
  points.forEach((p, i) => (i ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1])));
}

function drawDot(context, at, radius) {
  context.beginPath();
  context.arc(at[0], at[1], radius, 0, 2 * Math.PI);
  context.fill();
}

function drawArrow(context, from, to, head) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  tracePath(context, [from, to]);
  context.stroke();
  if (length < 1) return;
  const h = Math.min(head, length), e = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  const barb = (side) => [to[0] - h * e[0] + side * 0.5 * h * e[1], to[1] - h * e[1] - side * 0.5 * h * e[0]];
  tracePath(context, [to, barb(1), barb(-1)]);
  context.closePath();
  context.fill();
}

/** Two unit vectors that span the plane across the axis. */
function across(axis) {
  const e = Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const first = cross(axis, e), length = norm(first);
  const a = first.map((x) => x / length);
  return [a, cross(axis, a)];
}

function ring(centre, axis, radius) {
  const [a, b] = across(axis), points = [];
  for (let i = 0; i < 48; ++i) {
    const turn = (2 * Math.PI * i) / 48;
    points.push(add(add(centre, a, radius * Math.cos(turn)), b, radius * Math.sin(turn)));
  }
  return points;
}

function drawTool(context, scene, project, pixels, tip, axis, colours) {
  const top = add(tip, axis, -scene.length);
  const ends = [...ring(tip, axis, scene.radius), ...ring(top, axis, scene.radius)].map(project);
  const centre = project(tip);
  for (let i = 0; scene.round && i < 48; ++i) {
    const turn = (2 * Math.PI * i) / 48, r = scene.radius * pixels;
    const p = [centre[0] + r * Math.cos(turn), centre[1] + r * Math.sin(turn)];
    // A planar tool is rounded beyond its tip only; its other end is flat.
    if (!scene.planar || (p[0] - centre[0]) * axis[0] - (p[1] - centre[1]) * axis[1] >= 0) ends.push(p);
  }
  context.fillStyle = context.strokeStyle = colours.tool;
  tracePath(context, hull(ends));
  context.closePath();
  context.globalAlpha = 0.2;
  context.fill();
  context.globalAlpha = 0.9;
  context.lineWidth = 1.5;
  context.stroke();
  if (!scene.planar) {
    tracePath(context, ring(tip, axis, scene.radius).map(project));
    context.closePath();
    context.lineWidth = 1;
    context.stroke();
  }
  context.setLineDash([6, 4]);
  tracePath(context, [centre, project(top)]);
  context.globalAlpha = 0.45;
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
  drawDot(context, centre, 3);
}

/** Shell points, those that face away fainter; returns the colliding ones. */
function drawShell(context, scene, project, toward, tip, axis, colours) {
  const colliding = [];
  context.fillStyle = colours.shell;
  for (const point of scene.points) {
    const depth = scene.depthIn(point.at, tip, axis);
    if (depth >= 0) colliding.push({at: point.at, depth});
    const [x, y] = project(point.at), n = point.normal;
    const facing = scene.planar ? 1 : n[0] * toward[0] + n[1] * toward[1] + n[2] * toward[2];
    context.globalAlpha = scene.planar ? 0.9 : facing > 0 ? 0.35 + 0.55 * facing : 0.2;
    const size = scene.planar ? 3.4 : 2;
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
  context.globalAlpha = 1;
  return colliding;
}

function drawContacts(context, scene, project, colliding, contacts, colours) {
  for (const {at, depth} of colliding) {
    context.fillStyle = depthColour(depth / scene.deepest);
    drawDot(context, project(at), 2.6);
  }
  context.lineWidth = 1.4;
  for (const {point, depth, gradient} of contacts) {
    const p = project(point);
    context.strokeStyle = colours.ink;
    context.fillStyle = colours.ink;
    drawArrow(context, p, project(add(point, gradient, depth)), 4);
    context.fillStyle = depthColour(depth / scene.deepest);
    context.lineWidth = 1;
    drawDot(context, p, 4.2);
    context.stroke();
  }
}

/** The rendered force from the tip. Logarithmic, as forces span four decades: 0.1 N, 1 N, 10 N are one step each. */
function drawForce(context, project, tip, force, colours) {
  const size = norm(force);
  if (!(size > 0)) return;
  const pixels = 26 * Math.log10(1 + size / 0.1), from = project(tip);
  const end = project(add(tip, force, 1 / size)), direction = [end[0] - from[0], end[1] - from[1]];
  // Seen from the side, the arrow keeps its length; seen along it, it shrinks.
  const unit = Math.abs(project.unit), to = [from[0] + direction[0] / unit * pixels, from[1] + direction[1] / unit * pixels];
  context.strokeStyle = context.fillStyle = colours.force;
  context.lineWidth = 3;
  drawArrow(context, from, to, 11);
  context.font = "600 13px system-ui, sans-serif";
  context.fillText(`${show(size)} N`, to[0] + 7, to[1] + (to[1] > from[1] ? 14 : -6));
}

/** A bar of a round length in the lower left corner. */
function drawScaleBar(context, height, pixels, colours) {
  const lengths = [0.1, 0.2, 0.5, 1, 2, 5], mm = lengths.find((l) => l * 1e-3 * pixels > 40) || 5;
  const y = height - 14;
  context.strokeStyle = context.fillStyle = colours.muted;
  context.lineWidth = 2;
  tracePath(context, [[14, y], [14 + mm * 1e-3 * pixels, y]]);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.fillText(`${mm} mm`, 14, y - 6);
}

function drawScene(canvas, scene, camera, recording, row) {
  const {context, width, height} = prepared(canvas), colours = palette();
  const project = camera.projection(width, height), pixels = camera.scale(width, height);
  project.unit = pixels;
  const tip = recording.tip(row), axis = recording.axis(row);
  const colliding = drawShell(context, scene, project, camera.basis()[2], tip, axis, colours);
  drawTool(context, scene, project, pixels, tip, axis, colours);
  drawContacts(context, scene, project, colliding, recording.contactsAt(row), colours);
  drawForce(context, project, tip, recording.force(row), colours);
  drawScaleBar(context, height, pixels, colours);
  drawWayOut(context, project(tip), width, height, colours);
}

/** A tool that was thrown out of view: where it went. */
function drawWayOut(context, at, width, height, colours) {
  if (at[0] >= 0 && at[0] <= width && at[1] >= 0 && at[1] <= height) return;
  const centre = [width / 2, height / 2], d = [at[0] - centre[0], at[1] - centre[1]];
  const reach = Math.min((width / 2 - 18) / Math.abs(d[0] || 1e-9), (height / 2 - 18) / Math.abs(d[1] || 1e-9));
  const to = [centre[0] + reach * d[0], centre[1] + reach * d[1]];
  context.strokeStyle = context.fillStyle = colours.tool;
  context.lineWidth = 2;
  drawArrow(context, [centre[0] + 0.8 * reach * d[0], centre[1] + 0.8 * reach * d[1]], to, 10);
  context.font = "600 13px system-ui, sans-serif";
  context.textAlign = "center";
  context.fillText("the tip is out of view", width / 2, 18);
  context.textAlign = "start";
}
