// Draws the stiffness field as in Fig. 2 of the thesis: u^T S u in units of K, with the stiffness tensor S, for each
// unit vector u in the plane of `lean` and `up`.

// Largest drawn value of u^T S u in units of K; larger values are cut. The text beside the field gives the true range.
const LARGEST_RATIO = 2;

function drawField(canvas, scene, recording, row) {
  const {context, width, height} = prepared(canvas), colours = palette();
  const [xx, xy, xz, yy, yz, zz] = recording.tensor(row);
  const ratio = (u) => xx * u[0] * u[0] + yy * u[1] * u[1] + zz * u[2] * u[2] +
    2 * (xy * u[0] * u[1] + xz * u[0] * u[2] + yz * u[1] * u[2]);
  const centre = [width / 2, height / 2], unit = (Math.min(width, height) / 2 - 4) / LARGEST_RATIO;
  drawGrid(context, centre, unit, colours);
  const outline = [];
  for (let i = 0; i < 180; ++i) {
    const turn = (2 * Math.PI * i) / 180, c = Math.cos(turn), s = Math.sin(turn);
    const u = scene.lean.map((x, k) => c * x + s * scene.up[k]);
    const r = unit * Math.min(LARGEST_RATIO, Math.max(0, ratio(u)));
    outline.push([centre[0] + r * c, centre[1] - r * s]);
  }
  context.fillStyle = context.strokeStyle = colours.field;
  tracePath(context, outline);
  context.closePath();
  context.globalAlpha = 0.35;
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.stroke();
  drawGradients(context, scene, recording.contactsAt(row), centre, unit, colours);
}

/** Draws the circle of stiffness K and the axes of the plane. */
function drawGrid(context, centre, unit, colours) {
  context.strokeStyle = colours.line;
  context.lineWidth = 1;
  const r = LARGEST_RATIO * unit;
  for (const [dx, dy] of [[r, 0], [0, r]]) {
    tracePath(context, [[centre[0] - dx, centre[1] - dy], [centre[0] + dx, centre[1] + dy]]);
    context.stroke();
  }
  context.strokeStyle = colours.ink;
  context.setLineDash([4, 3]);
  context.beginPath();
  context.arc(centre[0], centre[1], unit, 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
  context.fillStyle = colours.muted;
  context.font = "12px system-ui, sans-serif";
  context.fillText("K", centre[0] + 0.75 * unit, centre[1] - 0.75 * unit);
}

/** Draws a tick on the circle of K in the direction of each contact's gradient. */
function drawGradients(context, scene, contacts, centre, unit, colours) {
  context.strokeStyle = colours.ink;
  for (const {gradient} of contacts) {
    const along = (e) => gradient[0] * e[0] + gradient[1] * e[1] + gradient[2] * e[2];
    const x = along(scene.lean), y = along(scene.up), length = Math.hypot(x, y);
    if (length < 0.3) continue;
    const at = (r) => [centre[0] + (r * unit * x) / length, centre[1] - (r * unit * y) / length];
    tracePath(context, [at(0.93), at(1.07)]);
    context.stroke();
  }
}
