// Draws one moment of a recorded run: shell, tool, colliding points, depths, force, and the tip's path.

const DEPTH_STOPS = [[253, 231, 117], [247, 160, 72], [222, 84, 92], [150, 40, 120]];
const depthColour = (fraction) => {
  const at = Math.min(0.9999, Math.max(0, fraction)) * (DEPTH_STOPS.length - 1), i = Math.floor(at);
  const mix = DEPTH_STOPS[i].map((c, k) => Math.round(c + (at - i) * (DEPTH_STOPS[i + 1][k] - c)));
  return `rgb(${mix})`;
};

const NOT_A_NUMBER = "–";
const show = (value, digits = 3) => {
  if (!Number.isFinite(value)) return NOT_A_NUMBER;
  // Large values have no exponent, because readers compare the lengths of numbers.
  return (Math.abs(value) < 10 ** digits ? value.toPrecision(digits) : value.toFixed(0)).replace("-", "−");
};

const add = (p, v, length = 1) => p.map((x, i) => x + length * v[i]);
const norm = (v) => Math.hypot(...v);

/** Returns the colours of the page in the current theme. */
function palette() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ink", "muted", "panel", "line", "shell", "tool", "force", "field"];
  const colours = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  return Object.assign(colours, {theme: style.colorScheme === "dark" ? "dark" : "light"});
}

/** Clears the canvas and sets its resolution to the screen's. Returns its context, with coordinates in CSS pixels, and
 *  its size [CSS pixels]. */
function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1, {clientWidth: width, clientHeight: height} = canvas;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return {context, width, height};
}

/** Returns the corners of the convex hull, counter-clockwise for y upwards (Andrew's monotone chain). */
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

/** Draws the shell points; points that face away from the viewer are fainter. Returns the points inside the tool. */
function drawShell(context, scene, project, toward, tip, axis, view, colours) {
  const colliding = [], size = scene.planar ? 3.4 : 2;
  context.fillStyle = colours.shell;
  for (const point of scene.points) {
    const depth = scene.depthIn(point.at, tip, axis);
    if (depth >= 0) colliding.push({at: point.at, depth});
    const [x, y] = project(point.at), n = point.normal;
    if (!(x > -size && y > -size && x < view.width + size && y < view.height + size)) continue;
    const facing = scene.planar ? 1 : n[0] * toward[0] + n[1] * toward[1] + n[2] * toward[2];
    context.globalAlpha = scene.planar ? 0.9 : facing > 0 ? 0.35 + 0.55 * facing : 0.2;
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
  context.globalAlpha = 1;
  return colliding;
}

/** Returns the factor by which depths are drawn longer: the smallest round number, up to 1000, for which scene.deepest
 *  is at least 18 pixels long. */
function depthScale(scene, pixelsPerMetre) {
  const wanted = 18 / (scene.deepest * pixelsPerMetre);
  return [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((factor) => factor >= wanted) || 1000;
}

function drawContacts(context, scene, project, colliding, contacts, colours) {
  for (const {at, depth} of colliding) {
    context.fillStyle = depthColour(depth / scene.deepest);
    drawDot(context, project(at), 3.2);
  }
  const longer = depthScale(scene, project.scale);
  for (const {point, depth, gradient} of contacts) {
    const p = project(point);
    context.strokeStyle = context.fillStyle = colours.ink;
    context.lineWidth = 1.4;
    drawArrow(context, p, project(add(point, gradient, longer * depth)), 5);
    context.fillStyle = depthColour(depth / scene.deepest);
    context.lineWidth = 1;
    drawDot(context, p, 4.8);
    context.stroke();
  }
}

/** Draws the rendered force as an arrow from the tip. Its length is logarithmic, because forces span four decades: 26
 *  pixels per decade above about 1 N. */
function drawForce(context, project, tip, force, colours) {
  const size = norm(force);
  if (!(size > 0)) return;
  const pixels = 26 * Math.log10(1 + size / 0.1), from = project(tip);
  const end = project(add(tip, force, 1 / size)), direction = [end[0] - from[0], end[1] - from[1]];
  // Shorten the arrow by the perspective: full length if seen from the side, zero if seen along its direction.
  const to = [0, 1].map((i) => from[i] + direction[i] / project.scale * pixels);
  context.strokeStyle = context.fillStyle = colours.force;
  context.lineWidth = 3;
  drawArrow(context, from, to, 11);
  context.font = "600 13px system-ui, sans-serif";
  const label = [`${show(size)} N`, to[0] + 7, to[1] + (to[1] > from[1] ? 14 : -6)];
  // Outline the label, so that it is legible over points.
  context.strokeStyle = colours.panel;
  context.strokeText(...label);
  context.fillText(...label);
}

/** Draws a scale bar of a round length in the lower left corner. */
function drawScaleBar(context, height, pixels, colours) {
  const decade = 10 ** Math.floor(Math.log10(40 / pixels));
  const length = [1, 2, 5, 10].map((m) => m * decade).find((l) => l * pixels >= 40), y = height - 14;
  context.strokeStyle = context.fillStyle = colours.muted;
  context.lineWidth = 2;
  tracePath(context, [[14, y], [14 + length * pixels, y]]);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.fillText(length < 1e-3 ? `${+(length * 1e6).toPrecision(2)} µm` : `${+(length * 1e3).toPrecision(2)} mm`, 14, y - 6);
}

/** Draws the tip's path up to the row, and the later path fainter. */
function drawWay(context, project, recording, row, colours) {
  context.strokeStyle = recording.colours[colours.theme];
  context.lineWidth = 1.2;
  const tips = Array.from({length: recording.length}, (_, k) => project(recording.tip(k)));
  for (const [part, alpha] of [[tips.slice(row), 0.25], [tips.slice(0, row + 1), 0.7]]) {
    context.globalAlpha = alpha;
    tracePath(context, part);
    context.stroke();
  }
  context.globalAlpha = 1;
}

/** Draws each group of springs as a ray from the origin, where the springs have their rest length, with their number.
 *  Scenes of springs have no surface. */
function drawSprings(context, scene, project, colours) {
  context.strokeStyle = colours.shell;
  context.fillStyle = colours.muted;
  context.font = "12px system-ui, sans-serif";
  context.lineWidth = 2;
  for (const [x, y, z, count] of scene.springs) {
    const from = project([0, 0, 0]), unit = project([x, y, z]);
    const to = [0, 1].map((i) => from[i] + 60 * (unit[i] - from[i]) / project.scale);
    tracePath(context, [from, to]);
    context.stroke();
    context.fillText(`${count} springs`, to[0] + 4, to[1] - 4);
  }
}

function drawScene(canvas, scene, camera, recording, row) {
  const view = prepared(canvas), {context, width, height} = view, colours = palette();
  const project = camera.projection(width, height);
  const tip = recording.tip(row), axis = recording.axis(row);
  drawSprings(context, scene, project, colours);
  const colliding = drawShell(context, scene, project, camera.basis()[2], tip, axis, view, colours);
  drawWay(context, project, recording, row, colours);
  drawTool(context, scene, project, tip, axis, colours);
  drawContacts(context, scene, project, colliding, recording.contactsAt(row), colours);
  drawForce(context, project, tip, recording.force(row), colours);
  drawScaleBar(context, height, project.scale, colours);
  drawWayOut(context, project(tip), width, height, colours);
}

/** Draws an arrow towards the tip if the tip is outside of the view. */
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
