// Saves the shown views as a picture (PNG), or as a clip (WebM) during playback.

const SHEET_WIDTH = 1280, SHEET_PAD = 16, SHEET_HEAD = 64;

/** Draws all views and the tracks on one canvas. */
function drawSheet(sheet, player) {
  const views = player.visibleSides.map((side) => side.querySelector(".view")), tracks = player.tracks, colours = palette();
  const wide = (SHEET_WIDTH - SHEET_PAD * (views.length + 1)) / views.length;
  const high = Math.max(...views.map((view) => wide * view.height / view.width));
  const tracksHigh = (SHEET_WIDTH - 2 * SHEET_PAD) * tracks.height / tracks.width;
  const height = 2 * Math.round((SHEET_HEAD + high + tracksHigh + 2 * SHEET_PAD) / 2);
  if (sheet.width !== SHEET_WIDTH || sheet.height !== height) Object.assign(sheet, {width: SHEET_WIDTH, height});
  const context = sheet.getContext("2d");
  context.fillStyle = colours.panel;
  context.fillRect(0, 0, SHEET_WIDTH, height);
  context.fillStyle = colours.ink;
  context.font = "600 18px system-ui, sans-serif";
  context.fillText(`${player.scene.title}   t = ${player.time.toFixed(4)} s`, SHEET_PAD, 26);
  context.font = "600 15px system-ui, sans-serif";
  views.forEach((view, i) => {
    const left = SHEET_PAD + i * (wide + SHEET_PAD), recording = player.shown[i];
    context.fillStyle = recording.colours[colours.theme];
    context.fillText(recording.label, left, SHEET_HEAD - 8);
    context.drawImage(view, left, SHEET_HEAD, wide, wide * view.height / view.width);
  });
  context.drawImage(tracks, SHEET_PAD, SHEET_HEAD + high + SHEET_PAD, SHEET_WIDTH - 2 * SHEET_PAD, tracksHigh);
}

function download(blob, name) {
  const link = Object.assign(document.createElement("a"), {href: URL.createObjectURL(blob), download: name});
  link.click();
  // Revoke the address after 10 s, because the download may not have started yet.
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const fileStem = (player) => `${player.scene.id}_${player.time.toFixed(4)}s`;

function savePicture(player) {
  const sheet = document.createElement("canvas");
  drawSheet(sheet, player);
  sheet.toBlob((blob) => download(blob, `${fileStem(player)}.png`), "image/png");
}

/** Records from its construction until stop(), which downloads the file. */
class Clip {
  static get possible() { return typeof MediaRecorder === "function" && "captureStream" in HTMLCanvasElement.prototype; }

  constructor(player) {
    this.player = player;
    this.sheet = document.createElement("canvas");
    this.draw();
    const stream = this.sheet.captureStream(30), sound = player.sound.stream();
    if (sound) sound.getAudioTracks().forEach((track) => stream.addTrack(track));
    this.recorder = new MediaRecorder(stream, {mimeType: "video/webm", videoBitsPerSecond: 6e6});
    const parts = [], name = `${fileStem(player)}.webm`;
    this.recorder.addEventListener("dataavailable", (event) => parts.push(event.data));
    this.recorder.addEventListener("stop", () => download(new Blob(parts, {type: "video/webm"}), name));
    this.recorder.start();
  }

  draw() { drawSheet(this.sheet, this.player); }
  stop() { this.recorder.stop(); }
}
