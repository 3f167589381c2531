// Plots force, depth and number of contacts over time in tracks, one below the other, for all shown runs.

const TRACK_LEFT = 66, TRACK_RIGHT = 10, TRACK_TOP = 8, TRACK_BOTTOM = 36, TRACK_GAP = 12;
const TRACKS = [
  {title: "force", unit: "N", of: (r, k) => norm(r.force(k))},
  {title: "depth", unit: "mm", of: (r, k) => r.value(k, "depth_max_m") * 1e3},
  {title: "contacts", unit: "", of: (r, k) => r.colliding[k]},
];

/** Returns a step between ticks, 1, 2 or 5 times a power of ten: at most `count` steps fit into the range. */
function roundStep(range, count) {
  const least = range / count, decade = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((m) => m * decade).find((step) => step >= least * (1 - 1e-9));
}

/** Formats a tick's value, rounded to the digits of the step, without rounding errors of floating-point numbers. */
const tickText = (value, step) =>
  (Math.abs(value) >= 1e5 || (step < 1e-4 && value) ? value.toExponential(0) : value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))))
    .replace("-", "−");

function linearAxis(low, high, count = 4) {
  const top = high > low ? high : low + 1, step = roundStep(top - low, count), ticks = [];
  for (let i = Math.ceil(low / step); i * step <= top * (1 + 1e-9); ++i) ticks.push([i * step, tickText(i * step, step)]);
  return {at: (value) => (value - low) / (top - low), ticks};
}

/** Returns an axis from the decade below the first percentile of the positive values to the decade above their largest,
 *  with at most eight decades. */
function logarithmicAxis(values) {
  const sizes = values.filter((value) => value > 0).sort((a, b) => a - b);
  if (!sizes.length) return linearAxis(0, 1);
  const top = Math.ceil(Math.log10(sizes[sizes.length - 1]) + 1e-9);
  const low = Math.min(top - 1, Math.max(top - 8, Math.floor(Math.log10(sizes[Math.floor(sizes.length / 100)]))));
  const every = Math.ceil((top - low) / 4), ticks = [];
  for (let e = top; e >= low; e -= every) ticks.push([10 ** e, show10(e)]);
  return {at: (value) => Math.max(0, (Math.log10(Math.max(value, 1e-30)) - low) / (top - low)), ticks};
}

const show10 = (e) => (e >= -3 && e <= 4 ? String(+(10 ** e).toPrecision(1)) : `1e${e}`.replace("-", "−"));

/** Returns true if the largest force of all runs is more than 30 times the smallest median force of a run. On a linear
 *  axis, an unstable run or a landing would hide the other forces. */
function needsLogarithm(recordings) {
  const peaks = recordings.map((r) => Array.from({length: r.length}, (_, k) => norm(r.force(k)))).map((sizes) => {
    const touching = sizes.filter((size) => size > 0).sort((a, b) => a - b);
    return touching.length ? [touching[touching.length - 1], touching[touching.length >> 1]] : null;
  }).filter(Boolean);
  return peaks.length > 0 && Math.max(...peaks.map((p) => p[0])) > 30 * Math.min(...peaks.map((p) => p[1]));
}

/** Draws the curves, and a line at `time` [s]. The curves are cached until size, theme, runs or axes change. */
function drawTracks(canvas, recordings, duration, time, logarithmic) {
  const {context, width, height} = prepared(canvas), colours = palette();
  const key = [width, height, canvas.width, colours.theme, duration, logarithmic, ...recordings.map((r) => r.label)].join("|");
  if (canvas.paintedKey !== key) {
    canvas.painted = Object.assign(document.createElement("canvas"), {width: canvas.width, height: canvas.height});
    const layer = canvas.painted.getContext("2d");
    layer.setTransform(context.getTransform());
    paintTracks(layer, width, height, recordings, duration, logarithmic, colours);
    canvas.paintedKey = key;
  }
  context.drawImage(canvas.painted, 0, 0, width, height);
  const now = TRACK_LEFT + (time / duration) * (width - TRACK_LEFT - TRACK_RIGHT);
  context.strokeStyle = colours.ink;
  context.lineWidth = 1.5;
  tracePath(context, [[now, TRACK_TOP], [now, height - TRACK_BOTTOM]]);
  context.stroke();
}

