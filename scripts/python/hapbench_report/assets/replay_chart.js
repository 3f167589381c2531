// The size of the rendered force over time, both sides in one chart; a click goes to that time.

const CHART_LEFT = 48, CHART_BOTTOM = 18, CHART_TOP = 6;

function drawChart(canvas, recordings, duration, time) {
  const {context, width, height} = prepared(canvas), colours = palette();
  const columns = Math.max(1, Math.floor(width - CHART_LEFT - 4)), bottom = height - CHART_BOTTOM;
  const all = recordings.map((recording) => recording.peaks(duration, columns));
  const most = Math.max(1, ...all.map((p) => Math.max(...p)));
  const decades = [-1, Math.max(0, Math.ceil(Math.log10(most)))];
  const y = (force) => bottom - (bottom - CHART_TOP) *
    Math.max(0, (Math.log10(Math.max(force, 1e-9)) - decades[0]) / (decades[1] - decades[0]));
  drawChartGrid(context, width, bottom, decades, y, duration, colours);
  all.forEach((p, side) => {
    context.strokeStyle = side ? colours.force : colours.tool;
    context.lineWidth = side ? 2 : 1.3;
    tracePath(context, Array.from(p, (force, i) => [CHART_LEFT + i, y(force)]).filter((_, i) => p[i] > 0));
    context.stroke();
  });
  const x = CHART_LEFT + (time / duration) * columns;
  context.strokeStyle = colours.ink;
  context.lineWidth = 1.5;
  tracePath(context, [[x, CHART_TOP], [x, bottom]]);
  context.stroke();
}

function drawChartGrid(context, width, bottom, decades, y, duration, colours) {
  context.fillStyle = colours.muted;
  context.strokeStyle = colours.line;
  context.lineWidth = 1;
  context.font = "11px system-ui, sans-serif";
  const step = Math.max(1, Math.ceil((decades[1] - decades[0]) / 4));
  for (let e = decades[0]; e <= decades[1]; e += step) {
    const at = y(10 ** e);
    tracePath(context, [[CHART_LEFT, at], [width, at]]);
    context.stroke();
    context.textAlign = "end";
    context.fillText(e < 3 ? `${+(10 ** e).toPrecision(1)} N` : `${10 ** (e - 3)} kN`, CHART_LEFT - 5, at + 4);
  }
  context.textAlign = "start";
  context.fillText("0 s", CHART_LEFT, bottom + 14);
  context.textAlign = "end";
  context.fillText(`${+duration.toPrecision(3)} s`, width - 2, bottom + 14);
  context.textAlign = "start";
}

/** The time under a pointer. */
function chartTime(canvas, event, duration) {
  const x = event.clientX - canvas.getBoundingClientRect().left - CHART_LEFT;
  return Math.min(1, Math.max(0, x / (canvas.clientWidth - CHART_LEFT - 4))) * duration;
}