function paintTracks(context, width, height, recordings, duration, logarithmic, colours) {
  const high = (height - TRACK_TOP - TRACK_BOTTOM - (TRACKS.length - 1) * TRACK_GAP) / TRACKS.length;
  const x = (t) => TRACK_LEFT + (t / duration) * (width - TRACK_LEFT - TRACK_RIGHT);
  context.font = "12px system-ui, sans-serif";
  const times = linearAxis(0, duration, Math.max(2, Math.round(width / 80)));
  TRACKS.forEach((track, i) => {
    const box = {left: TRACK_LEFT, right: width - TRACK_RIGHT, top: TRACK_TOP + i * (high + TRACK_GAP), high};
    const values = recordings.map((r) => Array.from({length: r.length}, (_, k) => track.of(r, k)));
    const most = Math.max(0, ...values.flat().filter(Number.isFinite));
    const log = logarithmic && track.unit === "N";
    const axis = log ? logarithmicAxis(values.flat()) : linearAxis(0, most);
    drawFrame(context, box, track, axis, times, x, colours);
    recordings.forEach((r, side) => drawTrackCurve(context, box, r, values[side], axis, x, colours));
  });
  drawTimeAxis(context, width, height, times, x, colours);
}

function drawFrame(context, box, track, axis, times, x, colours) {
  const bottom = box.top + box.high, y = (value) => bottom - axis.at(value) * box.high;
  context.strokeStyle = colours.line;
  context.lineWidth = 1;
  context.fillStyle = colours.muted;
  context.textAlign = "end";
  for (const [value, label] of axis.ticks) {
    tracePath(context, [[box.left, y(value)], [box.right, y(value)]]);
    context.stroke();
    // Skip the top label, which would overlap a label of the track above, unless the axis has few labels.
    if (y(value) > box.top + 4 || axis.ticks.length < 3) context.fillText(label, box.left - 5, y(value) + 4);
  }
  for (const [value] of times.ticks) {
    tracePath(context, [[x(value), box.top], [x(value), bottom]]);
    context.stroke();
  }
  context.save();
  context.translate(12, box.top + box.high / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillStyle = colours.ink;
  context.fillText(track.unit ? `${track.title} [${track.unit}]` : track.title, 0, 0);
  context.restore();
}

function drawTrackCurve(context, box, recording, values, axis, x, colours) {
  const bottom = box.top + box.high;
  context.save();
  context.beginPath();
  context.rect(box.left, box.top - 2, box.right - box.left, box.high + 4);
  context.clip();
  context.strokeStyle = context.fillStyle = recording.colours[colours.theme];
  context.lineWidth = 1.4;
  context.setLineDash(recording.dash.map((length) => 1.4 * length));
  tracePath(context, values.map((value, k) => [x(recording.time(k)), bottom - axis.at(value) * box.high]));
  context.stroke();
  context.setLineDash([]);
  context.restore();
  const touch = recording.firstTouch;
  if (touch < 0) return;
  const at = x(recording.time(touch));
  tracePath(context, [[at, bottom], [at - 4, bottom + 7], [at + 4, bottom + 7]]);
  context.fillStyle = recording.colours[colours.theme];
  context.fill();
}

function drawTimeAxis(context, width, height, times, x, colours) {
  context.fillStyle = colours.muted;
  context.textAlign = "center";
  for (const [value, label] of times.ticks) context.fillText(label, Math.min(x(value), width - 14), height - TRACK_BOTTOM + 20);
  context.fillStyle = colours.ink;
  context.fillText("time [s]", (TRACK_LEFT + width - TRACK_RIGHT) / 2, height - 4);
  context.textAlign = "start";
}

/** Returns the time [s] at the pointer's position. */
function trackTime(canvas, event, duration) {
  const x = event.clientX - canvas.getBoundingClientRect().left - TRACK_LEFT;
  return Math.min(1, Math.max(0, x / (canvas.clientWidth - TRACK_LEFT - TRACK_RIGHT))) * duration;
}
